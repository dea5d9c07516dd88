"""The joint: the closed curve in which the tail's tube meets the body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from microswim.errors import SpecError, measured
from microswim.models.swimmer_surface import (
    Curve,
    section_axes,
    section_twist,
    smooth_centreline,
    tube_point,
)
from microswim.numerics.array import Array
from microswim.swimmer.geometry import attachment
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.facets import Opening
from microswim.swimmer.geometry.tails.kinds import Tail


def _last_crossing(values: Array) -> int:
    """Index of the last sample that lies inside (value < 0), -1 if none."""
    inside = np.nonzero(values < 0)[0]
    return int(inside[-1]) if inside.size else -1


def piercing(body: Body, tail: Tail, phase: float = 0.0) -> float:
    """Return s at which the centreline leaves the body for the last time.

    Raises
    ------
    SpecError
        If the tail never touches the body or ends inside it.
    """
    reach = max(body.semi_axes3) + tail.apparent_length
    s = np.linspace(-body.behind, min(reach, tail.apparent_length), 4001)
    value = body.level(smooth_centreline(tail, s, phase).P)
    last = _last_crossing(value)
    if last < 0:
        raise attachment.refusal(tail)
    if last == s.size - 1:
        raise SpecError(
            "tail.length", tail.apparent_length, "long enough to leave the body", "make it longer"
        )
    low, high = s[last], s[last + 1]
    for _ in range(6):
        grid = np.linspace(low, high, 129)
        inside = _last_crossing(body.level(smooth_centreline(tail, grid, phase).P))
        low, high = grid[max(inside, 0)], grid[min(max(inside, 0) + 1, 128)]
    return float(0.5 * (low + high))


def _section_coordinates(tail: Tail, X: Array, s: Array, phase: float) -> tuple[Array, Array]:
    """Distance from the centreline, in the section through X, and that section's s.

    Of a ribbon the distance is counted in half axes and is the mean one on its surface; of a
    tapered tail it is the radius of the root there.

    Perpendicular: the closest point, (X - P) . P' = 0, by Newton's method from `s`.
    Sheared: the section of X is the one with P_s(s) = X_s.
    """
    if tail.sections == "sheared":
        for _ in range(4):
            c = smooth_centreline(tail, s, phase)
            step = (X[..., 0] - c.P[..., 0]) / c.P_s[..., 0]
            s = s + step
            if np.abs(step).max() < 1e-12 * tail.radius:
                break
    else:
        for _ in range(3):
            c = smooth_centreline(tail, s, phase)
            d = X - c.P
            slope = np.sum(d * c.P_ss, axis=-1) - np.sum(c.P_s**2, axis=-1)
            step = np.sum(d * c.P_s, axis=-1) / np.minimum(slope, -0.05)
            s = s - np.clip(step, -tail.radius, tail.radius)
    at = smooth_centreline(tail, s, phase)
    if tail.section is None:
        return np.linalg.norm(X - at.P, axis=-1) / tail.narrowing(s), s
    first, second = in_section(tail, at, X - at.P)
    return tail.radius * np.hypot(first, second) / tail.narrowing(s), s


def in_section(tail: Tail, at: Curve, arm: Array) -> tuple[Array, Array]:
    """Return the coordinates of an arm in its section over the half axes, one on the tube."""
    (a, b), (n1, n2) = tail.half_axes, section_axes(tail, at)
    return np.sum(arm * n1, axis=-1) / a, np.sum(arm * n2, axis=-1) / b


@dataclass(frozen=True)
class Joint:
    """Closed curve in which the tube meets the body, by the azimuth psi about the piercing point.

    The body is the image of the unit sphere; `pole`, `first`, `second` are an
    orthonormal frame of that sphere with the piercing point as its pole.

    Parameters
    ----------
    s : float
        Where the centreline leaves the body.
    pole, first, second : (3,)
        Frame on the unit sphere.
    series : (3, n)
        Fourier coefficients (rfft, divided by n) of the polar angle, of s - s(pole) and of Theta -
        psi, Theta = theta + beta(s) - beta(s(pole)) the angle of the generator that does not wind.
    body : Body
        The body as those directions map to it.
    is_open : bool
        Whether the curve does not go round the tube: the root of a tail that leans comes out of the
        far side of the body's end.
    """

    s: float
    pole: Array
    first: Array
    second: Array
    series: NDArray[np.complex128]
    body: Body
    is_open: bool = False

    @property
    def ahead(self) -> float:
        """Mean of Theta - psi: where the tube's generators begin, seen from the azimuth."""
        return float(self.series[2, 0].real)

    @property
    def depth(self) -> float:
        """Largest |s - s(pole)| of the curve."""
        turn = np.linspace(0.0, 2 * np.pi, 64)
        return float(np.abs(self._evaluate(1, turn)).max())

    def _evaluate(self, row: int, psi: Array) -> Array:
        c = self.series[row]
        result = np.full(np.shape(psi), c[0].real)
        turn = np.exp(1j * np.asarray(psi))
        power = np.ones_like(turn)
        for coefficient in c[1:]:
            power = power * turn
            result = result + 2 * (coefficient * power).real
        return result

    def angle(self, psi: Array) -> Array:
        """Return the polar angle of the curve on the unit sphere."""
        return self._evaluate(0, psi)

    def section(self, psi: Array) -> tuple[Array, Array]:
        """Return (s, Theta) of the tube's section and generator through the curve."""
        return self.s + self._evaluate(1, psi), psi + self._evaluate(2, psi)

    def azimuth(self, turn: Array) -> Array:
        """Return psi at equal steps of the turn (psi + Theta)/2: smooth where either of the two
        rushes.

        Where a generator grazes the body, Theta runs through a radian while psi hardly moves.
        """
        grid = np.linspace(0.0, 2 * np.pi, 2001)
        ahead = self._evaluate(2, grid)
        psi = np.interp(turn, grid + 0.5 * (ahead - ahead[0]), grid)
        for _ in range(2):
            slope = np.interp(psi, grid, 1.0 + 0.5 * np.gradient(ahead, grid))
            miss = psi + 0.5 * (self._evaluate(2, psi) - ahead[0]) - turn
            psi = psi - miss / np.maximum(slope, 0.2)
        return psi

    def sphere_point(self, angle: Array, psi: Array) -> Array:
        """Return the unit-sphere point at polar angle and azimuth about the pole."""
        radial = np.cos(psi)[..., None] * self.first + np.sin(psi)[..., None] * self.second
        return np.cos(angle)[..., None] * self.pole + np.sin(angle)[..., None] * radial

    def angle_to(self, opening: Opening, psi: Array) -> Array:
        """Return the polar angle at which the great circle from the pole at azimuth psi meets an
        opening.

        cos(angle) p + sin(angle) q = cos(opening), p and q the components of pole and of radial
        direction along the opening's axis.
        """
        p = float(self.pole @ opening.axes[0])
        q = np.cos(psi) * (self.first @ opening.axes[0])
        q = q + np.sin(psi) * (self.second @ opening.axes[0])
        far = np.arccos(np.clip(np.cos(opening.angle) / np.hypot(p, q), -1.0, 1.0))
        return np.arctan2(q, p) + far


def _lies_on_body(tail: Tail) -> SpecError:
    return SpecError(
        "tail.radius",
        tail.radius,
        "thin enough for the tube to leave the body in one smooth closed curve",
        "the tube lies along the body: use a thinner filament, a smaller amplitude or a longer "
        "ramp",
    )


def _crossing(tail: Tail, excess: Any, step: float, psi: Array) -> Array:
    """Polar angle at which `excess` (negative at the pole) first turns positive; Illinois
    method.
    """
    low, high = np.zeros_like(psi), np.full_like(psi, np.nan)
    f_low, f_high = excess(low), np.ones_like(psi)
    for angle in np.arange(step, 0.45 * np.pi, step):
        f = excess(np.full_like(psi, angle))
        open_ = np.isnan(high)
        low, f_low = np.where(open_ & (f <= 0), angle, low), np.where(open_ & (f <= 0), f, f_low)
        high, f_high = np.where(open_ & (f > 0), angle, high), np.where(open_ & (f > 0), f, f_high)
        if not np.isnan(high).any():
            break
    else:
        raise _lies_on_body(tail)
    for _ in range(14):
        middle = np.clip(low + (high - low) * f_low / (f_low - f_high), low, high)
        f = excess(middle)
        out = f > 0
        f_low, f_high = np.where(out, 0.5 * f_low, f), np.where(out, f, 0.5 * f_high)
        low, high = np.where(out, low, middle), np.where(out, middle, high)
        if np.abs(f).max() < 1e-10 * tail.radius:
            break
    return middle


def _lean(body: Body, tail: Tail, curve: Curve, pole: Array) -> Array:
    """Direction on the unit sphere, across the pole, in which the tube leans on the body.

    From it the azimuth counts, so that the patches turn with the tail from phase to phase and are
    as good at one as at another. A tube that does not lean has its own first axis.
    """
    step = 0.01 * tail.radius
    for direction in (curve.tangent, section_axes(tail, curve)[0]):
        across = body.direction(curve.P + step * direction) - pole
        across = across - across @ pole * pole
        size = float(np.linalg.norm(across))
        if size * body.stretch > 1e-4 * step:
            break
    return across / size


def trace_joint(body: Body, tail: Tail, phase: float = 0.0, points: int = 96) -> Joint:
    """Return intersection of the tube with the body: where the distance to the centreline is r_t.

    Seen from the piercing point the curve is smooth even where the tube leans on the body, which
    its generators are not.
    """
    start = piercing(body, tail, phase)
    curve = smooth_centreline(tail, np.array(start), phase)
    body = body.about(curve.P, max(tail.half_axes))
    pole = body.direction(curve.P)
    first = _lean(body, tail, curve, pole)
    psi = 2 * np.pi * np.arange(points) / points
    second, none = np.cross(pole, first), np.zeros((3, 1), complex)
    bare = Joint(start, pole, first, second, none, body)
    s = np.full(points, start)

    def excess(angle: Array) -> Array:
        nonlocal s
        X = body.surface_point(bare.sphere_point(angle, psi))
        found, s = _section_coordinates(tail, X, s, phase)
        return found - tail.radius

    angle = _crossing(tail, excess, 0.3 * tail.radius / body.stretch, psi)
    at = smooth_centreline(tail, s, phase)
    arm = body.surface_point(bare.sphere_point(angle, psi)) - at.P
    along_n1, along_n2 = in_section(tail, at, arm)
    theta = np.arctan2(along_n2, along_n1)
    grid = np.linspace(s.min() - 1e-6 * tail.radius, s.max() + 1e-6 * tail.radius, 201)
    twist = section_twist(tail, grid, phase)
    theta = theta + np.interp(s, grid, twist) - np.interp(start, grid, twist)
    turned = np.exp(1j * (theta - psi))
    mean = np.angle(turned.mean())
    ahead = mean + np.angle(turned * np.exp(-1j * mean))
    series = np.fft.rfft(np.stack([angle, s - start, ahead]), axis=-1)[:, : points // 2] / points
    left = np.abs(series[:2, -6:]).max(axis=-1) @ [body.stretch, 1.0] / tail.radius
    if left > 1e-5 and points < 192:
        return trace_joint(body, tail, phase, 2 * points)
    if left > 0.01:
        raise _lies_on_body(tail)
    behind = np.angle(turned * np.conj(np.roll(turned, 1))).sum() / (2.0 * np.pi)
    return Joint(start, pole, first, second, series, body, round(float(behind)) != 0)


def check_clear(body: Body, tail: Tail, joint: Joint, phase: float = 0.0) -> None:
    """Refuse a tail that comes back to the body beyond the joint.

    Raises
    ------
    SpecError
        If the tube touches the body anywhere but at its root.
    """
    s = np.linspace(joint.s + 1.05 * joint.depth, tail.apparent_length, 400)
    turn = np.linspace(0.0, 2 * np.pi, 8, endpoint=False)
    touching = body.level(tube_point(tail, s[:, None], turn, phase)).min(axis=1) < 0
    if touching.any():
        place = float(s[touching.argmax()])
        amplitude = attachment.amplitude_of(tail)
        if not amplitude:
            raise SpecError(
                f"tail: it pierces the body at s = {measured(place)}; bend it less there, or use a "
                "smaller body"
            )
        raise SpecError(
            "tail.amplitude",
            amplitude,
            f"small enough for the tail to stay clear of the body at s = {measured(place)}",
            "the tail pierces the body: use a smaller amplitude, a longer ramp or a smaller body",
        )
