"""The swimmer's surface before any mesh: smooth centreline, sections, motion, senseless shapes.

Shared by the boundary elements and the finite elements. A point of the tail's tube is

    X(s, theta) = P(s) + r_t (cos(theta) n1(s) + sin(theta) n2(s)),

with `n1, n2` normal to the centreline (perpendicular sections) or the fixed `e_q, e_r` (sheared
sections); a ribbon has its half axes a, b in place of r_t and n1 towards the crests of the wave.
The kink of the ramp [Tabak Sec. 2] is rounded over +-r_t, and the centreline is
continued to s < 0 (analytically for helix and plane wave, straight for other tails) so that the
tube grows out of the body without a gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import cdist

from microswim.errors import SpecError, measured
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.tails.kinds import Tail, WaveTail

# Curvature x radius from which on a bend is refused (it folds into itself at one, and just below it
# is a crease that no level resolves), and from which on it is nearly a crease.
FOLDED, CREASED = 0.98, 0.9


def rounded_ramp(s: Array, start: float, half_width: float) -> tuple[Array, Array, Array]:
    """Return the amplitude fraction f(s), f'(s), f''(s) of the ramp min(1, s/s0), its kink rounded.

    A parabola over s0 - w < s < s0 + w joins the two lines with their slopes,
    f = 1 - (s0 + w - s)^2 / (4 w s0).

    Parameters
    ----------
    s : array
        Distance from the joint along the axis; negative values continue the ramp.
    start : float
        s0, where the sharp ramp reaches one; 0 means no ramp (f = 1).
    half_width : float
        w, reduced to s0 when larger.
    """
    s = np.asarray(s, dtype=float)
    if start <= 0:
        return np.ones_like(s), np.zeros_like(s), np.zeros_like(s)
    w = min(half_width, start)
    x = np.clip((s - start) / w, -1.0, 1.0)
    f = np.where(s < start - w, s / start, 1 - w / (4 * start) * (1 - x) ** 2)
    df = (1 - x) / (2 * start)
    ddf = np.where(np.abs(x) < 1, -0.5 / (w * start), 0.0)
    return f, df, ddf


def kinks(tail: Tail) -> list[float]:
    """Return values of s at which the smooth centreline's curvature jumps: the ends of the
    rounding.
    """
    length = tail.apparent_length
    if not isinstance(tail, WaveTail):
        return [float(f) * length for f in tail.edges[1:-1]]
    start = tail.ramp * length
    half = min(tail.radius, start)
    return [s for s in (start - half, start + half) if 0 < s < length]


@dataclass(frozen=True)
class Curve:
    """A centreline at given s: position, derivatives in s, and phase derivatives, each (..., 3).

    `radial` is the unit vector across s that a ribbon's sections turn with, None for a round tube.
    """

    P: Array
    P_s: Array
    P_ss: Array
    P_phi: Array
    P_sphi: Array
    radial: Array | None = None

    @property
    def tangent(self) -> Array:
        return self.P_s / np.linalg.norm(self.P_s, axis=-1, keepdims=True)

    @property
    def curvature(self) -> Array:
        """|P' x P''| / |P'|^3."""
        cross = np.linalg.norm(np.cross(self.P_s, self.P_ss), axis=-1)
        return cross / np.linalg.norm(self.P_s, axis=-1) ** 3


def _wave(tail: WaveTail, s: Array, phase: float, second: float) -> Curve:
    """Helix (second = -sign) and plane wave (second = 0): b f(s) [cos, second*sin](ks - phase)."""
    f, df, ddf = rounded_ramp(s, tail.ramp * tail.apparent_length, tail.radius)
    (b, slope), k = tail.taper(s), tail.wavenumber
    f, df, ddf = b * f, b * df + slope * f, b * ddf + 2.0 * slope * df
    c, n = np.cos(k * s - phase), np.sin(k * s - phase)
    zero, one = np.zeros_like(s), np.ones_like(s)

    def rows(first: Array, q: Array, r: Array) -> Array:
        return np.stack([first, q, second * r], axis=-1)

    return Curve(
        P=rows(s, f * c, f * n),
        P_s=rows(one, df * c - k * f * n, df * n + k * f * c),
        P_ss=rows(
            zero,
            (ddf - k * k * f) * c - 2 * k * df * n,
            (ddf - k * k * f) * n + 2 * k * df * c,
        ),
        P_phi=rows(zero, f * n, -f * c),
        P_sphi=rows(zero, df * n + k * f * c, -df * c + k * f * n),
        radial=None if tail.section is None else tail.radial(s, phase),
    )


def _general(tail: Tail, s: Array, phase: float) -> Curve:
    """Any other tail, from its own centreline; derivatives by differences, straight beyond the
    ends.
    """
    length = tail.apparent_length
    step = 1e-4 * length
    inside = np.clip(s, step, length - step)
    P, P_s, P_phi = tail.centreline(np.clip(s, 0.0, length), phase)
    _, up_s, up_phi = tail.centreline(inside + step, phase)
    _, down_s, down_phi = tail.centreline(inside - step, phase)
    P_ss, P_sphi = (up_s - down_s) / (2 * step), (up_phi - down_phi) / (2 * step)
    beyond = (s - np.clip(s, 0.0, length))[..., None]
    return Curve(
        P=P + beyond * P_s,
        P_s=P_s,
        P_ss=np.where(beyond != 0, 0.0, P_ss),
        P_phi=P_phi + beyond * P_sphi,
        P_sphi=P_sphi,
    )


def smooth_centreline(tail: Tail, s: Array, phase: float = 0.0) -> Curve:
    """Return the centreline of a tail with the ramp's kink rounded, continued to s < 0 (the
    reference's P).
    """
    s = np.asarray(s, dtype=float)
    if isinstance(tail, WaveTail) and tail.is_along_s:
        return _wave(tail, s, phase, tail.out_of_plane)
    if tail.sections == "sheared":
        raise SpecError("tail.sections", "sheared", "perpendicular for a tail by its angle")
    return _general(tail, s, phase)


def section_axes(tail: Tail, curve: Curve) -> tuple[Array, Array]:
    """Return the unit vectors n1, n2 that span the tube's sections.

    Perpendicular: e_q, e_r carried along by the smallest rotation that takes e_s to the tangent T,
    n1 = e_q - T_q (e_s + T)/(1 + T_s): smooth wherever the tail does not turn straight back.
    Sheared: e_q and e_r themselves. Of a ribbon n1 is what of the radial direction lies across T,
    or across s, n2 the binormal.
    """
    if curve.radial is not None:
        return _ribbon_axes(tail, curve, curve.radial)
    n1, n2 = np.zeros_like(curve.P), np.zeros_like(curve.P)
    n1[..., 1], n2[..., 2] = 1.0, 1.0
    if tail.sections == "sheared":
        return n1, n2
    T = curve.tangent
    bisector = T.copy()
    bisector[..., 0] += 1.0
    bisector /= 1.0 + T[..., :1]
    return n1 - T[..., 1:2] * bisector, n2 - T[..., 2:3] * bisector


def _ribbon_axes(tail: Tail, curve: Curve, radial: Array) -> tuple[Array, Array]:
    T = curve.tangent if tail.sections == "perpendicular" else np.zeros_like(radial)
    if tail.sections == "sheared":
        T[..., 0] = 1.0
    n1 = radial - np.sum(radial * T, axis=-1, keepdims=True) * T
    n1 = np.asarray(n1 / np.linalg.norm(n1, axis=-1, keepdims=True), float)
    return n1, np.asarray(np.cross(T, n1), float)


def section_twist(tail: Tail, s: Array, phase: float = 0.0) -> Array:
    """Return the angle beta(s) through which `section_axes` turn about the tangent, from
    beta(s[0]) = 0.

    Generators theta + beta = const do not wind about the tube: along them X moves along the tangent
    alone, so they leave the body once. Trapezoidal rule on the increasing grid s. Those of a ribbon
    run along its edges: no twist is taken off.
    """
    if tail.section is not None:
        return np.zeros_like(s)
    n1, n2 = section_axes(tail, smooth_centreline(tail, s, phase))
    step = np.sum(np.diff(n1, axis=0) * 0.5 * (n2[1:] + n2[:-1]), axis=-1)
    return np.concatenate([[0.0], np.cumsum(step)])


def tube_point(tail: Tail, s: Array, theta: Array, phase: float = 0.0) -> Array:
    """Return the tube's surface x(s, theta), shape of s and theta broadcast, then 3."""
    s, theta = np.broadcast_arrays(np.asarray(s, float), np.asarray(theta, float))
    curve = smooth_centreline(tail, s, phase)
    n1, n2 = section_axes(tail, curve)
    a, b = (axis * tail.narrowing(s) for axis in tail.half_axes)
    return curve.P + (a * np.cos(theta))[..., None] * n1 + (b * np.sin(theta))[..., None] * n2


def surface_velocity(tail: Tail, X: Array, s: Array, phase: float = 0.0) -> Array:
    """Return the velocity of the tail's surface at X (of the section at s) per unit phase rate.

    rigid        sign * e_s x X              (spin of the filament included)
    translating  P_phi
    bending      P_phi + (T x T_phi) x (X - P)   (sections turn with the tangent, no spin)
    """
    if tail.surface_motion == "rigid":
        zero = np.zeros_like(X[..., 0])
        return tail.sign * np.stack([zero, -X[..., 2], X[..., 1]], axis=-1)
    curve = smooth_centreline(tail, s, phase)
    if tail.surface_motion == "translating":
        return np.broadcast_to(curve.P_phi, X.shape).copy()
    T, speed = curve.tangent, np.linalg.norm(curve.P_s, axis=-1, keepdims=True)
    turning = np.cross(T, curve.P_sphi) / speed
    return curve.P_phi + np.cross(turning, X - curve.P)


def _bend_outside(body: Body, tail: Tail, s: Array, curve: Curve, alone: bool) -> Array:
    """Curvature x radius at every s whose section's inner side lies outside the body, else zero."""
    radius = max(tail.half_axes) * tail.narrowing(s)
    if alone:
        return np.where(s >= 0, curve.curvature * radius, 0.0)
    T = curve.tangent
    inward = curve.P_ss - np.sum(curve.P_ss * T, axis=-1, keepdims=True) * T
    size = np.linalg.norm(inward, axis=-1, keepdims=True)
    inner = curve.P + radius[..., None] * inward / np.where(size > 0, size, 1.0)
    return np.where(body.level(inner) > 0, curve.curvature * radius, 0.0)


def check(body: Body, tail: Tail, phase: float = 0.0) -> list[str]:
    """Refuse geometry that cannot be built; return remarks on geometry that is merely extreme.

    Raises
    ------
    SpecError
        If the tube folds into itself (curvature x radius of 0.98 and more, the inner side of the
        bend outside the body) or touches itself (turns closer than two filament radii).
    """
    radius = max(tail.half_axes)
    s = np.linspace(-2 * radius, tail.apparent_length, 2001)
    curve = smooth_centreline(tail, s, phase)
    remarks = []
    alone = body.is_absent
    bend = _bend_outside(body, tail, s, curve, alone)
    fold = float(bend.max())
    if tail.sections == "perpendicular":
        if fold >= FOLDED:
            most = measured(FOLDED * radius / fold, "tail.radius")
            raise SpecError(
                "tail.radius",
                radius,
                f"less than {most}, nearly the radius of curvature at "
                f"s = {measured(s[bend.argmax()])}",
                "the tube would fold into itself: use a thinner filament, a smaller amplitude, "
                "fewer waves or a longer ramp",
            )
        if fold > CREASED:
            remarks.append(
                f"curvature x radius reaches {fold:.2f}: nearly a crease, check with level fine"
            )
        outside = s >= 0
        _check_clearance(tail, curve.P[outside])
    if alone:
        return remarks
    P_s = curve.P_s[np.searchsorted(s, 0.0)]
    slope = float(np.linalg.norm(P_s[1:]) / max(abs(P_s[0]), 1e-12))
    if slope > 0.9:
        remarks.append(
            f"the tail leaves the body at a slope of {slope:.2f}: power and efficiency are less "
            "sure than u_s, check with level fine"
        )
    return remarks


def _check_clearance(tail: Tail, P: Array) -> None:
    """Refuse a tube that touches another part of itself."""
    P, radius = P[::5], max(tail.half_axes)
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(P, axis=0), axis=-1))])
    apart = cdist(P, P)
    gap = np.where(np.abs(arc[:, None] - arc[None, :]) > np.pi * radius, apart, np.inf)
    if gap.min() <= 2 * radius:
        raise SpecError(
            "tail.radius",
            radius,
            f"less than {measured(gap.min() / 2, 'tail.radius')}, half the distance of "
            "neighbouring turns",
            "the tube would touch itself: use a thinner filament or fewer waves",
        )
