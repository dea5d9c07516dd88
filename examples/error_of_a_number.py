"""A number and how wrong it may be.

Forward velocity against the radius of the body, as `microswim run` gives it without being asked.
Solid, in a band little wider than the line: the atlas, boundary elements solved beforehand;
nineteen of twenty such designs lie within the error that it states, here 0.9 to 1.4 %, and 3.3 %
for the smallest body. Dashed: local drag alone, Lighthill's law, the more off the larger the body.
Dots: boundary elements, solved for this picture.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

SOLVED = [0.2, 0.35, 0.5, 0.65]


def robot(radius):
    """The paper's tail on a sphere; no law and no coefficients are given, so the atlas answers."""
    tail = ms.Swimmer.preset("tabak/helix").tail
    return ms.Swimmer(body=ms.Sphere(radius=radius), tail=tail, fluid=ms.Fluid(viscosity=1.0))


def main():
    radius = np.linspace(0.15, 0.7, 23)
    robots = [robot(a) for a in radius]
    gaits = [r.gait("auto") for r in robots]
    speed = np.array([g.mean_velocity[0] for g in gaits])
    share = np.array([ms.expected_error(r, g)["us"] for r, g in zip(robots, gaits)])
    plain = np.array([r.gait("rft").mean_velocity[0] for r in robots])
    solved = np.array([robot(a).gait("bem").mean_velocity[0] for a in SOLVED])
    off = np.interp(SOLVED, radius, speed) / solved - 1.0
    return {
        "radius": radius,
        "speed": speed,
        "band": np.abs(speed) * share,
        "plain": plain,
        "solved": solved,
        "largest stated error (%)": float(100.0 * share.max()),
        "largest error at the dots (%)": float(100.0 * np.abs(off).max()),
        "local drag over the truth": float(np.interp(SOLVED[-1], radius, plain) / solved[-1]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.2), layout="constrained")
    axes = fig.subplots()
    a, speed, band = results["radius"], -results["speed"], results["band"]
    axes.fill_between(a, speed - band, speed + band, color="#0072B2", alpha=0.3, lw=0)
    axes.plot(a, speed, color="#0072B2", label="as it comes, with its error")
    axes.plot(a, -results["plain"], "--", color="#D55E00", label="local drag")
    axes.plot(SOLVED, -results["solved"], "o", color="#222222", label="boundary elements")
    axes.set(xlabel="radius of the body", ylabel="$-u_s$ (per period)", ylim=(0, None))
    axes.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if isinstance(v, float)), sep="\n")
    figure(results).savefig("error_of_a_number.svg")
