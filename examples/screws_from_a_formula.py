"""Screws from a formula.

A robot that is one surface, r(theta, s) with one, two or three threads, written as a surface file
and read as any file from CAD is. Left: the one with two starts. Right: how far each goes ahead in
a turn about its axis, as a magnetic field may turn it; threads of the other hand go the other way,
by as much. In per cent of the lead, which a screw in wood would go: in a fluid it slips.
"""

import tempfile

import numpy as np
import trimesh
from matplotlib.figure import Figure

import microswim as ms

LENGTH, RADIUS, DEPTH, LEAD = 4.0, 0.5, 0.3, 2.0
ALONG, AROUND = 41, 28


def screw(starts):
    """Corners and triangles of r = R (1 + d cos n(theta - 2 pi s/lead)), its ends round."""
    u = np.linspace(0.0, np.pi, ALONG)[:, None]
    theta = 2.0 * np.pi * np.arange(AROUND) / AROUND
    s = -0.5 * LENGTH * np.cos(u)
    wave = np.cos(starts * (theta - 2.0 * np.pi * s / LEAD))
    r = RADIUS * np.sin(u) ** 0.5 * (1.0 + DEPTH * np.sin(u) * wave)
    points = np.stack(np.broadcast_arrays(s, r * np.cos(theta), r * np.sin(theta)), axis=-1)
    i, j = np.meshgrid(np.arange(ALONG - 1), np.arange(AROUND), indexing="ij")
    a, b = i * AROUND + j, i * AROUND + (j + 1) % AROUND
    quads = np.stack([a, b, b + AROUND, a + AROUND], axis=-1).reshape(-1, 4)
    return points.reshape(-1, 3), np.concatenate([quads[:, [0, 2, 1]], quads[:, [0, 3, 2]]])


def advance(points, faces):
    """Way ahead per turn about s, and chirality, of the surface in a file."""
    with tempfile.TemporaryDirectory() as folder:
        name = f"{folder}/screw.stl"
        trimesh.Trimesh(points, faces).export(name)
        found = ms.mobility(name, scale=1.0, level="coarse")
    M = found.mobility
    return 2.0 * np.pi * M[0, 3] / M[3, 3], found.chirality


def main():
    told = [advance(*screw(n)) for n in (1, 2, 3)]
    points, faces = screw(2)
    mirror = advance(points * [1.0, 1.0, -1.0], faces[:, ::-1])
    ahead, chirality = np.transpose(told)
    return {"starts": np.array([1, 2, 3]), "advance": ahead, "chirality": chirality,
            "advance of the mirror image": mirror[0], "surface": screw(2)}  # fmt: skip


def figure(results):
    fig = Figure(figsize=(7.2, 3.0), layout="constrained")
    drawing, axes = fig.add_subplot(1, 2, 1, projection="3d"), fig.add_subplot(1, 2, 2)
    points, faces = results["surface"]
    drawing.plot_trisurf(*points.T, triangles=faces, color="#9BBCD1", edgecolor="none")
    drawing.set_box_aspect((LENGTH, 1.3, 1.3), zoom=1.7)
    drawing.set_axis_off()
    axes.bar(results["starts"], 100.0 * results["advance"] / LEAD, width=0.5, color="#0072B2")
    axes.plot(
        2, 100.0 * results["advance of the mirror image"] / LEAD, "_", color="#D55E00", ms=40, mew=3
    )
    axes.axhline(0.0, color="#222222", lw=0.8)
    axes.set(
        xlabel="starts of the thread", ylabel="advance per turn (% of the lead)", xticks=[1, 2, 3]
    )
    return fig


if __name__ == "__main__":
    results = main()
    print("advance per turn:", results["advance"])
    figure(results).savefig("screws_from_a_formula.svg")
