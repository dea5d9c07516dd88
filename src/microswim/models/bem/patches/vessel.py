"""A tube around a swimmer as a surface: patches whose size follows their distance to the swimmer.

    X(u, v) = m + u e_1 + (d/2) (cos v e_2 + sin v e_3),   |u| <= length/2

A closed tube ends in two flat discs; an open one ends in fluid at rest, so that it is a tube of no
thickness with fluid on both sides. Normals point to the axis. Of a long closed tube only what lies
around the swimmer is there: what ends at a distance d from it send back falls as exp(-2 * 2.6 d /
(diameter/2)).
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from scipy.spatial import KDTree

from microswim.errors import SpecError
from microswim.models.bem.patches.near_wall import refined
from microswim.models.bem.patches.resolution import Sides
from microswim.models.bem.patches.surface import Surface, grid_boxes, positions, sample, still
from microswim.numerics.array import Array
from microswim.swimmer.geometry.surroundings import Channel


def in_tube(swimmer: Surface, channel: Channel, middle: Array, sides: Sides) -> Surface:
    """Return one surface of swimmer and tube, each fine where it is near the other.

    Parameters
    ----------
    swimmer
        Surface of the swimmer, frame of `middle`.
    channel
        The tube.
    middle
        Middle of the tube (3,); its axes are `channel.axes`.
    sides
        Sizes of the tube's patches.

    Raises
    ------
    SpecError
        If the channel is no tube, or the swimmer touches it.
    """
    if not channel.is_cylinder:
        raise SpecError(
            "channel.shape", channel.shape, '"cylinder" for model "bem"', 'or take "fem"'
        )

    def height(X: Array) -> Array:
        return channel.clearance((X - middle) @ channel.axes)

    reach = positions(swimmer, 9)
    channel.check_fits((reach.reshape(-1, 3) - middle) @ channel.axes, np.zeros(reach.size // 3))
    swimmer = refined(swimmer, height)
    near = KDTree(positions(swimmer, 9).reshape(-1, 3))

    def distance(X: Array) -> Array:
        return near.query(X.reshape(-1, 3))[0].reshape(X.shape[:-1])

    ends = _ends(channel, (reach.reshape(-1, 3) - middle) @ channel.axes[:, 0])
    tube = still(_patches(channel, middle, swimmer.order, sides, ends), swimmer.order)
    tube = refined(tube, distance, sides.change)
    return joined(swimmer, tube, closed=channel.ends == "closed")


def joined(swimmer: Surface, tube: Surface, closed: bool) -> Surface:
    """Return the patches of both, those of the tube marked."""
    inner = swimmer.inner
    if inner is not None and len(inner):
        nothing = np.zeros((len(inner), *tube.controls.shape[:3]))
        inner = np.concatenate([inner, nothing], axis=1)
    vessel = np.arange(swimmer.patches + tube.patches) >= swimmer.patches
    return replace(
        swimmer,
        controls=np.concatenate([swimmer.controls, tube.controls]),
        motion=np.concatenate([swimmer.motion, tube.motion]),
        of_tail=np.concatenate([swimmer.of_tail, tube.of_tail]),
        inner=inner,
        vessel=vessel,
        closed=closed,
    )


#: Radii from the swimmer at which a longer closed tube is closed: 2e-6 comes back.
BEYOND = 2.5


def _ends(channel: Channel, along: Array) -> tuple[float, float]:
    """Ends of the tube that is solved, for places (n,) of the swimmer along its axis."""
    half, beyond = 0.5 * channel.length, BEYOND * 0.5 * channel.diameter
    if channel.ends == "open":
        return -half, half
    return max(-half, float(along.min()) - beyond), min(half, float(along.max()) + beyond)


def _patches(
    channel: Channel, middle: Array, order: int, sides: Sides, ends: tuple[float, float]
) -> Array:
    """Positions (e, q, q, 3) of the tube's coarsest patches.

    The fluid that the swimmer pushes ahead passes it again: the tube must hold it tightly, all the
    way round, or the drag is too small.
    """
    radius = 0.5 * channel.diameter
    pieces = max(2, int(np.ceil((ends[1] - ends[0]) / (sides.along * radius))))
    around = sides.around // order

    def side(u: Array, v: Array) -> Array:
        return np.stack([u, radius * np.cos(v), radius * np.sin(v)], axis=-1)

    boxes = grid_boxes(np.linspace(*ends, pieces + 1), 2.0 * np.pi * np.arange(around + 1) / around)
    parts = [sample(side, boxes)]
    if channel.ends == "closed":
        unit = grid_boxes(np.array([-1.0, 1.0]), np.array([-1.0, 1.0]))
        for end, at in zip((-1.0, 1.0), ends, strict=True):
            parts.append(sample(partial(_centre, at, radius, end), unit))
            parts += [sample(partial(_rim, at, radius, k, end), unit) for k in range(4)]
    return middle + np.concatenate(parts) @ channel.axes.T


#: Half side of the square in the middle of a disc of radius 1.
SQUARE = 0.45


def _centre(at: float, radius: float, end: float, u: Array, v: Array) -> Array:
    """Square in the middle of the disc at one end; its normal points inwards."""
    return np.stack([at + 0.0 * u, SQUARE * radius * u, -end * SQUARE * radius * v], axis=-1)


def _rim(at: float, radius: float, quarter: int, end: float, u: Array, v: Array) -> Array:
    """What lies between one side of the square and the rim."""
    angle, t = 0.25 * np.pi * v, 0.5 * (u + 1.0)
    y = (1.0 - t) * SQUARE + t * np.cos(angle)
    z = (1.0 - t) * SQUARE * v + t * np.sin(angle)
    turn = 0.5 * np.pi * quarter
    across = y * np.cos(turn) - z * np.sin(turn), y * np.sin(turn) + z * np.cos(turn)
    return np.stack([at + 0.0 * u, radius * across[0], -end * radius * across[1]], axis=-1)
