"""Solves of a campaign in one file: a line of JSON each, so that it can go on wherever it was.

``{"i": 7, "x": [b k, k r_t, waves, head, aspect, ramp], "gait": {...}, "shape": [rows, complex],
"asym": ...}``: the numbers of `campaign.design`, and the Fourier series of a gait, complex numbers
as pairs. A design without ``gait`` was refused, and ``why`` says the reason.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from microswim.calibration.region.calibrate import ASYMMETRY
from microswim.calibration.region.fit import Solved
from microswim.errors import SpecError
from microswim.gait.gait import Gait

#: Fields of a gait in the file, with the shape of a row.
SERIES = {
    "resistance": (6, 6),
    "propulsion": (6,),
    "activity": (),
    "body_resistance": (6, 6),
    "body_propulsion": (6,),
}


def read(path: Path, design: Any) -> list[Solved]:
    """Return the resolved solves of a file.

    Parameters
    ----------
    path
        The file; a last line that was cut off does not count.
    design
        From the six numbers to a swimmer, or None where none can be built.

    Raises
    ------
    SpecError
        If a line is no solve.
    """
    out = []
    lines = path.read_text("utf-8").splitlines()
    for number, line in enumerate(lines, 1):
        try:
            held = json.loads(line)
            swimmer = design(held["x"]) if "gait" in held else None
            if swimmer is not None and held["asym"] < ASYMMETRY:
                out.append(Solved(swimmer, _gait(held, swimmer)))
        except (ValueError, KeyError, TypeError) as error:
            if number < len(lines):
                raise SpecError(f"{path}: line {number} is no solve: {error}") from None
    return out


def _gait(held: dict[str, Any], swimmer: Any) -> Gait:
    made = {}
    for name, row in SERIES.items():
        values = np.array(held["gait"][name], dtype=float)
        values = values.view(complex) if held["shape"][1] else values
        made[f"{name}_series"] = values.reshape(-1, *row)
    common = {"rate": swimmer.tail.rate, "free": swimmer.motion.mask, "model": "bem"}
    return Gait(**made, **common, info={"asymmetry": held["asym"]})
