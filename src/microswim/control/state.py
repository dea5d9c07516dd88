"""State: pose and phase of a swimmer, or of many."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.numerics.array import still_read_only


@checks.by_name
@still_read_only
@dataclass(frozen=True, eq=False)
class State:
    """Pose and phase of one swimmer or of many.

    Parameters
    ----------
    values
        Position of the body's centre (lab), quaternion ``wxyz`` body to lab, phase: (8,) or
        (n, 8).

    Examples
    --------
    >>> import microswim as ms
    >>> ms.State.at(position=[1.0, 0.0, 0.0]).position
    array([1., 0., 0.])
    """

    values: np.ndarray

    def __post_init__(self) -> None:
        values = self.values
        if not isinstance(values, np.ndarray) or values.shape[-1:] != (8,) or values.ndim > 2:
            shown = getattr(values, "shape", values)
            raise SpecError("values", shown, "an array (8,) or (n, 8)", "State.at makes one")
        own = values.view()
        own.flags.writeable = False
        object.__setattr__(self, "values", own)

    @classmethod
    @checks.given(position=checks.series, quaternion=checks.series, phase=checks.series)
    def at(
        cls, position: Any = (0, 0, 0), quaternion: Any = (1, 0, 0, 0), phase: Any = 0.0
    ) -> State:
        """Return the state from its parts, which broadcast over swimmers.

        Raises
        ------
        SpecError
            If a part has the wrong shape, is not finite, or the quaternion is not a unit one.
        """
        parts = {"position": (position, 3), "quaternion": (quaternion, 4), "phase": (phase, 0)}
        arrays = []
        for name, (value, width) in parts.items():
            a = np.asarray(value, dtype=float)
            if a.ndim > 1 + (width > 0) or (width and a.shape[-1:] != (width,)):
                raise SpecError(name, value, f"{width} numbers, or as many rows as swimmers")
            arrays.append(a if width else a[..., None])
        norm = np.linalg.norm(arrays[1], axis=-1, keepdims=True)
        if (abs(norm - 1.0) > 0.01).any():
            raise SpecError("quaternion", quaternion, "a unit quaternion wxyz")
        arrays[1] = arrays[1] / norm
        try:
            n = np.broadcast_shapes(*(a.shape[:-1] for a in arrays))
        except ValueError:
            raise SpecError("position, quaternion and phase: give as many rows of each") from None
        full = [np.broadcast_to(a, (*n, a.shape[-1])) for a in arrays]
        return cls(np.concatenate(full, axis=-1))

    @property
    def position(self) -> np.ndarray:
        """Position of the body's centre, lab frame, (..., 3)."""
        return self.values[..., :3]

    @property
    def quaternion(self) -> np.ndarray:
        """Attitude ``wxyz``, body to lab, (..., 4)."""
        return self.values[..., 3:7]

    @property
    def phase(self) -> np.ndarray:
        """Phase of the tail relative to the body (rad), (...)."""
        return self.values[..., 7][()]


def check_finite(values: np.ndarray) -> None:
    """Refuse a state or a velocity that is beyond all numbers."""
    if not np.isfinite(values).all():
        raise MicroswimError(
            "the state or the velocity would not be finite: state and inputs must be finite, and "
            "not so large that their products overflow"
        )


def check_state(state: Any) -> None:
    """Refuse what is no state."""
    if not isinstance(state, State):
        raise SpecError("state", state, "a State", "State.at makes one")


def check_one(state: Any) -> None:
    """Refuse what is not the state of one swimmer."""
    check_state(state)
    if state.values.ndim != 1:
        raise SpecError("state", f"{len(state.values)} swimmers", "one swimmer")
