"""Thermal noise in the environments: the displacements of the loop, one stream a robot."""

import gymnasium as gym
import numpy as np
import pytest

import microswim as ms
from microswim.control.environments.jostle import jostle
from microswim.control.environments.random_streams import normals
from microswim.control.environments.reach import ReachWorld
from microswim.control.thermal import moved

TASKS = ["microswim.control.environments:microswim/Steer-v0",
         "microswim.control.environments:microswim/Reach-v0"]  # fmt: skip


def test_a_robot_is_displaced_as_in_the_loop():
    """Against the Cholesky factor of the mobility and the exponential of rigid motions."""
    stepper, size = ReachWorld.stepper(), 3e-3
    y = np.array([1e-3, 2e-3, 3e-3, 0.5, -0.5, 0.7, 0.1, 0.9])
    keys, again = np.array([9], dtype=np.uint64), np.array([9], dtype=np.uint64)
    n = np.array([x for _ in range(3) for x in normals(again, 0)])
    M = np.linalg.inv(stepper.gait.resistance(0.9))
    size = 0.3 / np.sqrt(M[3, 3])
    z = size * np.linalg.cholesky(M) @ n
    wanted = moved(y[None], z[None])[0]
    jostle(stepper.response.twist, y, size, keys, 0)
    assert y == pytest.approx(wanted, rel=1e-10, abs=1e-14)
    assert keys[0] == again[0]


@pytest.mark.parametrize("task", TASKS)
def test_noise_is_an_option_of_each_task(task):
    def run(**options):
        env = gym.make(task, **options)
        seen = [env.reset(seed=3)[0]]
        action = np.full(env.action_space.shape, 0.4, dtype=np.float32)
        seen += [env.step(action)[0] for _ in range(8)]
        return np.array(seen)

    still = run()
    assert np.array_equal(run(temperature=0.0), still)
    hot = run(temperature=1e13)  # a robot of a millimetre takes that much
    assert np.array_equal(hot, run(temperature=1e13))
    assert np.abs(hot - still).max() > 1e-4
    with pytest.raises(ms.SpecError, match="temperature"):
        run(temperature=-1.0)
    tumbling = run(run_time=0.5)
    assert np.array_equal(tumbling, run(run_time=0.5))
    assert np.abs(tumbling - still).max() > 1e-4
    for bad in ({"run_time": -1.0}, {"run_time": 1e-6}, {"run_time": 1.0, "tumble_angle": 4.0}):
        with pytest.raises(ms.SpecError, match=list(bad)[-1]):
            run(**bad)


def test_one_robot_is_one_of_many():
    single = gym.make(TASKS[1], temperature=1e15)
    many = gym.make_vec(TASKS[1], num_envs=3, temperature=1e15)
    one, _ = single.reset(seed=12)
    all_, _ = many.reset(seed=10)
    for _ in range(5):
        assert np.array_equal(one, all_[2])
        one = single.step(np.ones(2, dtype=np.float32))[0]
        all_ = many.step(np.ones((3, 2), dtype=np.float32))[0]
