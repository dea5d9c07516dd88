"""What became of a path: its circle, its drift, and how it ended."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.gait.units import unit
from microswim.numerics.array import Array, sealed

if TYPE_CHECKING:
    import xarray as xr

#: Turn of the path (rad) from which on it is told by a circle.
FEWEST = 0.3


def circle(points: Array) -> tuple[float, float]:
    """Return radius and signed turn (rad) of the circle through points (n, 2) of a path.

    Counterclockwise is positive. A straight line has an infinite radius and no turn. By least
    squares on the distances from the centre, which start from the algebraic fit (Kasa 1976).
    """
    middle = points.mean(axis=0)
    size = float(np.abs(points - middle).max())
    if size == 0.0 or len(points) < 3:
        return np.inf, 0.0
    P = (points - middle) / size
    A = np.column_stack([2.0 * P, np.ones(len(P))])
    found, _, rank, _ = np.linalg.lstsq(A, (P**2).sum(axis=1), rcond=1e-9)
    if rank < 3:
        return np.inf, 0.0
    centre, radius = found[:2], float(np.sqrt(max(found[2] + found[:2] @ found[:2], 0.0)))
    for _ in range(20):
        away = P - centre
        distance = np.maximum(np.linalg.norm(away, axis=1), 1e-12)
        J = np.column_stack([-away / distance[:, None], -np.ones(len(P))])
        step, *_ = np.linalg.lstsq(J, distance - radius, rcond=None)
        centre, radius = centre - step[:2], radius - float(step[2])
        if np.abs(step).max() < 1e-12:
            break
    angle = np.unwrap(np.arctan2(*(P - centre).T[::-1]))
    turn = float(angle[-1] - angle[0])
    return (np.inf, 0.0) if not np.isfinite(radius) or radius > 1e6 else (size * radius, turn)


def circling(x: Array, up: Array) -> tuple[float | None, float | None]:
    """Return radius and turn (rad) of the circle of a path (n, 3), seen from where `up` points to.

    A positive turn is counterclockwise. None twice if it turns by less than `FEWEST`, or leaves
    its plane by more than it is wide.
    """
    first = np.eye(3)[int(np.argmin(np.abs(up)))]
    first = first - (first @ up) * up
    first /= np.linalg.norm(first)
    second = np.array(np.cross(up, first), float)
    flat = np.column_stack([x @ first, x @ second])
    radius, turn = circle(flat)
    wide = np.ptp(flat, axis=0).max()
    if abs(turn) < FEWEST or np.ptp(x @ up) > max(2.0 * wide, 1e-300):
        return None, None
    return radius, turn


def winding(x: Array) -> tuple[float | None, float | None]:
    """Return mean distance and turn (rad) of a path (n, 3) that goes round the x axis.

    A positive turn is counterclockwise, seen from +x. None twice if it turns by less than
    `FEWEST`.
    """
    turn = np.unwrap(np.arctan2(x[:, 2], x[:, 1]))
    whole = float(turn[-1] - turn[0])
    if abs(whole) < FEWEST:
        return None, None
    return float(np.hypot(x[:, 1], x[:, 2]).mean()), whole


def ended(gaps: Array, least: float, length: float, reach: float, turn: float | None) -> str:
    """Return how a path ended, from its gaps in time and the least of all.

    - ``"free"``: there is no boundary, or it never came within a length of the swimmer.
    - ``"touched"``: it came within the range of the contact.
    - ``"escaped"``: it was within a length, and at the end is more than two away.
    - ``"orbits"``: it stays, and has gone round by a quarter of a circle or more.
    - ``"trapped"``: it stays, and has not.
    """
    if not least < length:
        return "free"
    if least < reach:
        return "touched"
    if gaps[-1] > 2.0 * length:
        return "escaped"
    return "orbits" if turn is not None and abs(turn) >= np.pi / 2.0 else "trapped"


def with_numbers(data: xr.Dataset, told: dict[str, Any], numbers: dict[str, Any]) -> xr.Dataset:
    """Return a path with the further series `told` and its numbers as attributes."""
    kinds = {"gap": "length", "motor_work": "work", "dissipated": "work"}
    means = {
        "gap": "distance of the surface from the boundary",
        "motor_work": "work of the motor since the start",
        "dissipated": "heat given to the fluid since the start",
    }
    for name, values in told.items():
        dims = ("path", "time") if np.ndim(values) == 2 else ("time",)
        about = {"units": unit(data.attrs["units"], kinds[name]), "long_name": means[name]}
        data[name] = (dims, values, about)
    return sealed(data.assign_attrs(numbers))
