"""The flow about two swimmers: against swimmers alone, and against how the bodies move."""

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the studio extra is not installed")

import microswim as ms
from microswim.models.bem import solve as solve_one
from microswim.numerics.rigid_motion import quaternion_of, rotation_matrix
from microswim.spec.file import from_dict
from microswim.studio.brought import scenes
from microswim.studio.judge import jobs, pair_flow, together
from microswim.studio.spec_tables import canonical

HELIX = canonical(ms.Swimmer.preset("tabak/helix"))
ROBOT = """[[swimmer]]
preset = "shapes/magnet"
frequency = "0 Hz"
"""
FIELD = '[field]\nkind = "rotating"\nstrength = "5 mT"\nfrequency = "5 Hz"\n'
IN_FIELD = ROBOT + ROBOT + 'position = ["0 mm", "30 mm", "0 mm"]\n' + FIELD


def quiet(*_):
    """Tell no progress."""


def places(made):
    """Points (rows, columns, 3) of a served slice, in the axes of the scene."""
    x, y = np.linspace(*made["s"], made["shape"][1]), np.linspace(*made["q"], made["shape"][0])
    axes = rotation_matrix(np.array(made["frame"]["quaternion"]))
    return made["frame"]["origin"] + np.stack(np.meshgrid(x, y), axis=-1) @ axes[:, :2].T


def velocities(made, phase):
    """Velocities (rows, columns, 3) of a slice in the axes of the scene, as the page sums them."""
    total = np.array(made["series"][0])
    for h in range(1, len(made["series"]), 2):
        n = (h + 1) // 2
        total = total + np.cos(n * phase) * np.array(made["series"][h])
        total = total + np.sin(n * phase) * np.array(made["series"][h + 1])
    axes = rotation_matrix(np.array(made["frame"]["quaternion"]))
    return total.reshape(*made["shape"], 3) @ axes.T


def question(position, **more):
    return {"members": [{"tables": HELIX}, {"tables": HELIX, "position": position, **more}]}


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(pair_flow, "POINTS", 150)


def test_far_apart_it_is_the_sum_of_the_flows_of_each_alone(small):
    """Each alone by the solver of one swimmer, at the phase of its tail, in its own axes."""
    position, turned, ahead = [0.0, 40.0, 0.0], [0.0, 0.0, 1.0], 1.2
    made = pair_flow.pair_flow(question(position, direction=turned, phase=ahead), quiet)
    x = places(made)
    back = ms.Member(swimmer=ms.Swimmer.preset("tabak/helix"), direction=turned).rotation
    for phase in (0.0, 2.0 * np.pi * 3 / 8):
        one = solve_one(from_dict(HELIX), phase, level="coarse")
        other = solve_one(from_dict(HELIX), ahead + phase, level="coarse")
        wanted = one.velocity(_from_joint(x)) + other.velocity(
            _from_joint((x - position) @ back)
        ) @ back.T  # fmt: skip
        off = np.linalg.norm(velocities(made, phase) - wanted, axis=-1)
        assert off.max() < 0.02 * made["scale"] + 2e-3 * np.linalg.norm(wanted, axis=-1).max()


def _from_joint(x):
    """Places about the body's centre as the solver of one counts them, from the joint."""
    return x - [0.5, 0.0, 0.0]


def test_on_the_bodies_it_is_the_motion_of_the_bodies_in_company(monkeypatch):
    """No slip, against the velocities of the estimate, which knows no elements of the pair."""
    monkeypatch.setattr(pair_flow, "POINTS", 3000)
    asked = question([0.5, 0.0, -3.0], phase=2.0)
    faster = {**HELIX, "tail": {**HELIX["tail"], "frequency": 1.5}}
    asked["members"][1]["tables"] = faster  # two rates: it is solved once
    group = together.group_of(asked)
    made = pair_flow.pair_flow(asked, quiet)
    x, u = places(made), velocities(made, 0.0)
    guess = group.estimate(level="coarse")
    alone = ms.Group(group.members[:1]).estimate(level="coarse").velocity[0]
    for member, V in zip(group.members, guess.velocity, strict=True):
        far = x - member.position
        Q = member.rotation
        inside = np.linalg.norm(far, axis=-1) < 0.45  # of a sphere of radius 0.5
        inside &= far @ Q[:, 0] < 0.1  # the tail's root is on the other side
        assert inside.sum() > 20
        rigid = Q @ V[:3] + np.cross(Q @ V[3:], far[inside])
        size = np.linalg.norm(rigid, axis=-1).max()
        assert np.abs(u[inside] - rigid).max() < 0.03 * size
    assert np.abs(guess.velocity[0, :3] - alone[:3]).max() > 0.02 * np.abs(alone[:3]).max()


def test_a_pose_may_be_given_by_a_quaternion(small):
    direction = [0.3, -0.5, 0.8]
    by_words = question([0.0, 4.0, 1.0], direction=direction, roll=0.7, phase=1.0)
    group = together.group_of(by_words)
    q = quaternion_of(group.members[1].rotation).tolist()
    by_quaternion = question([0.0, 4.0, 1.0], quaternion=q, phase=1.0)
    assert np.allclose(together.group_of(by_quaternion).members[1].rotation,
                       group.members[1].rotation)  # fmt: skip
    origin, axes = pair_flow.plane_of(group)
    assert np.allclose(axes.T @ axes, np.eye(3))
    for member in group.members[:1]:  # the axis of the first lies in the plane, and both middles
        assert abs((np.array(member.position) - origin) @ axes[:, 2]) < 1e-12
    middle = (
        np.array(group.members[1].position) + group.members[1].rotation[:, 0]
    )  # (2 + 0.5 - 0.5) / 2
    assert abs((middle - origin) @ axes[:, 2]) < 1e-12


def test_motors_of_two_rates_have_the_flow_of_now(small):
    asked = question([0.0, 4.0, 0.0])
    fast = {**HELIX, "tail": {**HELIX["tail"], "frequency": 2.0}}
    asked["members"][1]["tables"] = fast
    assert len(pair_flow.pair_flow(asked, quiet)["series"]) == 1


# ------------------------------------------------------------------ in one field


def of_scene(made):
    pairs = zip(made["designs"], made["places"], strict=True)
    return {"members": [{"tables": d["answer"]["tables"], **p} for d, p in pairs]}


def test_what_is_followed_in_a_field_is_the_group_made_by_hand(monkeypatch):
    """It is not followed here; turns are those of the field."""
    asked = of_scene(scenes.read(IN_FIELD)) | {"turns": 2}
    followed = []

    def path(group, times, **_):
        followed.append((group, times))
        raise ms.MicroswimError("seen")

    monkeypatch.setattr(together, "group_path", path)
    with pytest.raises(ms.MicroswimError, match="seen"):
        together.together(asked, quiet)
    ((group, times),) = followed
    assert times[-1] == pytest.approx(0.4)
    robot = ms.Swimmer.preset("shapes/magnet", {"tail.frequency": 0.0})
    bare = {k: v for k, v in canonical(robot).items() if k != "field"}
    members = (ms.Member(swimmer=from_dict(bare)),
               ms.Member(swimmer=from_dict(bare), position=(0.0, 30e-3, 0.0)))  # fmt: skip
    field = ms.RotatingField(strength=5e-3, frequency=5.0)
    truth = ms.Group(members, field=field)
    for time in (0.0, 0.03):
        assert np.allclose(group.moved(time=time).wrench, truth.moved(time=time).wrench, rtol=1e-9)
    assert group.field == truth.field
    assert [m.swimmer for m in group.members] == [m.swimmer for m in truth.members]


def test_in_a_field_that_turns_the_flow_is_that_of_now(small):
    asked = of_scene(scenes.read(IN_FIELD))
    made = pair_flow.pair_flow({**asked, "time": 0.03}, quiet)
    assert len(made["series"]) == 1
    assert made["scale"] > 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (IN_FIELD + "axis = [0, 0, 1]\n", None),
        (IN_FIELD.replace("Hz\"\n", "Hz\"\ndirection = [0, 1, 0]\n", 1), "axes of its first"),
        (IN_FIELD.replace("Hz\"\n", 'Hz"\nposition = ["1 mm", "0 mm", "0 mm"]\n', 1), "origin"),
        (IN_FIELD.replace('kind = "rotating"', 'kind = "coils"\nfile = "/etc/passwd"'), "no file"),
    ],
)  # fmt: skip
def test_a_field_of_a_scene_is_that_of_both_designs(text, said):
    if said is None:
        tables = [d["answer"]["tables"] for d in scenes.read(text)["designs"]]
        assert [t["field"]["axis"] for t in tables] == [[0.0, 0.0, 1.0]] * 2
        return
    with pytest.raises(ms.SpecError, match=said):
        scenes.read(text)


def test_two_fields_are_no_field_of_a_pair():
    asked = of_scene(scenes.read(IN_FIELD))
    asked["members"][1]["tables"]["field"]["strength"] = "6 mT"
    with pytest.raises(ms.SpecError, match="different fields"):
        jobs.check("pair_flow", asked)
    del asked["members"][1]["tables"]["field"]
    with pytest.raises(ms.SpecError, match="different fields"):
        jobs.check("together", asked)
