"""Sensor: what a camera sees of a swimmer, late, seldom and with noise.

A layer of its own: the stepper does not know it, a controller may do without it.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from microswim import checks
from microswim.control.state import State
from microswim.numerics.rigid_motion import multiply


@dataclass(frozen=True, eq=False)
class Reading:
    """A frame of the camera as it reaches the controller.

    Parameters
    ----------
    time
        When the frame was taken.
    state
        What was seen: noisy position and attitude; the phase of a tail is not seen (NaN).
    """

    time: float
    state: State


@checks.by_name
@dataclass
class Sensor:
    """A camera: takes a frame each `interval`, adds noise, hands it over `latency` later.

    Call `read` at least as often as frames are taken; a frame shows the state at the first call at
    or after its due time.

    Parameters
    ----------
    interval
        Time between frames; zero: one at every call.
    latency
        Time from frame to controller.
    position_noise
        Standard deviation of each coordinate of the position.
    angle_noise
        Standard deviation (rad) of the attitude about each axis of the body.
    seed
        Seed of the noise: the same seed, the same noise.

    Raises
    ------
    SpecError
        If a parameter is negative or not finite.

    Examples
    --------
    >>> import microswim as ms
    >>> camera = ms.Sensor(interval=0.1, latency=0.2)
    >>> camera.read(0.0, ms.State.at()) is None  # nothing has arrived yet
    True
    >>> camera.read(0.2, ms.State.at()).time
    0.0
    """

    interval: float = 0.0
    latency: float = 0.0
    position_noise: float = 0.0
    angle_noise: float = 0.0
    seed: int | None = None
    _under_way: deque = field(default_factory=deque, init=False, repr=False)
    _due: float = field(default=-np.inf, init=False, repr=False)
    _last: Reading | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("interval", "latency", "position_noise", "angle_noise"):
            checks.number(name, getattr(self, name), "zero or more", least=0.0)
        checks.count("seed", self.seed, least=0)
        self._random = np.random.default_rng(self.seed)

    @checks.given(
        time=partial(checks.number, allowed="a finite time"),
        state=partial(checks.instance, kind="State"),
    )
    def read(self, time: float, state: State) -> Reading | None:
        """Return the latest frame that has arrived at a time, None before the first.

        Parameters
        ----------
        time
            Time now, not before that of the last call.
        state
            True state now, of one swimmer or of many.
        """
        slack = 1e-9 * max(abs(time), self.interval)  # of rounding in sums of time steps
        if time >= self._due - slack:
            self._under_way.append(Reading(time, self._seen(state)))
            missed = 0.0 if np.isinf(self._due) else time - self._due
            start = time if np.isinf(self._due) else self._due
            whole = np.floor((missed + slack) / self.interval) if self.interval else 0.0
            self._due = start + (whole + 1.0) * self.interval
        while self._under_way and self._under_way[0].time + self.latency <= time + slack:
            self._last = self._under_way.popleft()
        return self._last

    def _seen(self, state: State) -> State:
        values = state.values.copy()
        shape = values.shape[:-1]
        values[..., :3] += self.position_noise * self._random.standard_normal((*shape, 3))
        half = 0.5 * self.angle_noise * self._random.standard_normal((*shape, 3))
        angle = np.linalg.norm(half, axis=-1, keepdims=True)
        turn = np.concatenate([np.cos(angle), np.sinc(angle / np.pi) * half], axis=-1)
        values[..., 3:7] = multiply(values[..., 3:7], turn)
        values[..., 7] = np.nan
        return State(values)
