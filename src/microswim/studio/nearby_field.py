"""The magnetic field about a place, as the page reads it: B over a box and a while.

    B(t, x) = sum a_n(t) T_i(u) T_j(v) T_k(w) B_nijk      (u, v, w) = (x - centre) / half

T are Chebyshev polynomials through B at their nodes; the gradient is that of the sum. In time
``a = 1, cos(w t), sin(w t)`` where the field is such a wave at each place, else it is straight
between samples over a while. Box and while shrink until B agrees between the nodes.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.numerics.array import Array
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.magnetism.field_in_space import FieldInSpace

TOLERANCE = 5e-5  #: of B over the box, relative; of its gradient the same of B over half the box
IN_TIME = 3e-4  #: of B between samples in time, relative
NODES = {"wave": 6, "samples": 4}  #: along each axis
SAMPLES = 65
LONGEST, HALVINGS = 4096.0, 48  #: seconds, at first
SMALLER = 0.7
REACH = 20.0  #: half of the box at first, in lengths of the swimmer


def nearby(field: AppliedField, time: float, place: Any, length: float) -> dict[str, Any]:
    """Return a field about a place from a time on, ready for JSON.

    Parameters
    ----------
    field
        Of any kind.
    time, place
        When, and where (3,), lab frame.
    length
        Of the swimmer.

    Raises
    ------
    MicroswimError
        If the field is not known there.
    """
    with np.errstate(all="ignore"):  # in a magnet there is no field, which is said
        return _nearby(field, time, np.asarray(place, float), length)


def _nearby(field: AppliedField, time: float, place: Array, length: float) -> dict[str, Any]:
    kind, span = _in_time(field, time, place)
    in_space = isinstance(field, FieldInSpace)
    nodes, half = (NODES[kind], _half(field, time, place, length)) if in_space else (1, 1.0)
    for _ in range(HALVINGS):
        values = _coefficients(field, kind, time, span, place, half, nodes)
        if values is not None:
            made = {
                "kind": kind,
                "rate": float(field.rate),
                "from": time,
                "span": span,
                "centre": place.tolist(),
                "half": half if in_space else None,
                "nodes": nodes,
                "values": [float(f"{v:.11g}") for v in values.ravel()],
            }
            if not in_space or _is_good(field, made, values):
                return made
        half *= SMALLER
    raise _unknown(place)


def at(made: dict[str, Any], time: float, places: Any) -> tuple[Array, Array]:
    """Return B (n, 3) and ``dB_i/dx_j`` (n, 3, 3) of what `nearby` returned, as the page does."""
    n, half = made["nodes"], made["half"] or 1.0
    values = np.reshape(made["values"], (-1, n, n, n, 3))
    u = (np.asarray(places, float) - made["centre"]) / half * bool(made["half"])
    now = np.tensordot(_weights(made, time, len(values)), values, 1)
    T = np.polynomial.chebyshev.chebvander(u, n - 1)  # (places, 3, n)
    slopes = np.polynomial.chebyshev.chebder(np.eye(n)) if n > 1 else np.zeros((1, 1))
    D = np.moveaxis(np.polynomial.chebyshev.chebval(u, slopes), 0, -1) / half

    def summed(*of: Array) -> Array:
        first = np.tensordot(of[0][:, 0], now, 1)
        return np.einsum("pk,pkc->pc", of[2][:, 2], np.einsum("pj,pjkc->pkc", of[1][:, 1], first))

    return summed(T, T, T), np.stack([summed(D, T, T), summed(T, D, T), summed(T, T, D)], axis=-1)


def _weights(made: dict[str, Any], time: float, count: int) -> Array:
    if made["kind"] == "wave":
        angle = made["rate"] * time
        return np.array([1.0, np.cos(angle), np.sin(angle)])[:count]
    x = np.clip((time - made["from"]) / made["span"], 0.0, 1.0) * (count - 1)
    return np.maximum(0.0, 1.0 - np.abs(x - np.arange(count)))


def _half(field: AppliedField, time: float, place: Array, length: float) -> float:
    """Return half of the box at first: a part of the way over which the field changes."""
    B, J = field.at(time, place), field.gradient(time, place)
    way = np.linalg.norm(B) / max(float(np.linalg.norm(J)), 1e-300)
    return float(min(REACH * length, max(0.4 * way, length)))  # the field may vanish at a place


def _in_time(field: AppliedField, time: float, place: Array) -> tuple[str, float | None]:
    """Return how B goes at a place in time, and for how long samples of it are good."""
    some = time + LONGEST * np.array([0.0, 1e-5, 3e-4, 0.011, 0.13, 0.7, 1.0])
    if field.rate:
        some = np.append(some, time + np.array([0.1, 0.23, 0.37, 0.61, 0.89]) * 6.0 / field.rate)
    a = _waves(field, time, place[None])[:, 0]
    angle = field.rate * some[:, None]
    size = np.abs(a).max()
    if not np.isfinite(size):
        raise _unknown(place)
    off = a[0] - field.at(some, place)
    if len(a) > 1:
        off = off + a[1] * np.cos(angle) + a[2] * np.sin(angle)
    if np.abs(off).max() <= 1e-9 * size:
        return "wave", None
    span = min(LONGEST, 2.0 / field.rate) if field.rate else LONGEST
    for _ in range(HALVINGS):
        t = time + span * np.linspace(0.0, 1.0, 2 * SAMPLES - 1)
        B = field.at(t, place)
        off = np.abs(B[1::2] - (B[:-2:2] + B[2::2]) / 2.0).max()
        if off <= IN_TIME * np.abs(B).max():
            return "samples", span
        span /= 2.0
    raise _unknown(place)


def _waves(field: AppliedField, time: float, places: Array) -> Array:
    """Return B_0 (, B_1, B_2) at places (n, 3): (1 or 3, n, 3)."""
    if not field.rate:
        return np.broadcast_to(field.at(time, places), places.shape)[None]
    turn = 2.0 * np.pi / field.rate
    start, quarter, half = (
        np.broadcast_to(field.at(share * turn, places), places.shape) for share in (0.0, 0.25, 0.5)
    )
    mean = (start + half) / 2.0
    return np.stack([mean, (start - half) / 2.0, quarter - mean])


def _coefficients(
    field: AppliedField, kind: str, time: float, span: float | None, place: Array, half: float,
    nodes: int,
) -> Array | None:  # fmt: skip
    """Return coefficients (times, n, n, n, 3); None where the field is not known all over."""
    u = np.cos(np.pi * (np.arange(nodes) + 0.5) / nodes) if nodes > 1 else np.zeros(1)
    inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(u, nodes - 1))
    places = np.stack(np.meshgrid(u, u, u, indexing="ij"), axis=-1).reshape(-1, 3) * half + place
    try:
        if kind == "wave":
            B = _waves(field, time, places)
        else:
            times = time + (span or 0.0) * np.linspace(0.0, 1.0, SAMPLES)
            B = field.at(times[:, None], places)
    except MicroswimError:
        return None
    if not np.isfinite(B).all():
        return None
    B = np.broadcast_to(B, (len(B), *places.shape)).reshape(-1, nodes, nodes, nodes, 3)
    for axis in (1, 2, 3):
        B = np.moveaxis(np.tensordot(inverse, B, (1, axis)), 0, axis)
    return B


def _is_good(field: AppliedField, made: dict[str, Any], values: Array) -> bool:
    """Return whether B and its gradient agree at places between the nodes and on the rim."""
    random = np.random.default_rng(7)
    u = np.concatenate([random.uniform(-1.0, 1.0, (12, 3)), np.sign(random.normal(size=(4, 3)))])
    places, time = np.array(made["centre"]) + made["half"] * u, made["from"]
    if not np.isfinite(values).all():
        return False
    try:
        B, J = field.at(time, places), field.gradient(time, places)
    except MicroswimError:
        return False
    found = at(made, time, places)
    off = max(np.abs(found[0] - B).max(), made["half"] * np.abs(found[1] - J).max())
    return bool(off <= TOLERANCE * np.linalg.norm(B, axis=-1).max())


def _unknown(place: Array) -> MicroswimError:
    at_place = ", ".join(f"{x:.4g}" for x in place)
    return MicroswimError(f"the field is not known about the place {at_place} (m)")
