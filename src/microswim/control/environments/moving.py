"""One step of a robot in free fluid, whatever its task: field, flow, thermal noise, tumbles."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.control.environments.bench import made
from microswim.control.environments.jostle import jostle, tumble
from microswim.control.motion import FIELD_BENDS, substep
from microswim.numerics.compiling.compiled import FAST, njit


@njit(cache=True, fastmath=FAST, error_model="numpy")
def move(
    model: Any, mem: Any, slope: Any, u: Any, n: int, s: Any, keys: Any, i: int, work: Any
) -> None:
    """Step robot i by ``s.dt`` in n parts.

    Parameters
    ----------
    model
        As of `world.World`.
    mem
        What the robot remembers, its state (8,) first.
    slope
        Gradient of the field about the origin (9,).
    u
        Inputs.
    """
    h, bends = s.dt / n, FIELD_BENDS if s.slope > 0.0 else 0
    if model[3].shape[0] > 0:
        made(model, model[3][i], slope, mem, u, n, h, work)
    else:
        for k in range(n):
            substep(model[0], model[1], model[2], mem, u, k * h, h, bends, work)
    if s.energy > 0.0:
        jostle(model[0], mem, np.sqrt(2.0 * s.energy * s.dt), keys, i)
    if s.run_time > 0.0:
        tumble(mem, s.dt / s.run_time, s.tumble, keys, i)
