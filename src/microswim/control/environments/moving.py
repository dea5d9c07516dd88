"""One step of a robot, whatever its task: field, flow and boundary, thermal noise, tumbles."""

from __future__ import annotations

from typing import Any

from microswim.control.environments.bench import made
from microswim.control.environments.beside import flowing, parts, shaken
from microswim.numerics.compiling.compiled import FAST, njit


@njit(cache=True, fastmath=FAST, error_model="numpy")
def move(
    model: Any, bounded: Any, mem: Any, slope: Any, u: Any, n: int, s: Any, keys: Any, i: int,
    work: Any,
) -> None:  # fmt: skip
    """Step robot i by ``s.dt`` in n parts.

    Parameters
    ----------
    model
        As of `world.World`.
    bounded
        What bounds the fluid, `beside.Boundary.model`, or None.
    mem
        What the robot remembers, its state (8,) first.
    slope
        Gradient of the field about the origin (9,).
    u
        Inputs, as in free fluid.
    """
    if bounded is not None:
        flowing(bounded[0], s.depth, u)
    if model[3].shape[0] > 0:
        made(model, bounded, model[3][i], slope, mem, u, n, s.dt / n, work)
    else:
        parts(model, bounded, mem, u, n, s.dt / n, work)
    shaken(model, bounded, mem, s, keys, i)
