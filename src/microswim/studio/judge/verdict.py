"""The reference about a design, the surrogate beside it, and what calibration would give."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait.gait import Gait
from microswim.studio import answers
from microswim.studio.spec_tables import canonical, swimmer_of
from microswim.swimmer.swimmer import Swimmer

Progress = Callable[[int, int], None]
ROWS = (
    "swimming_speed",
    "forward_velocity",
    "body_rate_hz",
    "lateral_amplitude",
    "mean_torque",
    "mean_power",
    "efficiency",
)


def judge(question: dict[str, Any], progress: Progress) -> dict[str, Any]:
    """Return the reference's answer, the table of both, and what calibration here would give.

    The reference is finite elements in a channel, boundary elements elsewhere.
    """
    swimmer = swimmer_of(question["tables"])
    reference = swimmer.gait(
        "bem" if swimmer.channel is None else "fem",
        level=question.get("level", "standard"),
        progress=lambda i, n: progress(i, n + 1),
    )
    ours = answers.readings(swimmer, answers.surrogate(swimmer))
    theirs = answers.readings(swimmer, reference)
    answer = {
        "answer": answers.describe(swimmer, reference),
        "rows": compare(ours, theirs),
        "unknowns": int(reference.info.get("unknowns", 0)),
        "phases": int(reference.info.get("phases_solved", 0)),
        "level": question.get("level", "standard"),
        "circle": circle(swimmer, reference),
    }
    try:
        answer["calibration"] = calibration(swimmer, reference, theirs)
    except MicroswimError as error:
        answer["calibration"] = {"error": str(error)}
    return answer


def circle(swimmer: Swimmer, gait: Gait) -> dict[str, Any] | None:
    """Return the circle along the wall that a pose leads to while it is kept.

    A body of revolution turns about s without a change of its pose, and what moves it on is

        r = |u_t| / |Omega_n|,   centre n x u_t / Omega_n,

    u_t along the wall, Omega_n about its normal, both averaged over the phase.
    Nothing without a wall, or where it does not turn.
    """
    if swimmer.wall is None:
        return None
    n = np.array(swimmer.wall.normal)
    mean = np.real(gait.mean_velocity)
    along, about = mean[:3] - (mean[:3] @ n) * n, float(mean[3:] @ n)
    speed = float(np.linalg.norm(along))
    if abs(about) * 1e3 * swimmer.body_length < speed or speed == 0.0:
        return None
    return {
        "radius": speed / abs(about),
        "centre": (np.cross(n, along) / about).tolist(),
        "normal": n.tolist(),
        "sense": "counterclockwise" if about > 0 else "clockwise",
        "towards": float(-mean[:3] @ n),
    }


def compare(ours: dict[str, Any], theirs: dict[str, Any]) -> list[dict[str, Any]]:
    """Return rows of surrogate against reference; no percentage where the reference vanishes."""
    rows = []
    for name in ROWS:
        a, b = ours[name], theirs[name]
        if a is None or b is None:
            continue
        zero = abs(b) <= 1e-9 * (1.0 + abs(theirs["frequency"])) and name == "body_rate_hz"
        error = None if b == 0 or zero else abs(a) / abs(b) - 1.0
        rows.append({"name": name, "surrogate": a, "reference": b, "error": error})
    return rows


def calibration(swimmer: Swimmer, reference: Gait, theirs: dict[str, Any]) -> dict[str, Any]:
    """Return interaction coefficients that make the surrogate agree here, and how well they do."""
    from microswim.calibration.calibrate import calibrate

    fit = calibrate(swimmer, reference)
    rows = compare(answers.readings(fit.swimmer, answers.surrogate(fit.swimmer)), theirs)
    return {
        "tables": canonical(fit.swimmer),
        "coefficients": {k: float(v) for k, v in fit.coefficients.items()},
        "rows": rows,
        "warnings": list(fit.warnings),
    }
