"""Cells of the BOSO-Micro bank: predicted against measured speed, with the spread of the geometry.

The bank pools publications, so geometry and speed of a row are not those of one cell; what is
assumed on top is in `CELLS`. Spreads that the bank leaves out are taken as `MISSING` of the value.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import truncnorm

from microswim import data
from microswim.gait.screw import screw
from microswim.jobs import references
from microswim.models.rft.batch import evaluate
from microswim.output.plots.style import look, panels
from microswim.swimmer.drag.coefficients import GrayHancock
from microswim.swimmer.geometry.bodies import Spheroid
from microswim.swimmer.geometry.tails.kinds import HelicalTail, PlaneWaveTail
from microswim.swimmer.motion import Motion
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.swimmer import Swimmer

MISSING = 0.1  #: relative spread of what the bank gives without one
SAMPLES = 1000
VISCOSITY = 1e-3  # Pa s; at a given rate it cancels
MICRO = 1e-6
_COLUMNS = {
    "body.semi_axes[0]": ("B", 0.5 * MICRO),
    "body.semi_axes[1]": ("W", 0.5 * MICRO),
    "tail.length": ("L", MICRO),
    "tail.amplitude": ("h", MICRO),
    "tail.wavelength": ("lambda", MICRO),
    "tail.frequency": ("f", 1.0),
}


@dataclass(frozen=True)
class Cell:
    """A row of the bank and what has to be assumed to make a swimmer of it."""

    name: str
    table: str
    species: str
    filament: float
    assumed: str
    share: float = 1.0


BACTERIA, SPERM = "boso-micro-bacteria", "boso-micro-spermatozoa"
_HELIX = "rigid helix, its rate that of the filament seen from the lab"
_WAVE = "plane wave"
CELLS = (
    Cell("V. alginolyticus", BACTERIA, "Vibrio alginolyticus", 0.016, f"{_HELIX}; radius 16 nm"),
    Cell(
        "E. coli, h a radius",
        BACTERIA,
        "Escherichia coli",
        0.03,
        f"{_HELIX}; the bundle is one filament of radius 30 nm; h is the radius of the helix",
    ),
    Cell(
        "E. coli, h a diameter",
        BACTERIA,
        "Escherichia coli",
        0.03,
        f"{_HELIX}; as before, but h is the diameter of the helix",
        0.5,
    ),
    Cell("bull sperm", SPERM, "Bos (bull)", 0.25, f"{_WAVE}; radius 0.25 um; round head"),
    *(
        Cell(f"sea urchin ({species.split()[0]})", SPERM, species, 0.12, f"{_WAVE}; radius 0.12 um")
        for species in (
            "Lytechinus (sea urchin)",
            "Strongylocentrotus purpuratus (sea urchin)",
            "Colobocentrotus (sea urchin)",
        )
    ),
)


def measured(cell: Cell) -> dict[str, tuple[float, float]]:
    """Return the mean and spread of the speed and of each number of the spec, in SI units."""
    row = data.load(cell.table).sel(Species=cell.species)

    def pair(column: str, unit: float) -> tuple[float, float]:
        value, spread = float(row[column]), float(row[f"d{column}"])
        return unit * value, unit * (spread if np.isfinite(spread) else MISSING * value)

    out = {name: pair(*where) for name, where in _COLUMNS.items()}
    mean, spread = out["tail.amplitude"]
    out["tail.amplitude"] = (cell.share * mean, cell.share * spread)
    return out | {"swimming_speed": pair("U", MICRO)}


def swimmer(cell: Cell) -> Swimmer:
    """Return cell at the mean geometry; Gray and Hancock's law with spin, all six velocities free.

    Examples
    --------
    >>> from microswim.studies.world import cells
    >>> cells.swimmer(cells.CELLS[0]).tail.kind
    'helix'
    """
    at = {name: mean for name, (mean, _) in measured(cell).items()}
    bacterium = cell.table == BACTERIA
    tail = (HelicalTail if bacterium else PlaneWaveTail)(
        length=at["tail.length"],
        length_measure="arc",
        amplitude=at["tail.amplitude"],
        wavelength=at["tail.wavelength"],
        radius=cell.filament * MICRO,
        frequency=at["tail.frequency"],
    )
    return Swimmer(
        body=Spheroid(semi_axes=(at["body.semi_axes[0]"], at["body.semi_axes[1]"])),
        tail=tail,
        fluid=Fluid(viscosity=VISCOSITY, density=1e3),
        coefficients=GrayHancock(),
        motion=Motion(frequency_frame="lab" if bacterium else "body"),
        units="SI",
    )


def spread(cell: Cell, samples: int = SAMPLES, seed: int = 1) -> np.ndarray:
    """Return speeds that resistive force theory gives for geometries drawn from the measured
    spread.

    Independent normal errors, cut at three standard deviations and at a tenth of the mean;
    geometries that make no swimmer are left out.
    """
    rng = np.random.default_rng(seed)
    values = {}
    for name, (mean, sigma) in measured(cell).items():
        if name != "swimming_speed":
            low = max(-3.0, (0.1 * mean - mean) / sigma)
            draw = truncnorm.rvs(low, 3.0, size=samples, random_state=rng)
            values[name] = mean + sigma * draw
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        speed = evaluate(swimmer(cell), values)["swimming_speed"]
    return speed[np.isfinite(speed)]


def rows(bem: bool = True, level: str = "coarse", folder: Any = None) -> list[dict[str, Any]]:
    """Return one row per cell: measured and predicted speeds in um/s, with their spreads."""
    made = [swimmer(cell) for cell in CELLS]
    found: list[Any] = [None] * len(made)
    if bem:
        found = references.gaits(made, "bem", folder=folder, level=level)
    out = []
    for cell, own, judge in zip(CELLS, made, found):
        speed, sigma = measured(cell)["swimming_speed"]
        drawn = spread(cell) / MICRO
        low, high = np.quantile(drawn, [0.16, 0.84])
        row: dict[str, Any] = {
            "cell": cell.name,
            "measured": speed / MICRO,
            "spread": sigma / MICRO,
            "rft": screw(own.gait()).speed / MICRO,
            "rft, 16 %": float(low),
            "rft, 84 %": float(high),
            "left out (%)": 100.0 * (1.0 - len(drawn) / SAMPLES),
        }
        if bem:
            row["bem"] = float("nan") if isinstance(judge, str) else screw(judge).speed / MICRO
            row["note"] = judge if isinstance(judge, str) else ""
        out.append(row)
    return out


def picture(table: list[dict[str, Any]]) -> Any:
    """Return the figure: predicted against measured speed, with spreads."""
    with look():
        figure, grid = panels(1, 1, (6.4, 4.2))
        _speeds(grid[0, 0], table)
    return figure


def _speeds(ax: Any, table: list[dict[str, Any]]) -> None:
    judged = [row for row in table if np.isfinite(row.get("bem", np.nan))]
    ends = [5.0, 500.0]
    ax.plot(ends, ends, color="0.6", linewidth=0.8)
    ax.fill_between(ends, [x / 2 for x in ends], [2 * x for x in ends], color="0.93", zorder=0)
    for row in table:
        x, dx, y = row["measured"], row["spread"], row["rft"]
        bars = [[max(y - row["rft, 16 %"], 0.0)], [max(row["rft, 84 %"] - y, 0.0)]]
        shown = ax.errorbar(x, y, yerr=bars, xerr=dx, fmt="o", capsize=2, linewidth=1, markersize=5)
        label = f"{row['cell']}"
        ax.plot([], [], "o", color=shown.lines[0].get_color(), label=label)
        if row in judged:
            ax.plot(x, row["bem"], "D", color=shown.lines[0].get_color(), markerfacecolor="none")
    if judged:
        ax.plot([], [], "D", color="k", markerfacecolor="none", label="bem")
    ax.set(xscale="log", yscale="log", xlim=ends, ylim=ends)
    ax.set(xlabel="measured speed (µm/s)", ylabel="predicted speed (µm/s)")
    ax.set_title("bars: spread of speed, and of geometry; grey: within a factor of two")
    ax.legend(loc="upper left")


def without_spread(cell: Cell) -> list[str]:
    """Return numbers that the bank gives without a spread."""
    row = data.load(cell.table).sel(Species=cell.species)
    columns = [column for column, _ in _COLUMNS.values()]
    return [c for c in columns if not np.isfinite(float(row[f"d{c}"]))]
