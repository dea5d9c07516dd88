"""A robot that swims like sperm: a filament that bends itself.

Waves of inner moment run from the head to the tip, as the motors of an axoneme make them. Left:
speed against the sperm number, length over the length that bending can fight drag for, for three
sizes of the moment; small ones fall on one curve when divided by their square. Right: the filament
at eight instants, under the largest of the three, seen from the head.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

NUMBERS = np.geomspace(1.5, 8.0, 16)
MOMENTS = (0.5, 2.0, 4.0)  # in B / L
COLOURS = ("#0072B2", "#D55E00", "#222222")
SHOWN = 3.0


def sperm(sperm_number, moment):
    """A head of a twentieth of the length, at a beat of one per unit time."""
    law = ms.Constant(normal=1.0, tangential=0.55)
    bending = 2 * np.pi / sperm_number**4
    return ms.Swimmer(
        body=ms.Sphere(radius=0.05),
        tail=ms.ElasticTail(
            length=1.0, radius=0.005, bending=bending, drive="moment", moment=moment * bending,
            wavelength=1.0,
        ),
        fluid=ms.Fluid(viscosity=0.2),
        coefficients=law,
    )  # fmt: skip


def main():
    speed = {m: np.array([-sperm(n, m).gait().mean_velocity[0] for n in NUMBERS]) for m in MOMENTS}
    tail = sperm(SHOWN, MOMENTS[-1]).settled.tail
    s, phases = np.linspace(0.0, 1.0, 60), np.arange(8) * np.pi / 4
    return {"speed": speed, "shapes": tail.centreline(s, phases[:, None])[0][..., :2]}


def figure(results):
    fig = Figure(figsize=(7.2, 3.0), layout="constrained")
    left, right = fig.subplots(1, 2)
    for (moment, speed), colour in zip(results["speed"].items(), COLOURS):
        left.plot(NUMBERS, speed / moment**2, color=colour, label=f"moment {moment:g} B/L")
    left.set(xscale="log", xlabel="sperm number", xticks=[2, 3, 4, 6, 8])
    left.set(xticklabels=["2", "3", "4", "6", "8"], ylabel="lengths a beat / moment²")
    left.minorticks_off()
    left.legend(frameon=False, fontsize="small")
    for i, (x, y) in enumerate(np.moveaxis(results["shapes"], -1, 1)):
        right.plot(x, y, color="#0072B2", alpha=0.25 + 0.75 * i / 7, lw=1.2)
    right.set(aspect="equal", xlabel="s / L", ylabel="q / L")
    return fig


if __name__ == "__main__":
    results = main()
    print("lengths a beat:", {m: float(v.max()) for m, v in results["speed"].items()})
    figure(results).savefig("sperm_like.svg")
