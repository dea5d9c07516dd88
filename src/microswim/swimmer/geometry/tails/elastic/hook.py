"""The hook: a short piece between body and tail that bends more easily than both.

It is short against the tail, so it bends as one joint: a moment M turns the tail's base by
``M length / stiffness``. Its own drag, and that the joint moves, are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.tails.kinds import ElasticTail, Tail

SHORT = 0.2  #: of the tail's length, beyond which it is no joint


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Hook:
    """A flexible joint between the body's drive and an elastic tail.

    Parameters
    ----------
    stiffness
        Bending stiffness of the hook (force x length^2).
    length
        Its length.

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

    stiffness: float
    length: float

    def __post_init__(self) -> None:
        checks.positive("hook.stiffness", self.stiffness, "stiffness")
        checks.positive("hook.length", self.length, "length")

    @property
    def turning(self) -> Any:
        """Moment per angle."""
        return self.stiffness / self.length

    def check(self, tail: Tail) -> None:
        """Refuse a tail whose base it cannot hold.

        Raises
        ------
        SpecError
            If the tail does not bend, is hinged, or is not long against the hook.
        """
        if not isinstance(tail, ElasticTail):
            raise SpecError(
                "hook", tail.kind, "between the body and an elastic tail",
                "remove [hook], or take tail.kind = elastic",
            )  # fmt: skip
        if tail.base == "hinged":
            raise SpecError("tail.base", "hinged", '"clamped" with a hook', "the hook is the hinge")
        if self.length > SHORT * tail.length:
            raise SpecError("hook.length", self.length, f"at most {SHORT:g} of the tail's length")
