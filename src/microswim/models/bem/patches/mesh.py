"""Patches of a swimmer: body with a hole for each tail, and the tubes that grow out of it.

The body is the image of the unit sphere. Around the piercing point of the tail the sphere carries
rings that grow geometrically from the joint curve to a circle, the body's `opening`; what lies
beyond are the body's own facets. Where several tails leave it, rings lead to the sides of cells.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from microswim.models.bem.patches import rooted
from microswim.models.bem.patches.cells import shell
from microswim.models.bem.patches.resolution import Resolution
from microswim.models.bem.patches.surface import Surface, grid_boxes, sample_adapted, sampled, still
from microswim.models.bem.patches.triangles import surface_of
from microswim.models.bem.patches.tube import grown
from microswim.models.joint import Joint
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.parts import numbered

#: The hole that a ribbon leaves in its body is cut into so many times more.
HOLE_OF_RIBBON = 3


def _ring_radii(step: float, growth: float, quarter: float, gap: float, last: float) -> Array:
    """Fractions 0..1 of the way from the hole to the opening: steps that grow geometrically.

    Towards the opening they shrink to `last` again.
    """
    steps = [step]
    while sum(steps) < gap:
        left = last + (1 - 1 / growth) * max(gap - sum(steps), 0.0)
        steps.append(min(steps[-1] * growth, quarter, max(left, step)))
    edges = np.concatenate([[0.0], np.cumsum(steps)])
    return edges / edges[-1]


def _rings(
    joint: Joint, r: Resolution, side: int, flat: bool, gap: float, last: float
) -> tuple[Array, Callable[[float, float], int]]:
    """Fractions of the gap (rad) beyond the joint where rings end; patches per quarter of one."""
    mean = float(joint.series[0, 0].real)
    t = _ring_radii(r.root * mean, r.growth, 0.5 * np.pi / side, gap, last)
    most, finer = max(side, r.around // 4), HOLE_OF_RIBBON if flat else 1

    def per_quarter(low: float, high: float) -> int:
        shape = (mean + high * gap) / (2.2 * (high - low) * gap)
        return finer * int(np.clip(np.ceil(shape), 1, most))

    return t, per_quarter


def _side(body: Body, r: Resolution) -> int:
    return r.body + int(max(body.semi_axes3) > 1.5 * min(body.semi_axes3))


def _body(body: Body, joint: Joint, r: Resolution, flat: bool) -> Array:
    """Positions of the patches of a body with one root."""
    around = np.linspace(0.0, 2 * np.pi, 64)
    opening = body.opening(joint.pole, joint.first, float(joint.angle(around).max()))

    def chart(t: Array, psi: Array) -> Array:
        end = joint.angle_to(opening, psi)
        return body.surface_point(joint.sphere_point(joint.angle(psi) * (1 - t) + end * t, psi))

    gap = float(joint.angle_to(opening, around).mean()) - float(joint.series[0, 0].real)
    t, per_quarter = _rings(joint, r, _side(body, r), flat, gap, opening.last)
    parts = []
    for low, high in zip(t[:-1], t[1:], strict=True):
        sectors = 4 * per_quarter(low, high)
        turn = np.linspace(-np.pi / 4, 2 * np.pi - np.pi / 4, sectors + 1)
        parts.append(sample_adapted(chart, grid_boxes(np.array([low, high]), turn)))
    parts.append(sampled(body.facets(r.body, opening)))
    return np.concatenate(parts)


def _body_of_several(body: Body, joints: list[Joint], r: Resolution, flat: bool) -> Array:
    """Positions of the patches of a body from a file, or with several roots."""
    side = _side(body, r)

    def rings(joint: Joint, gap: float) -> tuple[Array, Callable[[float, float], int]]:
        return _rings(joint, r, side, flat, gap, float("inf"))

    if body.triangles is not None:
        return rooted.shell(body.triangles, joints, r.file, rings)
    return shell(body, joints, side, rings)


def body_surface(body: Body, r: Resolution) -> Surface:
    """Return the closed surface of a body without a tail."""
    if body.triangles is not None:
        return surface_of(body.triangles, r.file)[0]
    return still(sampled(body.facets(r.alone)), r.order)


def swimmer_surface(body: Body, tail: Tail, phase: float, r: Resolution) -> Surface:
    """Return the closed surface of a swimmer at one phase, with the tails' velocity per unit phase
    rate.

    The last one is kept: a fifth of a pose beside a wall is its surface, the same at each.
    """
    try:
        return _kept(body, tail, phase, r)
    except TypeError:  # what is made of arrays, a file's triangles say, has no hash
        return _surface(body, tail, phase, r)


def _surface(body: Body, tail: Tail, phase: float, r: Resolution) -> Surface:
    if tail.is_absent:
        return body_surface(body, r)
    tails = [numbered(name, grown, body, t, phase, r) for name, t in tail.named.items()]
    joints = [t.joint for t in tails if t.joint is not None]
    flat = any(t.is_flat for t in tails)
    shells = []
    if joints:
        one = len(joints) == 1 and body.triangles is None
        shells = [
            _body(body, joints[0], r, flat) if one else _body_of_several(body, joints, r, flat)
        ]
    X = np.concatenate([*shells, *(t.controls for t in tails)])
    motion = np.concatenate([*map(np.zeros_like, shells), *(t.motion for t in tails)])
    bare = len(X) - sum(len(t.controls) for t in tails)
    inner = np.zeros((sum(len(t.inner) for t in tails), *X.shape[:3]))
    row, first = 0, bare
    for t in tails:
        rows, patches = row + len(t.inner), first + len(t.controls)
        inner[row:rows, first:patches] = t.inner
        row, first = rows, patches
    of_tail = np.repeat(np.arange(len(tails) + 1), [bare, *(len(t.controls) for t in tails)])
    return Surface(
        np.ascontiguousarray(X), np.ascontiguousarray(motion), of_tail, r.order, inner,
        is_open=any(joint.is_open for joint in joints),
    )  # fmt: skip


_kept = lru_cache(maxsize=1)(_surface)
