"""What is refused of a swimmer is said in its units: ``tail.radius = 10 µm``, not ``1e-05``."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import Any, TypeVar

from microswim import errors
from microswim.gait import doors

Called = TypeVar("Called", bound=Callable[..., Any])


def as_units(of: Any) -> AbstractContextManager[None]:
    """Return the context in which sentences have the units of a swimmer or a group."""
    return errors.writing(functools.partial(doors.go, doors.IN_UNITS, of.units))


def in_its_units(function: Called) -> Called:
    """Decorate a function of a swimmer or a group, whose refusals then have its units."""
    first = next(iter(inspect.signature(function).parameters))

    @functools.wraps(function)
    def called(*args: Any, **named: Any) -> Any:
        with as_units(args[0] if args else named[first]):
            return function(*args, **named)

    return called  # type: ignore[return-value]
