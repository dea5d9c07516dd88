"""Motors that give a torque: how fast each turns, and how the swimmer moves.

    R(phi) V + sum_i F_i(phi) w_i = 0                 on the free axes
    F_i . V + sum_j G_ij(phi) w_j = tau_i(w_i)

the second the torque that motor i gives: constant T, or T up to a knee K and from there in a
straight line to none at its rate without load W (`Motor`). By resistive force theory R is the
body's and the sum of the tails', each at its own phase, and G is diagonal: what phases do to one
another goes through the motion of the body. By boundary elements tails feel one another's flow too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.models.rft.gait import body_resistance, tail_series
from microswim.models.rft.placed import at_own_rates, moved
from microswim.numerics.array import Array
from microswim.numerics.series.fourier import evaluate
from microswim.path.on_hooks import OnHooks, hooked
from microswim.path.torque_law import TorqueLaw
from microswim.swimmer.parts import replaced
from microswim.swimmer.physical_sense import require_drag, require_tail
from microswim.swimmer.swimmer import Swimmer


class AtPhases(Protocol):
    """What motors ask of a model."""

    def at(self, phase: Array) -> tuple[Array, Array, Array]:
        """Return R (6, 6), F (6, n) and G (n, n) at the phases (n,)."""
        ...


@dataclass(frozen=True, eq=False)
class TailsApart:
    """Tails that do not feel one another's flow.

    Parameters
    ----------
    body
        Resistance of the body (6, 6).
    tails
        Of each tail the series of ``B_t``, ``F_p`` and G in its own phase.
    """

    body: Array
    tails: tuple[tuple[Array, ...], ...]

    def at(self, phase: Array) -> tuple[Array, Array, Array]:
        """Return R (6, 6), F (6, n) and G (n, n) at the phases (n,)."""
        each = [[evaluate(s, p) for s in tail] for tail, p in zip(self.tails, phase)]
        R, F, G = zip(*each)
        return self.body + np.sum(R, axis=0), np.array(F).T, np.diag(G)


@dataclass(frozen=True, eq=False)
class Motors:
    """A swimmer of n tails, each with its own motor and phase.

    Parameters
    ----------
    law
        The torques.
    tails
        What the model says at the phases of the tails.
    model
        ``"rft"`` or ``"bem"``.
    error
        Of each velocity, ``us`` to ``or``, and of the ``rates``, and how it is known.
    """

    law: TorqueLaw
    tails: AtPhases
    model: str
    error: dict[str, Any] | None = None

    def given(self, rate: Array) -> Array:
        """Return the torque of each motor at its rate, (n,)."""
        return self.law.given(rate)

    def turning(self, phases: Array) -> tuple[Array, Array]:
        """Return twist V (6,) and rates (n,) at the phases (n,).

        Raises
        ------
        MicroswimError
            As `TorqueLaw.turning`.
        """
        return self.law.turning(*self.tails.at(phases))

    def moving(self, phases: Array, axes: Array) -> tuple[Array, Array, Array]:
        """Return twist V (6,), rates (n,), and how no axes (0, 3) move: tails stand as they are."""
        return *self.turning(phases), axes

    @property
    def axes(self) -> Array:
        """Axes that move, at the start: none, (0, 3)."""
        return np.zeros((0, 3))


def motors_of(
    swimmer: Swimmer,
    torque: Any = None,
    no_load: Any = None,
    knee: Any = None,
    **by: Any,
) -> Motors | OnHooks:
    """Return the motors of a swimmer; its own `Motor` without a torque.

    Parameters
    ----------
    swimmer, torque, no_load, knee
        As of `own_motors`.
    by
        ``model``, ``"rft"`` (default) or ``"bem"``; of the latter ``level``, ``workers`` and
        ``progress``.

    Raises
    ------
    SpecError
        If torques or rates are not one number, or one for each tail.
    MicroswimError
        If boundary elements cannot solve the tails at all their phases.
    """
    require_tail(swimmer, "motors of their own")
    if swimmer.tail.settles or swimmer.region is not None:
        raise SpecError(
            "tail: motors of given torque turn tails of a given shape, by the surrogate without a "
            "region calibration; leave [region] out, or take another kind of tail"
        )
    free = np.array(swimmer.motion.mask)
    law = TorqueLaw(free, *_laws(swimmer, len(swimmer.tail.each), torque, no_load, knee))
    model = by.pop("model", "rft")
    if swimmer.hook is not None:
        if model != "rft":
            mend = "by boundary elements tails stand as they are: remove [hook]"
            raise SpecError("model", model, '"rft" with [hook]', mend)
        require_drag(swimmer)
        return hooked(swimmer, law)
    if model == "rft":
        return Motors(law, _apart(swimmer), "rft")
    found = doors.go(doors.MOTOR_PHASES, swimmer, law.missed, **by)
    return Motors(law, found, "bem", _error_of(found))


def _apart(swimmer: Swimmer) -> TailsApart:
    """Return the tails by resistive force theory."""
    require_drag(swimmer)
    series = tuple(
        moved(tail_series(replaced(swimmer, "tail", t.own)), swimmer, t, ahead=0.0)
        for t in at_own_rates(swimmer.tail)
    )
    return TailsApart(body_resistance(swimmer), series)


def _error_of(found: Any) -> dict[str, Any]:
    """Return the errors of velocities and rates by boundary elements, and how they are known."""
    off = found.missed.max(axis=0) + found.rough.max(axis=0)
    how = (
        f"largest at {len(found.missed)} phases that had no part in the fit, and "
        f"the difference from the next coarser level at {len(found.rough)}; of speed, rate of "
        "turning, and each motor's rate"
    )
    known = dict(zip(DEGREES_OF_FREEDOM, off[:6].tolist(), strict=True))
    return {**known, "rates": off[6:].tolist(), "how": how}


def _laws(
    swimmer: Swimmer, count: int, torque: Any, no_load: Any, knee: Any
) -> tuple[Array, Array, Array]:
    """T, W and K of each motor: as given, else those of the swimmer's motor."""
    if torque is None:
        if swimmer.motor is None:
            raise SpecError("torque: missing; give it, or the swimmer a motor ([motor])")
        if no_load is not None or knee is not None:
            raise SpecError("no_load, knee: those of a torque that is given; give torque too")
        return swimmer.motor.of_each(count)
    T = one_for_each("torque", torque, count, "a torque, or one for each tail")
    W, K = np.full(count, np.inf), np.full(count, np.nan)
    allowed = "a rate other than zero (rad per time), or one for each tail"
    if no_load is not None:
        W = one_for_each("no_load", no_load, count, allowed)
        if not (W * T > 0.0).all():
            raise SpecError("no_load", no_load, "of the sign of the torque", allowed)
    if knee is not None:
        K = one_for_each("knee", knee, count, allowed)
        if not ((K * T > 0.0) & (np.abs(K) < np.abs(W)) & np.isfinite(W)).all():
            raise SpecError("knee", knee, "of the sign of the torque, and below no_load")
    return T, W, K


def one_for_each(name: str, value: Any, count: int, allowed: str) -> Array:
    """Return one number for each of n, given as one for all or one each."""
    each = list(value) if np.ndim(value) == 1 else [value] * count
    checks.numbers(name, each, count, allowed)
    return np.array(each, float)
