"""Which regime a magnetic robot is in at each frequency of a field that turns.

The robot is rigid: its motor, if it has one, stands still at phase 0. All steady states are those
of `microswim.gait.turning.steady_turning`; beyond step-out its path is followed in time.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import brentq

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.turning.long_axis import seen_along
from microswim.gait.turning.slipping import drift
from microswim.gait.turning.soft_turning import SoftTurning
from microswim.gait.turning.steady_turning import SteadyTurning, Turned
from microswim.gait.turning.step_out import mobility_of
from microswim.gait.turning.wobbling import Axisymmetric, closest, closest_soft
from microswim.numerics.array import Array, read_only
from microswim.path.regime_errors import expected, expected_of_elastic
from microswim.path.regime_portrait import Told
from microswim.path.regime_remarks import long_axis_of, of_inertia, remarks_of, reynolds_of
from microswim.swimmer.in_units import in_its_units
from microswim.swimmer.magnetism.applied_field import RotatingField
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEEP = np.radians(45.0)  #: precession angle above which a robot below the onset tumbles
STRAIGHT = np.radians(5.0)  #: of the axis: synchronous; of the plane of the field: tumbling


@checks.by_name
@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
@read_only
class Regimes(Told):
    """What a magnetic robot does at each frequency of the field.

    Parameters
    ----------
    frequency
        Turns of the field per time, (n,).
    regime
        For each ``"tumbling"``, ``"wobbling"``, ``"synchronous"``, ``"stepped out"`` or, held
        at no frequency, ``"not held"``.
    precession_angle
        Angle (rad) between the robot's long axis and the field's; NaN without a steady state.
    velocity
        Mean velocity along the field's axis, positive along it.
    velocity_error
        How well that is known: rounding in a steady state, beyond step-out the difference of two
        halves of the path. The model's own error is not in it.
    others
        Other states that the robot can be held in at this frequency: precession angle and velocity
        of each.
    step_out, wobbling_onset
        Turns of the field per time; the second NaN for a field that leans out of its plane.
    velocity_at_step_out
        Along the field's axis.
    reversals
        Frequencies at which the velocity changes its sign.
    reynolds
        Reynolds number of the turning, ``rho w a^2 / mu`` with a the largest distance of its
        surface from the axis, (n,).
    closed_form
        Closed forms of the axisymmetric robot next to it; None where it is too far from one, or
        the field leans out of its plane.
    expected_error
        Relative errors of ``step_out`` and ``velocity`` by the model of the gait, None where they
        are not known, and ``how`` they are known.
    units, model, remarks
        ``"SI"`` or ``"dimensionless"``, what made the gait, and what there is to say.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix-constant", {"motion.free": "all",
    ...     "magnet": {"moment": [0, 1, 0]},
    ...     "field": {"kind": "rotating", "strength": 60.0, "frequency": 0.1}})
    >>> found = ms.regimes(robot, [0.01], model="rft")
    >>> round(found.step_out, 4), found.reversals
    (0.0262, ())
    """

    frequency: Array
    regime: tuple[str, ...]
    precession_angle: Array
    velocity: Array
    velocity_error: Array
    others: tuple[tuple[tuple[float, float], ...], ...]
    step_out: float
    wobbling_onset: float
    velocity_at_step_out: float
    reversals: tuple[float, ...]
    reynolds: Array
    closed_form: Axisymmetric | None
    expected_error: dict[str, Any]
    units: str
    model: str
    remarks: tuple[str, ...] = field(default=())

    def as_dict(self) -> dict[str, Any]:
        """Return everything by name, closed forms in turns per time."""
        found = {n: getattr(self, n) for n in self.__dataclass_fields__ if n != "closed_form"}
        exact, turn = self.closed_form, 2.0 * np.pi
        found["closed_form"] = exact and {
            "wobbling_onset": exact.wobbling_onset / turn,
            "step_out": exact.step_out / turn,
            "precession_angle": exact.precession_angle(turn * self.frequency),
            "asymmetry": exact.asymmetry,
        }
        return found

    def plot(self) -> Figure:
        """Draw velocity and precession angle over the frequency; call its ``savefig``.

        Examples
        --------
        >>> import microswim as ms
        >>> robot = ms.Swimmer.preset("tabak/helix", {"motion.free": "all",
        ...     "magnet": {"moment": [0, 1, 0]},
        ...     "field": {"kind": "rotating", "strength": 60.0, "frequency": 0.1}})
        >>> ms.regimes(robot, [0.005, 0.01], model="rft").plot().axes[0].get_ylabel()
        'velocity along the axis'
        """
        return doors.go(doors.PLOT_REGIMES, self)


@checks.given(swimmer=checks.swimmer, frequency=checks.series, model=checks.text,
              gait=checks.gait, level=checks.one_of("coarse", "standard", "fine"))  # fmt: skip
@in_its_units
def regimes(
    swimmer: Swimmer, frequency: Any, *, model: doors.Model = "auto", gait: Gait | None = None,
    level: doors.Level | None = None,
) -> Regimes:  # fmt: skip
    """Return what a robot with a magnet does in a rotating field, frequency by frequency.

    Parameters
    ----------
    swimmer
        With a `Magnet`, permanent or soft, and a `RotatingField`, whose strength, axis, sense and
        cone count; all its rotations free. Its motor stands still at phase 0. An `ElasticTail`,
        without a drive, bends as it turns, and may be what is magnetic.
    frequency
        Turns of the field per time, positive, (n,).
    model
        Of the gait; of a robot that bends ``"elastic"``, ``"auto"``, or ``"bem"``, which solves the
        flow about the shape in which local drag holds it.
    gait, level
        A gait of the swimmer that is at hand, in place of the model; of its elements.

    Returns
    -------
    Regimes
        Where several states are held, that which is reached by raising the frequency slowly.

    Raises
    ------
    SpecError
        If the swimmer has no magnet, its field does not rotate, or a rotation is held.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix-constant", {"motion.free": "all",
    ...     "magnet": {"moment": [0.5, 0.9, 0]},
    ...     "field": {"kind": "rotating", "strength": 60.0, "frequency": 0.1}})
    >>> ms.regimes(robot, [0.0005, 0.004, 0.1], model="rft").regime
    ('tumbling', 'wobbling', 'stepped out')
    """
    frequencies = _frequencies(frequency)
    options: Any = {} if level is None else {"level": level}
    if swimmer.tail.settles:
        checks.choice("model", model, ("auto", "elastic", "bem"))
        doors.check_options(model if model == "bem" else "elastic", options)
        return _of_elastic(swimmer, frequencies, (model, options) if model == "bem" else None)
    steady = steady_turning(swimmer, gait := gait or swimmer.gait(model, **options))
    sense = float(np.sign(swimmer.field.frequency))  # type: ignore[union-attr]
    rates = 2.0 * np.pi * frequencies
    held = [_distinct(steady.states(rate)) for rate in rates]
    found = [_one(steady, rate, states) for rate, states in zip(rates, held)]
    angle, velocity, error = (np.array(column) for column in zip(*(f[1:] for f in found)))
    at_most = steady.at_step_out
    axis = long_axis_of(swimmer, gait)
    reynolds = reynolds_of(swimmer, rates, angle, axis)
    return Regimes(
        frequency=frequencies,
        regime=tuple(f[0] for f in found),
        precession_angle=angle,
        velocity=sense * velocity,
        velocity_error=error,
        others=tuple(
            tuple((float(s.precession_angle), sense * float(s.velocity)) for s in states[1:])
            for states in held
        ),
        step_out=steady.step_out / (2.0 * np.pi),
        wobbling_onset=steady.wobbling_onset / (2.0 * np.pi),
        velocity_at_step_out=sense * float(at_most.velocity) if at_most else float("nan"),
        reversals=_reversals(steady, rates, held),
        reynolds=reynolds,
        closed_form=_closed(steady),
        expected_error=expected(swimmer, gait),
        units=swimmer.units,
        model=gait.model,
        remarks=tuple(remarks_of(gait, steady, frequencies, reynolds, axis)),
    )


def _of_elastic(swimmer: Swimmer, frequencies: Array, judge: Any) -> Regimes:
    from microswim.path.elastic_regimes import held_at

    found, rates = held_at(swimmer, frequencies, judge), 2.0 * np.pi * frequencies
    reynolds, nought = reynolds_of(swimmer, rates, found.angle), np.isnan(found.angle)
    names = ["stepped out" if out else _named(a) for a, out in zip(found.angle, nought)]
    return Regimes(
        frequency=frequencies, regime=tuple(names), precession_angle=found.angle,
        velocity=found.velocity, velocity_error=found.error, others=((),) * len(frequencies),
        step_out=found.step_out, wobbling_onset=float("nan"),
        velocity_at_step_out=found.at_step_out, reversals=(), reynolds=reynolds, closed_form=None,
        expected_error=expected_of_elastic(swimmer, judge, found.torque), units=swimmer.units,
        model="elastic" if judge is None else judge[0],
        remarks=(*found.remarks, *of_inertia(frequencies, reynolds, swimmer.units)),
    )  # fmt: skip


def steady_turning(swimmer: Swimmer, gait: Gait) -> SteadyTurning:
    """Return the steady states of a robot in its rotating field, seen along its long axis.

    Raises
    ------
    SpecError
        If it has no magnet, its field does not rotate, or a rotation is held.
    """
    magnet, applied = swimmer.magnet, swimmer.field
    if magnet is None:
        raise SpecError('magnet: missing; give its moment, as moment = ["0 A m^2", "1e-6 A m^2", '
                        '"0 A m^2"], or its remanence and size')  # fmt: skip
    if not isinstance(applied, RotatingField):
        kind = "missing" if applied is None else applied.kind
        raise SpecError("field.kind", kind, '"rotating"', "its frequency is then asked for here")
    if not all(gait.free[3:]):
        held = [name for name, free in zip(("os", "oq", "or"), gait.free[3:]) if not free]
        raise SpecError("motion.free", " ".join(swimmer.motion.free),
                        f"with the rotations that the field turns ({', '.join(held)} held)",
                        '--set motion.free=all lets it tilt')  # fmt: skip
    sense = float(np.sign(applied.frequency))
    cone = sense * applied.cone
    axis, mobility = long_axis_of(swimmer, gait), mobility_of(gait)
    turning, magnetic = SteadyTurning, magnet.vector
    if magnet.susceptibility is not None:
        turning, magnetic = SoftTurning.of, magnet.softness
    mobility, magnetic = (seen_along(axis, np.asarray(of)) for of in (mobility, magnetic))
    return turning(mobility, magnetic, applied.strength, cone)


def _frequencies(values: Any) -> Array:
    try:
        found = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise SpecError("frequency", values, "positive numbers, turns per time") from None
    if found.ndim != 1 or not found.size:
        raise SpecError("frequency", values, "a list of frequencies")
    for i, value in enumerate(found):
        checks.positive(f"frequency[{i}]", value, "frequency, turns of the field per time")
    return found


def _distinct(states: list[Turned]) -> list[Turned]:
    """States that swim differently; mirror images of an axisymmetric robot count once."""
    kept: list[Turned] = []
    for state in states:
        size = max((abs(s.velocity) for s in states), default=0.0)
        if all(
            abs(state.precession_angle - k.precession_angle) > 1e-6
            or abs(state.velocity - k.velocity) > 1e-6 * size
            for k in kept
        ):
            kept.append(state)
    return kept


def _one(
    steady: SteadyTurning, rate: float, states: list[Turned]
) -> tuple[str, float, float, float]:
    """Regime, precession angle, velocity along the axis and its error, at one rate."""
    if not states:
        lost = "stepped out" if steady.step_out else "not held"
        name = lost if rate > steady.step_out else "wobbling"
        return (name, float("nan"), *drift(steady, rate))
    state = states[0]
    angle, velocity = float(state.precession_angle), float(state.velocity)
    tumbles = rate < steady.wobbling_onset and angle > STEEP
    name = "tumbling" if tumbles else _named(angle)
    return name, angle, velocity, 1e-12 * abs(velocity)


def _named(angle: float) -> str:
    """Regime of a robot that is held at an angle to the field's axis."""
    flat = np.pi / 2.0 - STRAIGHT
    return "tumbling" if angle > flat else "synchronous" if angle < STRAIGHT else "wobbling"


def _reversals(steady: SteadyTurning, rates: Array, held: list[list[Turned]]) -> tuple[float, ...]:
    """Frequencies between those asked for at which the velocity of the first state is zero."""

    def velocity(rate: float) -> float:
        return float(steady.states(rate)[0].velocity)

    order, found = np.argsort(rates), []
    for i, k in pairwise(order):
        if held[i] and held[k] and held[i][0].velocity * held[k][0].velocity < 0:
            at: Any = brentq(velocity, rates[i], rates[k], xtol=1e-12 * float(rates[k]))
            found.append(float(at) / (2.0 * np.pi))
    return tuple(found)


def _closed(steady: SteadyTurning) -> Axisymmetric | None:
    if isinstance(steady, SoftTurning):
        exact = closest_soft(steady.mobility, steady.softness, steady.strength)
    else:
        exact = closest(steady.mobility, steady.moment, steady.strength)
    return exact if exact is not None and exact.holds and not steady.cone else None
