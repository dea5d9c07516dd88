"""Stepper beside a wall or in a tube: R and F_p of the pose, lubrication and contact, in each step.

`Stepper.of` returns one for a swimmer whose boundary its gait at one pose would carry along. The
wall is the plane z = 0 of the lab, the fluid above it; the tube's axis is the x axis, and the flow
in it Poiseuille's, of which the input `flow` is the velocity on the axis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import Any, Unpack

import numpy as np

from microswim import checks
from microswim.calibration.poses.around import around
from microswim.control import linear, posed, thermal
from microswim.control.inputs import EVERY, Inputs, columns_of
from microswim.control.motion import INPUTS, STATE, internal_steps
from microswim.control.posed_noise import displaced
from microswim.control.state import State, check_finite, check_one, check_state
from microswim.control.stepper import Stepper
from microswim.errors import MicroswimError, SpecError, measured
from microswim.gait.poses.table import TUBE
from microswim.numerics.array import still_read_only
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.numerics.series.fourier import evaluate
from microswim.path import in_tube, strain
from microswim.path.contact import DRAG, LENGTH, THRUST, repulsion
from microswim.path.loads import periodic
from microswim.path.start import check_bounds
from microswim.swimmer.in_units import as_units
from microswim.swimmer.swimmer import Swimmer


def _strain(y: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the entries 00, 11, 22, 01, 02, 12 of the strain in the body frame."""
    Q, A = rotation_matrix(y[3:7]), u[INPUTS["gradient"]].reshape(3, 3)
    E = Q.T @ (A + A.T) @ Q / 2.0
    return E[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]


SMALL = 1e-5  #: of what is natural, by which derivatives move state and inputs


@checks.by_name
@still_read_only
@dataclass(frozen=True, eq=False, repr=False)
class PosedStepper(Stepper):
    """Stepper of a swimmer whose gait depends on its pose.

    Parameters
    ----------
    gait, swimmer
        As of `Stepper`: the gait in free fluid.
    poses
        The gait at every pose, `microswim.gait.poses.face.Poses`.
    contact
        Range of the repulsion that keeps the swimmer off the boundary, as of `microswim.path`.
    """

    _: KW_ONLY
    poses: Any = None
    contact: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not hasattr(self.poses, "table"):
            raise SpecError("poses", self.poses, "a gait at every pose")
        checks.instance("swimmer", self.swimmer, "Swimmer")
        check_bounds(self.poses, self.swimmer)  # type: ignore[arg-type]
        if self.contact is not None:
            checks.positive("contact", self.contact, "length")

    @cached_property
    def around(self) -> posed.Around:
        """What the compiled step asks of the boundary."""
        swimmer: Any = self.swimmer
        felt = self.poses.table.kind != TUBE
        series = periodic(lambda p: strain.coupling(swimmer, p)[0].reshape(-1, 36), felt, 36)
        return posed.Around(
            self.poses.table, np.array(self.gait.free), series,
            repulsion(swimmer, self.gait, self.contact),
        )  # fmt: skip

    @property
    def start(self) -> State:
        """The state that the spec states: beside the wall, in the tube."""
        return State.at(*self.poses.start)

    @cached_property
    def _rows(self) -> np.ndarray:
        return posed.rows_of_work(8)

    def gap(self, state: State) -> np.ndarray:
        """Return the distance of the surface to the boundary, (...)."""
        check_state(state)
        gaps = self._gaps(state.values.reshape(-1, STATE))
        return gaps.reshape(state.values.shape[:-1])[()]

    def _gaps(self, Y: np.ndarray) -> np.ndarray:
        return np.array([self.poses.gap(y[:3], y[3:7], y[7]) for y in Y])

    def held(self, n: int, inputs: Inputs) -> np.ndarray:
        """Return the inputs as an array, one row for all or (n, 37); checked."""
        U = super().held(n, inputs)
        if self.around.table.kind == TUBE:
            if U[:, INPUTS["gradient"]].any():
                raise SpecError("gradient: leave it out in a tube, whose flow is Poiseuille's")
            if U[:, 14:16].any():
                raise SpecError("flow", inputs.get("flow"), "along x in a tube, [speed, 0, 0]")
        return U

    def step(self, state: State, *, dt: float, **inputs: Unpack[Inputs]) -> State:
        """Return the pose and phase after a time dt; as `Stepper.step`.

        Raises
        ------
        SpecError
            If an input is unknown, of the wrong shape or not finite, the state reaches into the
            boundary, or the step would take more than `most_steps` internal steps.
        """
        check_state(state)
        checks.positive("dt", dt, "time")
        Y = state.values.reshape(-1, STATE).copy()
        U = self.held(len(Y), inputs)
        self._check_turn(U, dt)
        self._advance(Y, U, dt, self.steps or 0)
        return State(Y.reshape(state.values.shape))

    def _advance(self, Y: np.ndarray, U: np.ndarray, dt: float, steps: int) -> np.ndarray:
        """Advance states (n, 8) by a time; return what moved them last, (n, 19)."""
        status, out = np.zeros(len(Y), np.int64), np.empty((len(Y), 19))
        posed.advance_all.over(len(Y))(
            *self.around, self.magnetic, self.limits, Y, U, dt, steps, self.most_steps, status, out,
            self._rows,
        )  # fmt: skip
        if (status == posed.INSIDE).any():
            self._refuse_inside(Y[status == posed.INSIDE][0])
        if dt and status.any():
            raise MicroswimError(
                f"the step takes more than {self.most_steps} parts beside the boundary: shorten "
                "dt, or lower what presses the swimmer on"
            )
        check_finite(Y)
        return out

    def _refuse_inside(self, y: np.ndarray) -> None:
        deep = -self.poses.gap(y[:3], y[3:7], y[7])
        with as_units(self.swimmer):
            place, into = ", ".join(map(measured, y[:3])), measured(deep)
        raise SpecError(
            f"state: the swimmer at ({place}) would reach {into} into the boundary; start further "
            "from it, or turned otherwise"
        )

    def _lab(self, Y: np.ndarray, U: np.ndarray) -> np.ndarray:
        """Velocity in the lab, angular velocity in the body frame, motor's torque, (n, 7)."""
        found = self._advance(Y.copy(), U, 0.0, 1)
        V, F, held = found[:, 6:12], found[:, 13:], found[:, 12]
        motor = np.real(evaluate(self.response.motor, Y[:, 7]))
        free = np.where(held > 0.0, held, motor[:, 6])
        torque = free * U[:, 0] + np.sum(F * V, axis=1)
        strains = np.array(
            [_strain(y, u) for y, u in zip(Y, np.broadcast_to(U, (len(Y), U.shape[1])))]
        )
        torque -= np.sum(motor[:, 7:] * strains, axis=1)
        out = np.concatenate([found[:, :6], torque[:, None]], axis=1)
        check_finite(out)
        return out

    def outputs(self, state: State, **inputs: Unpack[Inputs]) -> tuple[np.ndarray, np.ndarray]:
        """Return the twist (..., 6), body frame, relative to the lab, and the motor's torque (...).

        As `Stepper.outputs`; what Poiseuille's flow gives to the motor is left out.
        """
        check_state(state)
        Y = np.array(state.values.reshape(-1, STATE))
        out = self._lab(Y, self.held(len(Y), inputs))
        turns = rotation_matrix(Y[:, 3:7])
        out[:, :3] = np.einsum("nji,nj->ni", turns, out[:, :3])
        out = out.reshape(*state.values.shape[:-1], 7)
        return out[..., :6], out[..., 6]

    def velocity(self, phase: float, rate: float, wrench: Any = None) -> np.ndarray:
        """Refuse to answer, for beside a boundary a phase is not enough."""
        raise SpecError("velocity: beside a boundary it depends on the pose; take twist(state)")

    def scattered(
        self, state: State, *, dt: float, random: np.random.Generator, energy: float | None = None
    ) -> State:
        """Return the state after thermal displacement and tumbles of a time dt; as `Stepper`.

        The mobility is that of the pose, its divergence included; what would reach through the
        boundary is not taken.
        """
        check_state(state)
        energy = thermal.checked(self.swimmer, dt, random, energy)
        values = state.values.reshape(-1, STATE)
        after = displaced(self.poses, self.around.free, values, energy, dt, random)
        before = after.copy()
        thermal.tumble(after, self.swimmer, dt, random)
        reaches = np.atleast_1d(self._gaps(after)) <= 0.0
        after[reaches] = before[reaches]
        return State(after.reshape(state.values.shape))

    def derivatives(
        self, state: State, *, dt: float, wrt: tuple[str, ...] = EVERY, **inputs: Unpack[Inputs]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of the next state of one swimmer: (8, 8) and (8, m).

        As `Stepper.derivatives`, by central differences: to about six digits.
        """
        check_one(state)
        u = self.held(1, inputs)
        checks.positive("dt", dt, "time")
        self._check_turn(u, dt)
        steps = self.steps or internal_steps(self.limits, u[0], dt)

        def after(y: np.ndarray, u: np.ndarray) -> np.ndarray:
            Y = y[None].copy()
            self._advance(Y, u[None], dt, steps)
            return Y[0]

        return self._slopes(after, state, u[0], columns_of(wrt), dt)

    def state_space(
        self,
        state: State,
        *,
        dt: float | None = None,
        wrt: tuple[str, ...] = EVERY,
        **inputs: Unpack[Inputs],
    ) -> linear.StateSpace:
        """Return the step of one swimmer as state space; as `Stepper.state_space`."""
        if dt is not None:
            return super().state_space(state, dt=dt, wrt=wrt, **inputs)
        check_one(state)
        u = self.held(1, inputs)[0]

        def slope(y: np.ndarray, u: np.ndarray) -> np.ndarray:
            return np.append(self._lab(y[None], u[None])[0, :6], u[0])

        A, B = self._slopes(slope, state, u, columns_of(wrt), 1.0)
        return linear.continuous(slope(np.array(state.values), u), A, B, state.quaternion)

    def _slopes(
        self, function: Callable[..., np.ndarray], state: State, u: np.ndarray,
        columns: np.ndarray, dt: float,
    ) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
        """Return derivatives of a function of state and inputs, by central differences."""
        steps, both = self._natural(state, u, dt), []
        for k in [*range(STATE), *(STATE + c for c in columns)]:
            ends = []
            for sense in (1.0, -1.0):
                z, w = np.array(state.values), u.copy()
                moved, i = (z, k) if k < STATE else (w, k - STATE)
                moved[i] += sense * steps[k]
                if 3 <= k < 7:
                    z[3:7] /= np.linalg.norm(z[3:7])
                ends.append(function(z, w))
            both.append((ends[0] - ends[1]) / (2.0 * steps[k]))
        J = np.array(both).T
        return J[:, :STATE], J[:, STATE:]

    def _natural(self, state: State, u: np.ndarray, dt: float) -> np.ndarray:
        """Small changes of the state and of the 37 inputs, by what moves a swimmer in time dt.

        That is its motor, or else what takes it on by its own length.
        """
        contact = self.around.contact
        length, rate = float(contact[LENGTH]), float(abs(u[0]) or abs(self._rest[0, 0]))
        push, rate = float(contact[THRUST] * rate or contact[DRAG] * length / dt), rate or 1.0 / dt
        moment = float(np.linalg.norm(self.magnetic)) or push * length
        field = push * length / moment
        place = SMALL * min(length, float(np.min(self.gap(state))))
        sizes = {
            "motor_rate": rate, "force": push, "torque": push * length, "field": field,
            "field_rate": rate, "flow": rate * length, "gradient": rate,
            "field_gradient": field / length, "field_place": length,
        }  # fmt: skip
        found = np.full(STATE + len(self._rest[0]), SMALL)
        found[:3] = place
        found[3:7] = min(SMALL, place / length)
        for name, part in INPUTS.items():
            found[STATE + part.start : STATE + part.stop] = SMALL * sizes[name]
        return found


def beside(
    swimmer: Swimmer,
    *,
    poses: Any = None,
    level: str | None = None,
    progress: Callable[[int, int], None] | None = None,
    **options: Any,
) -> PosedStepper:
    """Return the stepper of a swimmer by its wall or in its tube.

    Parameters
    ----------
    swimmer
        With a wall or a channel.
    poses
        The gait at every pose; solved by boundary elements if not given, and kept in the user's
        cache: minutes, once.
    level, progress
        Of these solves.
    options
        As of `PosedStepper`.
    """
    in_tube.check(swimmer)
    poses = around(swimmer, level=level, progress=progress) if poses is None else poses
    if not hasattr(poses, "table"):
        raise SpecError("poses", poses, "a gait at every pose")
    return PosedStepper(poses.gait, swimmer, poses=poses, **options)
