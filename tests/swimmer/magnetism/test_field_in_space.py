"""Dipoles and coils: another package, closed forms, and the laws of a field without currents."""

import magpylib
import numpy as np
import pytest
from scipy.special import eval_legendre

import microswim as ms
from microswim.spec.file import from_dict
from microswim.spec.readers.coils import read_coils
from microswim.spec.readers.text import toml
from microswim.swimmer.magnetism.multipole import Source

PLACES = np.random.default_rng(3).uniform(-0.05, 0.05, (40, 3))
#: The layout of a calibration as it is documented; own numbers.
COILS = """
System_Name: 'example'
Workspace_Dimensions:
- [-0.01, 0.01]
- [-0.01, 0.01]
- [-0.01, 0.01]
Coil_List: [Coil_1, Coil_2]
Coil_1:
  Source_List: [Src_1]
  Src_1:
    A_Coeff: []
    B_Coeff: [[1.0e-5], [-5.0e-7]]
    Source_Position: [[0.06], [0.0], [0.0]]
    Source_Direction: [[-1.0], [0.0], [0.0]]
Coil_2:
  Source_List: [Src_1]
  Src_1:
    A_Coeff: []
    B_Coeff: [[1.0e-5]]
    Source_Position: [[0.0], [0.06], [0.0]]
    Source_Direction: [[0.0], [-1.0], [0.0]]
"""


@pytest.fixture
def coils(tmp_path):
    path = tmp_path / "coils.yaml"
    path.write_text(COILS, encoding="utf-8")
    return str(path)


def dipole(**changes):
    given = {"moment": (3.0, -7.0, 5.0), "position": (0.1, 0.02, -0.06), **changes}
    return ms.DipoleField(**given)


def slopes(field, place, h=1e-5):
    """Fourth-order differences of a field."""
    columns = []
    for step in h * np.eye(3):
        one = field(place + step) - field(place - step)
        two = field(place + 2 * step) - field(place - 2 * step)
        columns.append((8 * one - two) / (12 * h))
    return np.stack(columns, axis=-1)


def test_a_dipole_is_that_of_another_package():
    field = dipole()
    other = magpylib.misc.Dipole(moment=field.moment, position=field.position)
    assert field.at(0.0, PLACES) == pytest.approx(other.getB(PLACES), rel=1e-9, abs=1e-16)


def test_a_small_magnet_far_away_is_its_dipole():
    """A block of 1 mm at 60 mm, by its exact field elsewhere: off by the square of the ratio."""
    block = ms.Magnet(remanence=1.2, size=(1e-3, 1e-3, 1e-3), direction=(0, 0, 1))
    exact = magpylib.magnet.Cuboid(dimension=(1e-3,) * 3, polarization=(0, 0, 1.2))
    place = (0.0, 0.03, 0.05)
    near = ms.DipoleField(moment=tuple(block.vector), position=(0, 0, 0)).at(0.0, place)
    assert near == pytest.approx(exact.getB(place), rel=1e-3)


@pytest.mark.parametrize("kind", ["dipole", "coils"])
def test_gradients_are_those_of_the_field_and_obey_maxwell(kind, coils):
    field = dipole() if kind == "dipole" else ms.CoilField(file=coils, currents=(1.3, -0.4))
    J = field.gradient(0.0, 0.2 * PLACES)
    size = np.abs(J).max(axis=(1, 2))
    assert np.abs(np.trace(J, axis1=1, axis2=2)).max() < 1e-12 * size.max()  # div B = 0
    assert np.abs(J - np.swapaxes(J, 1, 2)).max() < 1e-12 * size.max()  # curl B = 0
    for place, told in zip(0.2 * PLACES[:6], J):
        found = slopes(lambda x: field.at(0.0, x), place)
        assert told == pytest.approx(found, rel=1e-8, abs=1e-8 * np.abs(told).max())


def test_the_gradient_of_a_dipole_on_its_axis_is_the_closed_form():
    """``B = mu_0 p / (2 pi z^3)`` on the axis, so that dB/dz = -3 B/z."""
    field = ms.DipoleField(moment=(0, 0, 2.0), position=(0, 0, 0))
    B = field.at(0.0, (0, 0, 0.07))
    assert B[2] == pytest.approx(4e-7 * np.pi * 2.0 / (2 * np.pi * 0.07**3), rel=1e-9)
    assert field.gradient(0.0, (0, 0, 0.07))[2, 2] == pytest.approx(-3 * B[2] / 0.07, rel=1e-12)


def test_a_dipole_turns():
    field = dipole(axis=(0, 0, 1), frequency=0.5, moment=(1.0, 0.0, 0.0))
    half = dipole(moment=(-1.0, 0.0, 0.0))
    quarter = dipole(moment=(0.0, 1.0, 0.0))
    assert field.at(1.0, PLACES) == pytest.approx(half.at(0.0, PLACES), abs=1e-12)
    assert field.at(0.5, PLACES) == pytest.approx(quarter.at(0.0, PLACES), abs=1e-12)
    times = np.linspace(0.0, 1.0, 40)
    each = [field.at(t, x) for t, x in zip(times, PLACES)]
    assert field.at(times, PLACES) == pytest.approx(np.array(each), abs=1e-14)


@pytest.mark.parametrize("order", [1, 2, 3, 5])
@pytest.mark.parametrize("side", ["inner", "outer"])
def test_multipoles_are_the_slopes_of_their_potential(order, side):
    """Potential by SciPy's Legendre polynomials, differentiated numerically."""
    axis = np.array([1.0, 2.0, -2.0]) / 3.0
    coefficients = (0.0,) * (order - 1) + (1.0,)
    own = {"inner": (), "outer": (), side: coefficients}
    source = Source(**own, position=(0.3, -0.1, 0.2), direction=tuple(axis))

    def potential(x):
        r = x - np.array(source.position)
        d = np.linalg.norm(r)
        radial = d**order if side == "inner" else d ** (-order - 1)
        return np.array([radial * eval_legendre(order, r @ axis / d)])

    for place in 20.0 * PLACES[:4]:
        slope, bend = source.derivatives(place)
        found = slopes(potential, place, 1e-3)[0]
        assert slope == pytest.approx(found, rel=1e-6, abs=1e-6 * np.abs(found).max())
        second = slopes(lambda x: source.derivatives(x)[0], place, 1e-3)
        assert bend == pytest.approx(second, rel=1e-6, abs=1e-6 * np.abs(bend).max())


def test_the_first_outer_multipole_is_a_dipole(coils):
    """``B_1 = mu_0 p / (4 pi)``: the second coil of the file is one."""
    one = ms.CoilField(file=coils, currents=(0.0, 3.0))
    p = 3.0 * 1.0e-5 / 1.0e-7
    other = ms.DipoleField(moment=(0.0, -p, 0.0), position=(0.0, 0.06, 0.0))
    assert one.at(0.0, 0.2 * PLACES) == pytest.approx(other.at(0.0, 0.2 * PLACES), rel=1e-8)


def test_currents_make_a_field_that_turns(coils):
    field = ms.CoilField(file=coils, currents=(1.0, 1.0), frequency=2.0, phases=(0.0, -np.pi / 2))
    one = ms.CoilField(file=coils, currents=(1.0, 0.0)).at(0.0)
    other = ms.CoilField(file=coils, currents=(0.0, 1.0)).at(0.0)
    assert field.at(0.0) == pytest.approx(one, abs=1e-15)
    assert field.at(0.125) == pytest.approx(other, abs=1e-15)
    assert field.rate == pytest.approx(4 * np.pi)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Coil_List: [Coil_1, Coil_2]", "", "Coil_List is missing"),
        ("Coil_List: [Coil_1, Coil_2]", "Coil_List: 3", "must be a list"),
        ("[Coil_1, Coil_2]", "[Coil_1, Coil_3]", "Coil_3 is missing"),
        ("[[0.06], [0.0], [0.0]]", "[[0.06], [0.0]]", "three numbers"),
        ("[[-1.0], [0.0], [0.0]]", "[[0.0], [0.0], [0.0]]", "three numbers"),
        ("[[1.0e-5], [-5.0e-7]]", "[[red]]", "made of numbers"),
        ("[[1.0e-5], [-5.0e-7]]", "[[.nan]]", "finite numbers"),
        ("[[1.0e-5], [-5.0e-7]]", "[]", "1 to 30 coefficients"),
        ("System_Name: 'example'", "System_Name: [", "not valid YAML"),
    ],
)
def test_a_damaged_calibration_is_refused_in_a_sentence(coils, old, new, words):
    assert old in COILS
    with open(coils, "w", encoding="utf-8") as file:
        file.write(COILS.replace(old, new, 1))
    with pytest.raises(ms.SpecError, match=words) as caught:
        read_coils(coils)
    assert "\n" not in str(caught.value)


SPEC = """
[fluid]
viscosity = "0.34 Pa s"
[body]
shape = "sphere"
radius = "0.5 mm"
[tail]
kind = "helix"
length = "2 mm"
amplitude = "0.2 mm"
waves = 2
radius = "0.1 mm"
frequency = "0 Hz"
[magnet]
moment = "1e-5 A m^2"
direction = "90 deg"
"""


def test_the_file_is_looked_for_beside_the_spec(coils, tmp_path):
    field = '[field]\nkind = "coils"\nfile = "coils.yaml"\ncurrents = ["1 A", "200 mA"]\n'
    (tmp_path / "robot.toml").write_text(SPEC + field)
    robot = ms.Swimmer.from_toml(tmp_path / "robot.toml")
    assert robot.field.currents == (1.0, 0.2)
    assert [coil.name for coil in robot.field.coils] == ["Coil_1", "Coil_2"]
    again = robot.with_({"field.frequency": "2 Hz"})
    assert again.field.rate == pytest.approx(4 * np.pi)


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ('kind = "coils"\nfile = "none.yaml"\ncurrents = ["1 A"]', "none.yaml: no such file"),
        ('kind = "dipole"\nmoment = ["1 A m^2", "0 A m^2"]\nposition = ["1 m", "1 m", "1 m"]',
         "field.moment"),
        ('kind = "dipole"\nmoment = ["1 A m^2", "0 A m^2", "0 A m^2"]', "field.position: missing"),
    ],
)  # fmt: skip
def test_one_sentence_says_what_is_wrong(field, words):
    with pytest.raises(ms.SpecError, match=words):
        from_dict(toml(SPEC + "[field]\n" + field, "robot"))


def test_currents_must_fit_the_coils(coils):
    with pytest.raises(ms.SpecError, match=r"2 numbers, one for each coil \(Coil_1, Coil_2\)"):
        ms.CoilField(file=coils, currents=(1.0,))
