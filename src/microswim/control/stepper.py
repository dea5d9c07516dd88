"""Stepper: a swimmer sample by sample, for a controller's loop.

Inputs are held over a step; only the field may turn within it. Inside, a step is divided so that
tail, field and body turn little (`motion.internal_steps`), each part of order 4. A step that would
take too many parts, or turn too far in one, is refused: its time is bounded, whatever the inputs.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Any, Unpack

import numpy as np

from microswim import checks
from microswim.control import linear, motion, readout, thermal
from microswim.control.inputs import EVERY, Inputs, columns_of, rows
from microswim.control.response import Response, response, step_limits
from microswim.control.state import State, check_finite, check_one, check_state
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.held import warn_if_held
from microswim.gait.readable import origin, quantity
from microswim.gait.units import unit
from microswim.numerics.array import kept, still_read_only
from microswim.swimmer.magnetism.magnet import magnetic_of, vector_of
from microswim.swimmer.physical_sense import turning
from microswim.swimmer.swimmer import Swimmer

_NO_LOAD = np.zeros(6)
#: Largest turn (rad) of an internal step whose number is fixed; beyond 2.8 order 4 is not stable.
WIDEST = np.pi / 2.0


@checks.by_name
@still_read_only
@dataclass(frozen=True, eq=False, repr=False)
class Stepper:
    """Steps a swimmer, or thousands at once, from sample to sample.

    Deterministic; the compiled part allocates nothing. Use one stepper per thread.

    Parameters
    ----------
    gait
        Gait of the swimmer, by any model.
    swimmer
        The swimmer itself, if it shall feel the strain of a background flow; without it only the
        flow's velocity and rotation at the body's centre count.
    moment
        Magnetic moment fixed in the body, body frame: three numbers or a `Magnet`, which may be
        soft; by default that of `swimmer`.
    locked
        Motor locked at the phase of the state's start, which is then 0: a rigid robot.
    resolution
        Internal steps per turn of tail, field or body; the error falls with its fourth power.
    steps
        Internal steps per step, if they shall be the same always; a step in which something
        would turn by more than a right angle in one of them is refused.
    most_steps
        Internal steps that a step may take; one that would take more is refused.

    Raises
    ------
    SpecError
        If a parameter is out of range, or the gait holds at one pose beside a wall.

    Examples
    --------
    >>> import microswim as ms
    >>> stepper = ms.Stepper(ms.Swimmer.preset("tabak/helix").gait())
    >>> state = ms.State.at()
    >>> for _ in range(10):
    ...     state = stepper.step(state, motor_rate=6.0, dt=0.1)
    >>> bool(state.position[0] < 0)  # body first
    True
    """

    gait: Gait
    swimmer: Swimmer | None = None
    _: KW_ONLY
    moment: Any = None
    locked: bool = False
    resolution: float = 64.0
    steps: int | None = None
    most_steps: int = 100_000

    def __post_init__(self) -> None:
        checks.instance("gait", self.gait, "Gait")
        self.gait.check_path()
        if self.swimmer is not None:
            checks.instance("swimmer", self.swimmer, "Swimmer")
        checks.truth("locked", self.locked)
        own = self.swimmer.magnet if self.swimmer is not None else None
        magnet = own if self.moment is None else self.moment
        checks.numbers("moment", vector_of(magnet), 3, "three finite numbers, in the body frame")
        if not magnetic_of(magnet)[3:].any():
            magnet = tuple(map(float, vector_of(magnet)))
        object.__setattr__(self, "moment", magnet)
        warn_if_held(self.gait, self.magnetic)
        checks.number("resolution", self.resolution, "4 or more steps per turn", least=4)
        allowed = "a whole number from 1 to 10000000"
        for name in ("steps", "most_steps"):
            value: Any = getattr(self, name)
            if name != "steps" or value is not None:
                checks.number(name, value, allowed, least=1, most=1e7)
                if int(value) != value:
                    raise SpecError(name, value, allowed)
                object.__setattr__(self, name, int(value))

    @classmethod
    @checks.given(swimmer=checks.swimmer, model=checks.text)
    def of(cls, swimmer: Swimmer, model: doors.Model = "auto", **options: Any) -> Stepper:
        """Return stepper of a swimmer that feels a flow's strain; by a boundary, at each pose."""
        if "poses" in options or turning(swimmer):
            from microswim.control import posed_stepper

            return posed_stepper.beside(swimmer, **options)
        return cls(swimmer.gait(model), swimmer, **options)

    def __repr__(self) -> str:
        """Model, magnet, motor and steps, in a few lines."""
        felt = "felt" if self.swimmer is not None else "not felt"
        rate = quantity(np.real(self.gait.rate), unit(self.gait.units, "rate"))
        short = f"{self.resolution:g} internal steps a turn, at most {self.most_steps}"
        parts = f"{self.steps} internal steps, always" if self.steps else short
        return (
            f"Stepper of a {self.gait.model} gait, {self.gait.units}\n"
            f"  motor {'locked' if self.locked else rate}; magnetic moment {self._magnet}\n"
            f"  {parts}; strain of a flow {felt}"
            + "".join(f"\n  {line}" for line in origin(self.gait))
        )

    @property
    def _magnet(self) -> str:
        soft, of, moment = self.magnetic[3:], unit(self.gait.units, "moment"), self.magnetic[:3]
        hard = "(" + ", ".join(quantity(x, of) for x in moment) + ")" if moment.any() else "none"
        return "that of a soft magnet" if soft.any() else hard

    @cached_property
    def response(self) -> Response:
        """The gait solved for all phases."""
        solved = response(self.gait, self.swimmer)
        return solved.at(0.0) if self.locked else solved

    @cached_property
    def magnetic(self) -> np.ndarray:
        """Moment without a field, then moment per field row by row (12,), body frame."""
        return kept(magnetic_of(self.moment), float)

    @cached_property
    def limits(self) -> np.ndarray:
        """What bounds an internal step, as `motion.internal_steps` reads it."""
        return kept(step_limits(self.response, self.resolution, self.magnetic))

    @cached_property
    def _model(self) -> tuple[Any, ...]:
        return self.response.twist, self.response.strain, self.magnetic, self.limits

    @cached_property
    def _work(self) -> np.ndarray:
        return np.empty((8, motion.WORK))

    @cached_property
    def _rest(self) -> np.ndarray:
        rest = np.zeros((1, motion.INPUT))
        rest[0, 0] = 0.0 if self.locked else self.gait.rate
        return rest

    @checks.given()
    def step(self, state: State, *, dt: float, **inputs: Unpack[Inputs]) -> State:
        """Return the pose and phase after a time dt.

        Parameters
        ----------
        state
            State of one swimmer, or of many.
        dt
            Duration, positive.
        **inputs
            Held over the step; one for all swimmers or one row each. ``motor_rate`` (rad per
            time, negative = reversed; the gait's own by default), ``force`` and ``torque`` on the
            body about its centre, ``field`` B, ``field_rate`` (angular velocity with which the
            field turns during the step), ``field_gradient`` (3, 3) ``dB_i/dx_j`` about
            ``field_place``, at which B is `field`, ``flow`` and ``gradient`` (3, 3) of the
            background velocity ``u(x) = flow + gradient x``; all vectors in the lab frame.

        Returns
        -------
        State
            A new one; the old one is left as it was.

        Raises
        ------
        SpecError
            If an input is unknown, of the wrong shape or not finite, or the step would take more
            than `most_steps` internal steps.
        MicroswimError
            If the state would not be finite.
        """
        check_state(state)
        if type(dt) is not float or not 0.0 < dt < np.inf:
            checks.positive("dt", dt, "time")
        Y = state.values.reshape(-1, motion.STATE).copy()
        U = self.held(Y.shape[0], inputs)
        self._check_turn(U, dt)
        run = motion.advance_all.over(len(Y))
        run(*self._model, Y, U, dt, self.steps or 0, self._work)
        check_finite(Y)
        return State(Y.reshape(state.values.shape))

    @checks.given()
    def scattered(
        self, state: State, *, dt: float, random: np.random.Generator, energy: float | None = None
    ) -> State:
        """Return the state after thermal displacement and tumbles of a time dt, on top of `step`.

        Parameters
        ----------
        state
            State of one swimmer, or of many.
        dt
            Time.
        random
            Where the random numbers come from, ``numpy.random.default_rng(seed)``.
        energy
            k_B T; by default that of the swimmer's noise.

        Raises
        ------
        SpecError
            If an argument is out of range, or no temperature is known.
        """
        checks.instance("state", state, "State")
        energy = thermal.checked(self.swimmer, dt, random, energy)
        values = state.values.reshape(-1, motion.STATE)
        after = thermal.scattered(self.response.twist, values, energy, dt, random)
        thermal.tumble(after, self.swimmer, dt, random)
        return State(after.reshape(state.values.shape))

    def _check_turn(self, U: np.ndarray, dt: float) -> None:
        """Refuse inputs under which a step would take too long or go too wide."""
        turn = motion.fastest_of_all(self.limits, U) * dt
        widest = self.steps * WIDEST if self.steps else self.most_steps * self.limits[0]
        if not turn <= widest:
            n = self.steps or self.most_steps
            raise SpecError(
                "dt", dt,
                f"short enough that tail, field and body turn by at most {widest:.3g} rad, what "
                f"{n} internal steps can follow",
                "shorten it or lower the inputs",
            )  # fmt: skip

    @checks.given()
    def held(self, n: int, inputs: Inputs) -> np.ndarray:
        """Return the inputs as an array, one row for all or (n, 37); checked."""
        return rows(self._rest, n, inputs, self.locked)

    @checks.given()
    def outputs(self, state: State, **inputs: Unpack[Inputs]) -> tuple[np.ndarray, np.ndarray]:
        """Return the twist (..., 6), body frame, relative to the lab, and the motor's torque (...).

        The torque is what the motor gives per unit phase rate: for a helix the torque about its
        axis. Inputs as of `step`.
        """
        check_state(state)
        Y = state.values.reshape(-1, motion.STATE)
        U = self.held(Y.shape[0], inputs)
        out = np.empty((Y.shape[0], 7))
        readout.outputs(*self._model[:3], self.response.motor, Y, U, self._work[0], out)
        check_finite(out)
        out = out.reshape(*state.values.shape[:-1], 7)
        return out[..., :6], out[..., 6]

    @checks.given()
    def velocity(self, phase: float, rate: float, wrench: Any = None) -> np.ndarray:
        """Return the twist (6,) at a phase and motor rate, under a wrench in the body frame.

        The quick way: checks nothing; for a loop in Python that has to be done within microseconds.
        """
        out = np.empty(6)
        load = _NO_LOAD if wrench is None else np.asarray(wrench, dtype=float)
        readout.body_twist(self.response.twist, float(phase), float(rate), load, self._work[0], out)
        return out

    @checks.given()
    def twist(self, state: State, **inputs: Unpack[Inputs]) -> np.ndarray:
        """Return twist in the body frame about the body's centre, relative to the lab, (..., 6)."""
        return self.outputs(state, **inputs)[0]

    @checks.given()
    def derivatives(
        self, state: State, *, dt: float, wrt: tuple[str, ...] = EVERY, **inputs: Unpack[Inputs]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the exact derivatives of the next state of one swimmer: (8, 8) and (8, m).

        With respect to the state, and to the inputs named in `wrt`, by default all 37 numbers in
        the order of `motion.INPUTS`; by complex steps through the compiled step.
        """
        check_one(state)
        u, columns = self.held(1, inputs)[0], columns_of(wrt)
        checks.positive("dt", dt, "time")
        self._check_turn(u[None], dt)
        return readout.derivatives(*self._model, state.values, u, dt, self.steps or 0, columns)

    @checks.given()
    def state_space(
        self,
        state: State,
        *,
        dt: float | None = None,
        wrt: tuple[str, ...] = EVERY,
        **inputs: Unpack[Inputs],
    ) -> linear.StateSpace:
        """Return the step of one swimmer as state space in small differences, for a controller.

        Without a time, ``dt=None``, continuous in time: ``scipy.signal.StateSpace(*system)``.

        The state has seven numbers, ``[position (lab), small rotation (rad, body), phase]``,
        about the state given and about the one that follows; the inputs are those of `wrt`, in
        the order of `derivatives`. Exact, as `derivatives`.

        Returns
        -------
        StateSpace
            A (7, 7), B (7, m), C, D, as ``scipy.signal.StateSpace(*system, dt=dt)`` takes them.

        Raises
        ------
        SpecError
            As of `derivatives`.

        Examples
        --------
        >>> import microswim as ms
        >>> stepper = ms.Stepper(ms.Swimmer.preset("tabak/helix").gait())
        >>> A, B, C, D = stepper.state_space(ms.State.at(), dt=0.1, wrt=("motor_rate", "torque"))
        >>> A.shape, B.shape
        ((7, 7), (7, 4))
        """
        if dt is None:
            check_one(state)
            u = self.held(1, inputs)[0]
            V, A, B = readout.slopes(*self._model[:3], state.values, u, columns_of(wrt))
            return linear.continuous(V, A, B, state.quaternion)
        A, B = self.derivatives(state, dt=dt, wrt=wrt, **inputs)
        after = self.step(state, dt=dt, **inputs)
        return linear.error_state(A, B, state.quaternion, after.quaternion)
