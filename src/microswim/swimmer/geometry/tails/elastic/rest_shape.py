"""The shape that an elastic filament has where nothing pulls at it: a helix, or a drawn curve.

Its directors ``d_1, d_2, t`` follow ``d_1' = k_3 d_2 - k_2 t``, ``d_2' = k_1 t - k_3 d_1`` and
``t' = k_2 d_1 - k_1 d_2``. With ``d_1`` its normal, a helix of radius R and pitch ``2 pi p`` has
the curvature ``k_2 = R / (R^2 + p^2)`` and the torsion ``k_3 = p / (R^2 + p^2)``; a drawn curve is
taken without twist (Bishop 1975). Lengths are over that of the filament.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

#: Directors of a filament along s: ``d_1`` along q, ``d_2`` along r.
STRAIGHT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
DRAWN = 400  #: points between which a drawn curve is followed
IN_PLANE = 1e-6  #: rounding of a drawn curve's strains out of its plane


@dataclass(frozen=True, eq=False)
class RestShape:
    """Strains of a curve, and how it begins.

    Parameters
    ----------
    knots, values
        Arc lengths over L (k,), and strains times L there, (k, 3); a single one holds everywhere.
    base
        Directors at the root, rows ``d_1, d_2, t``, by the axes s, q, r, (3, 3).
    arm
        Place of the root from the joint, over L, (3,).
    """

    knots: np.ndarray
    values: np.ndarray
    base: np.ndarray
    arm: np.ndarray

    @property
    def is_planar(self) -> bool:
        """Whether the curve lies in the plane s-q, its second director along r everywhere."""
        bend, across = self.values[:, 1], self.values[:, [0, 2]]
        out = [*across.ravel(), *(self.base[1] - STRAIGHT[1]), self.arm[2] * np.abs(bend).max()]
        return bool(np.abs(out).max() <= IN_PLANE * max(np.abs(bend).max(), 1.0))

    @property
    def root_in_plane(self) -> tuple[float, tuple[float, float]]:
        """Angle of a planar curve's root from s, and its place along s and q."""
        (c, s, _), (x, y, _) = np.real(self.base[2]).tolist(), np.real(self.arm).tolist()
        return float(np.arctan2(s, c)), (x, y)

    def modes(self, tolerance: float = 2e-3, most: int = 40) -> int:
        """Return how many Legendre polynomials a strain it takes, to a part of its bends."""
        if len(self.knots) == 1:
            return 1
        x, w = np.polynomial.legendre.leggauss(2 * most)
        values = self.strains((x + 1.0) / 2.0)[:2]
        P = np.polynomial.legendre.legvander(x, most - 1)
        share = ((values * w) @ P) ** 2 * (2.0 * np.arange(most) + 1.0) / 4.0
        left = np.append(np.cumsum(share.sum(axis=0)[::-1])[::-1], 0.0)
        return int(np.argmax(left <= tolerance**2 * max(left[0], 1e-300)))

    def strains(self, s: np.ndarray) -> np.ndarray:
        """Return the two curvatures and the twist times L at arc lengths, (3, len(s))."""
        if len(self.knots) == 1:
            return np.repeat(self.values.T, len(s), axis=1)
        from scipy.interpolate import CubicSpline

        return CubicSpline(self.knots, self.values)(s).T


def helix_at_rest(radius: Any, pitch: Any) -> RestShape:
    """Return the shape of a helix about s, over L; right-handed with a positive pitch.

    It begins at ``q = radius``. Without pitch it is an arc of a circle that begins along s.
    """
    p = pitch / (2.0 * np.pi)
    turn = np.sqrt(radius**2 + p**2)
    zero = 0.0 * turn
    bend = radius / turn**2
    if not pitch:
        return RestShape(np.zeros(1), np.array([[zero, bend, zero]]), STRAIGHT + zero, np.zeros(3))
    sense = float(np.sign(np.real(p)))
    t = np.array([sense * p, zero, sense * radius]) / turn  # of (p phi, R cos phi, R sin phi)
    normal = np.array([zero, zero - 1.0, zero])
    base = np.stack([normal, np.cross(t, normal), t])
    values = np.array([[zero, bend, p / turn**2]])
    return RestShape(np.zeros(1), values, base, np.array([zero, radius, zero]))


def drawn_at_rest(points: Any) -> RestShape:
    """Return the shape of a smooth curve through points (n, 3) from the joint on, of any unit."""
    from scipy.interpolate import CubicSpline

    P = np.asarray(points, float)
    way = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(P, axis=0), axis=1)))
    curve = CubicSpline(way, P)
    fine = np.linspace(0.0, way[-1], DRAWN * 4 + 1)
    speed = np.linalg.norm(curve(fine, 1), axis=1)
    arc = np.append(0.0, np.cumsum((speed[1:] + speed[:-1]) / 2.0 * np.diff(fine)))
    length = arc[-1]
    t = CubicSpline(arc / length, curve(fine, 1) / speed[:, None])
    knots = np.linspace(0.0, 1.0, DRAWN + 1)
    tangents, bends = t(knots), t(knots, 1)
    directors = _carried(tangents)
    k1, k2 = -(directors[:, 1] * bends).sum(axis=1), (directors[:, 0] * bends).sum(axis=1)
    bend = k2 - 1j * k1
    twist = _mean_turning(bend)  # directors that turn with the curve see a bend that hardly changes
    bend = bend * np.exp(-1j * twist * knots)
    values = np.stack([-bend.imag, bend.real, twist + 0.0 * knots], axis=1)
    base = np.concatenate([directors[0], tangents[:1]])
    return RestShape(knots, values, base, P[0] / length)


def _mean_turning(bend: np.ndarray) -> float:
    """Rate at which a bend turns about the curve, where it bends most."""
    size = np.abs(bend)
    angle = np.unwrap(np.angle(bend**2)) / 2.0  # where it bends back nothing turns
    turning = np.gradient(angle, 1.0 / (len(bend) - 1))
    return float(np.average(turning, weights=size)) if size.any() else 0.0


def _carried(tangents: np.ndarray) -> np.ndarray:
    """Two directors across each tangent that do not turn about it, (n, 2, 3)."""
    t = tangents[0]  # in the plane s-q the first director stays there
    across = np.cross(STRAIGHT[1], t) if abs(t[2]) < 0.9 else STRAIGHT[2] - t[0] * t
    pair = [across / np.linalg.norm(across)]
    for old, t in zip(tangents, tangents[1:]):  # the least rotation that takes old to t
        d = pair[-1]
        d = d - (t @ d) / (1.0 + t @ old) * (t + old)
        d = d - (d @ t) * t
        pair.append(d / np.linalg.norm(d))
    first = np.array(pair)
    return np.stack([first, np.cross(tangents, first)], axis=1)
