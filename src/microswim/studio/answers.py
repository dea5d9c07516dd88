"""What the page asks when a number changes: gait, readings, map, optimum.

Pure functions of the spec's tables; nothing is remembered. A gait travels as rows of a Fourier
series, 21 columns for the lower triangle of R and 6 for F_p, as `gait.stepping` packs them.
"""

from __future__ import annotations

import math
import threading
import time
import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np

from microswim.calibration.atlas import choice
from microswim.calibration.atlas.everywhere import everywhere
from microswim.calibration.atlas.expected import expected_error
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.quantities import NUMBERS, QUANTITIES, numbers
from microswim.gait.screw import leading_end
from microswim.gait.stepping import pack
from microswim.models.rft.batch import evaluate, expected_errors, is_regular
from microswim.numerics.plain import plain
from microswim.spec.toml import to_toml
from microswim.studio import bounds as around
from microswim.studio import budget, magnet
from microswim.studio.brought import surfaces as dropped
from microswim.studio.drawing import shape
from microswim.studio.spec_tables import canonical, swimmer_of, units_of
from microswim.swimmer.geometry.tails.kinds import WaveTail
from microswim.swimmer.surroundings import clearance
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
PIECE = 500  #: designs between two looks at the budget
#: Readings that are as far off as a velocity.
MEASURES = {
    "swimming_speed": "us",
    "path_speed": "us",
    "forward_velocity": "us",
    "lateral_amplitude": "uq",
    "yaw_amplitude": "or",
    "body_rate": "os",
    "body_rate_hz": "os",
}
#: Readings whose error a calibration knows where it was made, each by the quantity it compared.
COSTS = {"mean_power": "mean_power", "mean_torque": "mean_power", "efficiency": "efficiency"}
TOLERANCE = 1e-3  #: of the quadrature of a map
PHASES = 16  #: over half a period of a plane wave, as in maps
FELT = 1e-9  #: harmonics below this share of the largest do not travel
KERNELS = threading.Lock()  #: the batched kernels are parallel already: one caller at a time


def solve(tables: Any, name: str = "design") -> dict[str, Any]:
    """Return everything the page shows about one design, by the atlas or the surrogate.

    Raises
    ------
    SpecError
        One sentence on what is wrong with the spec.
    """
    start = time.perf_counter()
    swimmer = swimmer_of(tables)
    clearance.check(swimmer)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        gait = surrogate(swimmer)
        answer = describe(swimmer, gait)
    answer["tables"] = canonical(swimmer)
    if swimmer.region is not None:
        answer["tables"]["region"] = tables["region"]
    own = dropped.beside(answer["tables"])
    answer["toml"] = to_toml(own, f"{name}, from the microswim studio")
    ours = [w for w in caught if w.category.__module__.startswith("microswim")]
    answer["notes"] = list(dict.fromkeys(" ".join(str(w.message).split()) for w in ours))
    answer["milliseconds"] = 1e3 * (time.perf_counter() - start)
    return answer


def surrogate(swimmer: Swimmer) -> Gait:
    """Return the gait by the atlas where `auto` takes it, else by resistive force theory.

    Resolved as far as an eye and five digits need.
    """
    if not choice.not_atlas(swimmer):
        return swimmer.gait("atlas")
    plain = swimmer.tail.is_rigid or swimmer.region is not None
    phases: dict[str, Any] = {} if plain else {"phases": PHASES}
    return swimmer.gait(**phases)


def describe(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return the shape, gait and readings of a swimmer, ready for JSON."""
    magnetic = magnet.of(swimmer)
    leads = leading_end(gait)
    return {
        "units": {k: v[0] for k, v in units_of(swimmer).items()},
        "dimensional": swimmer.units == "SI",
        "shape": shape(swimmer),
        "around": around.scene(swimmer),
        "magnet": magnetic,
        "gait": {
            "model": gait.model,
            "rate": float(gait.rate),
            "free": list(map(bool, gait.free)),
            "one_pose": gait.one_pose,
            "series": _felt(pack(gait)),
            "body": _body_series(gait),
        },
        "readings": readings(swimmer, gait),
        "leading_end": leads,
        "remarks": [*_sways(gait, leads), *gait.info.get("remarks", ()), *magnetic["remarks"]],
        **trust(swimmer, gait),
        "region": swimmer.region is not None,
    }


def _sways(gait: Gait, leads: str) -> list[str]:
    """What a forward velocity says that is taken in a body that sways."""
    back = float(np.real(gait.mean_velocity[0])) > 0.0
    if not leads or back == (leads == "tail"):
        return []
    return [f"the forward velocity is that in the swaying body; along its path the {leads} leads"]


def trust(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return how far the velocities may be off, how that is known, and whence a calibration is."""
    errors, made = expected_error(swimmer, gait), swimmer.calibration
    beside = {name: errors.get(of) for name, of in MEASURES.items()}
    told = None
    if made is not None:
        here = not (made.away(swimmer) or made.changed(swimmer))
        told = {"here": here, "lines": made.lines(swimmer), "missed": made.missed}
        left = {**made.unmatched, **made.matched}
        beside |= {n: abs(left[of]) for n, of in COSTS.items() if here and of in left}
    return {
        "expected_error": plain(errors["us"]),
        "errors": plain(beside),
        "how": str(errors["how"]),
        "calibration": told,
    }


def readings(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return the numbers beside the scene, all quantities of a gait that are one number."""
    found = numbers(gait, swimmer.body_length)
    return plain({name: found[name] for name in NUMBERS})


def _felt(series: np.ndarray) -> list[list[float]]:
    """Rows of a series up to the last harmonic that can be felt."""
    scale = np.abs(series).max(axis=0)
    shares = np.abs(series) / np.where(scale > 0, scale, 1.0)
    # lateral drift of rounding in columns that vanish by symmetry must not keep harmonics alive
    blocks = [np.arange(21), np.arange(21, 27)]
    size = np.stack([np.abs(series[:, b]).max(axis=1) for b in blocks])
    felt = (size > FELT * size.max(axis=1, keepdims=True)).any(axis=0) & (shares > FELT).any(axis=1)
    last = int(np.flatnonzero(felt).max(initial=0))
    return series[: 1 + 2 * ((last + 1) // 2)].tolist()


def _body_series(gait: Gait) -> list[list[float]] | None:
    """The share of the body alone, packed in the same way."""
    R, F = gait.body_resistance_series, gait.body_propulsion_series
    if R is None:
        return None
    held = Gait(R, np.zeros((1, 6)) if F is None else F, np.zeros(1), rate=gait.rate)
    return _felt(pack(held))


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


def map_(tables: Any, x: Any, y: Any) -> dict[str, Any]:
    """Return readings over a grid of two numbers of the spec; null where a design is impossible."""
    start = time.perf_counter()
    swimmer = swimmer_of(tables)
    (fx, X), (fy, Y) = axis(swimmer, x), axis(swimmer, y)
    if X.size * Y.size > MOST_DESIGNS:
        raise SpecError("map", f"{X.size} x {Y.size}", f"at most {MOST_DESIGNS} designs")
    if fx == fy or {fx, fy} == {"tail.waves", "tail.wavelength"}:
        raise SpecError("map", f"{fx} and {fy}", "two different numbers")
    if not is_regular(swimmer, {fx: X, fy: Y}):
        X, Y = (np.linspace(v[0], v[-1], min(v.size, n)) for v, n in zip((X, Y), MOST_SINGLY))
    results, serves = _served(swimmer, fx, X, fy, Y)
    values = {k: [_short(v) for v in results[k]] for k in MAP_OUTPUTS}
    made = {"x": X.tolist(), "y": Y.tolist(), "values": values, "inside": None, "model": serves}
    made["expected_error"] = [_short(v) for v in results["expected_error"]]
    if swimmer.region is not None:
        made["inside"] = {"x": _calibrated(swimmer, fx), "y": _calibrated(swimmer, fy)}
    made["milliseconds"] = 1e3 * (time.perf_counter() - start)
    return made


def _served(
    swimmer: Swimmer, fx: str, X: Any, fy: str, Y: Any
) -> tuple[dict[str, np.ndarray], str]:
    """Outputs and expected errors over a grid, and the model: the atlas where it holds anywhere.

    Where it does not hold beside that there is no answer: two models on one map would make a cliff.
    """
    own = any(name.startswith(("interaction.", "coefficients.")) for name in (fx, fy))
    by_atlas = None if own else everywhere(swimmer)
    if by_atlas is not None:
        results = _grid(by_atlas, fx, X, fy, Y)
        if np.isfinite(results["swimming_speed"]).any():
            return results, "atlas"
    return _grid(swimmer, fx, X, fy, Y), "rft"


def _calibrated(swimmer: Swimmer, field: str) -> list[float] | None:
    """Ends of a field in the region of a calibration; nothing if it may have any value."""
    region = swimmer.region
    assert region is not None
    if field in region.low:
        return [float(region.low[field]), float(region.high[field])]
    held = region.fixed.get(field)
    return None if held is None else [float(held)] * 2


def _grid(swimmer: Swimmer, fx: str, X: Any, fy: str, Y: Any) -> dict[str, np.ndarray]:
    """Outputs over the grid, y by rows, flattened."""
    gx, gy = (g.ravel() for g in np.meshgrid(X, Y))
    pieces = []
    for rows in np.array_split(np.arange(gx.size), -(-gx.size // PIECE)):
        budget.check()
        with KERNELS:
            pieces.append(evaluate(swimmer, {fx: gx[rows], fy: gy[rows]}, tolerance=TOLERANCE))
            if swimmer.region is not None:
                own = expected_errors(swimmer, {fx: gx[rows], fy: gy[rows]})
                pieces[-1]["expected_error"] = own
    made = {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
    made.setdefault("expected_error", np.full(gx.size, np.nan))
    return {**made, "body_rate_hz": QUANTITIES["body_rate_hz"].of(SimpleNamespace(**made))}


def _short(value: float) -> float | None:
    return float(f"{value:.5g}") if math.isfinite(value) else None


def optimum(tables: Any, x: Any, y: Any, output: str, zooms: int = 5) -> dict[str, Any]:
    """Return the best design on a map: a grid that closes in on its best point, five times.

    Speed and efficiency are to be large; of the others, the size. A surrogate that carries a
    region calibration is searched inside that region.
    """
    swimmer = swimmer_of(tables)
    if output not in MAP_OUTPUTS:
        raise SpecError("output", output, "one of " + ", ".join(MAP_OUTPUTS))
    (fx, X), (fy, Y) = axis(swimmer, {**x, "count": 17}), axis(swimmer, {**y, "count": 13})
    X, Y = _trusted(swimmer, fx, X), _trusted(swimmer, fy, Y)
    ends = (X[0], X[-1]), (Y[0], Y[-1])
    best = None
    for _ in range(zooms):
        value = np.abs(_served(swimmer, fx, X, fy, Y)[0][output])
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
