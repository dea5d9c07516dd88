"""The short-range repulsion that keeps a swimmer off a boundary; of paths, steps and environments.

    F e^-d / (1 - e^-d),   d = gap / range,   along the normal at the nearest point

It bears any load f at the gap ``range log(1 + F / f)``. So F is the largest of what may press just
then: thrust, force (weight and the pull of a field among it), torque over a length of the swimmer,
and the drag in the flow; where nothing of these is, what noise presses with, k_B T / range.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.gait.stepping import length_of
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import compiled
from microswim.swimmer.swimmer import Swimmer

#: Range of the repulsion, of the body's girth; what is further off than so many ranges has none.
RANGE, FAR = 0.01, 40.0
#: Entries of `repulsion`.
REACH, THRUST, LENGTH, DRAG, NOISE = range(5)


def repulsion(swimmer: Swimmer, gait: Gait, reach: float | None = None) -> Array:
    """Return what the size of a swimmer's repulsion is made of, (5,).

    Range; thrust per rate of the motor; a length; drag per velocity; k_B T over the range.

    Parameters
    ----------
    swimmer
        Its body or tail and its noise.
    gait
        In free fluid.
    reach
        The range (length).
    """
    phases = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    thrust = np.linalg.norm(np.real(gait.propulsion(phases)[:, :3]), axis=1).max()
    drag = np.linalg.norm(np.real(gait.resistance(0.0))[:3, :3], 2)
    far = _reach(swimmer) if reach is None else float(reach)
    noise = 0.0 if swimmer.noise is None else swimmer.noise.energy(swimmer.units)
    return np.array([far, thrust, length_of(gait), drag, noise / far])


def _reach(swimmer: Swimmer) -> float:
    girth = max(np.real(np.array(swimmer.body.semi_axes3, float)[1:])) or float(swimmer.tail.radius)
    return RANGE * float(girth)


@compiled()
def pressing(contact: Any, W: Any, rate: Any, u: Any, G: Any) -> Any:
    """Return F: of wrench W (6,) without a flow, motor's rate, flow u and its gradient G (3, 3)."""
    force, torque, speed, bend = 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        force += W[i] * W[i]
        torque += W[3 + i] * W[3 + i]
        speed += u[i] * u[i]
        for j in range(3):
            bend += G[i, j] * G[i, j]
    length = contact[LENGTH]
    F = max(np.sqrt(force), np.sqrt(torque) / length, contact[THRUST] * abs(rate))
    F = max(F, contact[DRAG] * (np.sqrt(speed) + length * np.sqrt(bend)))
    return F if F > 0.0 else contact[NOISE]


@compiled()
def cross_to(W: Any, k: int, a: Any, b0: Any, b1: Any, b2: Any) -> None:
    """Add ``a x b`` to W[k:k+3]."""
    W[k] += a[1] * b2 - a[2] * b1
    W[k + 1] += a[2] * b0 - a[0] * b2
    W[k + 2] += a[0] * b1 - a[1] * b0


@compiled()
def add_contact(contact: Any, touch: Any, W: Any, rate: Any, u: Any, G: Any) -> None:
    """Add the repulsion of body and tail, `touch` (14,), to the wrench W of everything else."""
    near = FAR * contact[REACH]
    if not min(touch[0], touch[7]) < near:
        return
    F = pressing(contact, W, rate, u, G)
    for part in (0, 7):
        if touch[part] < near:
            close = np.exp(-touch[part] / contact[REACH])
            push = F * close / (1.0 - close)
            for i in range(3):
                W[i] += push * touch[part + 4 + i]
                W[3 + i] += push * touch[part + 1 + i]
