"""How well what a rotating field does with a robot is known."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.swimmer.swimmer import Swimmer

#: Largest relative errors of step-out and of the velocity there, by model: 14 random robots against
#: boundary elements (benchmarks/step_out.py).
MEASURED = {"atlas": (0.006, 0.015), "rft": (0.06, 2.0)}
#: The same of robots without a body.
HEADLESS = {"atlas": (0.005, 0.009), "rft": (0.3, 0.34)}
#: The same of the step-out of a body alone.
ALONE = 0.0025


def expected(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return the relative errors of step-out and of the velocity there, and how they are known."""
    if swimmer.tail.is_absent:
        how = "largest miss of bodies alone against published resistances (docs/cad.md)"
        return {"step_out": ALONE, "velocity": None, "how": how}
    measured = HEADLESS if swimmer.body.is_absent else MEASURED
    known = {} if swimmer.tail.is_placed else measured
    step_out, velocity = known.get(gait.model, (None, None))
    how = "not measured for this model" if known else "not measured for such tails"
    if step_out is not None:
        how = "largest of 14 random helical robots against boundary elements"
    return {"step_out": step_out, "velocity": velocity, "how": how}


def expected_of_elastic(swimmer: Swimmer, judge: Any, torque: np.ndarray) -> dict[str, Any]:
    """Return the same of a robot that bends; torque is the judge's over that of local drag."""
    if judge is None:
        return {"step_out": None, "velocity": None, "how": "not measured; compare with model bem"}
    felt = torque[~np.isnan(torque)]
    if not len(felt):
        return {"step_out": None, "velocity": None, "how": "it is held at no frequency asked for"}
    how = (
        f"shape, attitude and step-out are those of local drag; {judge[0]} finds {felt.min():.2f} "
        f"to {felt.max():.2f} times its torque"
    )
    return {"step_out": float(np.abs(1.0 / felt - 1.0).max()), "velocity": None, "how": how}
