"""The hook: a short piece between body and tail that bends more easily than both.

It is short against the tail, so it bends as one joint: a moment M turns the tail's base by
``M length / stiffness``. Its own drag, and that the joint moves, are left out. An elastic tail has
one; rigid tails that motors of given torque turn have one each.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.swimmer.geometry.tails.kinds import ElasticTail, Tail

SHORT = 0.2  #: of the tail's length, beyond which it is no joint


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Hook:
    """A flexible joint between the body's drive and a tail, elastic or rigid.

    With an elastic tail the beat knows it. Rigid tails tilt on theirs along a `path` by the torque
    of a `Motor`; in a gait they stand as they are at rest.

    Parameters
    ----------
    stiffness
        Bending stiffness of the hook (force x length^2); of several tails one number or one each.
    length
        Its length; of several tails one number or one each.

    Raises
    ------
    SpecError
        If one is not positive.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Hook(stiffness=2.0, length=0.1).turning
    20.0
    """

    stiffness: float | tuple[float, ...]
    length: float | tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("stiffness", "length"):
            value = getattr(self, name)
            if np.ndim(value) != 1:
                checks.positive(f"hook.{name}", value, name)
                continue
            for n, one in enumerate(value):
                checks.positive(f"hook.{name}[{n}]", one, name)
            object.__setattr__(self, name, tuple(value))

    @property
    def turning(self) -> Any:
        """Moment per angle; an array of several."""
        if np.ndim(self.stiffness) or np.ndim(self.length):
            return np.array(self.stiffness) / np.array(self.length)
        return self.stiffness / self.length  # type: ignore[operator]

    def of_each(self, tails: int) -> Array:
        """Return the moment per angle of each tail's hook (n,).

        Raises
        ------
        SpecError
            If there are fewer or more numbers than tails.
        """
        for name in ("stiffness", "length"):
            value = getattr(self, name)
            if np.ndim(value) == 1 and len(value) != tails:
                count = f"one number, or {tails}, one for each tail"
                raise SpecError(f"hook.{name}", value, count)
        return np.broadcast_to(np.real(self.turning), tails).astype(float)

    def check(self, tail: Tail) -> None:
        """Refuse a tail whose base it cannot hold.

        Raises
        ------
        SpecError
            If a tail neither bends nor is rigid, is hinged, or is not long against the hook, or
            there are fewer or more numbers than tails.
        """
        self.of_each(len(tail.each))
        if not isinstance(tail, ElasticTail):
            self._check_rigid(tail)
        elif np.ndim(self.turning):
            raise SpecError("hook.stiffness, hook.length: one number each with an elastic tail")
        elif tail.base == "hinged":
            raise SpecError("tail.base", "hinged", '"clamped" with a hook', "the hook is the hinge")
        lengths = np.broadcast_to(np.real(self.length), len(tail.each))
        for n, (length, one) in enumerate(zip(lengths, tail.each, strict=True)):
            if length > SHORT * np.real(one.length):
                name = f"hook.length[{n}]" if np.ndim(self.length) else "hook.length"
                raise SpecError(name, float(length), f"at most {SHORT:g} of the tail's length")

    def _check_rigid(self, tail: Tail) -> None:
        for name, one in tail.named.items():
            if one.is_absent or not one.turns_whole:
                raise SpecError(
                    "hook", f"{name} of kind {one.kind}",
                    "between the body and an elastic tail, or rigid helices",
                    "remove [hook], or take tail.kind = elastic",
                )  # fmt: skip
