"""The record that a calibration leaves with its swimmer: the table [calibration] of the spec."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim import __version__
from microswim.calibration.coefficients import CoefficientCalibration
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.gait.observed import observed, parse
from microswim.models.rft.gait import unchecked as surrogate
from microswim.swimmer.provenance import Provenance, deciding
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    from microswim.calibration.region.correction import Correction

#: What is compared at one design, beside what was made to agree.
COMPARED = (
    *("mean.us", "amplitude.uq", "mean.os", "amplitude.or", "mean_power", "efficiency"),
    *("mobility.us.us", "mobility.uq.uq", "mobility.os.os", "mobility.or.or"),
)
NOTICED = 0.01  #: relative difference that is worth a word
VANISHES = 1e-9  #: share of the largest velocity below which an average is zero by symmetry


def _stamp() -> dict[str, Any]:
    return {"date": datetime.now(UTC).date().isoformat(), "version": __version__}


def kept(fit: CoefficientCalibration, data: Any) -> CoefficientCalibration:
    """Return a calibration whose swimmer says where its coefficients come from."""
    reference = data if isinstance(data, Gait) else None
    swimmer, numbers = fit.swimmer, fit.swimmer.numbers
    found = {path: numbers[path] for path in _paths(fit)}
    design, region = _where([o.swimmer for o in fit.observations])
    made = Provenance(
        reference=reference.model if reference is not None else "measurements",
        level=str(reference.info.get("level") or "") if reference is not None else "",
        law=swimmer.coefficients.law,
        design={n: v for n, v in design.items() if n not in found},
        region={n: v for n, v in region.items() if n not in found},
        found=found,
        matched=_left(fit),
        unmatched={} if reference is None else _others(fit, swimmer, reference),
        **_stamp(),
    )
    return replace(fit, swimmer=replace(swimmer, calibration=made))


def of_region(correction: Correction) -> Provenance:
    """Return where a region calibration comes from."""
    return Provenance(
        reference=correction.about["reference"],
        level=_level(correction.about),
        design=correction.fixed,
        region={name: (low, correction.high[name]) for name, low in correction.low.items()},
        matched={name: error["median"] for name, error in correction.errors.items()},
        **_stamp(),
    )


def _level(about: dict[str, Any]) -> str:
    return str(about["options"].get("level", "" if about["reference"] == "rft" else "standard"))


def _paths(fit: CoefficientCalibration) -> list[str]:
    from microswim.calibration.unknowns import resolve

    return [path for u in resolve(fit.swimmer, fit.names) for path, _ in u.paths]


def _where(swimmers: Iterable[Swimmer]) -> tuple[dict[str, float], dict[str, Any]]:
    """Return numbers that all designs share, and the ends of those that vary."""
    each = [deciding(s) for s in swimmers]
    shared = [n for n in each[0] if all(n in numbers for numbers in each)]
    ends = {n: (min(x[n] for x in each), max(x[n] for x in each)) for n in shared}
    return (
        {n: low for n, (low, high) in ends.items() if low == high},
        {n: pair for n, pair in ends.items() if pair[0] != pair[1]},
    )


def _left(fit: CoefficientCalibration) -> dict[str, float]:
    """Return the largest relative difference left of each quantity that was asked for."""
    out: dict[str, float] = {}
    at = 0
    for o in fit.observations:
        size = np.size(o.value)
        miss = np.max(np.abs(fit.predicted[at : at + size] - np.ravel(o.value)))
        out[o.quantity] = max(out.get(o.quantity, 0.0), _rounded(miss / (o.scale or 1.0)))
        at += size
    return out


def _others(fit: CoefficientCalibration, swimmer: Swimmer, reference: Gait) -> dict[str, float]:
    """Return what else is off by more than a per cent: the surrogate over the reference, less 1."""
    ours, free = surrogate(swimmer), dict(zip(DEGREES_OF_FREEDOM, reference.free))
    asked = {o.quantity for o in fit.observations}
    largest = float(np.max(np.abs(reference.velocity_amplitude + np.abs(reference.mean_velocity))))
    out = {}
    for name in COMPARED:
        _, entries = parse(name)
        if name in asked or not all(free[DEGREES_OF_FREEDOM[i]] for i in entries):
            continue
        if name == "efficiency" and reference.body_resistance_series is None:
            continue
        a, b = (float(np.real(observed(g, name))) for g in (ours, reference))
        vanishes = b == 0 or (name.startswith("mean.") and abs(b) < VANISHES * largest)
        if not vanishes and abs(a / b - 1.0) > NOTICED:
            out[name] = _rounded(a / b - 1.0)
    return out


def _rounded(value: float) -> float:
    return float(f"{float(value):.3g}")
