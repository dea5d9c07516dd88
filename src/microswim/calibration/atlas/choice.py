"""The cheapest model that is honest for a swimmer (`auto`)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from microswim import checks
from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.atlas import of
from microswim.calibration.atlas.expected import LEVELS, expected_error
from microswim.calibration.atlas.gait import gait
from microswim.gait import doors
from microswim.gait.gait import Gait
from microswim.gait.readable import percent
from microswim.swimmer.swimmer import Swimmer

#: Mean velocities that an asked accuracy is about.
MEANS = ("us", "os")


def auto(swimmer: Swimmer, accuracy: float | None = None, **options: Any) -> Gait:
    """Return the gait by the cheapest model that serves a swimmer; it says which, and how far off
    it may be.

    An elastic tail is one for the model ``"elastic"``. Else the atlas where it covers the swimmer
    and the user chose no law and no coefficients, else resistive force theory; with an accuracy
    asked, boundary elements where neither holds it.

    Parameters
    ----------
    swimmer
        Any swimmer.
    accuracy
        Largest relative error of the mean ``us`` and ``os``, between 0 and 1; 19 of 20 hold it.
    options
        What the boundary elements take, if it comes to them.

    Returns
    -------
    Gait
        With ``info["expected_error"]``, as `expected_error` gives it.

    Raises
    ------
    SpecError
        If the accuracy is not a share, or no model serves.
    """
    doors.check_options("bem", options)
    if accuracy is not None:
        allowed = "a share above 0 and below 1, such as 0.02"
        checks.number("accuracy", accuracy, allowed, above=0.0, most=float(np.nextafter(1.0, 0.0)))
    if swimmer.tail.settles:
        made = _with_error(swimmer, swimmer.gait("elastic"), "")
    else:
        why = not_atlas(swimmer)
        made = _with_error(swimmer, gait(swimmer) if not why else swimmer.gait("rft"), why)
    if accuracy is None or _holds(made, accuracy):
        return made
    levels = [name for name, error in LEVELS.items() if error <= accuracy] or ["fine"]
    asked: dict[str, Any] = {"level": levels[0], **options}
    found = swimmer.gait("bem", **asked)
    was = made.info["expected_error"]["us"]
    off = "by an unknown error" if was is None else f"by up to {percent(was)}"
    return _with_error(swimmer, found, f"{made.model} is off {off} in u_s here")


def _holds(made: Gait, accuracy: float) -> bool:
    errors = [made.info["expected_error"][name] for name in MEANS]
    return all(error is not None and error <= accuracy for error in errors)


def not_atlas(swimmer: Swimmer) -> str:
    """Return in words why the atlas does not serve a swimmer; empty where it does."""
    if swimmer.tail.is_absent:
        return "rft: without a tail its resistance is that of its body alone"
    if swimmer.region is not None:
        return "rft, with the corrections of its region"
    if swimmer.calibration is not None and not swimmer.is_open:
        return "rft, with the coefficients of its calibration"
    if not swimmer.is_open:
        return "rft, as the spec chooses its law or its coefficients"
    missing = coordinates.outside(swimmer)
    if not missing and of(swimmer) is None:
        return "rft, as no atlas comes with this build"
    advice = "boundary elements do better: accuracy 2%, or model bem"
    return (
        f"rft, as the atlas does not cover this: {'; '.join(missing)}; {advice}" if missing else ""
    )


def _with_error(swimmer: Swimmer, made: Gait, remark: str) -> Gait:
    remarks = [*made.info.get("remarks", ()), *([remark] if remark else ())]
    error = expected_error(swimmer, made)
    return replace(made, info={**made.info, "remarks": remarks, "expected_error": error})
