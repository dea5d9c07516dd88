"""Run and tumble.

A cell of the size of E. coli with four flagella, each with a motor of its own, by resistive force
theory. a: the cell to scale. b: its speed, and how fast it turns end over end, with none to four
motors reversed; four reversed back up as fast as none swims. c: a path of runs (blue, four motors
forwards) and tumbles (red, two of them reversed for a while), after each of which it runs another
way. The flagella keep their directions: that they bundle in a run and splay in a tumble is left
out.
"""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse

import microswim as ms

UM = 1e-6
TUMBLES = (0.21, 0.34, 0.27)  # seconds
RUN = 0.6


def cell(reversed_motors=0):
    tails = []
    for k in range(4):
        turn = np.pi * (k + 0.5) / 2
        q, r = np.cos(turn), np.sin(turn)
        tails.append(
            ms.HelicalTail(
                length=6 * UM, amplitude=0.2 * UM, wavelength=2.3 * UM, radius=0.012 * UM,
                position=(-0.35 * UM, 0.3 * UM * q, 0.3 * UM * r),
                direction=(1, 0.15 * q, 0.15 * r),
                phase=turn, frequency=-130.0 if k < reversed_motors else 130.0,
            )
        )  # fmt: skip
    body, water = ms.Spheroid(semi_axes=(1.25 * UM, 0.44 * UM)), ms.Fluid(viscosity=1e-3)
    return ms.Swimmer(body=body, tail=tails, fluid=water, units="SI")


def main():
    gaits = [cell(n).gait() for n in range(5)]
    mean = np.array([g.mean_velocity for g in gaits])
    pose, parts = {}, []
    for tumble in (*TUMBLES, 0.0):
        for gait, time in ((gaits[0], RUN), (gaits[2], tumble)):
            if time:
                path = ms.trajectory(gait, np.linspace(0.0, time, 200), **pose)
                x, turn = path.position.values, path.quaternion.values
                pose = {"position": x[-1], "quaternion": turn[-1]}
                parts.append(x)
    runs = [x[-1] - x[0] for x in parts[::2]]
    headings = np.array(runs) / np.linalg.norm(runs, axis=1, keepdims=True)
    return {
        "parts": parts,
        "forwards": -mean[:, 0],
        "end over end": np.linalg.norm(mean[:, 4:], axis=1),
        "turned by tumbles": np.degrees(np.arccos(np.sum(headings[1:] * headings[:-1], axis=1))),
        "running speed (um/s)": float(-mean[0, 0] / UM),
    }


def figure(results):
    fig = Figure(figsize=(7.6, 3.6), layout="constrained")
    panels = fig.subplot_mosaic([["a", "b"], ["c", "b"]], width_ratios=(1.5, 1.0))
    left, middle, right = (panels[name] for name in "abc")
    robot = cell()
    left.add_patch(Ellipse((-1.25, 0), 2.5, 0.88, color="#0072B2"))
    for tail in robot.tail.each:
        P = tail.centreline(np.linspace(0.0, tail.length, 400), 0.0)[0] / UM
        left.plot(P[:, 0], P[:, 1], color="#D55E00", lw=1.2)
    left.set(aspect="equal", xlabel="s (µm)", ylabel="q (µm)", title="a")
    middle.plot(results["forwards"] / UM, "o-", color="#0072B2")
    middle.set(xlabel="motors reversed", ylabel="forwards (µm/s)", title="b", xticks=range(5))
    other = middle.twinx()
    other.plot(results["end over end"], "s--", color="#D55E00")
    other.set_ylabel("end over end (rad/s)", color="#D55E00")
    for n, x in enumerate(results["parts"]):
        right.plot(x[:, 0] / UM, x[:, 2] / UM, color=("#0072B2", "#D55E00")[n % 2], lw=1.5)
    right.set(xlabel="x (µm)", ylabel="z (µm)", title="c", aspect="equal")
    return fig


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v}" for k, v in results.items() if k != "parts"), sep="\n")
    figure(results).savefig("run_and_tumble.svg")
