"""How thermal noise turns cells away.

A bacterium swims in water at 298 K, forty times from the same start in the same direction. Left:
the paths in the plane, dashed the one without noise. Rotational diffusion turns the cells away,
within the persistence time 1/(2 D_r) of their heading. Right: mean square displacement of the forty
in time; the line is that of an active particle with the cell's speed and the mobility's D and D_r,
6 D t + 2 (v tau)^2 (t/tau - 1 + exp(-t/tau)): first straight ahead, then a random walk.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

CELLS, TIME, EVERY = 40, 10.0, 101


def main():
    cell = ms.Swimmer.preset("goto/C", {"noise": {"temperature": "298 K"}, "motion.free": "all"})
    gait = cell.gait()
    turn = float(gait.period) / 12.0  # a time step; half as fine as usual serves here
    paths = ms.path(cell, TIME, gait=gait, paths=CELLS, samples=EVERY, seed=4, step=turn)
    still = ms.Swimmer.preset("goto/C", {"motion.free": "all"})
    straight = ms.path(still, TIME, gait=gait, samples=EVERY)
    mobility = np.linalg.inv(gait.resistance(0.0))
    energy = cell.noise.energy("SI")
    turning = energy * (mobility[4, 4] + mobility[5, 5]) / 2.0
    spreading = energy * np.trace(mobility[:3, :3]) / 3.0
    return {
        "paths": paths,
        "straight": straight,
        "persistence time": float(1.0 / (2.0 * turning)),
        "diffusion": float(spreading),
        "speed": float(ms.screw(gait).speed),
    }


def displacement(results):
    """Mean square displacement of the cells, and that of an active particle, at the times."""
    x = results["paths"].position.values
    square = ((x - x[:, :1]) ** 2).sum(axis=-1).mean(axis=0)
    t, tau = results["paths"].time.values, results["persistence time"]
    active = 2.0 * (results["speed"] * tau) ** 2 * (t / tau - 1.0 + np.exp(-t / tau))
    return t, square, active + 6.0 * results["diffusion"] * t


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    plane, time = fig.subplots(1, 2)
    for x in 1e6 * results["paths"].position.values:
        plane.plot(x[:, 0], x[:, 1], color="#0072B2", lw=0.6)
        plane.plot(*x[-1, :2], "o", color="#0072B2", ms=2.5, mfc="white")
    x = 1e6 * results["straight"].position.values
    plane.plot(x[:, 0], x[:, 1], "--", color="#222222", label="without noise")
    plane.set(xlabel="x (µm)", ylabel="y (µm)", aspect="equal")
    plane.legend(frameon=False, loc="upper right")
    t, square, active = displacement(results)
    time.loglog(t[1:], 1e12 * active[1:], color="#222222", label="active particle")
    time.loglog(t[1:], 1e12 * square[1:], "o", color="#0072B2", ms=3, label="forty cells")
    time.set(xlabel="time (s)", ylabel="mean square displacement (µm$^2$)")
    time.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("persistence time (s):", results["persistence time"])
    figure(results).savefig("cells_in_noise.svg")
