"""Motors that give a torque: constant, or as the motors of bacteria do, a plateau and a slope.

    tau(w) = T                        up to the knee,
    tau(w) = T (W - w)/(W - K)        beyond, none at the rate W without load

[Chen Berg 2000]. Without a knee the slope begins at rest, K = 0; without W the torque is constant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.swimmer.geometry.tails.kinds import Tail

_EACH = "or one for each tail"
_NAMES = ("torque", "no_load_frequency", "knee_frequency")


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Motor:
    """The torque of the motors of a swimmer's tails, which turn as fast as it lets them.

    `path` then follows a phase for each tail; gaits have the rate ``tail.frequency`` as before.

    Parameters
    ----------
    torque
        Of each motor, one number or one for each tail; below zero it turns its tail the other way.
    no_load_frequency
        Turns per time without load, above zero; left out, the torque is constant.
    knee_frequency
        Turns per time up to which the torque does not fall; left out, it falls from rest on.

    Raises
    ------
    SpecError
        If a number is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> motor = ms.Motor(torque=1.26e-18, no_load_frequency=300.0, knee_frequency=175.0)
    >>> torque, no_load, knee = motor.of_each(2)
    >>> [round(float(w)) for w in no_load]
    [1885, 1885]
    """

    torque: float | tuple[float, ...]
    no_load_frequency: float | tuple[float, ...] | None = None
    knee_frequency: float | tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name in _NAMES:
            value = getattr(self, name)
            if value is None:
                continue
            each = tuple(value) if np.ndim(value) == 1 else (value,)
            what = "a torque" if name == "torque" else "a frequency"
            checks.numbers(f"motor.{name}", each, len(each), f"{what}, {_EACH}")
            if np.ndim(value) == 1:
                object.__setattr__(self, name, each)
            ok = [x != 0.0 if name == "torque" else x > 0.0 for x in np.real(each)]
            if not all(ok):
                allowed = "other than zero" if name == "torque" else "above zero"
                raise SpecError(f"motor.{name}", value, allowed)
        self._check_knee()

    def _check_knee(self) -> None:
        if self.knee_frequency is None:
            return
        if self.no_load_frequency is None:
            raise SpecError("motor.no_load_frequency: missing; a torque that falls from the knee "
                            "on is none at that frequency")  # fmt: skip
        if not np.all(np.real(self.knee_frequency) < np.real(self.no_load_frequency)):
            raise SpecError("motor.knee_frequency", self.knee_frequency, "below no_load_frequency")

    def check(self, tail: Tail) -> None:
        """Refuse a tail that it cannot turn, and numbers of motors other than that of the tails.

        Raises
        ------
        SpecError
            If there is no tail, one that settles to a shape of its own, or too few or many numbers.
        """
        if tail.is_absent or tail.settles:
            raise SpecError("motor", tail.kind, "for tails of a given shape", "remove [motor]")
        self.of_each(len(tail.each))

    def of_each(self, tails: int) -> tuple[Array, Array, Array]:
        """Return T, W and K of each motor, (n,), rates in rad per time and of the torque's sign.

        W is infinite without a rate without load, K not a number without a knee.

        Raises
        ------
        SpecError
            If there are fewer or more numbers than tails.
        """
        found = []
        for name, without in zip(_NAMES, (0.0, np.inf, np.nan)):
            value = getattr(self, name)
            if np.ndim(value) == 1 and len(value) != tails:
                count = f"one number, or {tails}, one for each tail"
                raise SpecError(f"motor.{name}", value, count)
            found.append(np.broadcast_to(np.array(without if value is None else value), tails))
        T, W, K = found
        turn = 2.0 * np.pi * np.sign(T)
        return T, turn * W, turn * K
