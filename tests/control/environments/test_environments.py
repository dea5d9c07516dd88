"""The environments: by Gymnasium's own checker, against the stepper, and against their physics."""

import os
import subprocess
import sys
import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import microswim as ms
from microswim.control.environments import (
    ReachEnv,
    ReachVectorEnv,
    SteerEnv,
    SteerVectorEnv,
    camera,
    paths,
    reach,
    steer,
)
from microswim.control.environments import random_streams as chance
from microswim.control.environments.world import robot
from microswim.numerics.rigid_motion import rotation_matrix

NAMES = ["microswim/Steer-v0", "microswim/Reach-v0"]
CALM = {"disturbance": 0.0, "position_noise": 0.0, "angle_noise": 0.0, "frame_interval": 1}
WORLDS = {"microswim/Steer-v0": steer, "microswim/Reach-v0": reach}


def actions(env, n, seed=0):
    shape = env.action_space.shape
    return np.random.default_rng(seed).uniform(-1, 1, (n, *shape)).astype(np.float32)


@pytest.mark.parametrize("name", NAMES)
def test_gymnasium_finds_nothing_wrong(name):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gym.make(name).unwrapped)


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_gives_the_same_episode(name):
    runs = []
    for seed in (5, 5, 6):
        env = gym.make(name)
        seen = [env.reset(seed=seed)[0]]
        seen += [env.step(a)[0] for a in actions(env, 50)]
        runs.append(np.array(seen))
    assert (runs[0] == runs[1]).all()
    assert (runs[0] != runs[2]).any()


@pytest.mark.parametrize("name", NAMES)
def test_a_vector_is_its_single_environments(name):
    """Environment i of seed n is the single one of seed n + i, bit by bit, also past an end."""
    many = gym.make_vec(name, num_envs=3, vectorization_mode="vector_entry_point", max_steps=20)
    seen, _ = many.reset(seed=11)
    moves = actions(many, 20)
    alone = []
    for i in range(3):
        env = gym.make(name, max_steps=20)
        alone.append(env)
        assert (env.reset(seed=11 + i)[0] == seen[i]).all()
    for step, move in enumerate(moves):
        seen, rewards, over, cut, _ = many.step(move)
        for i, env in enumerate(alone):
            obs, reward, o, c, _ = env.step(move[i])
            assert (obs == seen[i]).all()
            assert (reward, o, c) == (rewards[i], over[i], cut[i])
        assert cut.all() == (step == 19)
    seen, rewards, over, cut, _ = many.step(moves[0])  # begins anew, whatever the action
    assert not (over | cut).any()
    assert (rewards == 0).all()
    assert (many.unwrapped.all.count[:, 0] == 0).all()
    with pytest.raises(gym.error.ResetNeeded):
        alone[0].step(moves[0][0])


@pytest.mark.parametrize("name", NAMES)
def test_what_is_returned_is_not_overwritten(name):
    many = gym.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point")
    first, _ = many.reset(seed=0)
    kept = first.copy()
    many.step(actions(many, 1)[0])
    assert (first == kept).all()


def pose_of(world):
    values = world.memory[0, :8].copy()
    return ms.State(values)


def test_steer_moves_as_the_stepper():
    """Forty control periods against a stepper eight times as fine; field, robot and all."""
    world = steer.SteerWorld(1, **CALM)
    world.reset(np.array([3], dtype=np.uint64))
    start = pose_of(world)
    one = ms.Stepper(
        robot("steer").gait(), moment=(0.0, steer.MOMENT, 0.0), locked=True, resolution=200
    )
    b, state = world.memory[0, 8:11].copy(), start
    for i in range(40):
        d = np.array([1.0, 0.5 * np.sin(i / 9), 0.3])
        d /= np.linalg.norm(d)
        b -= b @ d * d
        b /= np.linalg.norm(b)
        w = -2 * np.pi * 5.0 * d
        state = one.step(state, dt=0.02, field=4e-3 * b, field_rate=w)
        angle = np.linalg.norm(w) * 0.02
        axis = w / np.linalg.norm(w)
        b = b * np.cos(angle) + np.cross(axis, b) * np.sin(angle)
        world.step(np.array([[*d, 0.5]]))
    moved = np.linalg.norm(state.position - start.position)
    assert moved > 0.3e-3
    assert np.abs(pose_of(world).position - state.position).max() < 1e-3 * moved
    Q, P = (rotation_matrix(s.quaternion) for s in (pose_of(world), state))
    assert np.abs(Q - P).max() < 2e-3


def test_reach_moves_as_the_stepper():
    world = reach.ReachWorld(1, **CALM)
    world.reset(np.array([3], dtype=np.uint64))
    start = state = pose_of(world)
    one = ms.Stepper(robot("reach").gait(), moment=(-reach.MOMENT, 0.0, 0.0), resolution=200)
    angle = world.memory[0, reach.ANGLE]
    for i in range(40):
        motor, swing = np.cos(i / 10), np.sin(i / 7)
        B = 4e-3 * np.array([np.cos(angle), np.sin(angle), 0.0])
        inputs = {"motor_rate": 16 * np.pi * motor, "field": B, "field_rate": [0, 0, 2.0 * swing]}
        state = one.step(state, dt=0.02, **inputs)
        angle += 2.0 * swing * 0.02
        world.step(np.array([[motor, swing]]))
    assert np.linalg.norm(state.position - start.position) > 0.1e-3
    assert np.abs(pose_of(world).position - state.position).max() < 1e-6
    Q, P = (rotation_matrix(s.quaternion) for s in (pose_of(world), state))
    assert np.abs(Q - P).max() < 2e-3


def test_an_uneven_field_pulls_as_it_does_in_the_stepper():
    """A gradient of its own each episode, symmetric and free of trace, about the origin."""
    world = reach.ReachWorld(1, field_gradient=0.01, **CALM)
    world.reset(np.array([3], dtype=np.uint64))
    J = world.memory[0, reach.SLOPE :].reshape(3, 3).copy()
    assert pytest.approx(J.T) == J
    assert np.linalg.eigvalsh(J) == pytest.approx([-0.005, -0.005, 0.01], abs=1e-12)
    start = state = pose_of(world)
    one = ms.Stepper(robot("reach").gait(), moment=(-reach.MOMENT, 0.0, 0.0), resolution=200)
    even, angle = state, world.memory[0, reach.ANGLE]
    for _ in range(40):
        B = 4e-3 * np.array([np.cos(angle), np.sin(angle), 0.0])
        inputs = {"motor_rate": 8 * np.pi, "field": B}
        state = one.step(state, dt=0.02, field_gradient=J, **inputs)
        even = one.step(even, dt=0.02, **inputs)
        world.step(np.array([[0.5, 0.0]]))
    moved = np.linalg.norm(state.position - start.position)
    assert np.abs(pose_of(world).position - state.position).max() < 2e-3 * moved
    assert np.linalg.norm(state.position - even.position) > 0.03 * moved
    world.reset(np.array([4], dtype=np.uint64))
    assert not np.allclose(world.memory[0, reach.SLOPE :].reshape(3, 3), J)


def test_a_steered_robot_feels_an_uneven_field_too():
    ends = []
    for slope in (0.0, 0.1):
        world = steer.SteerWorld(1, field_gradient=slope, **CALM)
        world.reset(np.array([3], dtype=np.uint64))
        for _ in range(40):
            world.step(np.array([[1.0, 0.0, 0.0, 0.5]]))
        ends.append(pose_of(world).position)
    apart = np.linalg.norm(ends[1] - ends[0])
    assert 1e-6 < apart < 1e-4  # the pull on a moment that turns averages out but for a little


def speed(frequency):
    """Millimetres a second along a straight path after three seconds in the calm."""
    env = SteerEnv(**CALM)
    env.reset(seed=1, options={"path": [[0, 0, 0], [20, 0, 0]]})
    for _ in range(150):
        env.step([1, 0, 0, frequency / 10])
    x = env.all.memory[0, 0]
    for _ in range(100):
        env.step([1, 0, 0, frequency / 10])
    return (env.all.memory[0, 0] - x) * 1e3 / 2.0


def test_in_step_speed_goes_with_frequency_and_step_out_is_real():
    """About its axis the robot steps out at m B / R = 7.8 Hz; 10 Hz is slower than 7 Hz."""
    R = np.linalg.inv(robot("steer").gait().resistance(0.0))
    critical = steer.MOMENT * 4e-3 * R[3, 3] / (2 * np.pi)
    assert 7 < critical < 9
    slow, fast = speed(3.0), speed(6.0)
    assert fast == pytest.approx(2 * slow, rel=0.01)
    assert slow > 0.3
    assert speed(10.0) < 0.8 * speed(7.0)
    assert speed(-3.0) == pytest.approx(-slow, rel=0.02)


def test_the_camera_is_late_by_its_latency():
    """In the calm the frame is the true pose of so many steps ago."""
    late = SteerEnv(**CALM, latency=3)
    late.reset(seed=2, options={"path": [[0, 0, 0], [10, 0, 0]]})
    true, seen = [], []
    for _ in range(20):
        obs, *_ = late.step([1, 0, 0, 0.5])
        true.append(late.all.memory[0, :3] * 1e3)
        seen.append(obs[:3])  # nearest point of the path less the position: -y, -z across it
    assert np.array(seen)[3:, 1:] == pytest.approx(-np.array(true)[:-3, 1:], abs=1e-6)


def test_noise_of_the_camera_and_the_flow_are_as_told():
    n = 4000
    world = steer.SteerWorld(n, disturbance=0.2, position_noise=0.05)
    world.reset(np.arange(n, dtype=np.uint64))
    off = (world.ring[:, 0, :3] - world.memory[:, :3]) * 1e3
    assert off.std() == pytest.approx(0.05, rel=0.03)
    for _ in range(300):
        world.step(np.zeros((n, 4)))
    flow = world.memory[:, steer.FLOW : steer.FLOW + 3] * 1e3
    assert flow.std() == pytest.approx(0.2, rel=0.03)


def test_streams_are_uniform_normal_and_their_own():
    keys = np.array([1, 2], dtype=np.uint64)
    u = np.array([[chance.uniform(keys, i) for i in (0, 1)] for _ in range(20000)])
    assert u.mean(axis=0) == pytest.approx(0.5, abs=0.01)
    assert u.var(axis=0) == pytest.approx(1 / 12, abs=0.002)
    assert abs(np.corrcoef(u.T)[0, 1]) < 0.03
    z = np.array([chance.normals(keys, 0) for _ in range(20000)])
    assert z.std(axis=0) == pytest.approx(1.0, abs=0.02)
    assert abs(np.corrcoef(z.T)[0, 1]) < 0.03


def test_paths_are_smooth_and_of_their_length():
    keys, path = np.array([7], dtype=np.uint64), np.empty((paths.POINTS, 3))
    for _ in range(20):
        paths.wander(path, 10.0, 0.6, 3, keys, 0)
        steps = np.diff(path, axis=0)
        assert np.linalg.norm(steps, axis=1) == pytest.approx(10.0 / (paths.POINTS - 1))
        t = steps / np.linalg.norm(steps, axis=1)[:, None]
        turn = np.arccos(np.clip(np.sum(t[1:] * t[:-1], axis=1), -1, 1))
        assert turn.max() < 1.01 * 0.6 * 10.0 / (paths.POINTS - 1)


def test_heads_lead_where_they_are_told():
    rng, y = np.random.default_rng(0), np.zeros(8)
    for h in [*rng.normal(size=(10, 3)), [1.0, 0, 0], [-1.0, 0, 0]]:
        h = np.array(h) / np.linalg.norm(h)
        camera.attitude(y, h, 0.7)
        assert np.linalg.norm(y[3:7]) == pytest.approx(1.0)
        assert rotation_matrix(y[3:7]) @ [-1, 0, 0] == pytest.approx(h, abs=1e-12)


def test_ends_are_told_apart():
    env = SteerEnv(**CALM)
    env.reset(seed=1, options={"path": [[0, 0, 0], [1, 0, 0]]})
    over = False
    while not over:
        _, reward, over, cut, info = env.step([1, 0, 0, 0.6])
        assert not cut
    assert reward > 4
    assert info["progress"] > 0.85
    env.reset(seed=1, options={"path": [[0, 0, 0], [10, 0, 0]]})
    over = False
    while not over:
        _, reward, over, _, info = env.step([0, 1, 0, 0.6])
    assert reward < -4
    assert info["off_path"] > 3.0


def makers(name):
    """The single environment and the vector of two."""
    return gym.make(name).unwrapped, gym.make_vec(
        name, num_envs=2, vectorization_mode="vector_entry_point"
    )


def episode(env, seed=None, options=None):
    """All that an episode of thirty steps gives."""
    seen = [env.reset(seed=seed, options=options)[0]]
    for move in actions(env, 30):
        obs, reward, *_ = env.step(move)
        seen += [obs, np.atleast_1d(reward)]
    return np.concatenate([np.ravel(s) for s in seen])


@pytest.mark.parametrize("kind", [0, 1], ids=["single", "vector"])
def test_a_reset_forgets_the_path_that_was_given(kind):
    """An own path of 2 or 40 mm does not scale the path of 10 mm of the next episode."""
    env = makers("microswim/Steer-v0")[kind]
    first = episode(env, 7)
    for end in (2.0, 40.0):
        episode(env, 1, {"path": [[0, 0, 0], [end, 0, 0]]})
        assert (episode(env, 7) == first).all()
        with pytest.raises(ms.SpecError, match="path"):
            env.reset(seed=1, options={"path": [[0, 0, 0]]})
        assert (episode(env, 7) == first).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kind", [0, 1], ids=["single", "vector"])
def test_what_follows_a_seed_does_not_depend_on_what_came_before(name, kind):
    """Nor do the episodes after it, which are not given a seed."""
    new, used = makers(name)[kind], makers(name)[kind]
    episode(used)
    episode(used, 3)
    for seed in (5, [5, 9]) if kind else (5,):
        for _ in range(2):
            first, second = episode(new, seed), episode(new)
            assert (episode(used, seed) == first).all()
            assert (episode(used) == second).all()
            assert (first != second).any()


@pytest.mark.parametrize("name", NAMES)
def test_a_vector_goes_on_as_its_single_environments_are_reset(name):
    """Past an end and through a reset without a seed."""
    many = gym.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point", max_steps=5)
    alone = [gym.make(name, max_steps=5) for _ in range(2)]
    many.reset(seed=[4, 8])
    for env, seed in zip(alone, (4, 8)):
        env.reset(seed=seed)
    moves = actions(many, 5)
    for move in moves:
        many.step(move)
        for env, own in zip(alone, move):
            env.step(own)
    begun, *_ = many.step(moves[0])
    assert (begun == [env.reset()[0] for env in alone]).all()
    begun, _ = many.reset(seed=[None, 8])
    assert (begun[0] == alone[0].reset()[0]).all()
    assert (begun[1] == alone[1].reset(seed=8)[0]).all()


@pytest.mark.parametrize("name", NAMES)
def test_a_step_before_the_first_reset_is_an_error(name):
    for env in makers(name):
        with pytest.raises(gym.error.ResetNeeded, match="reset"):
            env.step(actions(env, 1)[0])
    with pytest.raises(ms.MicroswimError, match="reset"):
        makers(name)[0].all.step(np.zeros((1, 4)))


FORKED = """
import gymnasium as gym, numpy as np
import microswim.control.environments
many = gym.make_vec("microswim/Steer-v0", num_envs=300)
many.reset(seed=0)
many.step(np.zeros((300, 4), np.float32))
apart = gym.make_vec("microswim/Steer-v0", num_envs=2, vectorization_mode="async")
begun, _ = apart.reset(seed=0)
for _ in range(3):
    seen, *_ = apart.step(np.zeros((2, 4), np.float32))
apart.close()
alone = gym.make("microswim/Steer-v0")
alone.reset(seed=1)
for _ in range(3):
    own, *_ = alone.step(np.zeros(4, np.float32))
print((own == seen[1]).all())
"""


@pytest.mark.parametrize("layer", ["omp", "workqueue"])
def test_processes_forked_from_one_with_threads_step_on(layer):
    """As Gymnasium's asynchronous vector forks them; the same numbers as in one process."""
    done = subprocess.run(
        [sys.executable, "-c", FORKED],
        env={**os.environ, "NUMBA_THREADING_LAYER": layer},
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )
    assert done.stdout.split() == ["True"], done.stderr[-500:]


BAD = [
    (SteerEnv, {"latency": -1}, "latency"),
    (SteerEnv, {"latency": 1.5}, "latency"),
    (ReachEnv, {"frame_interval": 0}, "frame_interval"),
    (ReachEnv, {"disturbance": np.nan}, "disturbance"),
    (SteerEnv, {"latency": 10**9}, "latency"),
    (ReachEnv, {"disturbance": 1e308}, "disturbance"),
    (SteerEnv, {"wind": 1.0}, "wind = 1.0: must be one of the settings disturbance"),
    (ReachVectorEnv, {"num_envs": 0}, "num_envs"),
    (SteerVectorEnv, {"num_envs": 2.5}, "num_envs"),
    (SteerVectorEnv, {"num_envs": "two"}, "num_envs"),
    (SteerVectorEnv, {"num_envs": 2, "wind": 1.0}, "wind"),
]


@pytest.mark.parametrize(("kind", "options", "word"), BAD)
def test_bad_settings_are_one_sentence(kind, options, word):
    with pytest.raises(ms.SpecError, match=word):
        kind(**options)


def test_bad_actions_and_paths_are_one_sentence():
    env = SteerEnv()
    for path in ([[0, 0, 0]], [[0, 0, 0], [0, 0, 0]], "home", [[0, 0, 0], [np.nan, 0, 0]]):
        with pytest.raises(ms.SpecError, match="path"):
            env.reset(options={"path": path})
    back = [[0, 0, 0], [1, 0, 0], [2.0 / 41.0, 0, 0]]  # two of the points of its steps coincide
    for path in (back, [[0, 0, 0], [1e-9, 0, 0]], [[0, 0, 0], [1e30, 0, 0]]):
        with pytest.raises(ms.SpecError, match="path"):
            env.reset(options={"path": path})
    for options in ({"route": []}, {"path": None, 3: 1}, "path", [1]):
        with pytest.raises(ms.SpecError, match="options"):
            env.reset(options=options)
    for seed in (-1, 1.5, "one", True):
        with pytest.raises(ms.SpecError, match="seed"):
            env.reset(seed=seed)
    env.reset(seed=0)
    for action in ([1, 0, 0], [1, 0, 0, np.nan], [1e300, 0, 0, 0], "left", None):
        with pytest.raises(ms.SpecError, match="action"):
            env.step(action)
    with pytest.raises(ms.SpecError, match="target"):
        ReachEnv().reset(options={"path": [[0, 0, 0], [1, 0, 0]]})
    many = gym.make_vec(NAMES[0], num_envs=2, vectorization_mode="vector_entry_point")
    with pytest.raises(ms.SpecError, match="seed"):
        many.reset(seed=[1, 2, 3])
    with pytest.raises(ms.SpecError, match="seed"):
        many.reset(seed=[1, -2])
    many.reset(seed=[1, 2])
    with pytest.raises(ms.SpecError, match="shape"):
        many.step(np.zeros((3, 4)))
