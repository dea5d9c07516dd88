"""Magnets and coils of finite size: dipole limit, closed forms, laws without currents."""

import numpy as np
import pytest

import microswim as ms
from microswim.spec.file import from_dict
from microswim.spec.readers.coils import read_coils
from microswim.spec.readers.text import toml
from microswim.swimmer.magnetism.magnet import MU_0

SHAPES = {"block": (0.02, 0.015, 0.03), "cylinder": (0.02, 0.03), "sphere": (0.02,)}
PLACES = np.random.default_rng(5).uniform(-0.03, 0.03, (12, 3)) + np.array([0.06, 0, 0])


def magnet(shape, **changes):
    given = {"remanence": 1.3, "position": (0.0, 0.0, 0.0), "direction": (1, 2, -1), **changes}
    return ms.MagnetField(shape=shape, size=SHAPES[shape], **given)


@pytest.mark.parametrize("shape", SHAPES)
def test_far_away_every_magnet_is_a_dipole(shape):
    """The next multipole of these shapes is the octupole: off by the square of size over way."""
    near = magnet(shape)
    dipole = ms.DipoleField(moment=tuple(near.moment), position=(0, 0, 0))
    off = []
    for far in (8.0, 16.0):
        a, b = near.at(0.0, far * PLACES), dipole.at(0.0, far * PLACES)
        J, K = near.gradient(0.0, far * PLACES), dipole.gradient(0.0, far * PLACES)
        off.append((abs(a - b).max() / abs(b).max(), abs(J - K).max() / abs(K).max()))
    if shape == "sphere":
        assert np.max(off) < 1e-9
    else:
        assert np.max(off) < 0.01
        assert off[0][0] / off[1][0] == pytest.approx(4.0, rel=0.05)
        assert off[0][1] / off[1][1] == pytest.approx(4.0, rel=0.05)


def test_on_the_axis_of_a_cylinder_field_and_slope_are_the_closed_forms():
    R, L, Br = 0.01, 0.03, 1.3
    z = np.array([0.02, 0.03, 0.06])
    a, b = z + L / 2.0, z - L / 2.0
    field = magnet("cylinder", direction=(0, 0, 1))
    B = field.at(0.0, np.stack([0 * z, 0 * z, z], axis=-1))[:, 2]
    J = field.gradient(0.0, np.stack([0 * z, 0 * z, z], axis=-1))
    assert pytest.approx(Br / 2.0 * (a / np.hypot(a, R) - b / np.hypot(b, R)), rel=1e-9) == B
    slope = Br / 2.0 * R**2 * (np.hypot(a, R) ** -3.0 - np.hypot(b, R) ** -3.0)
    assert J[:, 2, 2] == pytest.approx(slope, rel=1e-9)
    assert J[:, 0, 0] == pytest.approx(-slope / 2.0, rel=1e-8)


def test_a_magnet_that_turns_and_moves_is_seen_from_its_own_frame():
    still = magnet("block")
    field = magnet(
        "block", axis=(0, 0, 1), frequency=0.5, position=(0.01, 0.0, 0.0), velocity=(0, 0.02, 0)
    )
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    x = PLACES[0]
    seen = quarter.T @ (x - np.array([0.01, 0.01, 0.0]))
    assert field.at(0.5, x) == pytest.approx(quarter @ still.at(0.0, seen), rel=1e-12)
    J = quarter @ still.gradient(0.0, seen) @ quarter.T
    assert field.gradient(0.5, x) == pytest.approx(J, rel=1e-9, abs=1e-12)
    many = field.gradient(np.array([0.5, 0.5]), PLACES[:2])
    assert many[0] == pytest.approx(J, rel=1e-9, abs=1e-12)


COIL = """
[[coil]]
name = "east"
position = ["40 mm", "0 mm", "0 mm"]
axis = [-1, 0, 0]
diameter = "60 mm"
turns = 200
[[coil]]
position = ["0 mm", "0 mm", "50 mm"]
axis = [0, 0, 1]
diameter = "40 mm"
length = "20 mm"
thickness = "10 mm"
turns = 300
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "coils.toml"
    path.write_text(COIL, encoding="utf-8")
    return str(path)


def test_on_the_axis_of_a_loop_field_and_slope_are_the_closed_forms(file):
    loop = read_coils(file)[0]
    x, a = np.array([0.0, 0.02, -0.03]), 0.03
    d = x - 0.04
    places = np.stack([x, 0 * x, 0 * x], axis=-1)
    B, J = loop.both(places)
    exact = -MU_0 / 2.0 * 200 * a**2 * (a**2 + d**2) ** -1.5
    assert B[:, 0] == pytest.approx(exact, rel=1e-9)
    assert np.abs(B[:, 1:]).max() < 1e-9 * np.abs(B).max()
    assert J[:, 0, 0] == pytest.approx(-3.0 * d / (a**2 + d**2) * exact, rel=1e-9)


def test_on_the_axis_of_a_thick_winding_the_field_is_the_closed_form(file):
    """``mu_0 N I / (2 l t) [z asinh(R / z)]`` between radii and ends [Montgomery]."""
    coil = read_coils(file)[1]

    def part(z):
        return z * np.log((0.025 + np.hypot(0.025, z)) / (0.015 + np.hypot(0.015, z)))

    z = np.array([0.0, 0.02, 0.05, 0.09])
    low, high = z - 0.06, z - 0.04
    exact = MU_0 * 300 / (2.0 * 0.02 * 0.01) * (part(high) - part(low))
    B = coil.field(np.stack([0 * z, 0 * z, z], axis=-1))[:, 2]
    assert pytest.approx(exact, rel=1e-6) == B


@pytest.mark.parametrize("source", ["block", "cylinder", "winding"])
def test_there_is_neither_source_nor_current_and_the_slope_is_that_of_differences(source, file):
    if source == "winding":
        coil = read_coils(file)[1]
        field, J = coil.field, coil.gradient(PLACES)
    else:
        one = magnet(source)
        field, J = (lambda x: one.at(0.0, x)), one.gradient(0.0, PLACES)
    h = 2e-4
    for j, step in enumerate(h * np.eye(3)):
        near, far = field(PLACES + step) - field(PLACES - step), None
        far = field(PLACES + 2 * step) - field(PLACES - 2 * step)
        assert J[..., j] == pytest.approx((8 * near - far) / (12 * h), rel=1e-5, abs=1e-6)
    assert np.abs(np.trace(J, axis1=1, axis2=2)).max() < 1e-12 * np.abs(J).max()


def test_inside_the_magnet_there_is_no_gradient(file):
    for shape in SHAPES:
        assert np.isnan(magnet(shape).gradient(0.0, (0.001, 0.002, 0.003))).all()
    loop = read_coils(file)[1]
    assert np.isnan(loop.gradient((0.02, 0.0, 0.05))).all()


def test_a_spec_has_them(file):
    text = """
[fluid]
viscosity = "1 mPa s"
[body]
shape = "sphere"
radius = "0.5 mm"
[tail]
kind = "none"
[magnet]
moment = ["0 A m^2", "1e-6 A m^2", "0 A m^2"]
[field]
kind = "magnet"
remanence = "1.3 T"
shape = "cylinder"
size = ["20 mm", "30 mm"]
position = ["0 mm", "0 mm", "80 mm"]
direction = [0, 1, 0]
frequency = "2 Hz"
"""
    robot = from_dict(toml(text, "robot"))
    assert isinstance(robot.field, ms.MagnetField)
    assert robot.field.moment[1] == pytest.approx(1.3 * np.pi * 0.01**2 * 0.03 / MU_0)
    again = from_dict(toml(robot.to_toml(), "robot"))
    assert again.field == robot.field
    field = ms.CoilField(file=file, currents=(1.0, -2.0))
    one, two = read_coils(file)
    assert field.at(0.0) == pytest.approx(one.field((0, 0, 0)) - 2.0 * two.field((0, 0, 0)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"40 mm", "0 mm", "0 mm"', '"40 mm", "0 mm"', r"coil\[0\].position: must be three"),
        ("axis = [-1, 0, 0]", "axis = [0, 0, 0]", r"coil\[0\].axis: must be a vector other"),
        ("turns = 200", "turns = 0", r"coil\[0\].turns: must be positive"),
        ("turns = 200", "", r"coil\[0\].turns: missing"),
        ("turns = 200", 'turns = 200\ncore = "iron"', r"coil\[0\].core: unknown; known are"),
        ('"60 mm"', '"60 mT"', r"coil\[0\].diameter"),
        ('"10 mm"', '"50 mm"', r"coil\[1\].thickness: must be below"),
        ("[[coil]]", "[coil]", "coils.toml"),
    ],
)
def test_one_sentence_says_what_is_wrong_with_a_file(file, old, new, words):
    from pathlib import Path

    Path(file).write_text(COIL.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ms.SpecError, match=words):
        read_coils(file)
