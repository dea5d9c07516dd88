"""Two swimmers.

Two helical swimmers side by side, by boundary elements with both surfaces in one system. a: the
fluid in the plane of their axes at one moment; it is drawn in at their sides and driven out along
their axes, as pushers do. b: what each changes of the other's velocity, over its speed; dots by
boundary elements, line by the point forces that each exerts alone. Far away it falls off with the
square of the distance (grey).
"""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

import microswim as ms


def main():
    robot = ms.Swimmer.preset("tabak/helix")
    pair = ms.Group((ms.Member(swimmer=robot), ms.Member(swimmer=robot, phase=np.pi)))
    blocks = pair.prepared("coarse")  # once; each pose below takes a fraction of it

    def beside(y):
        return pair.moved(positions=[(0, 0, 0), (0, y, 0)])

    far = beside(1e4).estimate(blocks=blocks).velocity
    speed = np.linalg.norm(far[0, :3])

    def change(found):
        return np.linalg.norm((found.velocity - far)[0, :3]) / speed

    distance, line = np.array([1.5, 2.0, 3.0, 5.0, 8.0]), np.geomspace(1.5, 30.0, 25)
    solved = np.array([change(beside(d).solve(blocks=blocks)) for d in distance])
    quick = np.array([change(beside(d).estimate(blocks=blocks)) for d in line])
    return {
        "beside": beside(2.0).solve(blocks=blocks),
        "distance": distance,
        "solved": solved,
        "line": line,
        "quick": quick,
        "change at a distance of 2": float(solved[1]),
        "slope far away": float(np.log(quick[-1] / quick[-5]) / np.log(line[-1] / line[-5])),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.4), layout="constrained")
    left, right = fig.subplots(1, 2)
    ms.plots.group(results["beside"], resolution=50, ax=left)
    left.set_title("a")
    right.loglog(results["line"], results["quick"], color="#0072B2")
    right.loglog(results["distance"], results["solved"], "o", color="#D55E00")
    right.loglog(results["line"], 0.7 * results["line"] ** -2.0, color="0.6", lw=1)
    right.set_xticks([2, 4, 8, 16, 30], ["2", "4", "8", "16", "30"], minor=False)
    right.xaxis.set_minor_locator(NullLocator())
    right.set(xlabel="distance (body diameters)", ylabel="change of velocity over speed", title="b")
    return fig


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if isinstance(v, float)), sep="\n")
    figure(results).savefig("two_swimmers.svg")
