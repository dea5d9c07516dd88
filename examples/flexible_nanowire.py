"""A nanowire that bends: a magnetic head in a turning field, and a slack tail.

A nickel head of 1.5 µm and a silver tail of 4.3 µm in a field of 1 mT, as Pak, Gao, Wang and Lauga
built them in 2011; their fastest swam at about 21 µm/s. The head goes round with the field, the
tail lags behind it as a screw, and that screw swims, head first. Radii (100 and 50 nm), stiffness
and the field's angle to its axis are assumed. Left: the speed over the frequency. Right: over the
stiffness, at 15 Hz and 60°; softer and stiffer tails are slower. Dotted: what was measured.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

MEASURED = 21e-6  # m/s
NICKEL = 4.9e5  # A/m, saturated
COLOURS = ("#0072B2", "#D55E00")
FREQUENCIES = np.array([5.0, 15.0, 30.0, 60.0])  # Hz
STIFFNESS = np.array([1e-24, 2e-24, 4e-24, 8e-24, 2e-23])  # N m^2
ANGLES = (60.0, 45.0)  # degrees between the field and its axis


def wire(bending, angle=45.0):
    """A head magnetised along itself, in water."""
    volume = np.pi * (0.1e-6) ** 2 * 1.5e-6
    return ms.Swimmer(
        body=ms.Capsule(length=1.5e-6, radius=0.1e-6),
        tail=ms.ElasticTail(length=4.3e-6, radius=0.05e-6, bending=bending, drive="none"),
        fluid=ms.Fluid(viscosity=1e-3),
        magnet=ms.Magnet(moment=(NICKEL * volume, 0.0, 0.0)),
        field=ms.RotatingField(strength=1e-3, frequency=15.0, cone=np.radians(90.0 - angle)),
        units="SI",
    )


def speeds(bending, angle, frequencies):
    """Head first, along the axis of the field."""
    return -ms.regimes(wire(bending, angle), frequencies).velocity


def main():
    return {
        "over_frequency": {a: speeds(4e-24, a, FREQUENCIES) for a in ANGLES},
        "over_stiffness": np.concatenate([speeds(b, 60.0, [15.0]) for b in STIFFNESS.tolist()]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.0), layout="constrained")
    left, right = fig.subplots(1, 2, sharey=True)
    for (angle, speed), colour in zip(results["over_frequency"].items(), COLOURS):
        left.plot(FREQUENCIES, 1e6 * speed, "o-", color=colour, label=f"{angle:.0f}°")
    right.plot(1e24 * STIFFNESS, 1e6 * results["over_stiffness"], "o-", color=COLOURS[0])
    for axes in (left, right):
        axes.axhline(1e6 * MEASURED, ls=":", color="#222222", lw=1.0)
        axes.set(ylabel="speed / µm/s")
    left.set(xlabel="frequency / Hz")
    left.legend(frameon=False, title="field to axis", fontsize="small", title_fontsize="small")
    right.set(xscale="log", xlabel="stiffness of the tail / 1e-24 N m²", xticks=[1, 2, 4, 8, 20])
    right.set_xticklabels(["1", "2", "4", "8", "20"])
    right.minorticks_off()
    return fig


if __name__ == "__main__":
    results = main()
    print("µm/s over the frequency:", {k: 1e6 * v for k, v in results["over_frequency"].items()})
    print("µm/s over the stiffness:", 1e6 * results["over_stiffness"])
    figure(results).savefig("flexible_nanowire.svg")
