"""Robots of the environments beside a wall and in a tube, against the stepper and the path.

The boundaries are made up (tests/boundaries.py): nothing is solved.
"""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from boundaries import beside, inside
from microswim.control.environments import (
    ReachEnv,
    ReachVectorEnv,
    SteerEnv,
    SteerVectorEnv,
    reach,
    steer,
)
from microswim.control.environments.world import robot
from microswim.numerics.rigid_motion import rotation_matrix

CALM = {"disturbance": 0.0, "position_noise": 0.0, "angle_noise": 0.0, "frame_interval": 1}
DEPTH = 0.8  # mm
TUBE = 3.0  # mm, tests/boundaries has radius 1.5


def walled(name):
    return beside(replace(robot(name), wall=ms.Wall(1e-3 * DEPTH)))


def tubed(name):
    channel = ms.Channel(diameter=1e-3 * TUBE, length=0.3)
    return inside(replace(robot(name), channel=channel), radius=5e-4 * TUBE)


AROUND = {"wall": (walled, {"wall": DEPTH}), "channel": (tubed, {"channel": TUBE})}


class Twin:
    """The stepper of a world's robot, its wall at z = 0, and the same flow."""

    def __init__(self, world, moment, flow, **options):
        bound = world.boundary
        self.depth = np.array([0.0, 0.0, bound.depth])
        one = ms.Stepper.of(
            bound.swimmer, poses=bound.options["poses"], moment=moment, resolution=100, **options
        )
        start = world.memory[0, :8]
        self.one, self.state = one, ms.State.at(start[:3] + self.depth, start[3:7], start[7])
        self.flow = {"flow": [flow[0], 0.0, 0.0]}
        if bound.depth:
            G = np.zeros((3, 3))
            G[:2, 2] = flow[:2] / bound.depth
            self.flow = {"gradient": G}

    def step(self, **inputs):
        self.state = self.one.step(self.state, dt=0.02, **inputs, **self.flow)

    def off(self, world):
        """How far the world's robot is from it, of the way: in place, and in its axes."""
        place, Q = (self.state.position - self.depth), rotation_matrix(self.state.quaternion)
        apart = np.abs(world.memory[0, :3] - place).max()
        return apart, np.abs(rotation_matrix(world.memory[0, 3:7]) - Q).max()


@pytest.mark.parametrize("kind", AROUND)
def test_reach_beside_a_boundary_moves_as_the_stepper(kind):
    poses, where = AROUND[kind]
    options = CALM | where | {"disturbance": 0.2, "poses": poses("reach")}
    world = reach.ReachWorld(1, **options)
    world.reset(np.array([3], dtype=np.uint64))
    start = world.memory[0, :3].copy()
    twin = Twin(world, (-reach.MOMENT, 0.0, 0.0), world.memory[0, reach.FLOW : reach.FLOW + 3])
    angle = world.memory[0, reach.ANGLE]
    for i in range(15):
        motor, swing = np.cos(i / 10), np.sin(i / 7)
        B = 4e-3 * np.array([np.cos(angle), np.sin(angle), 0.0])
        twin.step(motor_rate=16 * np.pi * motor, field=B, field_rate=[0, 0, 2.0 * swing])
        angle += 2.0 * swing * 0.02
        world.step(np.array([[motor, swing]]))
    moved = np.linalg.norm(world.memory[0, :3] - start)
    assert moved > 3e-5
    place, axes = twin.off(world)
    assert place < 3e-3 * moved
    assert axes < 2e-3


@pytest.mark.parametrize("kind", AROUND)
def test_steer_beside_a_boundary_moves_as_the_stepper(kind):
    poses, where = AROUND[kind]
    world = steer.SteerWorld(1, poses=poses("steer"), **(CALM | where))
    world.reset(np.array([3], dtype=np.uint64))
    start = world.memory[0, :3].copy()
    twin = Twin(world, (0.0, steer.MOMENT, 0.0), np.zeros(3), locked=True)
    b = world.memory[0, 8:11].copy()
    for i in range(15):
        d = np.array([1.0, 0.5 * np.sin(i / 9), 0.3])
        d /= np.linalg.norm(d)
        b -= b @ d * d
        b /= np.linalg.norm(b)
        w = -2 * np.pi * 5.0 * d
        twin.step(field=4e-3 * b, field_rate=w)
        axis, turn = w / np.linalg.norm(w), np.linalg.norm(w) * 0.02
        b = b * np.cos(turn) + np.cross(axis, b) * np.sin(turn)
        world.step(np.array([[*d, 0.5]]))
    moved = np.linalg.norm(world.memory[0, :3] - start)
    assert moved > 1e-4
    place, axes = twin.off(world)
    assert place < 3e-3 * moved
    assert axes < 2e-3


def test_a_steered_robot_is_never_in_the_wall():
    """Driven down onto the wall, it stays above it; the observation is of the same size."""
    poses = walled("steer")
    env = SteerEnv(wall=DEPTH, poses=poses, temperature=3e7, run_time=0.05, **CALM)
    seen, _ = env.reset(seed=4)
    assert seen.shape == (17,)
    assert env.all.memory[0, 2] == 0.0  # along the wall
    assert (env.all.path[:, :, 2] == 0.0).all()
    for _ in range(30):
        env.step(np.array([0.3, 0.0, -1.0, 1.0]))
        y = env.all.memory[0, :8].copy()
        y[2] += 1e-3 * DEPTH
        assert poses.gap(y[:3], y[3:7], y[7]) > 0.0
    assert env.all.memory[0, 2] < -1e-5


@pytest.mark.parametrize("kind", AROUND)
@pytest.mark.parametrize(
    ("name", "many", "one"),
    [("steer", SteerVectorEnv, SteerEnv), ("reach", ReachVectorEnv, ReachEnv)],
)
def test_a_vector_beside_a_boundary_is_its_single_environments(kind, name, many, one):
    poses, where = AROUND[kind]
    options = where | {"poses": poses(name), "max_steps": 3, "temperature": 300.0}
    many, alone = many(2, **options), [one(**options) for _ in range(2)]
    seen, _ = many.reset(seed=5)
    for i, env in enumerate(alone):
        assert (env.reset(seed=5 + i)[0] == seen[i]).all()
    move = np.array([[0.5, 0.5, 0.1, 0.6], [-1.0, 0.2, 0.3, 0.1]])[:, : many.all.actions]
    for _ in range(3):
        seen, rewards, _, cut, _ = many.step(move)
        for i, env in enumerate(alone):
            obs, reward, *_ = env.step(move[i])
            assert (obs == seen[i]).all()
            assert reward == rewards[i]
    assert cut.all()
    assert (many.step(move)[1] == 0).all()  # begins anew


def test_targets_in_a_tube_lie_along_it():
    many = ReachVectorEnv(8, channel=TUBE, poses=tubed("reach"), **CALM)
    many.reset(seed=1)
    assert np.abs(many.all.memory[:, reach.TARGET + 1]).max() < 1e-12
    assert len(set(np.sign(many.all.memory[:, reach.TARGET]))) == 2  # either way


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"wall": 0.2}, "wall.distance"),
        ({"wall": "near"}, "wall"),
        ({"wall": 1.0, "channel": 3.0}, "one of the two"),
        ({"channel": 0.5}, "channel"),
        ({"poses": 3}, "wall, channel"),
        ({"wall": 1.0, "poses": 3}, "poses = 3"),
        ({"channel": 4.0, "poses": tubed("steer")}, "poses = .*tube of diameter 3 mm.*4 mm"),
        ({"wall": 1.0, "poses": tubed("steer")}, "poses = .*in a tube.*beside a wall"),
    ],
)
def test_a_boundary_that_makes_no_sense_is_refused(options, match):
    with pytest.raises(ms.SpecError, match=match):
        SteerEnv(**options)


@pytest.mark.parametrize(
    ("path", "match"),
    [
        ([[0, 0, 0], [1, 0, -1.0]], "beyond the boundary.*above the wall"),
        ([[0, 0, 0], [0.1, 0, 1.0]], "begun where the robot would reach"),
    ],
)
def test_a_path_that_the_wall_does_not_allow_is_refused(path, match):
    env = SteerEnv(wall=DEPTH, poses=walled("steer"))
    with pytest.raises(ms.SpecError, match=f"path = .*{match}"):
        env.reset(seed=0, options={"path": path})
