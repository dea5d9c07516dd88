"""A tail that bends: what stiffness pushes best.

A filament whose base is moved across its axis, or turned to and fro, pushes because it bends: a
stiff one retraces its way and goes nowhere, a limp one wags only at its root. Left: mean thrust on
the held base against the sperm number, length over the length that bending can fight drag for;
lines are the model of elastic tails at a hundredth of the length, marks the closed forms of small
amplitude. Right: the filament at eight instants, at the best stiffness and at a tenth of it.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

NUMBERS = np.geomspace(0.7, 9.0, 60)
SIZE = 0.01
DRIVES = {
    "clamped, moved across": {"drive": "heave", "base": "clamped", "amplitude": SIZE},
    "hinged, moved across": {"drive": "heave", "base": "hinged", "amplitude": SIZE},
    "turned to and fro": {"drive": "pivot", "angle": SIZE},
}
#: Closed forms of small amplitude: sperm number to thrust, in the order of the drives.
KNOWN = {
    1: (0.0621, 0.0016, 0.00966), 2: (0.3835, 0.0261, 0.05831), 3: (0.1901, 0.1196, 0.01914),
    4: (0.2357, 0.2073, 0.00897), 5: (0.2754, 0.1800, 0.00627), 8: (0.2513, 0.1780, 0.00229),
}  # fmt: skip
COLOURS = ("#0072B2", "#D55E00", "#222222")


def held(sperm_number, **drive):
    """A filament of length 1 and c_n = 2 c_t = 1 on a held base."""
    bending = 2 * np.pi / sperm_number**4
    return ms.Swimmer(
        body=ms.NoBody(),
        tail=ms.ElasticTail(length=1.0, radius=0.01, bending=bending, **drive),
        fluid=ms.Fluid(viscosity=1.0),
        coefficients=ms.Constant(normal=1.0, tangential=0.5, spin=False),
        motion=ms.Motion(free="none"),
    )


def thrust(sperm_number, **drive):
    """Towards the body, in units of (c_n - c_t) w size^2."""
    wrench = ms.summary(held(sperm_number, **drive).gait())["held_wrench"]
    return -wrench[0] / (0.5 * 2 * np.pi * SIZE**2)


def main():
    found = {k: np.array([thrust(n, **d) for n in NUMBERS]) for k, d in DRIVES.items()}
    at_known = {k: [thrust(n, **d) for n in KNOWN] for k, d in DRIVES.items()}
    best = NUMBERS[np.argmax(found["clamped, moved across"])]
    phases, s = np.arange(8) * np.pi / 4, np.linspace(0.0, 1.0, 60)
    shapes = {}
    for number in (best, best * 10**0.25):
        tail = held(number, drive="heave", amplitude=0.2).settled.tail
        shapes[float(number)] = tail.centreline(s, phases[:, None])[0][..., :2]
    return {"thrust": found, "at known": at_known, "best": float(best), "shapes": shapes}


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    grid = fig.add_gridspec(2, 2, width_ratios=(1.5, 1.0))
    left = fig.add_subplot(grid[:, 0])
    for (name, values), colour, known in zip(
        results["thrust"].items(), COLOURS, zip(*KNOWN.values())
    ):
        left.plot(NUMBERS, values, color=colour, label=name)
        left.plot(list(KNOWN), known, "o", ms=4, mfc="none", color=colour)
    left.set(xscale="log", xlabel="sperm number", xticks=list(KNOWN), xticklabels=list(KNOWN))
    left.set_ylabel(r"thrust / $(c_n - c_t)\,\omega\,$size$^2$")
    left.minorticks_off()
    left.legend(frameon=False, fontsize="small")
    for row, (number, shape) in enumerate(results["shapes"].items()):
        axes = fig.add_subplot(grid[row, 1])
        for i, (x, y) in enumerate(np.moveaxis(shape, -1, 1)):
            axes.plot(x, y, color="#0072B2", alpha=0.25 + 0.75 * i / 7, lw=1.2)
        axes.set(title=f"sperm number {number:.2g}", aspect="equal")
        axes.set(xlabel="s / L", ylabel="q / L")
    return fig


if __name__ == "__main__":
    results = main()
    print("best sperm number, clamped and moved across:", results["best"])
    figure(results).savefig("tail_that_bends.svg")
