"""Drawing a swimmer to scale: a camera, shaded faces sorted by depth, a scale bar, the axes.

Parallel projection, so that lengths can be compared.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from microswim.gait.readable import prefixed
from microswim.gait.units import is_dimensionless
from microswim.output.io.surface import BODY, Surface
from microswim.output.plots.style import BLACK, GREY
from microswim.output.plots.style import BODY as BODY_COLOUR
from microswim.output.plots.style import TAIL as TAIL_COLOUR

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = {True: BODY_COLOUR, False: TAIL_COLOUR}
LIGHT = np.array([-0.35, 0.75, 0.65]) / np.linalg.norm([-0.35, 0.75, 0.65])


@dataclass(frozen=True, eq=False)
class Camera:
    """Parallel projection; rows of `axes`: to the right, up, and towards the viewer."""

    axes: np.ndarray

    @classmethod
    def behind(cls, basis: np.ndarray, azimuth: float, elevation: float) -> Camera:
        """Return camera beside a swimmer that swims along ``basis[0]``, with ``basis[2]`` up."""
        a, e = np.radians([azimuth, elevation])
        right = np.cos(a) * basis[0] + np.sin(a) * basis[1]
        level = np.cross(right, basis[2])
        towards = np.cos(e) * level + np.sin(e) * basis[2]
        return cls(np.array([right, np.cross(towards, right), towards]))

    def project(self, points: np.ndarray) -> np.ndarray:
        """Return points (..., 3) to right, up and depth towards the viewer."""
        return points @ self.axes.T


def draw_surface(axes: Axes, mesh: Surface, camera: Camera, strength: float = 1.0) -> None:
    """Draw a surface, shaded; a `strength` below one fades it towards white."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    corners = camera.project(mesh.points)[mesh.quads]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = normal / np.where(size > 0, size, 1.0)
    seen = normal[:, 2] > 0
    order = np.flatnonzero(seen)[np.argsort(corners[seen, :, 2].mean(axis=1))]
    body, tail = (np.array(to_rgb(COLOURS[k])) for k in (True, False))
    base = np.where((mesh.part == BODY)[:, None], body, tail)
    glance = np.clip(normal @ LIGHT, 0.0, 1.0)[:, None]
    half = (LIGHT + [0.0, 0.0, 1.0]) / np.linalg.norm(LIGHT + [0.0, 0.0, 1.0])
    shine = 0.35 * np.clip(normal @ half, 0.0, 1.0)[:, None] ** 40
    colour = np.clip(base * (0.52 + 0.6 * glance) + shine, 0.0, 1.0)
    colour = 1.0 - strength * (1.0 - colour)
    axes.add_collection(
        PolyCollection(
            list(corners[order, :, :2]),
            facecolors=colour[order],
            edgecolors=colour[order],
            linewidths=0.25,
            zorder=2 if strength < 1 else 4,
            rasterized=True,
        )
    )
    axes.autoscale_view()


def scale_bar(axes: Axes, length: float, unit: str) -> None:
    """Draw a bar of a round length of about a third of `length`, with its size, below the scene."""
    step = 10.0 ** np.floor(np.log10(length / 3.0))
    size = step * max(m for m in (1, 2, 5) if m * step <= length / 3.0 * 1.0001)
    factor, name = prefixed(size, unit)
    (left, _), (low, high) = axes.get_xlim(), axes.get_ylim()
    y = low - 0.04 * (high - low)
    axes.plot([left, left + size], [y, y], color=BLACK, lw=2.0, solid_capstyle="butt")
    axes.annotate(
        f"length {size:.3g}" if is_dimensionless(unit) else f"{size * factor:.3g} {name}",
        (left + size / 2.0, y),
        (0, -4),
        textcoords="offset points",
        ha="center",
        va="top",
        fontsize=7.5,
    )


def triad(axes: Axes, camera: Camera) -> None:
    """Draw the lab's axes in the upper left corner."""
    inset = axes.inset_axes((0.0, 0.72, 0.1, 0.26))
    for end, name in zip(camera.project(np.eye(3))[:, :2], "xyz"):
        arrow = {"arrowstyle": "-|>", "lw": 0.8, "color": GREY, "shrinkA": 0, "shrinkB": 0}
        inset.annotate("", end, (0, 0), arrowprops={**arrow, "mutation_scale": 6})
        inset.text(
            1.3 * end[0], 1.3 * end[1], name, ha="center", va="center", fontsize=7, color=GREY
        )
    inset.set(xlim=(-1.5, 1.5), ylim=(-1.5, 1.5), aspect="equal")
    inset.set_axis_off()
