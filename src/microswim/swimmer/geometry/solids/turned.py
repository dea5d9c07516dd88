"""Bodies of revolution about s, given by their profile (s, rho) from the joint to the nose.

A direction at the angle theta from ``e_s`` is mapped to the point of the profile at the share
``theta / pi`` of its length, so that the map is smooth at both poles.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.errors import SpecError, measured
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import Facet, Opening, graded
from microswim.swimmer.geometry.solids.solved import SolvedBody

#: Largest share of the smooth part at the rear that the root of a tail may cover.
ROOM = 0.92


@dataclass(frozen=True, eq=False)
class Piece:
    """A smooth piece of a profile.

    Parameters
    ----------
    length
        Length of the piece.
    point
        (s, rho), shape (..., 2), at the length from its beginning.
    """

    length: float
    point: Callable[[Array], Array]


def line(start: tuple[float, float], end: tuple[float, float]) -> Piece:
    """Return the straight piece from one (s, rho) to another."""
    a, b = np.array(start), np.array(end)
    length = float(np.linalg.norm(b - a))
    return Piece(length, lambda x: a + np.asarray(x)[..., None] / length * (b - a))


def quarter(centre: tuple[float, float], radius: float, start: float) -> Piece:
    """Return the quarter of a circle about (s, rho), from the angle `start` from the axis s on."""

    def point(x: Array) -> Array:
        angle = start + np.asarray(x) / radius
        return np.array(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    return Piece(0.5 * np.pi * radius, point)


@dataclass(frozen=True, eq=False)
class Profile:
    """Profile of a body of revolution: pieces in order, those of no length left out."""

    pieces: tuple[Piece, ...]

    @cached_property
    def edges(self) -> Array:
        """Lengths at which pieces begin and end."""
        return np.concatenate([[0.0], np.cumsum([p.length for p in self.pieces])])

    @property
    def length(self) -> float:
        return float(self.edges[-1])

    def point(self, x: Array) -> Array:
        """Return (s, rho), shape (..., 2), at lengths from the joint."""
        x = np.asarray(x, float)
        which = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.pieces) - 1)
        result = np.empty((*x.shape, 2))
        for n, piece in enumerate(self.pieces):
            here = which == n
            result[here] = piece.point(x[here] - self.edges[n])
        return result

    @cached_property
    def dense(self) -> tuple[Array, Array, Array, Array]:
        """Lengths, points (n, 2), unit tangents (n, 2), curvature (n,) on a fine grid."""
        x = np.concatenate([
            low + (high - low) * (np.arange(1500) + 0.5) / 1500
            for low, high in zip(self.edges[:-1], self.edges[1:])
        ])  # fmt: skip
        step = 1e-5 * self.length * np.array([-1.0, 0.0, 1.0])
        which = np.searchsorted(self.edges, x, side="right") - 1
        ends = self.edges[which, None], self.edges[which + 1, None]
        middle = np.clip(x[:, None], ends[0] - step[0], ends[1] + step[0])
        a, b, c = np.moveaxis(self._inside(which, middle + step), 1, 0)
        tangent = (c - a) / np.linalg.norm(c - a, axis=-1, keepdims=True)
        bend = np.linalg.norm(a - 2 * b + c, axis=-1) / step[2] ** 2
        return x, self.point(x), tangent, np.where(bend * self.length > 1e-3, bend, 0.0)

    def _inside(self, which: NDArray[np.int64], x: Array) -> Array:
        """Points at lengths (n, m), each row on its own piece."""
        result = np.empty((*x.shape, 2))
        for n, piece in enumerate(self.pieces):
            here = which == n
            result[here] = piece.point(np.clip(x[here] - self.edges[n], 0.0, piece.length))
        return result

    def nearest(self, place: Array) -> tuple[Array, Array]:
        """Return the length of the profile's point nearest to places (..., 2), and distance
        outside of it.
        """
        from scipy.spatial import KDTree

        x, P, tangent, _ = self.dense
        _, i = KDTree(P).query(place)
        T = tangent[i]
        at = x[i]
        for _ in range(5):
            at = np.clip(at + np.sum((place - self.point(at)) * T, axis=-1), 0.0, self.length)
        normal = np.stack([T[..., 1], -T[..., 0]], axis=-1)  # to the right, outwards
        return at, np.sum((place - self.point(at)) * normal, axis=-1)


def made_of(*pieces: Piece) -> Profile:
    """Return the profile of the pieces that have a length."""
    whole = sum(p.length for p in pieces)
    return Profile(tuple(p for p in pieces if p.length > 1e-9 * whole))


class TurnedBody(SolvedBody):
    """A body of revolution about s."""

    @abstractmethod
    def outline(self) -> Profile:
        """Return the profile (s, rho) from the joint to the nose."""

    @cached_property
    def _profile(self) -> Profile:
        return self.outline()

    def __getstate__(self) -> dict[str, Any]:
        """Return what another process is given: not the profile, which is made of functions."""
        return {name: value for name, value in self.__dict__.items() if name != "_profile"}

    def level(self, X: Array) -> Array:
        X = np.asarray(X, float)
        place = np.stack([X[..., 0], np.hypot(X[..., 1], X[..., 2])], axis=-1)
        return self._profile.nearest(place)[1]

    def surface_point(self, direction: Array) -> Array:
        across = np.hypot(direction[..., 1], direction[..., 2])
        angle = np.arctan2(across, direction[..., 0])
        s, rho = np.moveaxis(self._profile.point(angle / np.pi * self._profile.length), -1, 0)
        spread = np.where(across > 0, rho / np.where(across > 0, across, 1.0), 0.0)
        return np.stack([s, spread * direction[..., 1], spread * direction[..., 2]], axis=-1)

    def direction(self, X: Array) -> Array:
        rho = float(np.hypot(X[1], X[2]))
        x, _ = self._profile.nearest(np.array([X[0], rho]))
        angle = np.pi * float(x) / self._profile.length if rho > 0 else 0.0
        side = np.array([X[1], X[2]]) / rho if rho > 0 else np.zeros(2)
        return np.array([np.cos(angle), *np.sin(angle) * side])

    @property
    def stretch(self) -> float:
        x, P, _, _ = self._profile.dense
        along = self._profile.length / np.pi
        return float(max(along, (P[:, 1] / np.sin(np.pi * x / self._profile.length)).max()))

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        """Return the end of the first smooth piece of the profile: of the flat end, of the round
        cap.
        """
        edges = self._rings(1)
        per = np.pi / self._profile.length
        own = float(np.arccos(np.clip(pole[0], -1.0, 1.0)))
        first_edge = self._profile.edges[1]
        if len(self._profile.pieces) == 1:  # smooth all along: two holes away, or half way
            first_edge = min(max(2.5 * (own + reach) / per, edges[1]), 0.5 * self._profile.length)
        if own + reach > ROOM * first_edge * per:
            raise self._no_room(own, reach, first_edge * per)
        beyond = edges[edges > first_edge * (1 + 1e-9)]
        last = float(beyond[0] - first_edge) * per if len(self._profile.pieces) > 1 else np.inf
        return Opening(np.eye(3), first_edge * per, last)

    def _no_room(self, own: float, reach: float, angle: float) -> SpecError:
        """What to say of a root that reaches the edge of the rear end."""
        at, room = (
            measured(self.surface_point(np.array([np.cos(a), np.sin(a), 0.0]))[1])
            for a in (own, max(ROOM * angle - reach, 0.0))
        )
        return SpecError(
            f"tail: its root, {at} from the axis, reaches over the edge of the body's rear end; "
            f"bring it within {room} of the axis (a ramp or a smaller amplitude), or thin the "
            "filament"
        )

    def _rings(self, splits: int, start: float = 0.0) -> Array:
        """Lengths at which rings of patches end, from `start` on."""
        x, P, _, bend = self._profile.dense
        radius = np.minimum(P[:, 1].max(), 1.0 / np.maximum(bend, 1e-12))
        inner = self._profile.edges
        breaks = np.concatenate([[start], inner[inner > start * (1 + 1e-9) + 1e-12 * inner[-1]]])
        kept = x >= start
        at = np.concatenate([[start], x[kept], [inner[-1]]])
        wanted = 0.5 * np.pi / splits * radius[kept]
        return graded(breaks, np.concatenate([wanted[:1], wanted, wanted[-1:]]), at)

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        """Return rings of patches, and a disc of five at each pole."""
        whole = self._profile.length
        start = 0.0 if opening is None else opening.angle / np.pi * whole
        rings = self._rings(splits, start)
        parts = [] if opening is not None else _disc(self._on_plane(1.0), rings[1])
        parts += _disc(self._on_plane(-1.0), whole - rings[-2])
        if opening is None:
            rings = rings[1:]
        for low, high in zip(rings[:-2], rings[1:-1]):
            parts.append(self._ring(low, high, splits))
        return parts

    def _ring(self, low: float, high: float, splits: int) -> Facet:
        rho = self._profile.point(np.linspace(low, high, 9))[:, 1].max()
        count = int(np.clip(np.ceil(np.pi * rho / (3.2 * (high - low))), 1, max(2 * splits, 2)))

        def chart(x: Array, turn: Array) -> Array:
            s, rho = np.moveaxis(self._profile.point(x), -1, 0)
            return np.stack([s, rho * np.cos(turn), rho * np.sin(turn)], axis=-1)

        return Facet(chart, np.array([low, high]), np.linspace(0.0, 2 * np.pi, 4 * count + 1))

    def _on_plane(self, end: float) -> Callable[[Array, Array], Array]:
        """X at plane coordinates about the rear pole (end = 1) or the nose (-1), outwards."""
        whole = self._profile.length

        def at(first: Array, second: Array) -> Array:
            x = np.hypot(first, second)
            s, rho = np.moveaxis(self._profile.point(x if end > 0 else whole - x), -1, 0)
            spread = np.where(x > 0, rho / np.where(x > 0, x, 1.0), 0.0)
            sides = (first, second) if end > 0 else (second, first)
            return np.stack([s, *(spread * side for side in sides)], axis=-1)

        return at


def _disc(at: Callable[[Array, Array], Array], radius: float) -> list[Facet]:
    """A square and four patches around it, of a disc with a chart of its plane."""
    half, whole = 0.5 * radius, np.array([-1.0, 1.0])
    parts = [Facet(lambda a, b: at(half * a, half * b), whole, whole)]
    for k in range(4):
        c, s = np.cos(0.5 * np.pi * k), np.sin(0.5 * np.pi * k)

        def side(t: Array, turn: Array, c: float = c, s: float = s) -> Array:
            a = (1 - t) * half + t * radius * np.cos(turn)
            b = (1 - t) * half * np.tan(turn) + t * radius * np.sin(turn)
            return at(c * a - s * b, s * a + c * b)

        parts.append(Facet(side, np.array([0.0, 1.0]), 0.25 * np.pi * whole))
    return parts
