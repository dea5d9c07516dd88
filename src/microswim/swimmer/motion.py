"""How the motion is read: free degrees of freedom and the readings of the paper."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from microswim import checks
from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Motion:
    """How the motion is read: the readings of the paper that differ from the default.

    Parameters
    ----------
    free
        ``"all"``, the free degrees of freedom out of us, uq, ur, os, oq, or, or ``"none"``: body
        and joint are held, and the tail beats.
    frequency_frame
        ``"body"``: the tail's frequency is the motor's, relative to the body. ``"lab"``: in the
        lab frame, the body's counter-rotation not subtracted (helix only).
    line_element
        ``"arc"``, or ``"apparent"``: Eqs. (5), (14) integrated over the apparent length.

    Raises
    ------
    SpecError
        If a field holds something else.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Motion(free=("us", "uq", "ur", "os")).mask
    (True, True, True, True, False, False)
    """

    free: Literal["all", "none"] | tuple[str, ...] = "all"
    frequency_frame: Literal["body", "lab"] = "body"
    line_element: Literal["arc", "apparent"] = "arc"

    def __post_init__(self) -> None:
        if not isinstance(self.free, str) or self.free not in ("all", "none"):
            allowed = '"all", "none" or a list out of ' + ", ".join(DEGREES_OF_FREEDOM)
            if not isinstance(self.free, (list, tuple)):
                raise SpecError("motion.free", self.free, allowed)
            if not self.free or any(name not in DEGREES_OF_FREEDOM for name in self.free):
                raise SpecError("motion.free", self.free, allowed)
            object.__setattr__(self, "free", tuple(self.free))
        checks.choice("motion.frequency_frame", self.frequency_frame, ("body", "lab"))
        checks.choice("motion.line_element", self.line_element, ("arc", "apparent"))

    @property
    def mask(self) -> tuple[bool, ...]:
        """Whether us, uq, ur, os, oq, or are free."""
        if self.free == "all":
            return (True,) * 6
        if self.free == "none":
            return (False,) * 6
        return tuple(name in self.free for name in DEGREES_OF_FREEDOM)
