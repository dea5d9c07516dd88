"""Steps beside a wall and in a tube: against the path's own integrator, contact, slopes, refusals.

The boundaries are made up (tests/boundaries.py): the laws hold whatever was solved.
"""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from boundaries import RADIUS, beside, inside
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.swimmer.surroundings.weight import arm, excess

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
BY_WALL = replace(ROBOT, wall=ms.Wall(1.0, tilt=0.2))
IN_TUBE = replace(ROBOT, channel=ms.Channel(diameter=2 * RADIUS, length=30.0))
WALL, TUBE = beside(BY_WALL), inside(IN_TUBE)
AT = {"wall": (0.0, 0.0, 0.9), "tube": (0.0, 0.3, -0.2)}


def stepper(where, **options):
    swimmer, poses = (BY_WALL, WALL) if where == "wall" else (IN_TUBE, TUBE)
    return ms.Stepper.of(swimmer, poses=poses, **options)


def carried(stepper, state, n, dt, **inputs):
    for _ in range(n):
        state = stepper.step(state, dt=dt, **inputs)
    return state


@pytest.mark.parametrize(
    ("where", "flow", "given"),
    [
        ("wall", None, {}),
        ("wall", ms.ShearFlow(rate=0.3), {"gradient": [[0, 0, 0.3], [0, 0, 0], [0, 0, 0]]}),
        ("tube", None, {}),
        ("tube", ms.PoiseuilleFlow(speed=0.2, diameter=2 * RADIUS), {"flow": [0.2, 0, 0]}),
    ],
)
def test_steps_are_the_path_under_the_same_loads(where, flow, given):
    """Order 4 of fixed steps against Dormand and Prince's: in parts of a 64th of a turn."""
    one = stepper(where)
    pull = (0.0, 0.0, -8.0)  # towards the boundary
    swimmer = replace(one.swimmer, flow=flow)
    path = ms.path(
        swimmer, 1.0, poses=one.poses, position=AT[where], quaternion=(1, 0, 0, 0), samples=2,
        tolerance=1e-7, force=pull, contact=0.02,
    )  # fmt: skip
    one = replace(one, contact=0.02)
    end = carried(one, ms.State.at(AT[where]), 8, 1 / 8, force=pull, **given)
    assert end.position == pytest.approx(path.position.values[-1], abs=2e-5)
    assert end.quaternion == pytest.approx(path.quaternion.values[-1], abs=2e-5)


LAID = replace(ROBOT.with_({"tail.frequency": 0.0}), wall=ms.Wall(0.6))
HEAVY = replace(
    LAID,
    fluid=replace(LAID.fluid, density=1.0),
    gravity=ms.Gravity(density=100.0, acceleration=9.0),
)
FLIPPED = replace(
    LAID, magnet=ms.Magnet(moment=(2.0, 0.0, 0.0)),
    field=ms.RotatingField(strength=5e3, frequency=0.1, axis=(0, 1, 0)),
)  # fmt: skip


@pytest.mark.parametrize("swimmer", [HEAVY, FLIPPED])
def test_a_stepper_holds_the_gap_of_the_path_under_weight_and_under_a_magnet(swimmer):
    """What lies on the wall, or is turned over on it, with no motor."""
    poses, dt = beside(swimmer), 0.5
    how = {"samples": 41, "contact": 0.02, "tolerance": 1e-7}  # that of the path by itself is 3e-4
    path = ms.path(swimmer, 20.0, poses=poses, **how)
    one = ms.Stepper.of(swimmer, poses=poses, contact=0.02)
    state, gaps = one.start, []
    pull = np.array([0.0, 0.0, -9.0 * excess(swimmer)])
    for k in range(40):
        gaps.append(float(one.gap(state)))
        felt = {} if swimmer.field is None else swimmer.field.felt(k * dt)
        turned = rotation_matrix(state.quaternion) @ arm(swimmer, np.zeros(1))[0]
        state = one.step(state, dt=dt, force=pull, torque=np.cross(turned, [0, 0, -9.0]), **felt)
    assert min(gaps) < 0.03  # they touch
    assert gaps == pytest.approx(path.gap.values[:-1], abs=1e-4)


def test_the_start_of_a_stepper_is_that_of_the_spec():
    one = stepper("wall")
    assert one.start.position == pytest.approx([0, 0, 1.0])
    assert rotation_matrix(one.start.quaternion)[2, 0] == pytest.approx(np.sin(0.2))
    assert one.gap(one.start) == pytest.approx(WALL.gap(*WALL.start, 0.0))


@pytest.mark.parametrize("where", ["wall", "tube"])
def test_no_step_goes_through_the_boundary(where):
    """Pressed on by a thousand times the thrust, in steps of a turn."""
    one = stepper(where)
    state = ms.State.at(AT[where])
    for _ in range(6):
        state = one.step(state, dt=1.0, force=(0.0, 0.0, -5000.0))
        assert one.gap(state) > 0.0
    assert one.gap(state) < 0.05


def test_many_at_once_are_each_alone():
    one = stepper("wall")
    many = ms.State.at(position=[(0, 0, 0.9), (0, 0, 1.5), (1, 2, 4.0)])
    after = one.step(many, dt=0.3)
    for i in range(3):
        alone = one.step(ms.State(many.values[i].copy()), dt=0.3)
        assert np.array_equal(after.values[i], alone.values)


def test_far_from_a_wall_steps_are_those_of_free_fluid():
    state, force = ms.State.at((0, 0, 1e6)), (0.0, 3.0, 1.0)
    near = stepper("wall").step(state, dt=0.7, force=force)
    free = ms.Stepper(WALL.gait, BY_WALL).step(state, dt=0.7, force=force)
    assert near.values == pytest.approx(free.values, abs=1e-5)


@pytest.mark.parametrize("where", ["wall", "tube"])
def test_power_of_the_motor_is_that_of_the_path(where):
    """Torque times rate, with nothing else at work, is what the fluid takes up."""
    one = stepper(where)
    state = ms.State.at(AT[where])
    path = ms.path(
        one.swimmer, 1e-3, poses=one.poses, position=AT[where], quaternion=(1, 0, 0, 0), samples=2
    )
    _, torque = one.outputs(state)
    spent = float(path.motor_work[-1]) / 1e-3
    assert torque * one.gait.rate == pytest.approx(spent, rel=1e-3)


@pytest.mark.parametrize("where", ["wall", "tube"])
def test_slopes_of_a_step_predict_another(where):
    one, state = stepper(where), ms.State.at(AT[where])
    wrt = ("motor_rate", "force", "torque")
    A, B, _, _ = one.state_space(state, dt=0.05, wrt=wrt)
    push = np.array([0.5, 0.3, -0.4, 0.2, 0.5, -0.1, 0.3]) * 0.01
    rate = one.gait.rate
    before = one.step(state, dt=0.05)
    after = one.step(state, dt=0.05, motor_rate=rate + push[0], force=push[1:4], torque=push[4:])
    moved = after.position - before.position
    assert (B @ push)[:3] == pytest.approx(moved, rel=2e-3, abs=1e-9)
    off = np.array([0.0, 0.001, -0.001])
    other = one.step(ms.State.at(np.add(AT[where], off)), dt=0.05)
    assert (A[:3, :3] @ off) == pytest.approx(other.position - before.position, rel=2e-2, abs=1e-6)
    C, D, _, _ = one.state_space(state, wrt=wrt)  # continuous: to first order the same
    assert (D @ push)[:3] * 0.05 == pytest.approx(moved, rel=0.2, abs=1e-6)
    assert C.shape == (7, 7)


def test_noise_beside_a_wall_never_reaches_into_it():
    one = stepper("wall")
    state = ms.State.at(position=np.tile([0.0, 0.0, 0.55], (100, 1)))
    random = np.random.default_rng(0)
    after = one.scattered(state, dt=0.05, random=random, energy=5.0)
    assert one.gap(after).min() > 0.0
    far = ms.State.at(position=np.tile([0.0, 0.0, 1e5], (600, 1)))
    spread = one.scattered(far, dt=0.05, random=random, energy=1.0).position.std(axis=0)
    M = np.linalg.inv(WALL.gait.resistance(0.0))
    assert spread == pytest.approx(np.sqrt(0.1 * np.diag(M)[:3]), rel=0.12)


@pytest.mark.parametrize(
    ("where", "given", "said"),
    [
        ("tube", {"gradient": np.diag([1.0, -1.0, 0.0])}, "Poiseuille"),
        ("tube", {"flow": (0.0, 1.0, 0.0)}, "along x"),
        ("wall", {"wind": 1.0}, "one of the inputs"),
    ],
)
def test_what_makes_no_sense_beside_a_boundary_is_refused(where, given, said):
    with pytest.raises(ms.SpecError, match=said):
        stepper(where).step(ms.State.at(AT[where]), dt=0.1, **given)


def test_a_state_in_the_wall_and_a_quick_velocity_are_refused():
    one = stepper("wall")
    with pytest.raises(ms.SpecError, match="into the boundary"):
        one.step(ms.State.at((0, 0, 0.2)), dt=0.1)
    with pytest.raises(ms.SpecError, match="into the boundary"):
        one.outputs(ms.State.at((0, 0, 0.2)))
    with pytest.raises(ms.SpecError, match="twist"):
        one.velocity(0.0, 1.0)


@pytest.mark.slow
def test_many_swimmers_beside_a_wall_are_stepped_on_all_cores():
    """From 256 on; the same as each alone."""
    one = stepper("wall")
    many = ms.State(np.tile(ms.State.at(AT["wall"]).values, (300, 1)))
    after = one.step(many, dt=0.05)
    alone = one.step(ms.State.at(AT["wall"]), dt=0.05)
    assert np.abs(after.values - alone.values).max() < 1e-12
