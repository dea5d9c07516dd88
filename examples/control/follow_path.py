"""A magnetised robot follows paths in space.

Left: four of the paths, each in the plane in which it bends most (dashed), and what was swum.
Right: how far 64 robots are off their paths. The pursuit knows only what the camera of
`microswim/Steer-v0` tells, frames that are late and noisy, and nothing of the flow that carries
the robots: it aims at the point 1 mm ahead, plus what the robot has lately been off the path (an
integral, which cancels the mean flow), just below step-out. The head is 0.6 mm across.
"""

import gymnasium
import numpy as np
from matplotlib.figure import Figure

from microswim.control import environments

gymnasium.register_envs(environments)

GAIN, MEMORY, WEIGHT, ANGLE, FREQUENCY = 2.0, 0.1, 0.5, 0.6, 6.0  # 1/mm, 1/mm s, 1, rad, Hz
DT, LEAK = 0.02, 0.15  # s, 1/s
SHOWN = 4  # paths in the picture


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
    envs = gymnasium.make_vec("microswim/Steer-v0", num_envs=robots)
    seen, _ = envs.reset(seed=seed)
    world = envs.unwrapped.all
    control, running, arrived = Pursuit(robots), np.ones(robots, bool), 0
    paths, swum, off = world.path * 1e3, [], []
    for _ in range(steps):
        seen, rewards, over, cut, _ = envs.step(control(seen))
        swum.append(np.where(running[:, None], world.memory[:, :3] * 1e3, np.nan))
        off.append(np.where(running, world.about["off_path"], np.nan))
        arrived += int(np.sum(over & running & (rewards > 0)))
        running &= ~(over | cut)
    off, late = np.array(off), int(1.0 / DT)
    rms = np.sqrt(np.nanmean(off[late:] ** 2))
    return {
        "distance off the path after a second (mm, rms)": float(rms),
        "arrived": arrived / robots,
        "off": off,
        "paths": paths[:SHOWN],
        "swum": np.array(swum)[:, :SHOWN],
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.4), layout="constrained")
    left, right = fig.subplots(1, 2)
    for i, path in enumerate(results["paths"]):
        centre = path.mean(axis=0)
        plane = np.linalg.svd(path - centre)[2][:2]  # in which it bends most
        (x, y), (u, v) = (plane @ (p - centre).T for p in (path, results["swum"][:, i]))
        left.plot(x, y - 4 * i, "--", color="#222222", lw=1, label="wanted" if i == 0 else None)
        left.plot(u, v - 4 * i, color="#D55E00", lw=1, label="swum" if i == 0 else None)
    left.set(xlabel="mm", ylabel="mm", aspect="equal")
    left.legend(frameon=False, fontsize=8)
    off = results["off"]
    off = off[np.isfinite(off).sum(axis=1) > len(off[0]) / 2]  # while most are on their way
    time = DT * np.arange(1, len(off) + 1)
    low, middle, high = np.nanpercentile(off, [10, 50, 90], axis=1)
    right.fill_between(time, low, high, color="#0072B2", alpha=0.3, lw=0, label="8 of 10 robots")
    right.plot(time, middle, color="#0072B2", label="median")
    right.set(xlabel="time (s)", ylabel="distance off the path (mm)", ylim=(0, None))
    right.legend(frameon=False, fontsize=8)
    return fig


if __name__ == "__main__":
    results = main()
    print({k: v for k, v in results.items() if isinstance(v, float)})
    figure(results).savefig("follow_path.svg")
