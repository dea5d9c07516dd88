"""All loads of a swimmer as the arrays that the compiled path reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.numerics.array import Array
from microswim.numerics.series.fourier import series_of, trimmed
from microswim.path import strain
from microswim.path.contact import repulsion
from microswim.path.velocity import CURVED, LINEAR, STILL, Loads
from microswim.swimmer.magnetism.applied_field import AppliedField, unit
from microswim.swimmer.magnetism.magnet import magnetic_of
from microswim.swimmer.surroundings import weight
from microswim.swimmer.surroundings.flow import Flow, PoiseuilleFlow
from microswim.swimmer.swimmer import Swimmer

FINEST = 512


def loads_of(
    swimmer: Swimmer, gait: Gait, force: Any = (0, 0, 0), torque: Any = (0, 0, 0), reach: Any = None
) -> Loads:
    """Return the loads on a swimmer.

    Parameters
    ----------
    swimmer
        Its magnet, field, gravity and flow; of a field that depends on place the moment alone.
    gait
        Its rate and free axes.
    force, torque
        Further ones, constant, lab frame (3,).
    reach
        Range of the repulsion between swimmer and boundary (length).
    """
    magnetic = swimmer.magnet is not None and swimmer.field is not None
    bends = _bends(swimmer.flow)
    flow = swimmer.flow
    return Loads(
        rate=float(np.real(gait.rate)),
        free=np.array(gait.free),
        force=np.asarray(force, float) + weight.pull(swimmer),
        torque=np.array(torque, float),
        gravity=np.zeros(3) if swimmer.gravity is None else swimmer.gravity.vector,
        arm=periodic(lambda p: weight.arm(swimmer, p), swimmer.gravity is not None, 3),
        magnetic=magnetic_of(swimmer.magnet if magnetic else None),
        field=_waves(swimmer.field) if magnetic else np.zeros((3, 3)),
        field_rate=float(swimmer.field.rate) if magnetic else 0.0,  # type: ignore[union-attr]
        flow=np.zeros(3) if flow is None or bends == CURVED else flow.at_origin,
        gradient=np.zeros((3, 3)) if flow is None else flow.gradient,
        tube=_tube(flow),
        bends=bends,
        strain=periodic(lambda p: strain.coupling(swimmer, p)[0].reshape(-1, 36), bends, 36),
        curved=periodic(
            lambda p: strain.curved_coupling(swimmer, p).reshape(-1, 108), bends == CURVED, 108
        ),
        activity=np.ascontiguousarray(np.real(gait.activity_series)[:, None]),
        contact=repulsion(swimmer, gait, reach),
    )


def periodic(function: Callable[[Array], Array], wanted: Any, width: int) -> Array:
    """Return the series (1 + 2 H, width) of a function of phases (n,) to (n, width); or zeros."""
    if not wanted:
        return np.zeros((1, width))
    n = 16
    while True:
        series = series_of(function(2.0 * np.pi * np.arange(n) / n))
        size = np.abs(series).max(axis=0)
        small = np.abs(series[-4:]) <= 1e-13 * np.where(size > 0, size.max(), 1.0)
        if small.all() or n >= FINEST:
            return np.ascontiguousarray(trimmed(series))
        n *= 2


def _waves(field: AppliedField | None) -> Array:
    """Rows B_0, B_1, B_2 of ``B_0 + B_1 cos(w t) + B_2 sin(w t)``."""
    if field is None or not field.is_periodic:  # the path asks such a field where it is
        return np.zeros((3, 3))
    if not field.rate:
        return np.array([field.at(0.0), np.zeros(3), np.zeros(3)])
    turn = 2.0 * np.pi / field.rate
    start, quarter, half = (field.at(share * turn) for share in (0.0, 0.25, 0.5))
    mean = (start + half) / 2.0
    return np.array([mean, (start - half) / 2.0, quarter - mean])


def _bends(flow: Flow | None) -> int:
    if flow is None:
        return STILL
    return CURVED if flow.bends else (LINEAR if flow.gradient.any() else STILL)


def _tube(flow: Flow | None) -> Array:
    if not isinstance(flow, PoiseuilleFlow):
        return np.zeros(8)
    return np.concatenate([unit(flow.axis), flow.centre, [flow.speed, (2.0 / flow.diameter) ** 2]])


def left_out(swimmer: Swimmer) -> list[str]:
    """Return what of its spec does not act on a path as it would in a fluid, in words."""
    said = []
    held = [n for n, free in zip(DEGREES_OF_FREEDOM, swimmer.motion.mask) if not free]
    if held:
        said.append(
            f"motion.free holds {', '.join(held)}: in these the swimmer goes with the fluid, and "
            "neither load nor noise moves it"
        )
    if swimmer.channel is not None:
        said.append("the tube is taken as endless: its ends and its length do not act")
        return said
    if swimmer.flow is not None and (swimmer.flow.gradient.any() or swimmer.flow.bends):
        said.append(
            "what a strain of the flow does to the tail is at the level of local drag, the body "
            "is taken alone; turning with the flow is exact"
        )
    return said
