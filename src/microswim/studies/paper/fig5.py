"""Fig. 5: travelling plane waves, model against reference; as Fig. 4.

The body's rotation is the amplitude of its rate about r.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from microswim.studies.paper.context import WAVES, Context, circles, lines, sweep, swimmer
from microswim.studies.paper.fig4 import six_panels

TITLE = "Fig. 5. Swimmer with a travelling plane wave"
CAPTION = (
    "Travelling plane waves, as Fig. 4. The rotation is the amplitude of the body's rate about r."
)
ROWS = (
    r"$\overline{u}_s$ ($D_b$ / period)",
    r"$v_{q,\,\mathrm{max}}$ ($D_b$ / period)",
    r"$\Omega_{r,\,\mathrm{max}}$ (rev / period)",
)


def compute(context: Context) -> dict[str, Any]:
    """Return both sweeps of the plane wave."""
    return sweep(context, "plane_wave")


def plot(result: dict[str, Any]) -> Figure:
    """Return six panels as in the paper."""
    return six_panels(result, ROWS)


def many_waves(context: Context, coefficients: str = "sbt") -> float:
    """Return the change of the speed from its maximum to five waves (%; negative: it falls)."""
    x = np.linspace(1.0, 5.0, 161)
    speed = -lines(swimmer("plane_wave", coefficients), {WAVES: x})[:, 0]
    return float(100.0 * (speed[-1] / speed.max() - 1.0))


def swing(context: Context, source: str = "sbt") -> float:
    """Return the contrast of the rate about r over 2 to 4 waves: (largest - least) / (largest +
    least).
    """
    x = np.linspace(2.0, 4.0, 81)
    if source == "reference":
        n = context.sweeps[WAVES]
        y = circles(context, "plane_wave", WAVES)[(n >= 2.0) & (n <= 4.0), 2]
    else:
        y = lines(swimmer("plane_wave", source), {WAVES: x})[:, 2]
    return float(np.ptp(y) / (y.max() + y.min()))


def swing_ratio(context: Context) -> float:
    """Return `swing` of the model (constant pair) over that of the reference."""
    return swing(context, "constant") / swing(context, "reference")
