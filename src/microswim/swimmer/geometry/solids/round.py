"""Bodies of revolution of today's robots and cells: capsule, cylinder, any smooth profile."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, ClassVar, Self

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.facets import check_fillet
from microswim.swimmer.geometry.solids.turned import (
    Piece,
    Profile,
    TurnedBody,
    line,
    made_of,
    quarter,
)

#: Edge of a cylinder whose fillet is not given, in radii.
FILLET = 0.2


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Capsule(TurnedBody):
    """Cylinder with hemispherical ends, along s: a rod-shaped cell.

    Parameters
    ----------
    length
        From end to end, the round ends included; at least twice the radius.
    radius
        Radius (length), positive.

    Raises
    ------
    SpecError
        If a field is not a positive number, or the ends do not fit into the length.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Capsule(length=3.0, radius=0.5).semi_axes3
    (1.5, 0.5, 0.5)
    """

    length: float
    radius: float
    shape: ClassVar[str] = "capsule"

    def __post_init__(self) -> None:
        checks.positive("body.length", self.length, "length")
        checks.positive("body.radius", self.radius, "length")
        if self.length < 2.0 * self.radius * (1.0 - 1e-12):
            raise SpecError(
                "body.length",
                self.length,
                f"at least twice the radius, {measured(2.0 * self.radius)}: it counts from end to "
                "end",
                "lengthen the capsule, thin it, or take a spheroid",
            )

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        return (0.5 * self.length, self.radius, self.radius)

    @property
    def rim(self) -> tuple[Any, Any, Any]:
        return (0.5 * self.length - self.radius, 0.0 * self.radius, self.radius)

    def scaled(self, factor: float) -> Self:
        return replace(self, length=self.length * factor, radius=self.radius * factor)

    def outline(self) -> Profile:
        a, end = float(np.real(self.radius)), float(np.real(self.length))
        return made_of(
            quarter((-a, 0.0), a, 0.0),
            line((-a, a), (a - end, a)),
            quarter((a - end, 0.0), a, 0.5 * np.pi),
        )


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Cylinder(TurnedBody):
    """Circular cylinder along s with rounded edges: a magnet, a motor's case.

    Parameters
    ----------
    length
        From face to face.
    radius
        Radius (length), positive.
    edge
        Radius of the fillet at both edges (length), positive; a fifth of the radius by default,
        half the length at most.

    Raises
    ------
    SpecError
        If a field is not a positive number, or the edge is larger than the radius or half the
        length.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Cylinder(length=2.0, radius=0.5).fillet
    0.1
    """

    length: float
    radius: float
    edge: float | None = None
    shape: ClassVar[str] = "cylinder"

    def __post_init__(self) -> None:
        checks.positive("body.length", self.length, "length")
        checks.positive("body.radius", self.radius, "length")
        if self.edge is not None:
            check_fillet(self.edge, min(self.radius, 0.5 * self.length))

    @property
    def fillet(self) -> float:
        """Radius of the rounded edges."""
        if self.edge is not None:
            return self.edge
        return min(FILLET * self.radius, 0.25 * self.length)

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        return (0.5 * self.length, self.radius, self.radius)

    @property
    def rim(self) -> tuple[Any, Any, Any]:
        return (0.5 * self.length - self.fillet, self.radius - self.fillet, self.fillet)

    def scaled(self, factor: float) -> Self:
        edge = None if self.edge is None else self.edge * factor
        return replace(self, length=self.length * factor, radius=self.radius * factor, edge=edge)

    def outline(self) -> Profile:
        a, end, e = (
            float(np.real(self.radius)),
            float(np.real(self.length)),
            float(np.real(self.fillet)),
        )
        return made_of(
            line((0.0, 0.0), (0.0, a - e)),
            quarter((-e, a - e), e, 0.0),
            line((-e, a), (e - end, a)),
            quarter((e - end, a - e), e, 0.5 * np.pi),
            line((-end, a - e), (-end, 0.0)),
        )


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Revolution(TurnedBody):
    """Body of revolution about s with a smooth profile through given points.

    Parameters
    ----------
    profile
        ``[[s, rho], ...]`` (lengths) from the joint's end to the nose, four points at least;
        the first and the last on the axis (rho = 0), between them rho positive. Where s begins,
        and whether it counts up or down, does not matter: the first point is the joint. A cubic
        spline, round at both ends, runs through the points.

    Raises
    ------
    SpecError
        If there are fewer than four points, an end is not on the axis, or the profile crosses the
        axis or itself.

    Examples
    --------
    >>> import microswim as ms
    >>> pear = ms.Revolution(profile=[[0, 0], [0.2, 0.3], [0.8, 0.5], [1.2, 0.3], [1.3, 0]])
    >>> pear.semi_axes3[0]
    0.65
    """

    profile: tuple[tuple[float, float], ...]
    shape: ClassVar[str] = "revolution"
    is_balanced: ClassVar[bool] = False

    def __post_init__(self) -> None:
        rows = _rows(self.profile)
        object.__setattr__(self, "profile", rows)
        allowed = "points from the joint to the nose, the first and the last on the axis (rho = 0)"
        if rows[0][1] != 0.0 or rows[-1][1] != 0.0:
            raise SpecError("body.profile", rows, allowed, "add [s, 0] where the body ends")
        for n, (_, rho) in enumerate(rows[1:-1], start=1):
            checks.number(f"body.profile[{n}][1]", rho, "a radius above zero", above=0.0)
        if rows[0][0] == rows[-1][0]:
            raise SpecError("body.profile", rows, "as long as the body: its ends have the same s")
        _check_simple(self)

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        length = abs(self.profile[-1][0] - self.profile[0][0])
        widest = max((rho for _, rho in self.profile), key=np.real)
        return (0.5 * length, widest, widest)

    def scaled(self, factor: float) -> Self:
        return replace(self, profile=tuple((s * factor, rho * factor) for s, rho in self.profile))

    def outline(self) -> Profile:
        return _spline(np.real(np.array(self.profile)).astype(float))


def _rows(profile: Any) -> tuple[tuple[float, float], ...]:
    """Profile as pairs of numbers."""
    allowed = "a list of at least four points [s, rho]"
    if isinstance(profile, (str, bytes)) or not isinstance(profile, Iterable):
        raise SpecError("body.profile", profile, allowed)
    rows = [row.tolist() if isinstance(row, np.ndarray) else row for row in profile]
    if len(rows) < 4:
        raise SpecError("body.profile", rows, allowed)
    for n, row in enumerate(rows):
        checks.numbers(f"body.profile[{n}]", row, 2, "two numbers [s, rho]")
    return tuple((row[0], row[1]) for row in rows)


def _spline(rows: Array) -> Profile:
    """Curve through the points of a profile, from the joint to the nose."""
    from scipy.interpolate import CubicSpline

    s = -np.sign(rows[-1, 0] - rows[0, 0]) * (rows[:, 0] - rows[0, 0])
    chord = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(s), np.diff(rows[:, 1])))])
    even: Any = ((1, 0.0), (1, 0.0))  # at the poles, as s is there; rho is odd
    odd: Any = ((2, 0.0), (2, 0.0))
    along = CubicSpline(chord, s, bc_type=even)
    across = CubicSpline(chord, rows[:, 1], bc_type=odd)
    return Profile((Piece(float(chord[-1]), lambda x: np.stack([along(x), across(x)], -1)),))


def _check_simple(body: Revolution) -> None:
    """Refuse a profile whose spline crosses the axis or itself."""
    fault = _fault(tuple((float(np.real(s)), float(np.real(rho))) for s, rho in body.profile))
    if fault:
        raise SpecError(f"body.profile: the curve through it {fault} from the joint; add points "
                        "there, or move them so that the curve through them is smooth")  # fmt: skip


@lru_cache(64)
def _fault(rows: tuple[tuple[float, float], ...]) -> str:
    """What is wrong with a profile, and where; kept, as a map asks it of each design."""
    _, P, _, _ = _spline(np.array(rows)).dense
    low = P[:, 1] <= 0.0
    if low.any():
        return f"meets the axis at {abs(float(P[low.argmax(), 0])):.4g}"
    place = _crossing(P)
    return "" if place is None else f"crosses itself at {abs(place):.4g}"


def _crossing(P: Array) -> float | None:
    """s at which a polygon crosses itself, None if nowhere."""
    P = P[:: max(1, len(P) // 400)]
    a, d = P[:-1], np.diff(P, axis=0)
    gap = a[None] - a[:, None]
    det = d[:, None, 0] * d[None, :, 1] - d[:, None, 1] * d[None, :, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (gap[..., 0] * d[None, :, 1] - gap[..., 1] * d[None, :, 0]) / det
        u = (gap[..., 0] * d[:, None, 1] - gap[..., 1] * d[:, None, 0]) / det
    i, j = np.indices(t.shape)
    meets = (t >= 0) & (t <= 1) & (u >= 0) & (u <= 1) & (j > i + 1)
    return float(a[np.argwhere(meets)[0][0], 0]) if meets.any() else None
