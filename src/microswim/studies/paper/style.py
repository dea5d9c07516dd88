"""Lines of the paper's figures: solid for the constant pair, dashed for coefficients from slender
body theory (SBT), circles for the reference.
"""

from __future__ import annotations

from microswim.output.plots.style import BLUE, ORANGE

CONSTANT = {"color": BLUE, "ls": "-", "lw": 1.4, "label": "model, constant $c_n$, $c_t$"}
SBT = {"color": ORANGE, "ls": (0, (4, 2)), "lw": 1.4, "label": "model, $c_n$, $c_t$ from SBT"}
REFERENCE = {
    "color": "black", "ls": "none", "marker": "o", "ms": 4.0, "mfc": "white", "mew": 0.9,
    "zorder": 3, "label": "boundary elements (ours)",
}  # fmt: skip
LINES = {"constant": CONSTANT, "sbt": SBT}
