"""Against the world: the surrogate and the judge beside published numbers.

Vibrio alginolyticus (Tabak Section 3.1), Rodenborn's rigid helix, cells of the BOSO-Micro bank,
Table 3 of the paper. Each function gives rows; ``microswim world`` prints them and writes the page.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from microswim import data
from microswim.calibration.calibrate import calibrate
from microswim.calibration.observations import Observation
from microswim.calibration.unknowns import usual
from microswim.studies.paper.fig2 import inferred, model
from microswim.studies.paper.table2 import MICRO, SPECIMENS
from microswim.studies.paper.table3 import PRINTED_CFD, printed
from microswim.studies.world import cells
from microswim.swimmer.drag.coefficients import Cox, GrayHancock, Lighthill
from microswim.swimmer.geometry.tails.kinds import HelicalTail
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.swimmer import Swimmer

Row = dict[str, Any]
LEVEL = "coarse"  #: of the boundary elements: filaments of many turns are long


def vibrio() -> list[Row]:
    """Return specimens of Goto et al.: coefficients from C, the others predicted.

    The measured values are inferred from the paper's statements, not read from Goto et al.
    """
    measured = inferred()
    truth = np.array([measured["speed"], measured["rate"]]).T
    C = Swimmer.preset("goto/C")
    of_C = truth[SPECIMENS.index("C")] / (MICRO, 1.0)
    data_C = [
        Observation(swimmer=C, quantity=q, value=v, sigma=0.01 * v)
        for q, v in zip(("forward_velocity", "body_rate_hz"), of_C)
    ]
    gamma = tuple(calibrate(C, data_C).values)
    rows = []
    for name, known in zip(SPECIMENS, truth):
        plain, fitted = model(name, (1.0, 1.0)), model(name, gamma)
        row: Row = {
            "specimen": name,
            "speed, Gamma = 1 (um/s)": plain[0],
            "speed, calibrated": fitted[0],
            "rate, Gamma = 1 (Hz)": plain[1],
            "rate, calibrated": fitted[1],
        }
        for i, what in enumerate(("speed (um/s)", "rate (Hz)")):
            if name != "C" and np.isfinite(known[i]):
                row["inferred"] = f"{what} {known[i]:.4g}"
                row["error (%)"] = 100.0 * (fitted[i] / known[i] - 1.0)
        rows.append(row)
    rows[0]["Gamma_N, Gamma_R"] = ", ".join(f"{v:.3f}" for v in gamma)
    return rows


def rodenborn(bem: bool = True, level: str = LEVEL) -> list[Row]:
    """Return thrust, torque and drag of a rigid helix, measured against each law and the judge."""
    measured = data.load("rodenborn2013-helix")
    R, length, radius, mu = 6.3e-3, 130e-3, 0.397e-3, 100.0
    scale = np.array([mu * R**2, mu * R**3, mu * R])
    laws = {law.law: law for law in (Lighthill(), GrayHancock(), Cox())}
    rows = []
    for pitch in measured["lambda_over_R"].values:
        point = measured.sel(lambda_over_R=pitch)
        truth = np.array([float(point[n]) for n in measured.data_vars])
        tail = HelicalTail(
            length=length, amplitude=R, wavelength=float(pitch) * R, radius=radius, ramp=0.0
        )
        rows.append(_helix_row(pitch, "measured", truth, truth))
        for name, law in laws.items():
            rows.append(_helix_row(pitch, name, _isolated(tail, mu, law) / scale, truth))
        if bem:
            rows.append(_helix_row(pitch, "bem", _isolated(tail, mu, None, level) / scale, truth))
    return rows


def _isolated(tail: HelicalTail, mu: float, law: Any, level: str = LEVEL) -> np.ndarray:
    """Thrust and torque per unit rate and drag per unit speed of the tail alone."""
    from microswim.swimmer.geometry.bodies import NoBody

    swimmer = Swimmer(body=NoBody(), tail=tail, fluid=Fluid(viscosity=mu))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            if law is None:
                gait = swimmer.gait("bem", level=level)
            else:
                gait = replace(swimmer, coefficients=law).gait()
        except Exception:
            return np.full(3, np.nan)
    F, R = gait.propulsion(0.0), gait.resistance(0.0)
    return np.abs([F[0], F[3], R[0, 0]])


def _helix_row(pitch: float, model: str, values: np.ndarray, truth: np.ndarray) -> Row:
    row: Row = {"lambda/R": float(pitch), "model": model}
    for name, value, true in zip(("thrust", "torque", "drag"), values, truth):
        row[name] = float(value)
        row[f"{name} error (%)"] = 100.0 * (float(value) / float(true) - 1.0)
    return row


def table_3() -> list[Row]:
    """Return Table 3 of the paper from its own CFD velocities, for both readings of the tail's
    rate.

    For the plane wave the paper gives no velocities of the base case in numbers; there each set of
    coefficients is found from the velocities that the paper's other set implies.
    """
    rows = []
    for law in ("constant", "sbt"):
        rows.append(_row_3("helix", law, "paper", printed("helix", law)))
        for frame in ("body", "lab"):
            swimmer = Swimmer.preset(f"tabak/helix-{law}").with_({"motion.frequency_frame": frame})
            rows.append(
                _row_3("helix", law, f"rate in {frame}", calibrate(swimmer, PRINTED_CFD).values)
            )
    for law, other in (("constant", "sbt"), ("sbt", "constant")):
        rows.append(_row_3("plane_wave", law, "paper", printed("plane_wave", law)))
        implied = Swimmer.preset(f"tabak/plane_wave-{other}").gait()
        start = Swimmer.preset(f"tabak/plane_wave-{law}")
        fit = calibrate(start, implied, usual(start))
        rows.append(_row_3("plane_wave", law, f"from the velocities of {other}", fit.values))
    return rows


def _row_3(tail: str, law: str, source: str, values: Any) -> Row:
    names = ("gamma_N,s", "gamma_N,q", "gamma_R,s" if tail == "helix" else "gamma_R,r")
    row: Row = {"tail": tail, "coefficients": law, "source": source}
    return row | {name: float(v) for name, v in zip(names, values)}


def boso(bem: bool = True, level: str = LEVEL) -> list[Row]:
    """Return cells of the BOSO-Micro bank: measured and predicted speed, with spreads."""
    return cells.rows(bem, level)


def _cells_part(table_: list[Row], picture: str | None) -> list[str]:
    assumed = "\n".join(
        f"- {c.name}: {c.assumed}"
        + (
            f"; no spread in the bank for {', '.join(gaps)}"
            if (gaps := cells.without_spread(c))
            else ""
        )
        for c in cells.CELLS
    )
    return [
        "## Cells of the BOSO-Micro bank",
        "Measured and predicted speeds in um/s (speed along the mean path). Data: Velho Rodrigues, "
        "Lisicki & Lauga, PLoS ONE 16 (2021) e0252291, CC-BY 4.0. Body: spheroid of the bank's length "
        "and width; the flagellum's length is arc length; ramp over a tenth of the tail. Gray and "
        "Hancock's law with spin, nothing fitted. The spread of the prediction comes from "
        f"{cells.SAMPLES} geometries (body, length, amplitude, wavelength, frequency) drawn "
        "independently from the bank's spreads, 10 % where it gives none; samples that make no "
        "swimmer are left out. bem: at the mean geometry, level "
        f"`{LEVEL}`.",
        assumed,
        table(table_),
        *([f"![predicted against measured speed]({picture})"] if picture else []),
        "How to read it. A row of the bank pools several publications, so its geometry and its speed "
        "are not of one cell: agreement within the spread is all that can be asked. As a radius, E. "
        "coli's 0.38 um means a pitch angle of 45 degrees, as a diameter 27; the measured speed "
        "lies between the two. Sperm are mostly filmed next to a surface, and their beat is no sine of "
        "constant amplitude; the plane wave in free space is too slow for the sea urchins by "
        "28 to 44 %. Both models share the geometry: the gap between them is the surrogate's own "
        "error, the gap to the measurement is mostly what the bank does not know.",
    ]


def page(bem: bool = True, picture: str | None = None, found: list[Row] | None = None) -> str:
    """Return the page "Against the world" as Markdown, every number computed now.

    Parameters
    ----------
    bem
        Solve by boundary elements too.
    picture
        Link to the picture of the cells, if there is one.
    found
        Rows of `boso`, if they are there already.
    """
    parts = [
        "# Against the world",
        "Made by `microswim world --out docs/world.md`; do not edit.",
        "## Vibrio alginolyticus",
        "Coefficients Gamma_N, Gamma_R from specimen C, the others predicted. The measurements of Goto et "
        "al. are not given as numbers; what is called inferred is what the errors stated by Tabak & "
        "Yesilyurt (Section 3.1) make of their own model. So the errors at B, F and G are the paper's "
        "by construction: the table shows that its coefficients follow from C, and nothing of the cells.",
        table(vibrio()),
        "## Rodenborn's helix",
        "Isolated rigid helix (R = 6.3 mm, L = 130 mm, a = 0.397 mm) in the paper's units: thrust / (mu "
        "Omega R^2), torque / (mu Omega R^3), drag / (mu U R). Digitised from Fig. 2, a few per cent.",
        table(rodenborn(bem)),
        *_cells_part(boso(bem) if found is None else found, picture),
        "## Table 3 from the paper's own CFD velocities",
        "Helix: u_s = -0.038, lateral amplitude 0.015, Omega_s = -0.4 rad per period. The forward and "
        "rotational coefficients lie between the two readings of the rate, within the rounding of the "
        "velocities. The lateral one does not: with the paper's coefficients the model's amplitude is "
        "0.0168 to 0.0182, so the printed pair and the printed amplitude do not belong together. Plane "
        "wave: the base case's CFD velocities are only in Fig. 5, not in numbers; what can be tested "
        "is that either set of coefficients follows from the velocities that the other implies.",
        table(table_3()),
    ]
    return "\n\n".join(parts) + "\n"


def table(rows: list[Row]) -> str:
    """Return rows as a Markdown table."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    lines = ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
    for row in rows:
        cells = [f"{v:.4g}" if isinstance(v := row.get(n, ""), float) else str(v) for n in names]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)
