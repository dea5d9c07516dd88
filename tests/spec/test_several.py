"""[[tail]]: a spec with several tails, and a tail with a place."""

import pytest

import microswim as ms
from microswim.spec.file import from_dict

TAIL = {"kind": "helix", "length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}


def tables(*tails):
    return {
        "fluid": {"viscosity": 1.0},
        "body": {"shape": "sphere", "radius": 0.5},
        "tail": list(tails),
    }


TWO = tables(
    TAIL | {"position": [0.0, 0.2, 0.0], "direction": [1, 0.5, 0]},
    TAIL | {"handedness": "right", "position": [0.0, -0.2, 0.0], "phase": "30 deg"},
)


def test_several_tails_are_read_and_written_back(tmp_path):
    robot = from_dict(TWO)
    assert [t.handedness for t in robot.tail.each] == ["left", "right"]
    assert robot.tail.each[1].phase == pytest.approx(0.5235987755982988)
    file = tmp_path / "two.toml"
    file.write_text(robot.to_toml())
    assert file.read_text().count("[[tail]]") == 2
    assert ms.Swimmer.from_toml(file) == robot


def test_with_units(tmp_path):
    text = ms.Swimmer.preset("goto/C", {"motion.frequency_frame": "body"}).to_toml()
    head, tail = text.split("[tail]\n")
    tail, rest = tail.split("\n[", 1)
    moved = tail + 'position = ["0.1 um", "0.2 um", "0 um"]\nphase = "90 deg"\n'
    file = tmp_path / "two.toml"
    file.write_text(f"{head}[[tail]]\n{tail}\n[[tail]]\n{moved}\n[{rest}")
    robot = ms.Swimmer.from_toml(file)
    assert robot.tail.each[1].position == pytest.approx((1e-7, 2e-7, 0.0))
    file.write_text(robot.to_toml())
    assert '"1e-07 m"' in file.read_text()
    assert ms.Swimmer.from_toml(file) == robot
    bare = file.read_text().replace('"1e-07 m"', "1e-7")
    file.write_text(bare)
    with pytest.raises(ms.SpecError, match=r"tail\.position: must have a unit"):
        ms.Swimmer.from_toml(file)


def test_one_of_several_is_one_tail():
    assert from_dict(tables(TAIL)) == from_dict(tables() | {"tail": TAIL})


def test_a_field_is_set_in_one_or_in_all():
    robot = from_dict(TWO, {"tail[1].radius": 0.04, "tail.waves": 2, "tail[0].wavelength": 0.5})
    first, second = robot.tail.each
    assert (first.radius, second.radius, second.waves) == (0.05, 0.04, 2)
    assert (first.waves, first.wavelength) == (None, 0.5)
    assert TWO["tail"][1]["radius"] == 0.05
    same = from_dict(TWO).with_({"tail[1].radius": 0.04, "tail.waves": 2})
    assert same.with_({"tail[0].wavelength": 0.5}) == robot
    assert from_dict(tables(TAIL), {"tail[0].radius": 0.04}).tail.radius == 0.04
    assert from_dict(TWO, {"tail.frequency": 2.0}).tail.frequency == 2.0


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"tail[1].radius": -1.0}, r"^tail\[1\]\.radius = -1\.0: must be a positive length"),
        ({"tail[0].rdius": 1.0}, r"^tail\[0\]\.rdius: no such field here; .*tail\[0\]\.radius"),
        ({"tail[2].radius": 1.0}, r"^tail\[2\]\.radius.*\[0\] to \[1\]"),
        ({"tail[x].radius": 1.0}, r"^tail\[x\]\.radius.*tail\[0\]\.amplitude"),
        ({"tail[1].kind": "screw"}, r"^tail\[1\]\.kind.*one of"),
        ({"tail[1].kind": "none"}, r"^tail\[1\]"),
        ({"tail[1].frequency": 2.01}, r"^tail\[1\]\.frequency"),
        ({"tail[1].direction": [0, 0, 0]}, r"^tail\[1\]\.direction"),
        ({"tail[1].position": [0, 0]}, r"^tail\[1\]\.position"),
        ({"tail[0].length": "2 mm"}, "must have a unit|bare number"),
    ],
)
def test_what_makes_no_sense_is_said_of_the_tail_it_is_in(change, match):
    with pytest.raises(ms.SpecError, match=match):
        from_dict(TWO, change)


@pytest.mark.parametrize("tail", [[], [1], ["helix"], [[TAIL]], [TAIL] * 101])
def test_what_is_no_list_of_tails_is_refused(tail):
    with pytest.raises(ms.SpecError, match="tail"):
        from_dict(tables() | {"tail": tail})


def test_names_of_python_reach_each_tail():
    robot = from_dict(TWO)
    assert robot.numbers["tail[1].position[1]"] == -0.2
    with pytest.raises(ms.SpecError, match=r"tail\[2\]\.radius"):
        robot.with_({"tail[2].radius": 0.1})
    with pytest.raises(ms.SpecError, match=r"tail\[1\]\.radius = -0\.1"):
        robot.with_({"tail[1].radius": -0.1})
    with pytest.raises(ms.SpecError, match="a single tail"):
        ms.Swimmer(body=robot.body, fluid=robot.fluid, tail=[1, 2])
    assert ms.Swimmer(body=robot.body, fluid=robot.fluid, tail=[]).tail == ms.NoTail()


def test_an_elastic_tail_has_no_place():
    elastic = {"kind": "elastic", "length": 2.0, "radius": 0.05, "bending": 1.0, "amplitude": 0.1}
    with pytest.raises(ms.SpecError, match=r"tail\.position: no such field here"):
        from_dict(tables() | {"tail": elastic | {"position": [0, 0, 0.1]}})
    with pytest.raises(ms.SpecError, match=r"tail\[1\]\.kind"):
        from_dict(tables(TAIL, elastic))
