"""Loads beyond which a straight filament no longer stands: it buckles, or it flutters.

Linearised about the straight filament a disturbance follows ``M dq/dt + G(load) q = 0``; the least
load at which an eigenvalue of ``-M^-1 G`` gets a positive real part is the threshold. It buckles
where that eigenvalue is real. Where it is one of a pair, the filament beats: a follower force,
which turns with the tangent, has no energy, and drag alone decides when.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from scipy.optimize import brentq
from threadpoolctl import threadpool_limits

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.models.elastic.plane import Base, Loads, balance
from microswim.models.elastic.problem import Problem, elastic_tail, problem
from microswim.models.elastic.rod import rod
from microswim.models.elastic.speeding import critical
from microswim.swimmer.geometry.tails.elastic.elastic_tail import ElasticTail
from microswim.swimmer.swimmer import Swimmer

Pull = Literal["tip", "along", "end", "weight", "motor"]
#: Powers of L that turn ``B / L^n`` into each load.
POWER = {"tip": 2, "end": 2, "along": 3, "weight": 3}
LARGEST, STEPS, MODES = 1e3, 400, 16
GROWS = 1e-6
HELD = np.zeros(1)


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Threshold:
    """Load at which a straight filament begins to move.

    Parameters
    ----------
    load
        A force, a force per length, or the motor's torque.
    rate
        Angular frequency (rad per time) of what begins there, of a tail that turns in the axes
        that turn with it; 0 where it buckles.
    motor_rate
        Rate of the motor (rad per time) with that torque; None where no motor turns it.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Threshold(load=1.0, rate=0.0).flutters
    False
    """

    load: float
    rate: float
    motor_rate: float | None = None

    @property
    def flutters(self) -> bool:
        """Whether it begins to beat rather than to bend aside."""
        return self.rate != 0.0


@checks.given(swimmer=checks.swimmer, load=checks.one_of(*get_args(Pull)))
@threadpool_limits.wrap(limits=1)  # small matrices
def stability(swimmer: Swimmer, load: Pull = "tip") -> Threshold:
    """Return the load that the shape of an elastic tail does not survive.

    Parameters
    ----------
    swimmer
        With an `ElasticTail`, held or free as its `motion` says; its drive counts for the load
        ``"motor"`` alone.
    load
        Towards the base: ``"tip"``, a force at the free end that follows the tangent there;
        ``"along"``, such a force per length; ``"end"`` and ``"weight"``, the same with a fixed
        direction along s. ``"motor"``: the torque of a motor that speeds up from rest and turns
        the tail about s, with its tilt, its hook and its shape at rest; a straight tail whirls, a
        tilted one jumps to a helix, a hook buckles.

    Returns
    -------
    Threshold
        Load and angular frequency, in the swimmer's units.

    Raises
    ------
    SpecError
        If the tail is not elastic, or bent at rest where not a motor turns it, or the load is none
        of these.
    MicroswimError
        If the shape survives any load up to 1000 ``B / L^2`` (or per length).

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.ElasticTail(length=1.0, radius=0.01, bending=1.0, drive="none")
    >>> swimmer = ms.Swimmer(
    ...     body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0),
    ...     motion=ms.Motion(free="none"),
    ... )
    >>> round(ms.stability(swimmer, "tip").load, 2)
    37.7
    """
    tail = elastic_tail(swimmer)
    if load == "motor":
        if not tail.turns:
            raise SpecError("tail.drive", tail.drive, '"rotate" for the load motor')
        motor_rate, torque, beats = critical(swimmer)
        return Threshold(load=torque, rate=beats, motor_rate=motor_rate)
    if tail.is_bent:
        raise SpecError("tail.rest", "bent", f'straight for the load "{load}"',
                        'or take the load "motor"')  # fmt: skip
    made = problem(swimmer)
    loads = np.linspace(0.0, LARGEST, STEPS + 1)[1:]
    below = 0.0
    for above in loads:
        if _fastest(made, load, above).real > GROWS * made.drag.normal**-1:
            break
        below = above
    else:
        raise MicroswimError(f"the straight tail survives any load up to {LARGEST:g} B / L^2")
    root: Any = brentq(lambda x: _fastest(made, load, float(x)).real, below, above, xtol=1e-10)
    at = float(root)
    return _in_units(tail, load, at, _fastest(made, load, at * (1.0 + 1e-9)))


def _in_units(tail: ElasticTail, load: Pull, at: float, root: complex) -> Threshold:
    unit = tail.bending / tail.length ** POWER[load]
    rate = abs(root.imag) * abs(tail.rate)
    return Threshold(load=at * unit, rate=rate if rate > GROWS * abs(tail.rate) else 0.0)


def _fastest(made: Problem, load: Pull, size: float) -> complex:
    """Eigenvalue of the largest real part, in units of the phase rate."""
    shapes = rod(MODES, made.turning)
    f = len(made.drag.free)
    loads = Loads(
        tip=size * (load == "tip"),
        along=size * (load == "along"),
        end=(-size * (load == "end"), 0.0),
        weight=(-size * (load == "weight"), 0.0),
    )
    q, w = np.zeros((1, shapes.count)), np.zeros((1, f + shapes.count))
    at = balance(shapes, made.drag, Base(HELD, HELD, HELD, HELD), q, w, loads, 0.0 * q)
    values = np.linalg.eigvals(-np.linalg.solve(at.resistance[0], at.stiffness[0])[f:])
    return complex(values[np.argmax(values.real)])
