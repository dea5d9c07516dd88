"""What is held over a step, by name, as the array that the compiled step reads; checked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from microswim import checks
from microswim.control import motion
from microswim.errors import SpecError


class ElasticInputs(TypedDict, total=False):
    """What a robot with an elastic tail may be given over a step."""

    motor_rate: ArrayLike | None
    force: ArrayLike | None
    torque: ArrayLike | None
    field: ArrayLike | None
    flow: ArrayLike | None


class Inputs(ElasticInputs, total=False):
    """What any other robot may: also how field and flow change in space and time."""

    field_rate: ArrayLike | None
    gradient: ArrayLike | None
    field_gradient: ArrayLike | None
    field_place: ArrayLike | None


_SHAPES: dict[str, tuple[int, ...]] = {
    name: (3, 3) if name.endswith("gradient") else (3,) for name in motion.INPUTS
}
_SHAPES["motor_rate"] = ()
EVERY = tuple(motion.INPUTS)  #: with respect to which a step has derivatives


def rows(rest: np.ndarray, n: int, inputs: Mapping[str, Any], locked: bool) -> np.ndarray:
    """Return the inputs of n swimmers, one row for all or (n, 37).

    Parameters
    ----------
    rest
        What holds where nothing is given (1, 37).
    n, inputs
        Swimmers, and what is given by name.
    locked
        Whether the motor is.

    Raises
    ------
    SpecError
        If an input is unknown, of the wrong shape or not finite.
    """
    U = rest.copy()
    for name, value in inputs.items():
        if value is None:
            continue
        if name not in _SHAPES:
            raise SpecError(name, value, "one of the inputs " + ", ".join(_SHAPES))
        try:
            given = np.asarray(value, dtype=float)
        except (TypeError, ValueError):
            raise SpecError(name, value, "made of numbers") from None
        shape = _SHAPES[name]
        if given.shape == (n, *shape) and n != len(U):
            U = np.repeat(U, n, axis=0)
        elif given.shape not in (shape, (n, *shape)):
            wanted = f"of shape {shape} or {(n, *shape)}"
            raise SpecError(name, value, wanted, "one for all swimmers or one each")
        U[:, motion.INPUTS[name]] = given.reshape(given.shape[: given.ndim - len(shape)] + (-1,))
    if not np.isfinite(U).all():
        bad = next(k for k, part in motion.INPUTS.items() if not np.isfinite(U[:, part]).all())
        raise SpecError(bad, inputs[bad], "finite")
    if inputs.get("gradient") is not None:
        _check_gradient(U[:, motion.INPUTS["gradient"]])
    if locked and U[:, 0].any():
        raise SpecError("motor_rate", inputs["motor_rate"], "0 for a swimmer whose motor is locked")
    return U


def _check_gradient(A: np.ndarray) -> None:
    trace = A[:, 0] + A[:, 4] + A[:, 8]
    if (abs(trace) > 1e-9 * np.abs(A).max(axis=1)).any():
        raise SpecError(
            "gradient", f"trace {trace[0]:.3g}", "free of trace: the fluid is incompressible"
        )


def columns_of(wrt: Any) -> np.ndarray:
    """Return the places of some inputs among all, by their names.

    Raises
    ------
    SpecError
        If a name is none of an input.
    """
    checks.words("wrt", wrt)
    wrt = (wrt,) if isinstance(wrt, str) else tuple(wrt)
    if not set(wrt) <= set(motion.INPUTS):
        raise SpecError("wrt", wrt, "some of the inputs " + ", ".join(motion.INPUTS))
    return np.concatenate([np.arange(motion.INPUT)[motion.INPUTS[name]] for name in wrt])
