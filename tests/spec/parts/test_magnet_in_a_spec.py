"""[magnet] and [field]: read with units, written back the same, refused in a sentence."""

import numpy as np
import pytest

import microswim as ms
from microswim.spec.describe import to_tables
from microswim.spec.file import from_dict
from microswim.spec.readers.text import toml
from microswim.spec.toml import to_toml
from microswim.studio.spec_tables import canonical

ROBOT = toml(
    """
    [fluid]
    kinematic_viscosity = "350 cSt"
    density = "970 kg/m^3"
    [body]
    shape = "sphere"
    radius = "0.3 mm"
    [tail]
    kind = "helix"
    length = "1.4 mm"
    radius = "0.05 mm"
    amplitude = "0.2 mm"
    waves = 2
    [magnet]
    remanence = "1.2 T"
    size = ["1 mm", "1 mm", "0.5 mm"]
    direction = [0, 2, 0]
    [field]
    kind = "rotating"
    strength = "50 G"
    frequency = "600 rpm"
    axis = [0, 0, 3]
    cone = "10 deg"
    """,
    "robot",
)


def test_units_are_read():
    robot = from_dict(ROBOT)
    mu_0 = 4e-7 * np.pi  # to ten digits, as the metre was once defined
    assert robot.magnet.vector == pytest.approx([0.0, 1.2 * 0.5e-9 / mu_0, 0.0], rel=1e-8)
    assert robot.field.strength == pytest.approx(5e-3)
    assert robot.field.rate == pytest.approx(20.0 * np.pi)
    assert robot.fluid.viscosity == pytest.approx(350e-6 * 970)


@pytest.mark.parametrize("written", [to_tables, canonical])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"magnet.direction": "30 deg", "magnet.azimuth": "40 deg"},
        {"magnet": {"moment": ["0 A m^2", "1e-6 A m^2", "2e-6 A m^2"]}},
        {"magnet": {"remanence": "1 T", "volume": "0.5 mm^3", "direction": [1, 1, 0]}},
        {"field": {"kind": "uniform", "strength": "1 mT", "direction": [0, 1, 1]}},
        {"field": {"kind": "oscillating", "strength": "1 mT", "frequency": "2 Hz"}},
    ],
)
def test_a_spec_reads_back(written, changes):
    robot = from_dict(ROBOT, changes)
    again = from_dict(toml(to_toml(written(robot), "again"), "again"))
    assert again.magnet.vector == pytest.approx(robot.magnet.vector, rel=1e-11)
    assert again.field.kind == robot.field.kind
    for time in (0.0, 0.013, 1.7):
        expected = robot.field.at(time)
        assert again.field.at(time) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"field.kind": "spinning"}, 'field.kind = .spinning.: must be one of "rotating"'),
        ({"field.strenght": "1 mT"}, 'did you mean "field.strength"'),
        ({"field.B": "1 mT"}, 'did you mean "field.strength"'),
        ({"field.strength": 5}, "field.strength: must have a unit"),
        ({"field.strength": "5 mm"}, "field.strength = '5 mm': must have the dimension of T"),
        ({"field.strength": "0 T"}, "field.strength = 0 T: must be a positive"),
        ({"field.frequency": "0 Hz"}, "field.frequency = 0 Hz: must be other than zero"),
        ({"field.axis": [0, 0, 0]}, "field.axis = .*a vector other than zero"),
        ({"field.axis": [1, 0]}, r"field.axis = .*three numbers \[x, y, z\]"),
        ({"field.cone": "90 deg"}, "field.cone = .*right angle"),
        ({"magnet.moment": "1 A m^2"}, "magnet: give moment, or remanence"),
        ({"magnet.size": ["1 mm", "1 mm"]}, "magnet.size = .*three lengths"),
        ({"magnet.size": ["1 mm", "1 mm", "0 mm"]}, r"magnet.size\[2\] = 0 mm"),
        ({"magnet.shape": "sphere"}, "magnet.size = .*a list of the diameter"),
        ({"magnet.volume": "1 mm^3"}, "size or volume, one of the two"),
        ({"magnet.direction": [0, 0, 0]}, "magnet.direction = .*other than zero"),
        ({"magnet.direction": "30 furlong"}, "magnet.direction = .*furlong"),
        ({"magnet": {"remanence": "1 T", "volume": "1 mm^3"}}, "magnet.direction: missing"),
        ({"magnet": {"moment": ["1 A m^2"]}}, "magnet.moment = .*three numbers"),
        ({"magnet": {"moment": ["1 A", "0 A m^2", "0 A m^2"]}}, r"magnet.moment\[0\] = '1 A'"),
        (
            {"magnet": {"moment": ["1 A m^2"] * 3, "direction": "3 deg"}},
            "the moment is a vector already",
        ),
        ({"magnet": {"moment": "1 A m^2", "volume": "1 m^3", "direction": 0}}, "magnet.volume"),
    ],
)
def test_one_sentence_says_what_is_wrong(changes, words):
    with pytest.raises(ms.SpecError, match=words) as caught:
        from_dict(ROBOT, changes)
    assert "\n" not in str(caught.value)
    assert "function" not in str(caught.value)


def test_an_entry_of_the_moment_of_a_filament_is_named():
    """A kind of field is called magnet too."""
    tail = {"kind": "elastic", "length": "1 mm", "radius": "10 um", "bending": "3e-15 N m^2",
            "drive": "none", "magnet": ["1e-6 A m", "0 A m^2", "0 A m^2"]}  # fmt: skip
    with pytest.raises(ms.SpecError, match=r"tail\.magnet\[0\] = '1e-6 A m'"):
        from_dict({**ROBOT, "tail": tail})


def test_a_swimmer_without_units_has_a_moment():
    bare = ms.Swimmer.preset("tabak/helix", {"magnet": {"moment": [0, 1, 0]}})
    assert bare.magnet.vector.tolist() == [0.0, 1.0, 0.0]
    with pytest.raises(ms.SpecError, match="without units give the moment"):
        ms.Swimmer.preset(
            "tabak/helix", {"magnet": {"remanence": 1.0, "volume": 1.0, "direction": [1, 0, 0]}}
        )


def test_fields_are_set_by_dotted_name():
    robot = from_dict(ROBOT)
    other = robot.with_({"magnet.direction": "60 deg", "field.strength": "3 mT"})
    size = np.linalg.norm(robot.magnet.vector)
    expected = size * np.array([0.5, np.sqrt(0.75), 0.0])
    assert other.magnet.vector == pytest.approx(expected, rel=1e-12)
    assert other.field.strength == 3e-3
    assert robot.with_({"magnet.size[2]": 1e-3}).magnet.strength == pytest.approx(2 * size)


def test_the_gait_does_not_depend_on_magnet_and_field():
    robot = from_dict(ROBOT)
    bare = from_dict({k: v for k, v in ROBOT.items() if k not in ("magnet", "field")})
    assert robot.gait().mean_velocity.tolist() == bare.gait().mean_velocity.tolist()
