"""Where a tail stands in the body: the rigid motion from its own frame to the frame ``sqr``.

A tail's own frame has its root at the origin and its axis along s. With the root ``x_0`` and the
rotation A that takes ``e_s`` to the axis d by the shortest way,

    X = x_0 + A X_own,     A = I + [v]_x + w [v]_x^2,    v = e_s x d,   w = 1 / (1 + d_s)

and a wrench about a point ``c_own`` of the tail's frame, seen from another point c of the body's,

    F = A F_own,    T = A T_own + (x_0 + A c_own - c) x F        =: Ad [F_own; T_own]
    R = Ad R_own Ad',    F_p = Ad F_p,own,    G = G_own

A tail that points straight back (``d = -e_s``) is turned half about r.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.rigid_motion import skew

AT_JOINT, ALONG_S = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class Placement:
    """Rigid motion from a tail's own frame to the frame ``sqr``.

    Parameters
    ----------
    root
        Where the tail's axis begins, from the joint (length).
    axis
        Direction of the tail's axis, of any length.
    """

    root: tuple[Any, Any, Any] = AT_JOINT
    axis: tuple[Any, Any, Any] = ALONG_S

    @cached_property
    def rotation(self) -> np.ndarray:
        """Matrix A (3, 3) from the tail's own axes to s, q, r."""
        d = np.array(self.axis)
        d_s, q, r = d / np.sqrt(np.sum(d * d))
        across = q * q + r * r
        if np.real(d_s) >= 0.0:
            w = 1.0 / (1.0 + d_s)
        elif across == 0.0:
            return np.diag([-1.0, -1.0, 1.0])
        else:
            w = (1.0 - d_s) / across  # the same, without cancellation
        rows = [[d_s, -q, -r], [q, 1.0 - q * q * w, -q * r * w], [r, -q * r * w, 1.0 - r * r * w]]
        return np.array(rows)

    def placed(self, X: np.ndarray) -> np.ndarray:
        """Return points (..., 3) of the tail's own frame in the frame ``sqr``."""
        return np.array(self.root) + self.turned(X)

    def turned(self, v: np.ndarray) -> np.ndarray:
        """Return vectors (..., 3) of the tail's own frame in the frame ``sqr``."""
        return v @ self.rotation.T

    def seen(self, X: np.ndarray) -> np.ndarray:
        """Return points (..., 3) of the frame ``sqr`` in the tail's own frame."""
        return (X - np.array(self.root)) @ self.rotation

    def adjoint(self, own: np.ndarray, centre: np.ndarray) -> np.ndarray:
        """Return Ad (6, 6): wrenches about `own`, in the tail's frame, to those about `centre`.

        Parameters
        ----------
        own
            Reference point (3,) in the tail's own frame.
        centre
            Reference point (3,) in the frame ``sqr``.
        """
        A = self.rotation
        arm = skew(self.placed(own) - centre)
        return np.block([[A, np.zeros((3, 3))], [arm @ A, A]])


def check(position: Any, direction: Any, phase: Any) -> None:
    """Refuse a root, an axis or a phase that is none; None stands for what is not given.

    Raises
    ------
    SpecError
        With the field.
    """
    if position is not None:
        allowed = "three lengths [s, q, r] from the joint to the root"
        checks.numbers("tail.position", position, 3, allowed)
    if direction is not None:
        allowed = "three numbers [s, q, r], not all zero: the tail's axis, away from its root"
        checks.numbers("tail.direction", direction, 3, allowed)
        if not sum(float(np.real(d)) ** 2 for d in direction) > 0.0:
            raise SpecError("tail.direction", tuple(direction), allowed)
    if phase is not None:
        checks.number("tail.phase", phase, "a finite angle: how far ahead of the others it is")
