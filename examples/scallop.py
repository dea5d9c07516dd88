"""Purcell's scallop: back and forth leads nowhere.

A motor that turns half a turn forth and half a turn back. Solid: displacement of the body along
the axis; dashed: the angle of the motor. However quickly one half is done and however slowly the
other, the body returns to where it was, because at low Reynolds number only the sequence of
shapes counts, not the time they take. The dotted line is the same motor turning on: it gets away.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

QUICK = 0.25  # share of the cycle that the way forth takes


def rate(time):
    """Phase rate of half a turn forth in a quarter of the time, and back in three quarters."""
    forth = np.mod(time, 1.0) < QUICK
    return np.where(forth, np.pi / QUICK, -np.pi / (1.0 - QUICK))


def main():
    gait = ms.Swimmer.preset("tabak/helix-constant").gait()
    cycle = np.linspace(0.0, 1.0, 41)
    time = np.concatenate([cycle[:-1] + n for n in range(3)] + [[3.0]])
    path = [np.zeros(3)]
    angle, pose = 0.0, {"position": (0, 0, 0), "quaternion": (1, 0, 0, 0)}
    angles = [angle]
    for a, b in zip(time[:-1], time[1:]):  # the rate is constant within each step
        w = float(rate(0.5 * (a + b)))
        step = ms.trajectory(gait, [a, b], rate=w, phase=angle, **pose)
        pose = {"position": step.position[-1].values, "quaternion": step.quaternion[-1].values}
        angle += w * (b - a)
        path.append(pose["position"])
        angles.append(angle)
    on = ms.trajectory(gait, time, rate=np.pi)
    return {
        "time": time,
        "forwards": -np.array(path)[:, 0],
        "turns": np.array(angles) / (2 * np.pi),
        "turning on": -on.position.values[:, 0],
        "displacement after three cycles": float(np.linalg.norm(path[-1])),
        "largest displacement on the way": float(np.abs(np.array(path)).max()),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.0), layout="constrained")
    left = fig.subplots()
    t = results["time"]
    left.plot(t, results["forwards"], color="#0072B2", label="back and forth")
    left.plot(t, results["turning on"], color="#222222", ls=":", label="turning on")
    left.set(xlabel="time (cycles)", ylabel="forward displacement (body diameters)", xlim=(0, 3))
    right = left.twinx()
    right.plot(t, results["turns"], color="#D55E00", ls="--", label="motor (right axis)")
    right.set(ylabel="angle of the motor (turns)", ylim=(0, 1.5))
    fig.legend(loc="outside upper center", ncols=3, frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("displacement after three cycles:", results["displacement after three cycles"])
    figure(results).savefig("scallop.svg")
