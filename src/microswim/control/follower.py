"""A magnetic robot along a path in space: which way the field turns, and the currents for it.

Pure pursuit: aim at the path a little ahead, plus what the robot is off it and has lately been (an
integral, which cancels a steady drift), never further from the robot's axis than it can follow. The
field turns about the aim, a little slower than step-out; its sense is the one in which this robot
swims forwards along the axis of the field.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.readable import quantity
from microswim.gait.units import UNITS
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.path.regimes import steady_turning
from microswim.swimmer.magnetism.applied_field import RotatingField, unit
from microswim.swimmer.magnetism.field_in_space import CoilField
from microswim.swimmer.swimmer import Swimmer

SLOWER = 0.75  #: than step-out, in which the robot still follows where its axis lags
AHEAD, GAIN, MEMORY, LEAK = 0.4, 5.0, 1.3, 0.75  #: in lengths of the robot, and lengths swum


class Command(NamedTuple):
    """What is sent for the next time step.

    Parameters
    ----------
    field, field_rate
        B (3,) at the start of the step and the vector about which it turns.
    currents
        Of the coils (n,) that make it at the robot's place; None without coils.
    inputs
        What `Stepper.step` takes: the field wanted, or that of the currents.
    off
        Distance from the path.
    done
        Whether the end of the path is reached.
    """

    field: Array
    field_rate: Array
    currents: Array | None
    inputs: dict[str, Any]
    off: float
    done: bool


@checks.by_name
@dataclass(eq=False, kw_only=True)
class PathFollower:
    """Controller that takes a magnetic robot along a path, on any spec.

    Call it with what the camera tells, in each time step; it keeps the field's direction, where it
    is on the path and how far off it has been.

    Parameters
    ----------
    swimmer
        With a magnet, all rotations free, and a field: rotating, whose strength counts, or coils,
        which then get currents.
    path
        Corners (k, 3) of the path, lab frame.
    strength, frequency
        Of the field; by default that of the spec's rotating field, and three quarters of step-out.
    most_turn
        Largest angle (rad) between the robot's axis and that of the field.
    model, gait
        Of the gait, as of `Swimmer.gait`, or a gait that is at hand.

    Raises
    ------
    SpecError
        If there is no magnet or no field, a rotation is held, or the path has no length.

    Examples
    --------
    >>> import microswim as ms
    >>> robot = ms.Swimmer.preset("tabak/helix-constant", {"motion.free": "all",
    ...     "magnet": {"moment": [0, 1, 0]},
    ...     "field": {"kind": "rotating", "strength": 60.0, "frequency": 0.1}})
    >>> follow = ms.PathFollower(swimmer=robot, path=[(0, 0, 0), (-9, 0, 0)], model="rft")
    >>> command = follow(ms.State.at(), dt=0.1)
    >>> command.done, round(float(abs(command.field_rate[0]) / 6.2832), 3)
    (False, 0.02)
    """

    swimmer: Swimmer
    path: Any
    strength: float | None = None
    frequency: float | None = None
    most_turn: float = 0.6
    model: doors.Model = "auto"
    gait: Gait | None = None

    def __post_init__(self) -> None:
        checks.instance("swimmer", self.swimmer, "Swimmer")
        points = checks.reals("path", self.path)
        if points.ndim != 2 or points.shape[1:] != (3,) or len(points) < 2:
            raise SpecError("path", f"of shape {points.shape}", "corners (k, 3), two at least")
        if not np.isfinite(points).all() or not (np.diff(points, axis=0) ** 2).sum(axis=1).all():
            raise SpecError("path", "two corners that are one", "finite corners that differ")
        self.path = points
        checks.number("most_turn", self.most_turn, "an angle (rad) up to 1.5", least=0.01, most=1.5)
        field = self.swimmer.field
        if self.strength is None:
            if not isinstance(field, RotatingField):
                raise SpecError("strength: missing; give that of the field the coils shall make")
            self.strength = field.strength
        checks.positive("strength", self.strength)
        if self.gait is None:
            self.gait = self.swimmer.gait(self.model)
        checks.instance("gait", self.gait, "Gait")
        self._plan(self.gait)
        self.restart()

    def _plan(self, gait: Gait) -> None:
        """Take frequency, sense and speed from the steady states of the robot."""
        from dataclasses import replace

        turning = RotatingField(strength=self.strength, frequency=1.0)  # type: ignore[arg-type]
        steady = steady_turning(replace(self.swimmer, field=turning), gait)
        if not steady.at_step_out:
            raise SpecError("magnet: the field never turns this robot; give another direction")
        fastest = steady.step_out / (2.0 * np.pi)
        if self.frequency is None:
            self.frequency = SLOWER * fastest
        least = quantity(fastest, UNITS["frequency"][self.swimmer.units != "SI"])
        checks.number("frequency", self.frequency, f"positive and below step-out, {least}",
                      above=0.0, most=fastest)  # fmt: skip
        self.step_out = fastest
        self._speed = float(steady.at_step_out.velocity) * self.frequency / fastest
        body = 2.0 * float(self.swimmer.body.semi_axes3[0])
        self._length = body + float(self.swimmer.tail.apparent_length)

    @property
    def speed(self) -> float:
        """Speed along the field's axis that its frequency gives, about."""
        return abs(self._speed)

    @property
    def share(self) -> float:
        """Part of the path's corners that is behind."""
        return self._segment / (len(self.path) - 1)

    def restart(self) -> None:
        """Begin anew at the start of the path."""
        self._segment, self._integral, self._b = 0, np.zeros(3), None

    def __call__(self, state: Any, *, dt: float) -> Command:
        """Return the command for a time step dt, from the state that is seen.

        Parameters
        ----------
        state
            A `State`, of which position and attitude count.
        dt
            Time until the next call.
        """
        checks.positive("dt", dt, "time")
        place = np.asarray(state.position, float)
        axis = rotation_matrix(np.asarray(state.quaternion, float))[:, 0]
        near, along, ahead, done = self._seen(place)
        aim = self._aim(place, near, along, ahead, dt)
        axis = axis if axis @ aim >= 0.0 else -axis  # the robot's axis is a line
        aim = _limited(aim, axis, self.most_turn)
        rate = np.sign(self._speed) * 2.0 * np.pi * self.frequency * aim
        field = float(self.strength or 0.0) * self._turned(aim, rate, dt)
        coils = self.swimmer.field
        off = float(np.linalg.norm(place - near))
        if not isinstance(coils, CoilField):
            return Command(field, rate, None, {"field": field, "field_rate": rate}, off, done)
        middle = _about(field, rate * dt / 2.0)  # currents are held over the step
        currents = coils.currents_for(middle, place, np.zeros((3, 3)))
        made = coils.per_ampere(place) @ currents
        felt = {"field": made[:3], "field_gradient": made[3:].reshape(3, 3), "field_place": place}
        return Command(field, rate, currents, felt, off, done)

    def _seen(self, place: Array) -> tuple[Array, Array, Array, bool]:
        """Nearest point of the path, direction there, the point ahead, and whether it ends."""
        fraction = 0.0
        last = len(self.path) - 2
        while True:
            a, b = self.path[self._segment : self._segment + 2]
            fraction = float((place - a) @ (b - a) / ((b - a) @ (b - a)))
            if fraction <= 1.0 or self._segment == last:
                break
            self._segment += 1
        done = self._segment == last and fraction >= 1.0
        near = a + np.clip(fraction, 0.0, 1.0) * (b - a)
        return near, unit(b - a), self._further(near), done

    def _further(self, start: Array) -> Array:
        """Return the point of the path a little ahead of a point on it."""
        left, here = AHEAD * self._length, start
        for corner in self.path[self._segment + 1 :]:
            step = np.linalg.norm(corner - here)
            if step >= left:
                return here + left / step * (corner - here)
            left, here = left - step, corner
        a, b = self.path[-2:]
        return here + left * unit(b - a)

    def _aim(self, place: Array, near: Array, along: Array, ahead: Array, dt: float) -> Array:
        swum = abs(self._speed) * dt / self._length
        across = (near - place) / self._length
        across = across - (across @ along) * along
        self._integral = self._integral + swum * (MEMORY * across - LEAK * self._integral)
        return unit(0.5 * (unit(ahead - place) + along) + GAIN * across + self._integral)

    def _turned(self, aim: Array, rate: Array, dt: float) -> Array:
        """Return the field's direction now: as it was led on to, across the new axis."""
        b = np.eye(3)[np.argmin(np.abs(aim))] if self._b is None else self._b
        b = b - (b @ aim) * aim
        if np.linalg.norm(b) < 1e-6:  # it pointed along the new axis: any across it
            b = np.eye(3)[np.argmin(np.abs(aim))]
            b = b - (b @ aim) * aim
        b = unit(b)
        self._b = _about(b, rate * dt)
        return b


def _limited(aim: Array, axis: Array, most: float) -> Array:
    """Return the direction nearest to the aim within an angle of the robot's axis."""
    along = float(aim @ axis)
    if along >= np.cos(most):
        return aim
    across = aim - along * axis
    return np.cos(most) * axis + np.sin(most) * across / (np.linalg.norm(across) + 1e-12)


def _about(v: Array, turn: Array) -> Array:
    """Return a vector across an axis, turned by a rotation vector about it."""
    angle = float(np.linalg.norm(turn))
    return v if angle == 0.0 else np.cos(angle) * v + np.sin(angle) * np.cross(turn / angle, v)
