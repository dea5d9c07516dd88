"""The errors a user meets, of a specification, a solution, the machine; and of old names.

Every message is one sentence: the field and its value, what is allowed, how to mend it.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

MOST_OFFERED = 10  #: names that an error lists; a longer list helps nobody
#: How a number is written, of a dotted field or a dimension; None: it is no quantity with a unit.
Writing = Callable[[str, float], "str | None"]
_notes: ContextVar[list[str] | None] = ContextVar("notes", default=None)
_writing: ContextVar[Writing | None] = ContextVar("writing", default=None)


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
        sentence = f"{self.field} = {_written(self.field, self.value)}: must be {self.allowed}"
        return f"{sentence}; {self.mend}" if self.mend else sentence

    def __reduce__(self) -> tuple:
        """Pickle by the four parts, so that the error survives a trip through a process pool."""
        parts = (self.field, self.value, self.allowed, self.mend)
        return type(self), parts, {"args": self.args}  # the sentence in the units it was said in


class MachineError(MicroswimError):
    """The machine is at fault, not the design: no memory, a full disk, a killed process.

    What was solved is kept where it is kept at all, and nothing is noted against the design: the
    same call goes on from there once the machine can.

    Examples
    --------
    >>> raise MachineError("run.nc: not written: No space left on device")
    Traceback (most recent call last):
        ...
    microswim.errors.MachineError: run.nc: not written: No space left on device
    """


class RenamedWarning(FutureWarning):
    """A name of an earlier version was used; it works for one release more.

    Examples
    --------
    >>> import warnings
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     renamed("torque", "mean_torque")
    >>> print(caught[0].message)
    torque is now called mean_torque; the old name works for one release more
    """


@contextmanager
def noted() -> Iterator[list[str]]:
    """Yield the list to which `warn` writes meanwhile, of this thread alone.

    What `warnings.catch_warnings` changes holds for all threads: a server that answers two at once
    would tell one what was warned of the other.
    """
    notes: list[str] = []
    token = _notes.set(notes)
    try:
        yield notes
    finally:
        _notes.reset(token)


@contextmanager
def writing(as_units: Writing | None) -> Iterator[None]:
    """Write quantities in sentences meanwhile in the units of a spec; the outermost holds.

    What refuses a design knows its numbers in SI alone; who reads it has written ``"12 um"``.
    """
    token = _writing.set(_writing.get() or as_units)
    try:
        yield
    finally:
        _writing.reset(token)


def measured(value: Any, of: str = "length") -> str:
    """Return a number in a sentence, of a field or a dimension, with its unit where it is known.

    Examples
    --------
    >>> measured(4.68423e-07)
    '4.68423e-07'
    >>> with writing(lambda what, value: f"{1e6 * value:g} um"):
    ...     measured(4.68423e-07)
    '0.468423 um'
    """
    value, as_units = float(f"{float(value):.6g}"), _writing.get()
    return (as_units(of, value) if as_units else None) or f"{value:g}"


def warn(message: str, category: type[Warning], stacklevel: int = 2) -> None:
    """Tell a warning, or write it down where somebody notes them."""
    notes = _notes.get()
    if notes is None:
        warnings.warn(message, category, stacklevel=stacklevel + 1)
    else:
        notes.append(" ".join(message.split()))


def renamed(old: str, new: str, level: int = 3) -> None:
    """Warn that a name was replaced."""
    text = f"{old} is now called {new}; the old name works for one release more"
    warn(text, RenamedWarning, stacklevel=level)


def _written(field: str, value: Any) -> str:
    """Show the value of a field, with its unit where the units of the spec are known."""
    as_units = _writing.get()
    if as_units is not None and isinstance(value, (float, int)) and not isinstance(value, bool):
        return as_units(field, _settled(float(value))) or _shown(value)
    if as_units is not None and type(value) in (tuple, list):
        entries: list[Any] = list(value)  # type: ignore[arg-type]
        each = [as_units(field, _settled(v)) if isinstance(v, float) else None for v in entries]
        if each and all(each):
            return f"({', '.join(map(str, each))})"
    return _shown(value)


def _shown(value: Any) -> str:
    """Show a value on one line of at most 60 characters, numbers without the noise of rounding."""
    if isinstance(value, float):
        value = _settled(value)
    elif type(value) in (tuple, list):
        value = type(value)(_settled(v) if isinstance(v, float) else v for v in value)
    text = " ".join(str(value).split()) if not isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _settled(value: float) -> float:
    """Return a number without what binary fractions leave behind its twelfth digit.

    Examples
    --------
    >>> _settled(0.1 + 0.2)
    0.3
    """
    return float(f"{value:.12g}")


def nearest(
    name: Any, known: Iterable[str], cutoff: float = 0.6, old: Mapping[str, str] | None = None
) -> str:
    """Return what an error offers in place of an unknown name.

    `old` are names of earlier versions with those of today, which are offered.

    Examples
    --------
    >>> nearest("sped", ["speed", "torque"]), nearest("x", ["speed", "torque"])
    ('did you mean "speed"?', 'known: speed, torque')
    """
    from difflib import get_close_matches

    name, known = str(name), list(dict.fromkeys(known))
    before = get_close_matches(name, old or (), n=1, cutoff=cutoff)
    close = [(old or {})[b] for b in before] or get_close_matches(name, known, n=1, cutoff=cutoff)
    if close:
        return f'did you mean "{close[0]}"?'
    table, dot, _ = name.partition(".")
    near = [k for k in known if dot and k.startswith(f"{table}.")] or known
    more = ", ..." if len(near) > MOST_OFFERED else ""
    return "known: " + ", ".join(near[:MOST_OFFERED]) + more
