"""Coils and stray fields around the robots of the environments, against the stepper."""

from pathlib import Path

import numpy as np
import pytest

import microswim as ms
from microswim.control.environments import ReachEnv, SteerEnv, SteerVectorEnv, reach, steer
from microswim.control.environments.world import robot

COILS = Path(__file__).parents[3] / "examples" / "control" / "eight_coils.yaml"
CALM = {"disturbance": 0.0, "position_noise": 0.0, "angle_noise": 0.0, "frame_interval": 1}
STRAY = ms.DipoleField(moment=(0.0, 0.6, 0.3), position=(0.0, 0.05, 0.0), frequency=0.3)


@pytest.fixture(scope="module")
def coils():
    return ms.CoilField(file=str(COILS), currents=(0.0,) * 8)


def by_stepper(world, coils, stray, B, rate, steps, parts=40):
    """Where the stepper ends, with the field of the currents set anew in each part of a step."""
    one = ms.Stepper(robot("steer").gait(), moment=(0.0, steer.MOMENT, 0.0), locked=True)
    state, dt = ms.State(world.memory[0, :8].copy()), 0.02 / parts
    P = np.linalg.pinv(coils.per_ampere(np.zeros(3))[:3]) if coils is not None else None
    size = np.linalg.norm(rate)
    for k in range(steps * parts):
        t = (k + 0.5) * dt
        a = rate / size
        now = np.cos(size * t) * B + np.sin(size * t) * np.cross(a, B)  # B lies across the axis
        x = state.position
        field, J = now, np.zeros((3, 3))
        if coils is not None:
            made = coils.per_ampere(x) @ (P @ now)
            field, J = made[:3], made[3:].reshape(3, 3)
        if stray is not None:
            field, J = field + stray.at(t, x), J + stray.gradient(t, x)
        state = one.step(state, dt=dt, field=field, field_gradient=J, field_place=x)
    return state


@pytest.mark.parametrize("which", ["coils", "stray", "both"])
def test_a_steered_robot_feels_the_field_of_coils_and_what_is_there_anyway(which, coils):
    bench = {"coils": coils if which != "stray" else None}
    bench["stray"] = STRAY if which != "coils" else None
    world, plain = steer.SteerWorld(1, **bench, **CALM), steer.SteerWorld(1, **CALM)
    for one in (world, plain):
        one.reset(np.array([3], dtype=np.uint64))
        one.memory[0, :3] += (1.2e-3, -1.5e-3, 8e-4)  # away from the middle, where coils are uneven
    action = np.array([[1.0, 0.2, -0.1, 0.4]])
    start = world.memory[0, :3].copy()
    steps = 15
    ahead = action[0, :3] / np.linalg.norm(action[0, :3])
    b = world.memory[0, steer.B : steer.B + 3].copy()
    b -= (b @ ahead) * ahead
    B = 4e-3 * b / np.linalg.norm(b)
    told = by_stepper(world, bench["coils"], bench["stray"], B, -8.0 * np.pi * ahead, steps)
    for _ in range(steps):
        world.step(action)
        plain.step(action)
    moved = np.linalg.norm(told.position - start)
    off = np.linalg.norm(world.memory[0, :3] - told.position)
    felt = np.linalg.norm(plain.memory[0, :3] - told.position)
    assert off < 0.01 * moved
    assert felt > 4.0 * off


def test_a_stray_field_of_nothing_changes_nothing():
    """Also of the guiding field of Reach, and where the field is uneven besides."""
    nothing = ms.UniformField(strength=1e-15)
    for kind, action in ((reach.ReachWorld, [0.5, 0.3]), (steer.SteerWorld, [1, 0, 0, 0.5])):
        ends = []
        for more in ({}, {"stray": nothing}):
            world = kind(1, field_gradient=0.05, **more, **CALM)
            world.reset(np.array([5], dtype=np.uint64))
            start = world.memory[0, :3].copy()
            for _ in range(20):
                world.step(np.array([action], float))
            ends.append(world.memory[0, :3] - start)
        assert ends[1] == pytest.approx(
            ends[0], rel=1e-3, abs=1e-3 * float(np.linalg.norm(ends[0]))
        )


def test_a_vector_has_each_robot_in_its_own_place(coils):
    many = SteerVectorEnv(3, coils=coils, stray=STRAY, **CALM)
    many.reset(seed=2)
    acts = np.tile([1.0, 0.1, 0.2, 0.5], (3, 1))
    for _ in range(4):
        many.step(acts)
    for i in range(3):
        one = SteerEnv(coils=coils, stray=STRAY, **CALM)
        one.reset(seed=2 + i)
        for _ in range(4):
            one.step(acts[0])
        assert one.all.memory[0, :8] == pytest.approx(many.all.memory[i, :8], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(
    ("kind", "options", "words"),
    [
        (SteerEnv, {"coils": "coils.yaml"}, "coils = 'coils.yaml': must be a CoilField"),
        (ReachEnv, {"stray": 3.0}, "stray = 3.0: must be a field, such as"),
    ],
)
def test_one_sentence_says_what_is_wrong(kind, options, words):
    with pytest.raises(ms.SpecError, match=words):
        kind(**options)


def test_too_few_coils_are_refused(tmp_path):
    file = tmp_path / "one.toml"
    file.write_text(
        '[[coil]]\nposition = ["0 m", "0 m", "5 cm"]\naxis = [0, 0, 1]\n'
        'diameter = "4 cm"\nturns = 100\n'
    )
    with pytest.raises(ms.SpecError, match="coils = 1: must be three or more"):
        SteerEnv(coils=ms.CoilField(file=str(file), currents=(1.0,)))
