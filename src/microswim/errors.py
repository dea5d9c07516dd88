"""The two errors a user meets.

Every message is one sentence: the field and its value, what is allowed, how to mend it.
"""

from __future__ import annotations

from typing import Any


class MicroswimError(Exception):
    """Something went wrong that is not the fault of the specification.

    For example a solver that did not converge, or an extra that is not installed.

    Examples
    --------
    >>> issubclass(SpecError, MicroswimError)  # one `except` for both
    True
    """


class SpecError(MicroswimError, ValueError):
    """A field of a specification has a value that makes no sense.

    Parameters
    ----------
    field
        Dotted name of the field, as in the spec file: ``"tail.radius"``. If it is the only
        argument it is taken for the whole sentence.
    value
        What was given.
    allowed
        What is allowed, in words: ``"a positive length"``.
    mend
        How to mend it, in words; left out when `allowed` says it already.

    Examples
    --------
    >>> print(SpecError("body.radius", -0.5, "a positive length", "give the radius, not its sign"))
    body.radius = -0.5: must be a positive length; give the radius, not its sign
    """

    def __init__(
        self, field: str, value: Any = None, allowed: str | None = None, mend: str | None = None
    ) -> None:
        self.field, self.value, self.allowed, self.mend = field, value, allowed, mend
        super().__init__(" ".join(self._sentence().split()))

    def _sentence(self) -> str:
        if self.allowed is None:
            return self.field
        sentence = f"{self.field} = {_shown(self.value)}: must be {self.allowed}"
        return f"{sentence}; {self.mend}" if self.mend else sentence

    def __reduce__(self) -> tuple:
        """Pickle by the four parts, so that the error survives a trip through a process pool."""
        return type(self), (self.field, self.value, self.allowed, self.mend)


def _shown(value: Any) -> str:
    """Show a value on one line of at most 60 characters."""
    text = " ".join(str(value).split()) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
