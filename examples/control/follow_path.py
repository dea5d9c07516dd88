"""A magnetised robot follows paths in space: pursuit of the point ahead, with a memory.

    python examples/control/follow_path.py

The controller knows only what the camera of ``microswim/Steer-v0`` tells: late, noisy frames, and a
flow it cannot see. It aims at the point 1 mm ahead, plus what the robot has lately been off the
path (an integral, which cancels the mean flow), just below step-out.
"""

import gymnasium
import numpy as np

from microswim.control import environments

gymnasium.register_envs(environments)

GAIN, MEMORY, WEIGHT, ANGLE, FREQUENCY = 2.0, 0.1, 0.5, 0.6, 6.0  # 1/mm, 1/mm s, 1, rad, Hz
DT, LEAK = 0.02, 0.15  # s, 1/s


class Pursuit:
    """Direction and frequency from observations of many robots at once."""

    def __init__(self, n):
        self.integral = np.zeros((n, 3))

    def __call__(self, seen):
        off, along, ahead, heading = (seen[:, i : i + 3] for i in (0, 3, 6, 9))
        across = off - np.sum(off * along, axis=1, keepdims=True) * along
        self.integral += DT * (across - LEAK * self.integral)
        aim = WEIGHT * ahead + (1.0 - WEIGHT) * along + GAIN * across + MEMORY * self.integral
        aim = limited(aim, heading)
        frequency = np.full(len(aim), FREQUENCY / 10.0)
        return np.concatenate([aim, frequency[:, None]], axis=1)


def limited(aim, heading):
    """The direction nearest to the aim within an angle of the heading, or the helix steps out."""
    aim = aim / np.linalg.norm(aim, axis=1, keepdims=True)
    along = np.sum(aim * heading, axis=1, keepdims=True)
    across = aim - along * heading
    size = np.linalg.norm(across, axis=1, keepdims=True) + 1e-12
    near = np.cos(ANGLE) * heading + np.sin(ANGLE) * across / size
    return np.where(along > np.cos(ANGLE), aim, near)


def main(robots=64, steps=900, seed=0):
    """Root mean square distance from the path (mm), after the first second, and robots arrived."""
    envs = gymnasium.make_vec("microswim/Steer-v0", num_envs=robots)
    seen, _ = envs.reset(seed=seed)
    control, running = Pursuit(robots), np.ones(robots, bool)
    squares, count, arrived = 0.0, 0, 0
    for step in range(steps):
        seen, rewards, over, cut, _ = envs.step(control(seen))
        off = envs.unwrapped.all.about["off_path"]
        if step * DT > 1.0:
            squares, count = squares + np.sum(off[running] ** 2), count + running.sum()
        arrived += np.sum(over & running & (rewards > 0))
        running &= ~(over | cut)
    error = float(np.sqrt(squares / count))
    print(f"{robots} paths of 10 mm: {arrived} arrived, {error:.3f} mm off the path (rms)")
    return {"error": error, "arrived": int(arrived), "robots": robots}


if __name__ == "__main__":
    main()
