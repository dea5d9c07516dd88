"""The motor rate beyond which a turning tail no longer keeps its shape: it whirls, or jumps.

The motor speeds up in small steps from rest, and the tail follows as `whirl` finds it. The first
rate at which a disturbance grows, the torque no longer rises, or beyond which no shape that turns
as a whole is near, is the threshold: a straight rod whirls (Wolgemuth, Powers & Goldstein 2000), a
tilted one jumps to a helix (Qian, Powers & Breuer 2008), a hook buckles and the cell flicks (Son,
Guasto & Stocker 2013).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.elastic.whirl import (
    FIRST,
    Whirl,
    drag_in_space,
    elastic_tail,
    filament_of,
    settled_at,
    slowed,
)
from microswim.swimmer.swimmer import Swimmer

SLOW, LARGEST = 1e-2, 1e7  #: from and to which ``w c_n L^4 / B``, and its share
FASTER, FINEST = 1.15, 1e-5
GROWS = 1e-6  #: of the bending rate, from which on a disturbance grows


def critical(swimmer: Swimmer) -> tuple[float, float, float]:
    """Return the motor rate at which a turning tail gives way, its torque, and the rate of what
    begins there in the axes that turn with it (zero: it bends aside).

    Raises
    ------
    MicroswimError
        If it keeps its shape at any rate.
    """
    tail = elastic_tail(swimmer)
    drag = drag_in_space(swimmer)
    rest = tail.rest_shape
    n = max(FIRST + 4, 0 if rest is None else rest.modes() + 4)
    rod = filament_of(swimmer, n)
    rate = float(np.sign(np.real(tail.rate))) or 1.0
    at = Whirl(drag, rod, rate, rod.rest, np.zeros(6), 0)
    share, faster = SLOW / float(np.real(drag.normal)), FASTER
    first = settled_at(replace(at, drag=slowed(drag, share)))
    at = at if first is None else first
    while share < LARGEST:
        found = settled_at(replace(at, drag=slowed(drag, share * faster)))
        if found is not None and not _grows(found) and torque_of(found) > torque_of(at):
            at, share = found, share * faster
            continue
        if faster - 1.0 < FINEST:
            break
        faster = faster**0.5
    else:
        raise MicroswimError("the turning tail keeps its shape at any rate of the motor")
    grows = found is not None and _grows(found)
    root = found.rates[np.argmax(np.real(found.rates))] if found is not None and grows else 0.0
    torque = torque_of(at) * float(np.real(tail.bending / tail.length))
    speed = abs(float(np.real(tail.rate)))
    beats = abs(np.imag(root)) * share * speed
    return share * speed, torque, float(beats)


def _grows(found: Whirl) -> bool:
    size = float(np.real(found.drag.normal))
    return bool(np.real(found.rates).max() * size > GROWS)


def torque_of(found: Whirl) -> float:
    """Return the torque (``B / L``) that the motor gives about s."""
    at, rate, drag = found.pose, found.rate, found.drag
    whole = found.velocity[3:] + rate * np.array([1.0, 0.0, 0.0])
    X = at.place + drag.offset * np.array([1.0, 0.0, 0.0])
    v = found.velocity[:3] + np.cross(found.velocity[3:], X)
    v = v + rate * np.cross(np.array([1.0, 0.0, 0.0]), at.place)
    t = at.directors[:, 2]
    W_t, W_n, W_r = drag.along(found.rod)
    f = W_n[:, None] * v + ((W_t - W_n) * (t * v).sum(axis=1))[:, None] * t
    m = (W_r * (t @ whole))[:, None] * t
    return float(rate * np.real(np.cross(at.place, f) + m).sum(axis=0)[0])
