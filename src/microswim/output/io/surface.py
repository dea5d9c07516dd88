"""The swimmer's surface as a mesh of quadrilaterals, for pictures and files.

Body, tube and its round tip at one phase, in the frame ``sqr`` moved to the body's centre. A
drawing, not a computational mesh: the reference solvers build their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.swimmer.geometry.solids.spheres import closed_grid
from microswim.swimmer.swimmer import Swimmer

BODY, TAIL = 0, 1


@dataclass(frozen=True, eq=False)
class Surface:
    """Quadrilaterals of a swimmer.

    Parameters
    ----------
    points
        Corners, shape (n, 3), outward side counter-clockwise.
    quads
        Indices of the four corners of each face, shape (m, 4).
    part
        Per face: 0 the body, 1 the tail.
    """

    points: np.ndarray
    quads: np.ndarray
    part: np.ndarray

    def moved(self, position: Any, rotation: Any) -> Surface:
        """Return the surface at a pose: rotation matrix (3, 3) body to lab, then position (3,)."""
        return Surface(self.points @ np.transpose(rotation) + position, self.quads, self.part)


def surface(swimmer: Swimmer, phase: float = 0.0, *, fineness: float = 1.0) -> Surface:
    """Return the surface of a swimmer at a phase, about its body's centre.

    Parameters
    ----------
    swimmer
        Any swimmer.
    phase
        Phase of the tail (rad).
    fineness
        Factor on the number of faces along each direction.

    Returns
    -------
    Surface
        In the axes of the body frame, origin at the body's centre.

    Examples
    --------
    >>> import microswim as ms
    >>> from microswim.output.io.surface import surface
    >>> bool(surface(ms.Swimmer.preset("tabak/helix")).points[:, 0].max() > 2.5)
    True
    """
    swimmer = swimmer.settled
    body, tail = swimmer.body, swimmer.tail
    points, quads = body.drawing(fineness)
    faces, count = len(quads), len(points)
    parts, cells = [points], [quads]
    for t in tail.each:
        own = _tube(t.own, float(t.own_phase(phase)), fineness, body.is_absent)
        grid = t.placement.placed(own) - body.centre
        parts.append(grid.reshape(-1, 3))
        cells.append(closed_grid(*grid.shape[:2]) + count)
        count += len(parts[-1])
    whole = np.concatenate(cells)
    part = np.repeat([BODY, TAIL], [faces, len(whole) - faces])
    return Surface(np.concatenate(parts), whole, part)


def bent(
    swimmer: Swimmer, filament: np.ndarray, position: Any, rotation: Any, fineness: float = 1.0
) -> Surface:
    """Return the surface of a swimmer whose tail lies along points (n, 3) of the lab.

    Parameters
    ----------
    swimmer
        Whose body it is, and whose filament is as thick as its tail.
    filament
        From root to tip, lab frame.
    position, rotation
        Of the body: its centre (3,), and the rotation matrix (3, 3) body to lab.
    fineness
        Factor on the number of faces along each direction.
    """
    from scipy.interpolate import CubicSpline  # nobody waits for it without a bent tail

    points, quads = swimmer.body.drawing(fineness)
    share = np.linspace(0.0, 1.0, len(filament))
    curve = CubicSpline(share, filament)
    at = np.linspace(0.0, 1.0, int(64 * fineness) + 1)
    P, slope = curve(at), curve(at, 1)
    tangent = slope / np.linalg.norm(slope, axis=1, keepdims=True)
    radius = float(swimmer.tail.radius)
    around = max(6, int(12 * fineness))
    closed = swimmer.body.is_absent
    grid = _round(P, tangent, transported(P, tangent), (radius, radius), around, closed)
    cells = closed_grid(*grid.shape[:2]) + len(points)
    body = Surface(points, quads, np.empty(0)).moved(position, rotation).points
    part = np.repeat([BODY, TAIL], [len(quads), len(cells)])
    return Surface(
        np.concatenate([body, grid.reshape(-1, 3)]), np.concatenate([quads, cells]), part
    )


def _tube(tail: Any, phase: float, fineness: float, closed: bool) -> np.ndarray:
    """Grid of a tube about the centreline, from the joint to its round tip."""
    waves = max(1.0, float(tail.number_of_waves))
    rings, around = int(32 * fineness * min(waves, 40.0)) + 1, max(6, int(12 * fineness))
    P, P_s, _ = tail.centreline(np.linspace(0.0, tail.apparent_length, rings), phase)
    tangent = P_s / np.linalg.norm(P_s, axis=1, keepdims=True)
    if tail.sections == "sheared":
        normal, axis = np.tile([0.0, 1.0, 0.0], (rings, 1)), np.tile([1.0, 0.0, 0.0], (rings, 1))
    else:
        normal, axis = transported(P, tangent), tangent
    if tail.section is not None:
        normal = tail.radial(np.linspace(0.0, tail.apparent_length, rings), phase)
        normal = normal - np.sum(normal * axis, axis=1, keepdims=True) * axis
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    thick = tail.narrowing(np.linspace(0.0, tail.apparent_length, rings))
    half = tuple(h * thick for h in tail.half_axes)
    return _round(P, axis, normal, half, around, closed)


def _round(
    P: np.ndarray, axis: np.ndarray, normal: np.ndarray, half: Any, around: int, closed: bool
) -> np.ndarray:
    """Grid of rings about a curve, with a round tip and, if closed, a round root.

    half : two half axes, numbers or one for each ring.
    """
    binormal = np.cross(axis, normal)
    a, b = (np.broadcast_to(h, len(P))[:, None, None] for h in half)
    angle = np.linspace(0.0, 2.0 * np.pi, around, endpoint=False)
    ring = a * np.cos(angle)[:, None] * normal[:, None]
    ring = ring + b * np.sin(angle)[:, None] * binormal[:, None]
    tip = np.linspace(0.0, np.pi / 2.0, 6)[1:, None, None]
    bend = np.cos(tip) * ring[-1] + min(a[-1], b[-1]) * np.sin(tip) * axis[-1]
    pieces = [P[:, None] + ring, P[-1] + bend]
    if closed:
        flat = np.cos(tip) * ring[0] - min(a[0], b[0]) * np.sin(tip) * axis[0]
        pieces.insert(0, (P[0] + flat)[::-1])
    return np.concatenate(pieces)


def transported(P: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Return normals that do not twist along a curve: double reflection (Wang et al. 2008)."""
    normal = np.empty_like(P)
    across = np.eye(3)[np.argmin(np.abs(tangent[0]))]
    normal[0] = across - (across @ tangent[0]) * tangent[0]
    normal[0] /= np.linalg.norm(normal[0])
    for i in range(len(P) - 1):
        v = P[i + 1] - P[i]
        n = normal[i] - 2.0 / (v @ v) * (v @ normal[i]) * v
        t = tangent[i] - 2.0 / (v @ v) * (v @ tangent[i]) * v
        w = tangent[i + 1] - t
        normal[i + 1] = n - 2.0 / (w @ w) * (w @ n) * w if w @ w > 0 else n
    return normal
