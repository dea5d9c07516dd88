"""The swimmer's surface before any mesh: smooth centreline, frames, joint, senseless shapes.

Shared by the boundary elements and the finite elements. A point of the tail's tube is

    X(s, theta) = P(s) + r_t (cos(theta) n1(s) + sin(theta) n2(s)),

with `n1, n2` normal to the centreline (perpendicular sections) or the fixed `e_q, e_r` (sheared
sections). The kink of the ramp [Tabak Sec. 2] is rounded over +-r_t, and the centreline is continued
to s < 0 (analytically for helix and plane wave, straight for other tails) so that the tube grows out
of the body without a gap.

Depends on: numpy, microswim.errors.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.errors import SpecError

Array = NDArray[np.float64]


def rounded_ramp(s: Array, start: float, half_width: float) -> tuple[Array, Array, Array]:
    """Amplitude fraction f(s), f'(s), f''(s) of the ramp min(1, s/s0), its kink rounded.

    With x = (s - s0)/w inside |x| < 1:  s0 f' = 1/2 - 3x/4 + x^3/4,  so f is twice continuously
    differentiable and f(s0 - w), f(s0 + w) are the values of the sharp ramp.

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
    inner = 1 - w / start + (w / start) * (x / 2 - 3 * x**2 / 8 + x**4 / 16 + 13 / 16)
    f = np.where(s < start - w, s / start, inner)
    df = (0.5 - 0.75 * x + 0.25 * x**3) / start
    ddf = -0.75 * (1 - x**2) / (w * start)
    return f, df, ddf


@dataclass(frozen=True)
class Curve:
    """A centreline at given s: position, derivatives in s, and phase derivatives, each (..., 3)."""

    P: Array
    P_s: Array
    P_ss: Array
    P_phi: Array
    P_sphi: Array

    @property
    def tangent(self) -> Array:
        return self.P_s / np.linalg.norm(self.P_s, axis=-1, keepdims=True)

    @property
    def curvature(self) -> Array:
        """|P' x P''| / |P'|^3."""
        cross = np.linalg.norm(np.cross(self.P_s, self.P_ss), axis=-1)
        return cross / np.linalg.norm(self.P_s, axis=-1) ** 3


def _wave(tail: Any, s: Array, phase: float, second: float) -> Curve:
    """Helix (second = -sign) and plane wave (second = 0): b f(s) [cos, second*sin](ks - phase)."""
    f, df, ddf = rounded_ramp(s, tail.ramp * tail.apparent_length, tail.radius)
    b, k = tail.amplitude, tail.wavenumber
    c, n = np.cos(k * s - phase), np.sin(k * s - phase)
    zero, one = np.zeros_like(s), np.ones_like(s)

    def rows(first: Array, q: Array, r: Array) -> Array:
        return np.stack([first, b * q, b * second * r], axis=-1)

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
    )


def _general(tail: Any, s: Array, phase: float) -> Curve:
    """Any other tail, from its own centreline; derivatives by differences, straight for s < 0."""
    length = tail.apparent_length
    step = 1e-4 * length
    inside = np.clip(s, step, length - step)
    P, P_s, P_phi = tail.centreline(np.clip(s, 0.0, length), phase)
    _, up_s, up_phi = tail.centreline(inside + step, phase)
    _, down_s, down_phi = tail.centreline(inside - step, phase)
    P_ss, P_sphi = (up_s - down_s) / (2 * step), (up_phi - down_phi) / (2 * step)
    beyond = np.minimum(s, 0.0)[..., None]
    return Curve(
        P=P + beyond * P_s,
        P_s=P_s,
        P_ss=np.where(beyond < 0, 0.0, P_ss),
        P_phi=P_phi + beyond * P_sphi,
        P_sphi=P_sphi,
    )


def smooth_centreline(tail: Any, s: Array, phase: float = 0.0) -> Curve:
    """Centreline of a tail with the ramp's kink rounded, continued to s < 0 (the reference's P)."""
    s = np.asarray(s, dtype=float)
    if hasattr(tail, "handedness"):
        return _wave(tail, s, phase, -float(tail.sign))
    if hasattr(tail, "amplitude"):
        return _wave(tail, s, phase, 0.0)
    return _general(tail, s, phase)


def section_axes(tail: Any, curve: Curve) -> tuple[Array, Array]:
    """Unit vectors n1, n2 that span the tube's sections.

    Perpendicular: e_q, e_r carried along by the smallest rotation that takes e_s to the tangent T,
    n1 = e_q - T_q (e_s + T)/(1 + T_s): smooth wherever the tail does not turn straight back.
    Sheared: e_q and e_r themselves.
    """
    n1, n2 = np.zeros_like(curve.P), np.zeros_like(curve.P)
    n1[..., 1], n2[..., 2] = 1.0, 1.0
    if tail.sections == "sheared":
        return n1, n2
    T = curve.tangent
    bisector = T.copy()
    bisector[..., 0] += 1.0
    bisector /= 1.0 + T[..., :1]
    return n1 - T[..., 1:2] * bisector, n2 - T[..., 2:3] * bisector


def tube_point(tail: Any, s: Array, theta: Array, phase: float = 0.0) -> Array:
    """X(s, theta), the tube's surface, shape of s and theta broadcast, then 3."""
    s, theta = np.broadcast_arrays(np.asarray(s, float), np.asarray(theta, float))
    curve = smooth_centreline(tail, s, phase)
    n1, n2 = section_axes(tail, curve)
    radial = np.cos(theta)[..., None] * n1 + np.sin(theta)[..., None] * n2
    return curve.P + tail.radius * radial


def surface_velocity(tail: Any, X: Array, s: Array, phase: float = 0.0) -> Array:
    """Velocity of the tail's surface at X (of the section at s) per unit phase rate.

    rigid        sign * e_s x X              (spin of the filament included)
    translating  P_phi
    bending      P_phi + (T x T_phi) x (X - P)   (sections turn with the tangent, no spin)
    """
    if tail.surface_motion == "rigid":
        if not hasattr(tail, "sign"):
            raise SpecError(
                "tail.surface_motion = 'rigid': only a helix turns as a rigid body; "
                "choose 'translating' or 'bending'"
            )
        zero = np.zeros_like(X[..., 0])
        return tail.sign * np.stack([zero, -X[..., 2], X[..., 1]], axis=-1)
    curve = smooth_centreline(tail, s, phase)
    if tail.surface_motion == "translating":
        return np.broadcast_to(curve.P_phi, X.shape).copy()
    T, speed = curve.tangent, np.linalg.norm(curve.P_s, axis=-1, keepdims=True)
    turning = np.cross(T, curve.P_sphi) / speed
    return curve.P_phi + np.cross(turning, X - curve.P)


def level_set(body: Any, X: Array) -> Array:
    """Ellipsoid's level function: negative inside the body, zero on it."""
    scaled = (X - body.centre) / np.asarray(body.semi_axes3)
    return np.sum(scaled**2, axis=-1) - 1.0


def _last_crossing(values: Array) -> int:
    """Index of the last sample that lies inside (value < 0), -1 if none."""
    inside = np.nonzero(values < 0)[0]
    return int(inside[-1]) if inside.size else -1


def piercing(body: Any, tail: Any, phase: float = 0.0) -> float:
    """s at which the centreline leaves the body for the last time.

    Raises
    ------
    SpecError
        If the tail never touches the body or ends inside it.
    """
    reach = max(body.semi_axes3) + tail.apparent_length
    s = np.linspace(-2 * body.semi_axes3[0], min(reach, tail.apparent_length), 4001)
    value = level_set(body, smooth_centreline(tail, s, phase).P)
    last = _last_crossing(value)
    if last < 0:
        raise SpecError(
            f"tail.amplitude = {getattr(tail, 'amplitude', float('nan')):g}: without a ramp the tail must start "
            "on the body; use an amplitude below the body's radius or a ramp"
        )
    if last == s.size - 1:
        raise SpecError(
            f"tail.length = {tail.apparent_length:g}: the tail ends inside the body; make it longer"
        )
    low, high = s[last], s[last + 1]
    for _ in range(60):
        mid = 0.5 * (low + high)
        inside = level_set(body, smooth_centreline(tail, np.array(mid), phase).P) < 0
        low, high = (mid, high) if inside else (low, mid)
    return float(0.5 * (low + high))


def joint_curve(body: Any, tail: Any, theta: Array, phase: float, s_joint: float) -> Array:
    """s(theta) at which each generator of the tube meets the body's surface (bisection).

    Parameters
    ----------
    theta : array
        Angles around the tube.
    s_joint : float
        The centreline's own crossing, from `piercing`.
    """
    theta = np.asarray(theta, dtype=float)
    for reach in tail.radius * np.arange(0.5, 8.1, 0.5):
        low, high = np.full_like(theta, s_joint - reach), np.full_like(theta, s_joint + reach)
        inside = level_set(body, tube_point(tail, low, theta, phase)) < 0
        outside = level_set(body, tube_point(tail, high, theta, phase)) > 0
        if inside.all() and outside.all():
            break
    else:
        raise SpecError(
            f"tail.radius = {tail.radius:g}: the tube does not leave the body in one closed curve; "
            "use a thinner filament, a smaller amplitude or a longer ramp"
        )
    for _ in range(46):
        mid = 0.5 * (low + high)
        inside = level_set(body, tube_point(tail, mid, theta, phase)) < 0
        low, high = np.where(inside, mid, low), np.where(inside, high, mid)
    return 0.5 * (low + high)
