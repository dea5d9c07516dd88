"""Compiled code for the surrogate, loaded or compiled now instead of when work asks for it."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.gait import doors
from microswim.gait.screw import screw
from microswim.models.rft.batch import evaluate
from microswim.numerics.compiling.compiled import choose_compiled, settled
from microswim.numerics.compiling.cores import MANY
from microswim.numerics.complex_step import STEP
from microswim.swimmer.fields import lifted
from microswim.swimmer.geometry.bodies import Sphere
from microswim.swimmer.geometry.tails.custom_tail import CustomTail
from microswim.swimmer.geometry.tails.kinds import HelicalTail, PlaneWaveTail, Tail
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.swimmer import Swimmer


def _beat(s: np.ndarray, phase: np.ndarray) -> np.ndarray:
    return np.stack([s + 0 * phase, 0.1 * s * np.cos(s - phase), 0 * (s + phase)], axis=-1)


#: A helix on a sphere that the atlas knows.
_LIKE = Swimmer(
    body=Sphere(radius=0.5),
    tail=HelicalTail(length=2.0, amplitude=0.1, waves=1.0, radius=0.05),
    fluid=Fluid(viscosity=1.0),
)


def _tails() -> tuple[Tail, ...]:
    wave: dict[str, Any] = {"length": 2.0, "amplitude": 0.1, "waves": 1.0, "radius": 0.05}
    return (
        HelicalTail(**wave),
        PlaneWaveTail(**wave),
        CustomTail(shape=_beat, length=2.0, radius=0.05, wavelength=2.0),
    )


@checks.given()
def warm_up() -> None:
    """Load the surrogate's compiled code now, and use it from now on for single gaits too.

    Without it one gait runs as Python, in about a millisecond, and only work that would take a
    tenth of a second so waits for compiled code. Who computes thousands of gaits one by one, or
    wants no call to wait, calls it once at the start: it takes one to three seconds, and up to a
    minute when the code is compiled for the first time on a machine. Afterwards a gait takes less
    than a tenth of a millisecond. The two ways agree to rounding, not to the last bit; sweeps,
    whose results are kept, do not ask which was chosen.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.warm_up()
    >>> ms.Swimmer.preset("tabak/helix").gait().mean_velocity.shape
    (6,)
    """
    choose_compiled()
    with settled(True):
        for tail in _tails():
            swimmer = Swimmer(body=Sphere(radius=0.5), tail=tail, fluid=Fluid(viscosity=1.0))
            stepped = lifted(swimmer, {"fluid.viscosity": 1.0 + 1j * STEP})
            for one in (swimmer, stepped):
                screw(one.gait())
                one.gait(nodes=8)
            if tail.in_batches:
                for designs in (1, MANY):
                    evaluate(swimmer, {"tail.amplitude": np.full(designs, 0.1)})
        doors.go(doors.WARM_UP_ATLAS, _LIKE)
