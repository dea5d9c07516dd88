"""Poses in a round tube that are solved: lines that its axis may be in the frame of the tail."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from microswim.calibration.poses import scattered
from microswim.calibration.poses.layout import Shape
from microswim.errors import SpecError
from microswim.gait.poses import in_tube as inside
from microswim.gait.poses.beside_wall import REACH
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.sobol import points

#: Poses at random among which each that is solved is chosen, if not told; those looked at at once.
AMONG, LOOK = 2, 2**14
#: Share of the poses of which the tail, and again of which the body is close to the tube; draws of
#: these; their least gap over their own, at which it is close no more.
CLOSE, FIRST_CLOSE, MOST_LOOKS, TOO_FAR = 0.2, 500_000, 100, 0.1


def places(
    shape: Shape, numbers: Array, radius: float, count: int, among: int, seed: int = 0
) -> tuple[Array, Array]:
    """Return lines (count, 6) and their features (count, 18), far from one another.

    Raises
    ------
    SpecError
        If the swimmer does not fit into the tube.
    """
    fit = _that_fit(shape, numbers, radius, 1000 * seed)
    lines, Z = _gathered(((found, z) for found, z, _ in fit), among)
    if not len(lines):
        raise SpecError(
            "channel.diameter", 2.0 * radius, "wide enough for the swimmer to move in it"
        )
    chosen = scattered.spread(Z[:, : inside.WHERE], count)
    return lines[chosen], Z[chosen]


def _gathered(parts: Iterable[tuple[Array, Array]], count: int) -> tuple[Array, Array]:
    """Return the first lines (count, 6) and their features, fewer where there are no more."""
    lines, Z = [np.empty((0, 6))], [np.empty((0, inside.FEATURES))]
    for some, z in parts:
        lines.append(some)
        Z.append(z)
        if sum(map(len, lines)) >= count:
            break
    return np.concatenate(lines)[:count], np.concatenate(Z)[:count]


def with_close_ones(
    shape: Shape, numbers: Array, radius: float, count: int, *, among: int = AMONG, seed: int = 0
) -> tuple[Array, Array]:
    """Return what `places` does; of a part of the poses the tail, of another the body is close.

    There velocities change most from pose to pose, and few poses at random lie there: these are
    spread evenly in the logarithm of the gap of the tail or of the body.
    """
    close, parts = int(CLOSE * count), _parts(shape)
    usual = count - close
    lines, Z = places(shape, numbers, radius, usual, among * usual, seed)
    keep = count - close * len(parts)
    lines, Z = lines[:keep], Z[:keep]
    for part in parts if close else ():
        some, z = _close(shape, numbers, radius, among * close, (part, seed))
        where = slice(0, inside.WHERE)
        chosen = scattered.spread(z[:, where], close, others=Z[:, where])
        lines, Z = np.concatenate([lines, some[chosen]]), np.concatenate([Z, z[chosen]])
    return lines, Z


#: Columns of the gaps.
BODY, TAIL = 0, 1


def _parts(shape: Shape) -> list[int]:
    """Return what of a swimmer there is."""
    return [TAIL] * bool(len(shape.tail)) + [BODY] * bool(len(shape.body))


def _close(
    shape: Shape, numbers: Array, radius: float, count: int, which: tuple[int, int]
) -> tuple[Array, Array]:
    """Return lines, and their features, of which the tail or the body is close to the tube."""
    part, seed = which
    first = FIRST_CLOSE * (2 - part) + 1000 * seed

    def near() -> Iterator[tuple[Array, Array]]:
        looks = islice(_that_fit(shape, numbers, radius, first), MOST_LOOKS + 1)
        for n, (some, z, gaps) in enumerate(looks):
            odds = numbers[inside.LEAST] / gaps[:, part]
            keep = (odds > points(LOOK, 1, first + n)[: len(some), 0]) & (odds > TOO_FAR)
            yield some[keep], z[keep]

    return _gathered(near(), count)


def _that_fit(
    shape: Shape, numbers: Array, radius: float, first: int
) -> Iterator[tuple[Array, Array, Array]]:
    """Yield lines at random that fit, their features and the gaps of body and tail."""
    widest, steep, some = radius - numbers[inside.LEAST], 1.0, False
    for more in range(400):
        found, z, gaps = _drawn(shape, numbers, radius, first + more, (widest, steep))
        fits = gaps.min(axis=1) > numbers[inside.LEAST]
        if fits.sum() < MANY and not some:  # a narrow tube: what is steep does not fit
            least = found[fits, 0].min() if fits.any() else 1.0 - steep / 4.0
            steep = min(1.5 * (1.0 - least), 0.5 * steep) if fits.any() else steep / 4.0
            if steep < 1e-9:
                widest, steep = _room(shape, numbers, radius, first)
                some = True
            continue
        some = True
        if not fits.any():
            break
        yield found[fits], z[fits], gaps[fits]


#: Lines that have to fit among those that are looked at.
MANY = 2**8


def _room(shape: Shape, numbers: Array, radius: float, first: int) -> tuple[float, float]:
    """Return how far the body's centre may be from the axis of a tight tube, and 1 - cos(tilt).

    From bounds that hold for any swimmer, then with a margin about what fits.
    """
    widest = radius - numbers[inside.LEAST] - (numbers[inside.LENGTH] if len(shape.body) else 0.0)
    slope = min(1.0, (widest + radius) / max(float(numbers[REACH]), 1e-300))
    steep = 1.0 - np.sqrt(1.0 - slope * slope)
    for _ in range(20):
        found, _, gaps = _drawn(shape, numbers, radius, first, (widest, steep))
        fits = gaps.min(axis=1) > numbers[inside.LEAST]
        if fits.sum() >= MANY:
            break
        if fits.sum() < MANY // 8:
            widest, steep = widest / 1.2, steep / 1.5
            continue
        away = np.linalg.norm(found[fits, 3:], axis=1).max()
        widest, steep = min(widest, 1.2 * away), min(steep, 1.5 * (1.0 - found[fits, 0].min()))
    return widest, steep


def _drawn(
    shape: Shape, numbers: Array, radius: float, draw: int, room: tuple[float, float]
) -> tuple[Array, Array, Array]:
    """Return lines at random, their features and the gaps of body and tail."""
    found = _lines(points(LOOK, 4, draw), *room)
    gaps, z = np.empty((len(found), 2)), np.empty((len(found), inside.FEATURES))
    with settled(True):
        inside.of_lines(found, shape.body, shape.tail, numbers, radius, gaps, z)
    return found, z, gaps


def _lines(u: Array, widest: float, steep: float) -> Array:
    """Return lines (n, 6) of points (n, 4) of the unit cube: evenly in direction and in place."""
    t0 = 1.0 - steep * u[:, 0]
    across = np.sqrt(1.0 - t0 * t0)
    c, s = np.cos(2.0 * np.pi * u[:, 1]), np.sin(2.0 * np.pi * u[:, 1])
    t = np.stack([t0, across * c, across * s], axis=-1)
    first = np.stack([-across, t0 * c, t0 * s], axis=-1)
    second = np.stack([0.0 * c, -s, c], axis=-1)
    away, turn = widest * np.sqrt(u[:, 2]), 2.0 * np.pi * u[:, 3]
    b = (away * np.cos(turn))[:, None] * first + (away * np.sin(turn))[:, None] * second
    return np.ascontiguousarray(np.concatenate([t, b], axis=-1))


def first(shape: Shape, whole: int, count: int) -> NDArray[np.int64]:
    """Return the first poses of `with_close_ones` by number, of those close in proportion."""
    if count >= whole:
        return np.arange(whole)
    parts = len(_parts(shape))
    close, of_close = int(CLOSE * count), int(CLOSE * whole)
    begins = [whole - (parts - n) * of_close for n in range(parts)]
    some = [np.arange(count - parts * close), *(k + np.arange(close) for k in begins)]
    return np.concatenate(some)
