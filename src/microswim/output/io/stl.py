"""A swimmer as one closed surface that can be printed, in an STL file.

Body and tube are closed surfaces of their own, united by manifold3d (extra ``mesh``). STL has no
unit: lengths are millimetres for a swimmer in SI, as printers take them, else those of the spec.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.joint import piercing
from microswim.models.seen_body import seen_from
from microswim.models.swimmer_surface import smooth_centreline, tube_point
from microswim.numerics.array import Array
from microswim.numerics.files import write
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.reading import checked
from microswim.swimmer.geometry.solids.spheres import closed_grid, sphere_grid
from microswim.swimmer.geometry.solids.triangles import Triangles
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.swimmer import Swimmer

MILLIMETRE = 1e-3


def printable(swimmer: Swimmer, phase: float = 0.0, *, fineness: float = 1.0) -> Triangles:
    """Return the closed surface of a swimmer at a phase, in the frame ``sqr``.

    Parameters
    ----------
    swimmer
        Any swimmer whose tail, if it has one, grows out of its body.
    phase
        Phase of the tail (rad).
    fineness
        Factor on the number of faces along each direction.

    Raises
    ------
    SpecError
        If the tail misses the body.
    MicroswimError
        If manifold3d is not installed.
    """
    try:
        import manifold3d
    except ImportError:
        raise MicroswimError(
            'an STL file needs manifold3d; install it with pip install "microswim[mesh]"'
        ) from None
    swimmer = swimmer.settled
    body, tail = swimmer.body, swimmer.tail
    parts = [] if tail.is_absent else [_tube(body, t, phase, fineness) for t in tail.each]
    if not body.is_absent:
        parts.append(_body(body, fineness))
    size = max(float(np.ptp(p.points, axis=0).max()) for p in parts)
    whole: Any = None
    for part in parts:
        points = np.asarray(part.points / size, np.float32)
        solid = manifold3d.Manifold(manifold3d.Mesh(points, part.faces.astype(np.uint32)))
        whole = solid if whole is None else whole + solid
    mesh = whole.to_mesh()
    at = np.asarray(mesh.vert_properties[:, :3], float) * size
    return checked(at, np.asarray(mesh.tri_verts, np.int64)).surface


def write_stl(
    path: str | Path, swimmer: Swimmer, phase: float = 0.0, *, fineness: float = 1.0
) -> Path:
    """Write the closed surface of a swimmer as a binary STL file, in millimetres if it is in SI.

    Parameters are those of `printable`.

    Examples
    --------
    >>> import tempfile, microswim as ms
    >>> from microswim.output.io.stl import write_stl
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = write_stl(f"{folder}/helix.stl", ms.Swimmer.preset("tabak/helix"))
    ...     path.stat().st_size > 100_000
    True
    """
    surface = printable(swimmer, phase, fineness=fineness)
    scale = 1.0 / MILLIMETRE if swimmer.units == "SI" else 1.0
    rows = np.zeros(len(surface.faces), [("v", "<f4", (4, 3)), ("attributes", "<u2")])
    normal = surface.area_vectors
    rows["v"][:, 0] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    rows["v"][:, 1:] = surface.points[surface.faces] * scale
    title = f"microswim, one unit is {unit_of(swimmer)}".encode().ljust(80)
    write(path, title + np.uint32(len(rows)).tobytes() + rows.tobytes())
    return Path(path)


def unit_of(swimmer: Swimmer) -> str:
    """Return the length of one unit of its STL file, as ``--scale`` takes it back."""
    return "1 mm" if swimmer.units == "SI" else "1"


def _body(body: Body, fineness: float) -> Triangles:
    if body.triangles is not None:
        return body.triangles
    finer = fineness if body.is_ellipsoid else 2.0 * fineness  # edges are on no line of the grid
    points, quads = sphere_grid(int(32 * finer) + 1, int(40 * finer))
    return _closed(body.surface_point(points), quads)


def _tube(body: Body, tail: Tail, phase: float, fineness: float) -> Triangles:
    """The tube with a round tip; its near end, closed flat, lies within the body."""
    place, body, phase = tail.placement, seen_from(body, tail), float(tail.own_phase(phase))
    tail = tail.own
    waves = max(1.0, float(tail.number_of_waves))
    rings, around = int(28 * fineness * min(waves, 40.0)) + 1, max(8, int(14 * fineness))
    length, radius = float(tail.apparent_length), float(tail.radius)
    start = 0.0 if body.is_absent else piercing(body, tail, phase) - 2.0 * radius
    s = np.linspace(start, length, rings)
    turn = 2.0 * np.pi * np.arange(around) / around
    grid = tube_point(tail, s[:, None], turn, phase)
    ends = smooth_centreline(tail, s[[0, -1]], phase)
    bend = np.linspace(0.0, 0.5 * np.pi, 5)[1:, None, None]
    axis = ends.tangent if tail.sections != "sheared" else np.tile([1.0, 0.0, 0.0], (2, 1))
    cap = min(tail.half_axes) * tail.narrowing(s[[0, -1]])
    tip = ends.P[1] + np.cos(bend) * (grid[-1] - ends.P[1]) + cap[1] * np.sin(bend) * axis[1]
    head = [np.broadcast_to(ends.P[0], (1, around, 3))]
    if body.is_absent:
        back = ends.P[0] + np.cos(bend) * (grid[0] - ends.P[0]) - cap[0] * np.sin(bend) * axis[0]
        head = [back[::-1]]
    rows = place.placed(np.concatenate([*head, grid, tip]))
    return _closed(rows.reshape(-1, 3), closed_grid(len(rows), around))


def _closed(points: Array, quads: np.ndarray) -> Triangles:
    """Triangles of quadrilaterals, points that coincide made one."""
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.int64)
    return checked(points, faces).surface
