"""The flow in files and pictures: VTK of surface and field, a plane cut through the fluid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.gait import doors
from microswim.models.bem.patches.surface import Surface, positions, values_at
from microswim.numerics.array import Array
from microswim.numerics.files import write

Flow = Callable[[Array], Array]
AXES = {"s": 0, "q": 1, "r": 2}


def quads_of(patches: int, side: int) -> NDArray[np.int64]:
    """Return quadrilaterals (n, 4) of grids of `side` x `side` points, one for each patch."""
    corner = np.arange(side * side).reshape(side, side)
    parts = (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:])
    one = np.stack(parts, axis=-1).reshape(-1, 4)
    return (one[None] + side * side * np.arange(patches)[:, None, None]).reshape(-1, 4)


def write_surface(
    surface: Surface, traction: Array, velocity: Array, path: str | Path, side: int = 6
) -> Path:
    """Write the surface with traction, velocity and tail (0 body, 1 tail) as a ``.vtp`` file."""
    data = {
        "traction": values_at(surface, traction, side).reshape(-1, 3),
        "velocity": values_at(surface, velocity, side).reshape(-1, 3),
        "tail": np.repeat(surface.on_tail.astype(np.uint8), side * side),
    }
    points, quads = positions(surface, side).reshape(-1, 3), quads_of(surface.patches, side)
    text = doors.go(doors.POLY_DATA, points, polys=quads, point_data=data)
    return _written(Path(path).with_suffix(".vtp"), text)


def write_mesh(surface: Surface, path: str | Path, side: int = 4) -> Path:
    """Write the surface alone, its patches numbered, as a ``.vtp`` file."""
    data = {"patch": np.repeat(np.arange(surface.patches, dtype=float), side * side)}
    points, quads = positions(surface, side).reshape(-1, 3), quads_of(surface.patches, side)
    text = doors.go(doors.POLY_DATA, points, polys=quads, point_data=data)
    return _written(Path(path).with_suffix(".vtp"), text)


def write_surfaces(surfaces: Sequence[Surface], path: str | Path, side: int = 6) -> Path:
    """Write several surfaces, each with its number and its tail marked, as a ``.vtp`` file."""
    points = np.concatenate([positions(s, side).reshape(-1, 3) for s in surfaces])
    quads = quads_of(sum(s.patches for s in surfaces), side)
    counts = [s.patches * side * side for s in surfaces]
    tails = np.concatenate([s.on_tail for s in surfaces]).astype(np.uint8)
    data = {
        "swimmer": np.repeat(np.arange(len(surfaces), dtype=float), counts),
        "tail": np.repeat(tails, side * side),
    }
    text = doors.go(doors.POLY_DATA, points, polys=quads, point_data=data)
    return _written(Path(path).with_suffix(".vtp"), text)


def write_field(
    velocity: Flow, path: str | Path, low: Array, high: Array, counts: tuple[int, int, int]
) -> Path:
    """Write the velocity of the fluid on a box of points as a ``.vti`` file."""
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, counts, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    u = velocity(grid).transpose(2, 1, 0, 3).reshape(-1, 3)
    step = np.array([float(a[1] - a[0]) if a.size > 1 else 1.0 for a in axes])
    text = doors.go(doors.IMAGE_DATA, np.asarray(low, float), step, counts, {"velocity": u})
    return _written(Path(path).with_suffix(".vti"), text)


def _written(path: Path, text: str) -> Path:
    write(path, text)
    return path


def picture(
    surface: Surface,
    velocity: Flow,
    units: str,
    plane: str = "sq",
    extent: tuple[float, float, float, float] | None = None,
    resolution: int = 60,
    ax: Any = None,
) -> Any:
    """Draw speed and streamlines in a plane through the joint, the swimmer's shadow over them.

    Parameters
    ----------
    surface, velocity, units
        The swimmer's surface, the flow about it at points (n, 3), ``"SI"`` or ``"dimensionless"``.
    plane : str
        Two of "s", "q", "r": the axes drawn across and up.
    extent : tuple
        (left, right, bottom, top) of the picture; by default around the swimmer.
    resolution : int
        Points across.
    ax : matplotlib Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    matplotlib Figure
    """
    i, j = (AXES[c] for c in plane)
    if extent is None:
        extent = _around(surface, i, j)
    x = np.linspace(extent[0], extent[1], resolution)
    rows = max(8, int(resolution * (extent[3] - extent[2]) / (extent[1] - extent[0])))
    y = np.linspace(extent[2], extent[3], rows)
    points = np.zeros((y.size, x.size, 3))
    points[..., i], points[..., j] = x[None, :], y[:, None]
    u = velocity(points.reshape(-1, 3)).reshape(points.shape)[..., [i, j, 3 - i - j]]
    shadow = positions(surface, 9)[..., [i, j]].reshape(-1, 2)[quads_of(surface.patches, 9)]
    return doors.go(doors.CUT, {plane[0]: x, plane[1]: y}, u, shadow, units, ax=ax)


def _around(surface: Surface, i: int, j: int) -> tuple[float, float, float, float]:
    """Sides of a picture that shows the whole swimmer with room about it."""
    hull = surface.controls.reshape(-1, 3)
    low, high = hull.min(axis=0), hull.max(axis=0)
    margin = 0.35 * (high - low).max()
    return low[i] - margin, high[i] + margin, low[j] - margin, high[j] + margin
