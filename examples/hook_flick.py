"""A hook that gives way: the flick of a bacterium.

A helix behind a soft hook pushes its head ahead, and so its hook together. Left: the motor torque
at which the hook buckles, against its stiffness, when the helix pushes and when, turned the other
way, it pulls; the dashed line is in proportion to the stiffness, as a rigid helix would have it.
Right: the same as rates of the motor.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

STIFFNESS = np.array([0.5, 1.0, 4.0]) * 1e-25  # N m^2
LENGTH = 100e-9
COLOURS = {"pushes": "#D55E00", "pulls": "#0072B2"}


def cell(stiffness, sense):
    """A round cell of a micrometre with a helix of 6 um, in water."""
    return ms.Swimmer(
        body=ms.Sphere(radius=0.6e-6),
        tail=ms.ElasticTail(
            length=6e-6, radius=10e-9, bending=3e-23, drive="rotate", frequency=sense * 100.0,
            rest_radius=0.2e-6, rest_pitch=-2.2e-6,
        ),
        fluid=ms.Fluid(viscosity=1e-3),
        hook=ms.Hook(stiffness=float(stiffness), length=LENGTH),
        units="SI",
    )  # fmt: skip


def main():
    senses = {"pushes": 1.0, "pulls": -1.0}
    found = {
        name: [ms.stability(cell(b, sense), "motor") for b in STIFFNESS]
        for name, sense in senses.items()
    }
    torque = {name: np.array([f.load for f in row]) for name, row in found.items()}
    rate = {name: np.array([f.motor_rate for f in row]) for name, row in found.items()}
    return {"torque": torque, "rate": rate}


def figure(results):
    fig = Figure(figsize=(7.2, 3.0), layout="constrained")
    left, right = fig.subplots(1, 2)
    for name, colour in COLOURS.items():
        left.plot(1e25 * STIFFNESS, 1e18 * results["torque"][name], "o-", color=colour, label=name)
        right.plot(1e25 * STIFFNESS, results["rate"][name] / (2 * np.pi), "o-", color=colour)
    first = 1e18 * results["torque"]["pushes"][0]
    left.plot(1e25 * STIFFNESS, first * STIFFNESS / STIFFNESS[0], "--", color="#222222", lw=0.8)
    left.set(xscale="log", ylabel="critical torque / pN µm")
    right.set(xscale="log", ylabel="critical motor rate / Hz")
    for axes in (left, right):
        axes.set(xlabel="stiffness of the hook / 1e-25 N m²", xticks=[0.5, 1.0, 2.0, 4.0])
        axes.set_xticklabels(["0.5", "1", "2", "4"])
        axes.minorticks_off()
    left.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("critical torque in N m:", {k: v.tolist() for k, v in results["torque"].items()})
    figure(results).savefig("hook_flick.svg")
