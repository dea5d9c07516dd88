"""What the page asks when a number changes: gait and readings.

Pure functions of the spec's tables; nothing is remembered. A gait travels as rows of a Fourier
series, 21 columns for the lower triangle of R and 6 for F_p, as `gait.stepping` packs them.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from microswim.calibration.atlas import choice
from microswim.calibration.atlas.expected import expected_error, of_reference
from microswim.errors import noted
from microswim.gait.gait import Gait
from microswim.gait.quantities import NUMBERS, numbers
from microswim.gait.screw import is_misled, leading_end
from microswim.gait.stepping import pack
from microswim.numerics.plain import plain
from microswim.spec.toml import to_toml
from microswim.studio import bounds as around
from microswim.studio import magnet
from microswim.studio.brought import surfaces as dropped
from microswim.studio.drawing import shape
from microswim.studio.spec_tables import canonical, swimmer_of, units_of
from microswim.swimmer.surroundings import clearance
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import unchosen

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
PHASES = 16  #: over half a period of a plane wave, as in maps
FELT = 1e-9  #: harmonics below this share of the largest do not travel


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
    with noted() as notes:
        gait = surrogate(swimmer)
        answer = describe(swimmer, gait)
    answer["tables"] = canonical(swimmer)
    if swimmer.region is not None:
        answer["tables"]["region"] = tables["region"]
    own = dropped.beside(answer["tables"])
    answer["toml"] = to_toml(own, f"{name}, from the microswim studio")
    answer["notes"] = list(dict.fromkeys(notes))
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
    magnetic = magnet.of(swimmer, gait)
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
    if not is_misled(float(np.real(gait.mean_velocity[0])), leads):
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
        left, own = {**made.unmatched, **made.matched}, of_reference(made)[0]
        beside |= {n: abs(left[of]) + own for n, of in COSTS.items() if here and of in left}
    return {
        "expected_error": plain(errors["us"]),
        "errors": plain(beside),
        "how": str(errors["how"]),
        "calibration": told,
        "atlas_knows": gait.model == "rft" and is_known_to_atlas(swimmer),
    }


def is_known_to_atlas(swimmer: Swimmer) -> bool:
    """Tell whether the atlas would answer, had nobody chosen a law or coefficients."""
    if swimmer.is_open:
        return False
    return not choice.not_atlas(unchosen(swimmer))


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
