"""The map: a reading over two numbers of a spec, and the best design on it.

Pure functions of the spec's tables; nothing is remembered.
"""

from __future__ import annotations

import math
import threading
import time
from types import SimpleNamespace
from typing import Any

import numpy as np

from microswim.calibration.atlas.everywhere import everywhere
from microswim.errors import SpecError
from microswim.gait.quantities import QUANTITIES
from microswim.gait.turning.driven import DRIVEN
from microswim.models.rft.batch import evaluate, expected_errors, is_regular
from microswim.studies.optimisation.merits import of_many
from microswim.studio import budget
from microswim.studio.spec_tables import swimmer_of
from microswim.swimmer.geometry.tails.kinds import WaveTail
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.swimmer import Swimmer

MAP_OUTPUTS = ("swimming_speed", "efficiency", "mean_power", "mean_torque", "body_rate_hz")
#: Numbers that a map is first drawn over: the first two that a design has and that can vary.
AXES = (
    "tail.amplitude",
    "tail.waves",
    "tail.wavelength",
    "tail.bending",
    "tail.length",
    "tail.radius",
)
MOST_DESIGNS = 4000
MOST_SINGLY = (12, 9)  #: values along the sides where symmetry does not help and each design counts
PIECE = 2000  #: designs between two looks at the budget
SLOW = ("driven_speed",)  #: a tenth of a second a design: for `microswim sweep`
TOLERANCE = 1e-3  #: of the quadrature of a map
KERNELS = threading.Lock()  #: the batched kernels are parallel already: one caller at a time


def axis(swimmer: Swimmer, ask: Any) -> tuple[str, np.ndarray]:
    """Return the field and values of one side of a map, SI or dimensionless.

    Raises
    ------
    SpecError
        If the field or the range makes no sense.
    """
    if not isinstance(ask, dict):
        raise SpecError("an axis of the map needs field, from, to and count")
    field, low, high, count = (ask.get(k) for k in ("field", "from", "to", "count"))
    bounds = ("wall.", "channel.")  # of which the surrogate knows nothing
    known = {n for n in swimmer.numbers if not n.startswith(bounds)}
    known |= {"tail.waves", "tail.wavelength"} if isinstance(swimmer.tail, WaveTail) else set()
    if field not in known:
        raise SpecError("map", field, "a number of this spec, such as tail.amplitude")
    ends = [v for v in (low, high) if isinstance(v, (int, float)) and math.isfinite(v)]
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise SpecError("map", f"{low} to {high}", "a range from a number to a larger one")
    if not isinstance(count, int) or not 2 <= count <= 200:
        raise SpecError("map", count, "2 to 200 values along a side")
    if (field == "tail.waves" and ends[1] > 20) or field.endswith("coupling"):
        raise SpecError("map", f"{field} up to {high}", "at most 20 waves")
    return field, np.linspace(ends[0], ends[1], count)


def driven(swimmer: Swimmer) -> tuple[str, ...]:
    """Return what a map can show of a swimmer in its rotating field; or nothing."""
    if drive_of(swimmer) is None or not all(swimmer.motion.mask[3:]):
        return ()
    return tuple(name for name in DRIVEN if name not in SLOW)


def map_(tables: Any, x: Any, y: Any, output: Any = None) -> dict[str, Any]:
    """Return readings over a grid of two numbers of the spec; null where a design is impossible.

    What a field does to it, step-out and the like, where the output asks for that: on a coarser
    grid, since each design counts.
    """
    start = time.perf_counter()
    swimmer = swimmer_of(tables)
    (fx, X), (fy, Y) = axis(swimmer, x), axis(swimmer, y)
    if X.size * Y.size > MOST_DESIGNS:
        raise SpecError("map", f"{X.size} x {Y.size}", f"at most {MOST_DESIGNS} designs")
    if fx == fy or {fx, fy} == {"tail.waves", "tail.wavelength"}:
        raise SpecError("map", f"{fx} and {fy}", "two different numbers")
    in_field = output if output in driven(swimmer) else None
    if in_field or not is_regular(swimmer, {fx: X, fy: Y}):
        X, Y = (np.linspace(v[0], v[-1], min(v.size, n)) for v, n in zip((X, Y), MOST_SINGLY))
    results, serves = _served(swimmer, fx, X, fy, Y, in_field)
    told = (*MAP_OUTPUTS, *([in_field] if in_field else ()))
    values = {k: _short(results[k]) for k in told}
    made = {"x": X.tolist(), "y": Y.tolist(), "values": values, "inside": None, "model": serves}
    made["expected_error"] = _short(results["expected_error"])
    if swimmer.region is not None:
        made["inside"] = {"x": _calibrated(swimmer, fx), "y": _calibrated(swimmer, fy)}
    made["milliseconds"] = 1e3 * (time.perf_counter() - start)
    return made


def _served(
    swimmer: Swimmer, fx: str, X: Any, fy: str, Y: Any, in_field: str | None
) -> tuple[dict[str, np.ndarray], str]:
    """Outputs and expected errors over a grid, and the model: the atlas where it holds anywhere.

    Where it does not hold beside that there is no answer: two models on one map would make a cliff.
    """
    by_atlas = everywhere(swimmer, (fx, fy))
    if by_atlas is not None:
        results = _grid(by_atlas, fx, X, fy, Y, in_field)
        if np.isfinite(results["swimming_speed"]).any():
            return results, "atlas"
    return _grid(swimmer, fx, X, fy, Y, in_field), "rft"


def _calibrated(swimmer: Swimmer, field: str) -> list[float] | None:
    """Ends of a field in the region of a calibration; nothing if it may have any value."""
    region = swimmer.region
    assert region is not None
    if field in region.low:
        return [float(region.low[field]), float(region.high[field])]
    held = region.fixed.get(field)
    return None if held is None else [float(held)] * 2


def _grid(
    swimmer: Swimmer, fx: str, X: Any, fy: str, Y: Any, in_field: str | None
) -> dict[str, np.ndarray]:
    """Outputs over the grid, y by rows, flattened."""
    gx, gy = (g.ravel() for g in np.meshgrid(X, Y))
    pieces = []
    for rows in np.array_split(np.arange(gx.size), -(-gx.size // PIECE)):
        budget.check()
        with KERNELS:
            here = {fx: gx[rows], fy: gy[rows]}
            pieces.append(evaluate(swimmer, here, tolerance=TOLERANCE))
            if swimmer.region is not None:
                pieces[-1]["expected_error"] = expected_errors(swimmer, here)
            if in_field:
                found = of_many(swimmer, here, TOLERANCE, (in_field,))
                pieces[-1][in_field] = found[in_field]
    made = {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
    made.setdefault("expected_error", np.full(gx.size, np.nan))
    return {**made, "body_rate_hz": QUANTITIES["body_rate_hz"].of(SimpleNamespace(**made))}


def _short(values: np.ndarray) -> list[float | None]:
    """Return numbers to five digits, None where there is none."""
    known = np.isfinite(values)
    v = np.where(known, values, 0.0)
    places = 4 - np.floor(np.log10(np.where(v == 0.0, 1.0, np.abs(v))))
    over, under = 10.0 ** np.maximum(places, 0), 10.0 ** np.maximum(-places, 0)
    short = (np.rint(v * over / under) * under / over).astype(object)
    short[~known] = None
    return short.tolist()


def optimum(tables: Any, x: Any, y: Any, output: str, zooms: int = 5) -> dict[str, Any]:
    """Return the best design on a map: a grid that closes in on its best point, five times.

    Speed and efficiency are to be large; of the others, the size. A surrogate that carries a
    region calibration is searched inside that region.
    """
    swimmer = swimmer_of(tables)
    allowed = (*MAP_OUTPUTS, *driven(swimmer))
    if output not in allowed:
        raise SpecError("output", output, "one of " + ", ".join(allowed))
    in_field = output if output in DRIVEN else None
    (fx, X), (fy, Y) = axis(swimmer, {**x, "count": 17}), axis(swimmer, {**y, "count": 13})
    X, Y = _trusted(swimmer, fx, X), _trusted(swimmer, fy, Y)
    ends = (X[0], X[-1]), (Y[0], Y[-1])
    best = None
    for _ in range(zooms):
        value = np.abs(_served(swimmer, fx, X, fy, Y, in_field)[0][output])
        if np.isnan(value).all():
            break
        j, i = map(int, np.unravel_index(np.nanargmax(value), (Y.size, X.size)))
        best = {"x": float(X[i]), "y": float(Y[j]), "value": float(np.nanmax(value))}
        X = _closer(X, i, *ends[0])
        Y = _closer(Y, j, *ends[1])
    if best is None:
        raise SpecError("optimum: no design on this map is possible; widen its ranges")
    return {"fields": [fx, fy], **best}


def _trusted(swimmer: Swimmer, field: str, values: np.ndarray) -> np.ndarray:
    """As many values within the region of a calibration, if any: outside it may be wild."""
    ends = None if swimmer.region is None else _calibrated(swimmer, field)
    if ends is None:
        return values
    low, high = max(ends[0], values[0]), min(ends[1], values[-1])
    if low > high:
        raise SpecError(
            "optimum: this map shows nothing of the calibrated region; widen its ranges"
        )
    return np.linspace(low, high, values.size)


def _closer(values: np.ndarray, at: int, low: float, high: float) -> np.ndarray:
    """Grid of as many values around one of them, 1.5 old steps to each side, within the ends."""
    reach = 1.5 * (values[1] - values[0])
    return np.linspace(max(low, values[at] - reach), min(high, values[at] + reach), values.size)
