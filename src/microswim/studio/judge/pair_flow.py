"""The flow about two swimmers in one fluid, on the plane through both, as a series in the phase.

Both are solved together, at their poses: each swims in the flow of the other. Motors of one rate
go round while the bodies stay; with two rates, or in a field that turns, it is the flow of now.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.models.group.blocks import prepare
from microswim.models.group.solution import solve
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import quaternion_of
from microswim.numerics.series.fourier import series_of
from microswim.studio.drawing import reach
from microswim.studio.judge.flow import FLOW_PHASES, served
from microswim.studio.judge.together import group_of
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.group import Group
from microswim.swimmer.member import Member

Progress = Callable[[int, int], None]
LEVEL = "coarse"
POINTS, MARGIN = 1800, 0.3  #: of the window, some; fluid about both, of the longer's length
ALIKE = 1e-9  #: of a rate, within which two motors keep their difference of phase


def pair_flow(question: dict[str, Any], progress: Progress) -> dict[str, Any]:
    """Return the velocity of the fluid on the plane through both swimmers, and where that is.

    The plane holds the axis of the first and the middle of the second. `series` is as that of
    `flow`, components along the plane's axes; a single term is the flow of now.

    Raises
    ------
    SpecError, MicroswimError
        If they are not of one fluid, or overlap.
    """
    group = group_of(question)
    blocks = prepare(group, LEVEL)
    origin, axes = plane_of(group)
    x, y = window(group, origin, axes)
    points = origin + np.stack(np.meshgrid(x, y), axis=-1) @ axes[:, :2].T
    phases = phases_of(group, np.array([blocks.of(m).rate for m in group.members]))
    made = []
    for n, row in enumerate(phases):
        progress(n, len(phases))
        found = solve(group.moved(phases=row.tolist()), level=LEVEL, blocks=blocks)
        made.append(found.flow(points) @ axes)
    series = series_of(np.array(made), harmonics=(len(made) - 1) // 2)
    frame = {"origin": origin.tolist(), "quaternion": quaternion_of(axes).tolist()}
    return {**served(x, y, series, made), "frame": frame}


def plane_of(group: Group) -> tuple[Array, Array]:
    """Return a point of the plane through both swimmers, and its axes (3, 3), columns: along the
    axis of the first, from it towards the second, normal.
    """
    first, second = group.members
    middles = [_ends(m).mean(axis=0) for m in (first, second)]
    Q = first.rotation
    across = middles[1] - middles[0]
    across = across - (across @ Q[:, 0]) * Q[:, 0]
    size = float(np.linalg.norm(across))
    beside = across / size if size > 1e-6 * float(nose_to_tip(first.swimmer)) else Q[:, 1]
    axes = np.stack([Q[:, 0], beside, np.cross(Q[:, 0], beside)], axis=-1)
    return np.mean(middles, axis=0), axes


def window(group: Group, origin: Array, axes: Array) -> tuple[Array, Array]:
    """Return coordinates along and across the plane's first axis: both swimmers and some fluid."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for member in group.members:
        own = member.swimmer
        wide = max(reach(own.settled.tail), *map(float, own.body.semi_axes3[1:]))
        seen = (_ends(member) - origin) @ axes[:, :2]
        low = np.minimum(low, seen.min(axis=0) - wide)
        high = np.maximum(high, seen.max(axis=0) + wide)
    margin = MARGIN * max(float(nose_to_tip(m.swimmer)) for m in group.members)
    low, high = low - margin, high + margin
    step = np.sqrt(np.prod(high - low) / POINTS)
    counts = np.clip(np.round((high - low) / step).astype(int) + 1, 8, POINTS // 8)
    x, y = (np.linspace(*side) for side in zip(low, high, counts, strict=True))
    return x, y


def phases_of(group: Group, rates: Array) -> Array:
    """Return the phases (N, 2) of both tails in a turn of their motors, or those of now."""
    own = np.array([m.phase for m in group.members])
    size = np.abs(rates)
    turning = size[size > 0]
    together = turning.size > 0 and float(np.ptp(turning)) <= ALIKE * float(turning.max())
    if not together or (group.field is not None and group.field.rate):
        return own[None]
    turns = 2.0 * np.pi * np.arange(FLOW_PHASES)[:, None] / FLOW_PHASES
    return own + turns * np.sign(rates)


def _ends(member: Member) -> Array:
    """Return nose and tail tip (2, 3) in the scene."""
    own = member.swimmer
    half = float(own.body.semi_axes3[0])
    along = np.array([-half, half + float(own.tail.apparent_length)])
    return np.array(member.position) + along[:, None] * member.rotation[:, 0]
