"""A bench around the robots: coils that make the field wanted, and a field that is there anyway.

The currents are those that make the wanted field B_w at the origin, ``I = P B_w``; where the robot
is they make another, with a slope, and what is there anyway adds to it:

    B = G B_w + B_s      dB_i/dx_j = H B_w + J_s      G = B_1(x) P     H = J_1(x) P

B_1 and J_1: field and slope of each coil at one ampere. G, H, B_s and J_s are those of the place
and time at which a step begins; in its parts the field turns on.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.control import motion
from microswim.control.motion import FIELD_BENDS, field_at, substep
from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import FAST, njit
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.magnetism.field_in_space import CoilField
from microswim.swimmer.magnetism.grid import GridCoil

#: Where G, H, B_s and J_s of an environment begin.
H_, B_, J_, NUMBERS = 9, 36, 39, 48


class Bench:
    """What makes the field of all environments.

    Parameters
    ----------
    coils
        `CoilField`, whose own currents do not count, or None: the field wanted is there everywhere.
    stray
        A field that is there anyway, or None.

    Raises
    ------
    SpecError
        If one is of another kind, or the coils cannot make every field at the origin.
    """

    def __init__(self, coils: CoilField | None, stray: AppliedField | None) -> None:
        if coils is not None:
            checks.instance("coils", coils, "CoilField")
            A = coils.per_ampere(np.zeros(3))[:3]
            self.currents = np.linalg.pinv(A, rcond=1e-9)
            if np.abs(A @ self.currents - np.eye(3)).max() > 1e-6:
                raise SpecError(
                    "coils", len(coils.coils), "three or more, in different directions",
                    "they must make every field at the origin",
                )  # fmt: skip
        if stray is not None and not isinstance(stray, AppliedField):
            raise SpecError("stray", stray, "a field, such as ms.UniformField or ms.DipoleField")
        self.coils, self.stray = coils, stray

    def write(self, places: Array, times: Array, out: Array) -> None:
        """Write the numbers (n, 48) at places (n, 3) and times (n,)."""
        n = len(places)
        out[:, :B_] = 0.0
        if self.coils is None:
            out[:, [0, 4, 8]] = 1.0
        else:
            inside = self._within(places)
            each = [coil.both(inside) for coil in self.coils.coils]
            B = np.stack([b for b, _ in each], axis=-1) @ self.currents
            J = np.stack([j for _, j in each], axis=-1) @ self.currents
            out[:, :H_], out[:, H_:B_] = B.reshape(n, 9), J.reshape(n, 27)
        if self.stray is None:
            out[:, B_:] = 0.0
        else:
            out[:, B_:J_] = self.stray.at(times, places)
            out[:, J_:] = self.stray.gradient(times, places).reshape(n, 9)

    def _within(self, places: Array) -> Array:
        """Places, those outside a grid at its edge: a robot that gets there is lost anyway."""
        first: Any = self.coils.coils[0]  # type: ignore[union-attr]
        if not isinstance(first, GridCoil):
            return places
        low, high = ([axis[k] for axis in first.axes] for k in (0, -1))
        return np.clip(places, low, high)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def made(model: Any, made_: Any, slope: Any, mem: Any, u: Any, n: int, h: Any, work: Any) -> None:
    """Take n steps of length h under what the bench makes of the field that u wants.

    Each part turns about the field at its middle; the slope (9,) is a further one about the origin.
    """
    v = u.copy()
    for k in range(n):
        under(made_, slope, mem, u, k * h, h, v)
        substep(model[0], model[1], model[2], mem, v, 0.0, h, FIELD_BENDS, work)


@njit(cache=True, fastmath=FAST, error_model="numpy")
def under(made_: Any, slope: Any, mem: Any, u: Any, t: float, h: float, v: Any) -> None:
    """Write to v the field that the bench makes of what u wants in a part of length h from t on."""
    b = field_at(u, t + 0.5 * h)
    for i in range(3):
        v[motion.PLACE + i] = mem[i]
        v[motion.FIELD + i] = made_[B_ + i]
        for j in range(3):
            m = 3 * i + j
            v[motion.FIELD + i] += made_[m] * b[j] + slope[m] * mem[j]
            v[motion.J + m] = made_[J_ + m] + slope[m]
            for c in range(3):
                v[motion.J + m] += made_[H_ + 3 * m + c] * b[c]
    start = field_at(v, -0.5 * h)
    for i in range(3):
        v[motion.FIELD + i] = start[i]


@njit(cache=True)
def under_all(made_: Any, slopes: Any, mem: Any, U: Any, t: float, h: float, V: Any) -> None:
    """Write `under` of all."""
    for i in range(mem.shape[0]):
        under(made_[i], slopes[i], mem[i], U[i], t, h, V[i])
