"""Paths of several swimmers: alone, forth and back, side by side."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.swimmer.member import direction_and_roll
from oracles import two_spheres

HELIX = ms.Swimmer.preset("tabak/helix")
PAIR = ms.Group((
    ms.Member(swimmer=HELIX, phase=0.4),
    ms.Member(swimmer=HELIX, position=(0.5, 4.0, 1.0), direction=(1.0, -0.4, 0.2)),
))  # fmt: skip


def test_one_swimmer_follows_its_own_path():
    """Against the screw motion of its gait, which shares no step with it."""
    times = np.array([0.0, 0.7, 2.0, 5.0])
    found = ms.group_path(ms.Group((ms.Member(swimmer=HELIX),)), times, level="coarse")
    known = ms.trajectory(HELIX.gait("bem", level="coarse"), times)
    assert found.position[:, 0].values == pytest.approx(known.position.values, abs=2e-5)
    cosine = np.sum(found.quaternion[:, 0].values * known.quaternion.values, axis=-1)
    assert np.abs(cosine) == pytest.approx(1.0, abs=1e-7)
    assert found.phase[:, 0].values == pytest.approx(2 * np.pi * times)


HEAVY = replace(
    HELIX,
    gravity=ms.Gravity(
        body_density=4.0, tail_density=9.0, acceleration=30.0, direction=(0.3, 0.1, -1.0),
        centre_of_mass=(0.1, 0.0, 0.05),
    ),
)  # fmt: skip


@pytest.mark.parametrize("model", ["estimate", "far"])
def test_a_heavy_swimmer_follows_its_own_path(model):
    """Against `path` with the same gait, whose loads are put together elsewhere."""
    times = np.array([0.0, 1.0, 2.0])
    alone = ms.Group((ms.Member(swimmer=HEAVY),))
    found = ms.group_path(alone, times, level="coarse", model=model)
    gait = HELIX.gait("bem", level="coarse")
    upright = {"gait": gait, "quaternion": (1.0, 0.0, 0.0, 0.0), "samples": 3}
    known, light = (ms.path(s, 2.0, **upright) for s in (HEAVY, HELIX))
    sunk = np.linalg.norm(known.position[-1] - light.position[-1])
    assert sunk > 0.08
    off = np.linalg.norm(found.position[:, 0].values - known.position.values, axis=1)
    if model == "far":  # averaged over the turns of the motor and about s
        assert off.max() < 0.05 * sunk
        return
    assert off.max() < 1e-3 * sunk
    cosine = np.sum(found.quaternion[-1, 0].values * known.quaternion[-1].values)
    assert 1.0 - abs(cosine) < 1e-5


def test_steps_are_of_order_four():
    times, ends = [0.0, 1.0], []
    for step in (1 / 8, 1 / 16, 1 / 64):
        found = ms.group_path(PAIR, times, level="coarse", max_step=step)
        ends.append(found.position[-1].values)
    coarse, fine = (np.abs(e - ends[2]).max() for e in ends[:2])
    assert coarse / fine == pytest.approx(16.0, rel=0.4)


def test_reversed_motors_take_the_swimmers_back():
    """The flow has no memory: forth and back ends where it began."""
    forth = ms.group_path(PAIR, [0.0, 2.0], level="coarse")
    back = HELIX.with_({"tail.frequency": -1.0})
    there = [
        replace(m, swimmer=back, position=tuple(x), phase=float(p))
        for m, x, p in zip(PAIR.members, forth.position[-1].values, forth.phase[-1].values)
    ]
    Q = rotation_matrix(forth.quaternion[-1].values)
    turned = [direction_and_roll(q) for q in Q]
    reverse = ms.Group(tuple(there)).moved(
        directions=[d for d, _ in turned], rolls=[r for _, r in turned]
    )
    home = ms.group_path(reverse, [0.0, 2.0], level="coarse")
    start = np.array([m.position for m in PAIR.members])
    away = np.abs(forth.position[-1].values - start).max()
    assert away > 0.04
    assert home.position[-1].values == pytest.approx(start, abs=2e-3 * away)


def mirrored(pose, own, other):
    """A left helix and a right one; poses: position, direction, roll, phase."""
    tails = (HELIX.with_({"tail.frequency": own}),
             HELIX.with_({"tail.handedness": "right", "tail.frequency": other}))  # fmt: skip
    names = ("position", "direction", "roll", "phase")
    return ms.Group(tuple(
        ms.Member(swimmer=s, **dict(zip(names, p))) for s, p in zip(tails, pose)
    ))  # fmt: skip


def angle_and_distance(found):
    axes = rotation_matrix(found.quaternion.values)[..., 0]
    apart = found.position[:, 1].values - found.position[:, 0].values
    return np.arccos(np.sum(axes[:, 0] * axes[:, 1], axis=-1)), np.linalg.norm(apart, axis=-1)


@pytest.mark.parametrize("backwards", [True, False])
def test_mirror_images_in_time_keep_their_angle_and_distance(backwards):
    """Mirrored, with time reversed, the pair is itself: as far apart and as inclined before the
    pose at which it is its own image as after it. With both motors forwards it is not.
    """
    image = [((0, 0, z), (1, 0.1, -0.25 * z), -z / 6, 0.4) for z in (-1.2, 1.2)]
    other = -1.0 if backwards else 1.0
    before = ms.group_path(mirrored(image, -1.0, -other), [0.0, 1.0], level="coarse")
    begin = []
    for x, q, phase in zip(*(before[n].values[-1] for n in ("position", "quaternion", "phase"))):
        begin.append((tuple(x), *direction_and_roll(rotation_matrix(q)), float(phase)))
    found = ms.group_path(mirrored(begin, 1.0, other), np.linspace(0, 2, 9), level="coarse")
    angle, distance = angle_and_distance(found)
    assert np.ptp(angle) > 0.02
    assert np.ptp(distance) > 4e-3
    off = max(np.abs(x - x[::-1]).max() for x in (angle, distance))
    assert off < 2e-4 if backwards else off > 5e-3  # few nodes stand for each, not mirror images


def test_two_balls_that_sink_side_by_side_keep_their_distance():
    """Their mirror image in time is themselves: they fall, faster than one, and turn alike."""
    ball = ms.Swimmer(body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0))
    down = {"swimmer": ball, "force": (0.0, 0.0, -6 * np.pi)}
    pair = ms.Group((ms.Member(**down), ms.Member(**down, position=(3.0, 0.0, 0.0))))
    found = ms.group_path(pair, [0.0, 1.0, 2.0], model="bem", max_step=1.0)
    x = found.position.values
    assert np.diff(x[..., 0], axis=1).ravel() == pytest.approx(3.0, abs=1e-4)
    R = two_spheres.resistance(1.0)  # across the line of centres, x there and z here
    V = np.linalg.solve(R, 6 * np.pi * np.eye(12)[0] + 6 * np.pi * np.eye(12)[6])
    assert x[-1, :, 2] == pytest.approx(-2.0 * V[0], rel=2e-3)
    assert V[0] > 1.2


def test_swimmers_that_come_too_near_are_refused():
    near = PAIR.moved(positions=[(0, 0, 0), (0, 1.04, 0)], directions=[(1, 0, 0)] * 2)
    with pytest.raises(ms.MicroswimError, match='take model = "bem"'):
        ms.group_path(near, [0.0, 1.0], level="coarse")


def test_a_path_that_was_stopped_is_gone_on_with_to_the_same_numbers(tmp_path):
    class Stopped(Exception):
        pass

    def stop(done, of):
        if done == 2:
            raise Stopped

    times, place = [0.0, 0.1, 0.2, 0.3], tmp_path / "checkpoint.npz"
    whole = ms.group_path(PAIR, times, level="coarse")
    with pytest.raises(Stopped):
        ms.group_path(PAIR, times, level="coarse", keep=place, progress=stop)
    done = []
    again = ms.group_path(PAIR, times, level="coarse", keep=place,
                          progress=lambda n, of: done.append(n))  # fmt: skip
    assert done == [3, 4]
    assert again.identical(whole)
    with pytest.raises(ms.SpecError, match="another path"):
        ms.group_path(PAIR, [0.0, 0.5], level="coarse", keep=place)


def test_from_afar_one_swimmer_follows_the_axis_of_its_screw():
    """Against the path of its gait, about the mean path by the radius of the screw."""
    times, gait = np.array([0.0, 150.0]), HELIX.gait("bem", level="coarse")
    for phase in (0.0, 1.0):
        one = ms.Group((ms.Member(swimmer=HELIX, phase=phase),))
        found = ms.group_path(one, times, model="far", level="coarse").position[-1, 0].values
        known = ms.trajectory(gait, times, phase=phase).position[-1].values
        assert np.linalg.norm(known) > 4.0
        assert np.linalg.norm(found - known) < 2.5 * ms.screw(gait).radius


def test_from_afar_a_pair_goes_where_the_point_forces_say():
    """Motors in step by the one, out of step by the other, which far apart is the same."""
    there = PAIR.moved(positions=[(0, 0, 0), (1, 7, 2)])
    times = np.array([0.0, 20.0])
    ends = [ms.group_path(there, times, model=m, level="coarse") for m in ("estimate", "far")]
    alone = ms.group_path(there.moved(positions=[(0, 0, 0), (1, 1e6, 2)]), times, model="far",
                          level="coarse")  # fmt: skip
    near, far = (e.position[-1].values for e in ends)
    changed = np.linalg.norm(far[0] - alone.position[-1, 0].values)
    radius = ms.screw(HELIX.gait("bem", level="coarse")).radius
    assert changed > 3 * radius
    assert np.linalg.norm(near - far, axis=1).max() < 2.5 * radius + 0.15 * changed
    assert float(ends[1].expected_error.max()) < 0.02


def test_from_afar_swimmers_that_come_too_near_are_refused():
    near = PAIR.moved(positions=[(0, 0, 0), (0, 1.04, 0)], directions=[(1, 0, 0)] * 2)
    with pytest.raises(ms.MicroswimError, match=r'model = "far".*take model = "bem"'):
        ms.group_path(near, [0.0, 1.0], model="far", level="coarse")


MAGNETIC = replace(HELIX.with_({"tail.frequency": 0.0}), magnet=ms.Magnet(moment=(0.0, 4.0, 0.5)))
TURNING = ms.RotatingField(strength=600.0, frequency=0.5, axis=(1.0, 0.2, 0.0))


def test_a_magnetic_robot_follows_its_own_path():
    """Against `path` with the same gait: its steps, its loads and its rotations are others'."""
    times = np.linspace(0.0, 1.0, 3)
    alone = ms.Group((ms.Member(swimmer=MAGNETIC),), field=TURNING)
    found = ms.group_path(alone, times, level="coarse")
    gait = MAGNETIC.gait("bem", level="coarse")
    driven = replace(MAGNETIC, field=TURNING)
    known = ms.path(driven, 1.0, gait=gait, quaternion=(1.0, 0.0, 0.0, 0.0), samples=3)
    moved = np.linalg.norm(known.position[-1])
    assert moved > 0.01
    assert np.abs(found.position[:, 0].values - known.position.values).max() < 2e-3 * moved
    cosine = np.sum(found.quaternion[-1, 0].values * known.quaternion[-1].values)
    assert 1.0 - abs(cosine) < 1e-6


def test_magnets_in_line_draw_each_other_near():
    """Two robots at rest without a field; side by side they would part."""
    um = 1e-6
    ball = ms.Swimmer(
        body=ms.Sphere(radius=5 * um), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1e-3),
        magnet=ms.Magnet(moment=(1e-12, 0.0, 0.0)), units="SI",
    )  # fmt: skip
    gaps = {}
    for name, place in (("in line", (40 * um, 0, 0)), ("beside", (0, 40 * um, 0))):
        pair = ms.Group((ms.Member(swimmer=ball), ms.Member(swimmer=ball, position=place)))
        path = ms.group_path(pair, [0.0, 0.2], level="coarse")
        gaps[name] = np.linalg.norm(path.position[-1, 1] - path.position[-1, 0]) - 40 * um
    assert gaps["in line"] < -0.1 * um
    assert 0.01 * um < gaps["beside"] < -gaps["in line"]


def test_what_does_not_go_together_with_a_field():
    alone = ms.Group((ms.Member(swimmer=MAGNETIC),), field=TURNING)
    with pytest.raises(ms.SpecError, match="follow the swimmers"):
        alone.swim(level="coarse")
    with pytest.raises(ms.SpecError, match="knows no magnets"):
        ms.group_path(alone, [0.0, 1.0], model="far")
    with pytest.raises(ms.SpecError, match="no swimmer of the group has a magnet"):
        ms.Group((ms.Member(swimmer=HELIX),), field=TURNING)
