"""Fields by tables in time: a sequence of B, and a magnet on an arm."""

from dataclasses import replace

import magpylib
import numpy as np
import pytest

import microswim as ms
from microswim.spec.file import from_dict
from microswim.spec.readers.text import toml


def table(path, head, rows):
    lines = [",".join(map(str, row)) for row in rows]
    path.write_text("\n".join([head, *lines]), encoding="utf-8")
    return str(path)


HEAD = "t (ms),Bx (mT),By (mT),Bz (mT)"
ROBOT = """
[fluid]
viscosity = "0.34 Pa s"
[body]
shape = "ellipsoid"
semi_axes = ["0.6 mm", "0.3 mm", "0.3 mm"]
[tail]
kind = "none"
[magnet]
moment = ["2e-7 A m^2", "0 A m^2", "0 A m^2"]
"""


def test_a_sequence_is_straight_between_its_rows_and_stays_at_its_ends(tmp_path):
    rows = [(0, 0, 0, 5), (100, 4, 0, 5), (300, 0, -2, 0)]
    field = ms.SequenceField(file=table(tmp_path / "b.csv", HEAD, rows))
    found = field.at([-1.0, 0.05, 0.2, 0.3, 9.0])
    assert 1e3 * found == pytest.approx(
        np.array([[0, 0, 5], [2, 0, 5], [2, -1, 2.5], [0, -2, 0], [0, -2, 0]]), abs=1e-12
    )
    assert not field.gradient(0.1, (1.0, 2.0, 3.0)).any()


def test_a_sequence_repeats(tmp_path):
    rows = [(0, 0, 0, 5), (100, 4, 0, 5), (200, 0, 0, 5)]
    field = ms.SequenceField(file=table(tmp_path / "b.csv", HEAD, rows), repeat=True)
    assert field.at(0.75) == pytest.approx(field.at(0.15), abs=1e-15)
    bad = table(tmp_path / "c.csv", HEAD, rows[:2])
    with pytest.raises(ms.SpecError, match="the first again"):
        ms.SequenceField(file=bad, repeat=True)


def test_a_path_in_a_finely_written_rotating_field_is_that_in_the_field(tmp_path):
    """The rows lie on the rotating field; the error falls with the square of their spacing."""
    exact = ms.RotatingField(strength=3e-3, frequency=0.5, axis=(0, 0, 1))
    robot = from_dict(toml(ROBOT, "robot"))
    wanted = ms.path(replace(robot, field=exact), 2.0, model="rft", samples=3, tolerance=1e-9)
    missed = []
    for n in (40, 80):
        times = np.linspace(0.0, 2.0, n + 1)
        rows = [(1e3 * t, *(1e3 * b)) for t, b in zip(times, exact.at(times))]
        file = table(tmp_path / f"b{n}.csv", HEAD, rows)
        text = ROBOT + f'[field]\nkind = "sequence"\nfile = {file!r}\n'
        one = ms.path(from_dict(toml(text, "r")), 2.0, model="rft", samples=3, tolerance=1e-9)
        missed.append(np.abs(one.quaternion.values[-1] - wanted.quaternion.values[-1]).max())
    assert missed[0] < 2e-3
    assert missed[0] / missed[1] == pytest.approx(4.0, rel=0.1)


def test_a_magnet_that_moves_is_magpylibs_dipole_there():
    field = ms.DipoleField(
        moment=(3.0, -7.0, 5.0), position=(0.1, 0.02, -0.06), velocity=(0.01, 0.0, -0.02),
        axis=(0, 1, 1), frequency=0.2,
    )  # fmt: skip
    x, t = np.array([0.01, -0.02, 0.005]), 0.7
    here, moment = field.pose(t)
    assert here == pytest.approx([0.107, 0.02, -0.074])
    other = magpylib.misc.Dipole(moment=moment, position=here)
    assert field.at(t, x) == pytest.approx(other.getB(x), rel=1e-9)
    many = field.at(np.array([0.0, t]), x)
    assert many[1] == pytest.approx(field.at(t, x), rel=1e-15)


def test_an_arm_goes_through_its_rows_and_may_turn_the_magnet(tmp_path):
    head = "t (s),x (mm),y (mm),z (mm),mx (A m^2),my (A m^2),mz (A m^2)"
    rows = [(0, 100, 0, 0, 5, 0, 0), (1, 80, 10, 0, 0, 5, 0), (3, 60, 10, 5, 0, 0, 5)]
    field = ms.DipoleField(file=table(tmp_path / "arm.csv", head, rows))
    for t, *pose in rows:
        here, moment = field.pose(t)
        assert [*(1e3 * here), *moment] == pytest.approx(pose)
    assert field.pose(9.0)[0] == pytest.approx(field.pose(3.0)[0])
    plain = table(tmp_path / "way.csv", head[:26], [row[:4] for row in rows])
    turned = ms.DipoleField(file=plain, moment=(0, 5, 0), frequency=1.0)
    assert turned.pose(0.25)[1] == pytest.approx([0, 0, 5], abs=1e-12)


def test_what_a_robot_feels_follows_the_arm(tmp_path):
    head = "t (s),x (mm),y (mm),z (mm)"
    rows = [(0, 60, 0, 0), (1, 60, 0, 0), (2, 50, 20, 0)]
    file = table(tmp_path / "arm.csv", head, rows)
    text = (
        ROBOT
        + f"""
    [field]
    kind = "dipole"
    moment = ["5 A m^2", "0 A m^2", "0 A m^2"]
    file = {file!r}
    """
    )
    found = ms.path(from_dict(toml(text, "robot")), 2.0, model="rft", samples=3)
    x = found.position.values
    assert x[1, 0] > 1e-5  # drawn along the line, then aside
    assert abs(x[1, 1]) < 1e-12
    assert abs(x[2, 1]) > 1e-6


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({}, "field.moment"),
        ({"moment": (1, 0, 0)}, "field.position"),
        ({"moment": (1, 0, 0), "position": (1, 0, 0), "file": "way"}, "position"),
        ({"moment": (1, 0, 0), "file": "turns"}, "moment"),
        ({"moment": (1, 0, 0), "file": "none"}, "none"),
    ],
)
def test_what_is_no_way_is_refused(tmp_path, given, word):
    head = "t (s),x (mm),y (mm),z (mm),mx (A m^2),my (A m^2),mz (A m^2)"
    rows = [(0, 100, 0, 0, 5, 0, 0), (1, 80, 10, 0, 0, 5, 0)]
    files = {
        "turns": table(tmp_path / "turns.csv", head, rows),
        "way": table(tmp_path / "way.csv", head[:26], [row[:4] for row in rows]),
        "none": str(tmp_path / "none.csv"),
    }
    if "file" in given:
        given = {**given, "file": files[given["file"]]}
    with pytest.raises(ms.SpecError, match=word):
        ms.DipoleField(**given)


def test_times_that_go_back_are_refused(tmp_path):
    file = table(tmp_path / "b.csv", HEAD, [(0, 0, 0, 5), (0, 4, 0, 5)])
    with pytest.raises(ms.SpecError, match="must increase"):
        ms.SequenceField(file=file)
    bare = table(tmp_path / "c.csv", "t,Bx,By,Bz", [(0, 0, 0, 5), (1, 4, 0, 5)])
    with pytest.raises(ms.SpecError, match="no unit"):
        ms.SequenceField(file=bare)
