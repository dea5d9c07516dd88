"""Scene files: several swimmers, refused in sentences."""

import numpy as np
import pytest

import microswim as ms
from microswim.spec.readers.scene import read_scene

PRESET = '[[swimmer]]\npreset = "tabak/helix"\n'
BESIDE = PRESET + "position = [0, 3, 0]\n"
IN_SI = '[[swimmer]]\npreset = "goto/C"\n'


@pytest.fixture
def scene(tmp_path):
    def write(text, **overrides):
        path = tmp_path / "scene.toml"
        path.write_text(text)
        return read_scene(path, overrides)

    return write


def test_a_scene_says_who_is_where(scene):
    group = scene(
        PRESET + "\n" + BESIDE + 'direction = [0, 2, 0]\nroll = "90 deg"\nphase = 1.5\n'
        'frequency = 2.0\nfree = "none"\nforce = [1, 0, 0]\n'
        '[swimmer.set]\n"tail.amplitude" = 0.08\n'
    )
    first, second = group.members
    assert first.position == (0.0, 0.0, 0.0)
    assert first.swimmer.tail.frequency == 1.0
    assert second.position == (0.0, 3.0, 0.0)
    assert second.rotation @ [1, 0, 0] == pytest.approx([0, 1, 0])
    assert second.rotation @ [0, 1, 0] == pytest.approx([0, 0, 1])  # the roll is about s
    assert second.roll == pytest.approx(np.pi / 2)
    assert (second.phase, second.swimmer.tail.frequency) == (1.5, 2.0)
    assert second.swimmer.tail.amplitude == 0.08
    assert second.wrench == pytest.approx([0, 0, 1, 0, 0, 0])
    assert not any(second.swimmer.motion.mask)


def test_specs_stand_beside_the_scene_and_are_read_once(tmp_path, monkeypatch):
    cells = tmp_path / "cells"
    cells.mkdir()
    (cells / "one.toml").write_text(ms.Swimmer.preset("goto/C").to_toml())
    text = '[[swimmer]]\nspec = "one.toml"\n[[swimmer]]\nspec = "one.toml"\n'
    (cells / "scene.toml").write_text(text + 'position = ["0 um", "9 um", "0 um"]\n')
    monkeypatch.chdir(tmp_path)
    group = ms.Group.from_toml("cells/scene.toml")
    assert group.units == "SI"
    assert group.members[1].position[1] == pytest.approx(9e-6)
    assert group.members[0].swimmer is group.members[1].swimmer  # one block serves both


def test_a_scene_may_have_a_wall(scene):
    wall = '[wall]\nposition = ["0 um", "-5 um", "0 um"]\nnormal = [0, 2, 0]\n'
    assert scene(IN_SI + wall).plane == pytest.approx([0, -5e-6, 0, 0, 1, 0])
    assert scene(IN_SI).plane is None


def test_overrides_are_of_one_swimmer_or_of_all(scene):
    changes = {
        "swimmer[1].phase": "90 deg",
        "swimmer[0].tail.amplitude": 0.05,
        "tail.frequency": 3.0,
    }
    first, second = scene(PRESET + BESIDE, **changes).members
    assert second.phase == pytest.approx(np.pi / 2)
    assert [m.swimmer.tail.amplitude for m in (first, second)] == [0.05, 0.1]
    assert [m.swimmer.tail.frequency for m in (first, second)] == [3.0, 3.0]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no [[swimmer]] table"),
        ("swimmer = 5", "no [[swimmer]] table"),
        ("[swimmer]\npreset = 'tabak/helix'", "in double brackets"),
        ("[fluid]\nviscosity = 1\n[body]\n[tail]", "this is the spec of one swimmer"),
        (PRESET + "[walls]", "walls: no such table in a scene"),
        (PRESET + "[wall]\nposition = [0, -1, 0]", "wall.normal: missing; add it"),
        (PRESET + "[wall]\nnormal = [0, 0, 0]", "wall normal = (0.0, 0.0, 0.0): must be a direct"),
        (PRESET + "[wall]\nnormal = [0, 1]", "wall normal = "),
        (PRESET + '[wall]\nnormal = [0, 1, 0]\nposition = ["1 um", 0, 0]', "wall.position[0] = '1"),
        ("[[swimmer]]\nposition = [0, 0, 0]", "swimmer[0].spec: missing; add spec"),
        (PRESET + 'spec = "x.toml"', "swimmer[0].spec: give one of"),
        ('[[swimmer]]\nspec = "gone.toml"', "gone.toml: no such file"),
        ('[[swimmer]]\npreset = "tabak/helx"', "swimmer[0], tabak/helx: "),
        (PRESET + "positon = [1, 2, 3]", "swimmer[0].positon: no such field of a swimmer in a sc"),
        (PRESET + "position = [1, 2]", "swimmer[0].position = "),
        (PRESET + 'position = "here"', "swimmer[0].position = "),
        (PRESET + "position = [1, nan, 2]", "swimmer[0].position"),
        (PRESET + "direction = [0, 0, 0]", "swimmer[0].direction = (0.0, 0.0, 0.0): must be a dir"),
        (PRESET + 'phase = "1 um"', "swimmer[0].phase = "),
        (PRESET + 'free = "some"', "motion.free = 'some'"),
        (PRESET + 'set = "x"', "swimmer[0].set = "),
        (PRESET + '[swimmer.set]\n"tail.amplitud" = 1', "tail.amplitud: no such field"),
        (PRESET + IN_SI, "swimmer[1]: its spec has units, that of swimmer[0] has none"),
        (IN_SI + "position = [0, 2, 0]", "swimmer[0].position[1] = 2: must have a unit"),
        (IN_SI + "force = [1, 0, 0]", 'must have a unit, as in "1 pN"'),
        (PRESET + 'position = ["1 um", 0, 0]', "must be a bare number; the spec has no units"),
        (PRESET + PRESET + '[swimmer.set]\n"fluid.viscosity" = 2.0', "a group swims in one fluid"),
        (PRESET + "[swimmer.set]\nwall = {distance = 3.0}", "wall: a swimmer of a group stands in"),
        (
            PRESET
            + "[swimmer.set]\ngravity = {density = 2.0, acceleration = 1.0}\n"
            + PRESET
            + "[swimmer.set]\ngravity = {density = 2.0, acceleration = 2.0}",
            "swimmer[1] gravity: must pull as on swimmer[0]",
        ),
        (
            PRESET + "[swimmer.set]\nflow = {kind = 'uniform', speed = 1.0, direction = [1, 0, 0]}",
            "flow: a swimmer of a group sta",
        ),
    ],
)
def test_a_wrong_scene_is_refused_in_a_sentence(scene, text, words):
    with pytest.raises(ms.SpecError) as caught:
        scene(text)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_override_of_nobody_is_refused(scene):
    with pytest.raises(ms.SpecError, match=r"of one of swimmer\[0\] to swimmer\[0\]"):
        scene(PRESET, **{"swimmer[3].phase": 1.0})


def test_functions_run_only_from_a_trusted_file(tmp_path):
    (tmp_path / "own.py").write_text(
        "import numpy as np\n"
        "def beat(s, phase):\n"
        "    q = 0.1 * s * np.cos(3 * s - phase)\n"
        "    return np.stack([s + 0 * q, q, 0 * q], axis=-1)\n"
    )
    (tmp_path / "robot.toml").write_text(
        '[fluid]\nviscosity = 1.0\n[body]\nshape = "sphere"\nradius = 0.5\n[tail]\n'
        'kind = "custom"\nshape = "own:beat"\nlength = 2.0\nradius = 0.03\n'
    )
    path = tmp_path / "scene.toml"
    path.write_text('[[swimmer]]\nspec = "robot.toml"\n')
    with pytest.raises(ms.SpecError, match=r"--trust own\.py"):
        read_scene(path)
    assert read_scene(path, trust=tmp_path / "own.py").members[0].swimmer.tail.kind == "custom"


MAGNET = '[swimmer.set]\n"magnet.moment" = ["0 A m^2", "1e-15 A m^2", "0 A m^2"]\n'
TURNS = '[field]\nkind = "rotating"\nstrength = "5 mT"\nfrequency = "2 Hz"\n'


def test_a_scene_has_a_field(scene):
    group = scene(IN_SI + MAGNET + TURNS)
    assert group.field == ms.RotatingField(strength=5e-3, frequency=2.0)
    # at time zero B is along y, as the moment; a quarter turn later along z
    assert group.wrench == pytest.approx(np.zeros(6), abs=1e-30)
    assert group.moved(time=0.125).wrench[3] == pytest.approx(5e-18)


def test_the_field_of_a_scene_takes_the_place_of_those_of_the_specs(scene):
    robot = '[[swimmer]]\npreset = "shapes/magnet"\n'
    with pytest.raises(ms.SpecError, match="field: a swimmer of a group stands in still"):
        scene(robot)
    group = scene(robot + TURNS)
    assert group.field.frequency == 2.0
    assert group.members[0].swimmer.field is None
    assert group.members[0].swimmer.magnet is not None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (IN_SI + TURNS, "field: no swimmer of the group has a magnet"),
        (IN_SI + MAGNET + TURNS.replace('"5 mT"', "5.0"), "field.strength"),
        (IN_SI + MAGNET + TURNS.replace("rotating", "rotary"), "field.kind"),
        ("field = 3\n" + IN_SI + MAGNET, "field = 3"),
        (
            IN_SI + MAGNET + '[field]\nkind = "coils"\nfile = "none.yaml"\ncurrents = ["1 A"]\n',
            "none.yaml",
        ),
    ],
)
def test_a_field_that_makes_no_sense_is_a_sentence(scene, text, said):
    with pytest.raises(ms.SpecError, match=said) as told:
        scene(text)
    assert "\n" not in str(told.value)
