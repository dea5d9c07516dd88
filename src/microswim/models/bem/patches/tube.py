"""Patches of one tail: a tube that grows out of the body, with a hemispherical tip.

The tube's panels follow arc length and curvature, its first edges bend into the joint curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim.models import swimmer_surface as geometry
from microswim.models.bem.patches.resolution import Resolution
from microswim.models.bem.patches.surface import grid_boxes, sample_adapted, sampled
from microswim.models.joint import Joint
from microswim.models.rooting import root
from microswim.models.seen_body import seen_from
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids.spheres import half_sphere
from microswim.swimmer.geometry.tails.kinds import Tail

# A joint that reaches this many filament radii along the tail counts as steep: shorter first rows.
STEEP = 0.6

# A tube flatter than this (radius over half thickness, or the ratio of half axes) gets one panel
# more around.
FLAT = 2.0


def _wanted_length(tail: Tail, phase: float, s: Array, r: Resolution) -> tuple[Array, Array]:
    """Arc length and wanted panel length on the grid s, the joint and the tip left aside."""
    curve = geometry.smooth_centreline(tail, s, phase)
    speed = np.linalg.norm(curve.P_s, axis=-1)
    arc = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(s))])
    bend = np.maximum(curve.curvature, 1e-12)
    radius = tail.radius * tail.narrowing(s)
    h = np.clip(r.bend / bend, r.panel * radius, r.stretch * radius)
    # wavenumber of the wave, also of tails that name none: rms P'' over rms P' about its mean
    swing = np.sum((curve.P_s - curve.P_s.mean(axis=0)) ** 2)
    wavenumber = np.sqrt(np.sum(curve.P_ss**2) / max(swing, 1e-20))
    turn = speed / max(wavenumber, 1e-12)
    h = np.minimum(np.minimum(h, r.wave * turn), 2 * r.bend / bend)
    long = np.minimum(r.slender * np.minimum(1.0 / bend, turn), r.reach * radius)
    return arc, np.maximum(h, long)


def tube_edges(tail: Tail, phase: float, start: float, r: Resolution, root: float | None) -> Array:
    """Return edges of the tube's panels in s: equal shares of int ds/h with h the wanted panel
    length.

    root : length of the first panel in filament radii, None for a tail without a body.
    """
    # not a round number: no grid point on a kink, where rounding would choose the curvature
    s = np.linspace(start, tail.apparent_length, 2999)
    arc, h = _wanted_length(tail, phase, s, r)
    end = tail.radius * float(tail.narrowing(tail.apparent_length))
    tip = 1.6 * end + 0.6 * (arc[-1] - arc)
    if root is None:
        first = 1.6 * tail.radius + 0.6 * arc
    else:
        first = root * tail.radius + (1 - 1 / r.growth) * arc
    h = np.minimum(h, np.minimum(tip, first))
    share = np.concatenate([[0.0], np.cumsum(0.5 * (1 / h[1:] + 1 / h[:-1]) * np.diff(arc))])
    breaks = np.interp([k for k in geometry.kinks(tail) if k > start], s, share)
    pieces = [0.0, *breaks, share[-1]]
    edges = [np.zeros(1)]
    for low, high in zip(pieces[:-1], pieces[1:], strict=True):
        count = max(1, int(np.ceil(high - low - 0.25)))
        edges.append(np.linspace(low, high, count + 1)[1:])
    return np.interp(np.concatenate(edges), share, s)


def _rows_bent(edges: Array, joint: Joint) -> int:
    """Number of panel rows over which the joint's displacement fades: 2.5 times its size."""
    rows = int(np.searchsorted(edges - edges[0], 2.5 * joint.depth))
    return min(max(1, rows), edges.size - 1)


def _bent(edges: Array, joint: Joint, v: Array, psi: Array) -> tuple[Array, Array]:
    """(s, Theta) at panel coordinate v, bent at the root so that v = 0 is the joint curve."""
    s_joint, theta_joint = joint.section(psi)
    last = _rows_bent(edges, joint)
    fade = np.clip(1 - (edges - edges[0]) / (edges[last] - edges[0]), 0.0, 1.0)
    panels = np.arange(float(edges.size))
    left = np.interp(v, panels, fade)
    far = psi + joint.ahead
    return (
        np.interp(v, panels, edges) + (s_joint - edges[0]) * left,
        far + (theta_joint - far) * left,
    )


def _tube(
    tail: Tail, phase: float, edges: Array, around: int, joint: Joint | None
) -> tuple[Array, Array]:
    """Positions and s of the tube's patches; u runs around, v along."""
    panels = np.arange(float(edges.size))
    rows = 0 if joint is None else _rows_bent(edges, joint)
    start = edges[0] if joint is None else edges[0] - 1.05 * joint.depth
    grid = np.linspace(start, edges[-1], 4001)
    twist = geometry.section_twist(tail, grid, phase)
    twist = twist - np.interp(edges[0], grid, twist)

    ahead = 0.0 if joint is None else joint.ahead

    def chart(u: Array, v: Array) -> Array:
        s, theta = np.interp(v, panels, edges), u + ahead
        if joint is not None:
            bent = v <= rows
            psi = u.copy()
            psi[bent] = joint.azimuth(u[bent])
            s, theta = _bent(edges, joint, v, psi)
        X = geometry.tube_point(tail, s, theta - np.interp(s, grid, twist), phase)
        return np.concatenate([X, s[..., None]], axis=-1)

    values = sample_adapted(chart, grid_boxes(np.linspace(0, 2 * np.pi, around + 1), panels))
    return values[..., :3], values[..., 3]


def _cap(tail: Tail, phase: float, end: float, outward: float) -> tuple[Array, Array]:
    """Hemisphere centred on P(end), positions and s.

    Sheared sections: the straight tube's hemisphere, each of its sections displaced to P(s) too.
    """
    radius = tail.radius * float(tail.narrowing(end))
    if tail.sections == "sheared":
        axes = np.eye(3) if outward > 0 else np.array([[-1.0, 0, 0], [0, 0, 1.0], [0, 1.0, 0]])
        offset = radius * sampled(half_sphere(axes[0], axes[1], axes[2], 1))
        if tail.section is not None:
            offset = _ribbon_cap(tail, offset / radius, end, phase)
        s = end + offset[..., 0]
        offset[..., 0] = 0.0
        return geometry.smooth_centreline(tail, s, phase).P + offset, s
    curve = geometry.smooth_centreline(tail, np.array(end), phase)
    axis, (first, second) = curve.tangent, geometry.section_axes(tail, curve)
    if outward < 0:
        axis, first, second = -axis, second, first
    directions = sampled(half_sphere(axis, first, second, 1))
    if tail.section is not None:
        directions = _ribbon_cap(tail, directions, end, phase) / radius
    return curve.P + radius * directions, np.full(directions.shape[:3], end)


def _ribbon_cap(tail: Tail, directions: Array, end: float, phase: float) -> Array:
    """Return unit directions stretched to the half axes; along the tail to the smaller one."""
    curve = geometry.smooth_centreline(tail, np.array(end), phase)
    first, second = geometry.section_axes(tail, curve)
    axes = np.stack([np.cross(first, second), first, second])
    a, b = (axis * float(tail.narrowing(end)) for axis in tail.half_axes)
    return (directions @ axes.T * [min(a, b), a, b]) @ axes


def _joined(parts: list[tuple[Array, Array]]) -> tuple[Array, Array]:
    X, s = zip(*parts, strict=True)
    return np.concatenate(X), np.concatenate(s)


def _flatness(tail: Tail, phase: float, s: Array) -> Array:
    """Radius over half thickness of the tube: |P'| with sheared sections, else one."""
    if tail.section is not None:
        return np.full_like(s, tail.radius / min(tail.half_axes))
    if tail.sections != "sheared":
        return np.ones_like(s)
    return np.linalg.norm(geometry.smooth_centreline(tail, s, phase).P_s, axis=-1)


def inner_pressures(tail: Tail, phase: float, s: Array) -> Array:
    """Return hats along the tail, (m, *s.shape), zero at the joint: pressures of the fluid inside.

    A pressure that varies over a length l drives a flow of order h^3/(r_t l^2) of it along a tube
    of half thickness h; sheared sections flatten the tube to h = r_t/|P'|. The hats' spacing
    35 r_t (h/r_t)^(3/2) is where that is 1e-3.
    """
    grid = np.linspace(0.0, tail.apparent_length, 1001)
    speed = np.linalg.norm(geometry.smooth_centreline(tail, grid, phase).P_s, axis=-1)
    rate = speed * _flatness(tail, phase, grid) ** 1.5 / (35 * tail.radius * tail.narrowing(grid))
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(grid)
    count = np.concatenate([[0.0], np.cumsum(steps)])
    number = round(float(count[-1]))
    at = np.interp(s, grid, count) * (number / count[-1])
    hats = [np.clip(1.0 - np.abs(at - k), 0.0, 1.0) for k in range(1, number + 1)]
    return np.array(hats).reshape(number, *s.shape)


@dataclass(frozen=True, eq=False)
class Grown:
    """Patches of one tail at its place, and where it leaves the body.

    Parameters
    ----------
    controls, motion
        Positions, and velocities per unit phase rate, (e, q, q, 3).
    inner
        Pressures of the fluid within, (m, e, q, q).
    joint
        With the body, if there is one.
    is_flat
        Whether it is a flat ribbon.
    """

    controls: Array
    motion: Array
    inner: Array
    joint: Joint | None
    is_flat: bool


def grown(body: Body, tail: Tail, phase: float, r: Resolution) -> Grown:
    """Return the patches of one tail of a body."""
    place, seen, phase = tail.placement, seen_from(body, tail), float(tail.own_phase(phase))
    tail, pace = tail.own, float(tail.pace)
    joint = None if body.is_absent else root(seen, tail, phase)
    start = 0.0 if joint is None else joint.s
    first = None
    if joint is not None:
        first = r.root * min(1.0, STEEP * tail.radius / max(joint.depth, 1e-3 * tail.radius))
    edges = tube_edges(tail, phase, start, r, first)
    around = r.around + int(_flatness(tail, phase, edges).max() > FLAT)
    is_flat = max(tail.half_axes) > FLAT * min(tail.half_axes)
    if tail.section is not None:  # panels meet where the section bends most and least
        around = 8 if is_flat else 4
    parts = [_tube(tail, phase, edges, around, joint), _cap(tail, phase, tail.apparent_length, 1.0)]
    if joint is None:
        parts.append(_cap(tail, phase, 0.0, -1.0))
    X, s = _joined(parts)
    motion = geometry.surface_velocity(tail, X, s, phase)
    inner = inner_pressures(tail, phase, s)
    return Grown(place.placed(X), pace * place.turned(motion), inner, joint, is_flat)
