"""What a region calibration from a file must be: names, shapes, types, bounds of all it holds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

#: What the arrays mean; of a plane wave since 2 the logarithms of mean thrust and power.
CONTENT = {"helix": "region 1", "plane_wave": "region 2"}
NOTES = ("low", "high", "fixed", "choices", "errors", "about")
ARRAYS = ("columns", "spots", "ratios")
MOST_DESIGNS = 2048
FEATURES = 7
#: Columns of each group of targets, and whether they are complex, as they are packed.
GROUPS = {
    "helix": ((1, False), (12, False), (6, True)),
    "plane_wave": ((1, False), (9, False), (10, True), (6, True), (6, True)),
}
QUANTITIES = ("mean.us", "amplitude.uq", "mean.os", "amplitude.or")
_LARGEST = 1e30  # of any number in the file


class Wrong(ValueError):
    """Something is not as `microswim calibrate` writes it."""


def check(notes: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> str:
    """Return the kind of tail, once all is as it must be.

    Raises
    ------
    Wrong
        In a few words.
    """
    content = notes.get("content")
    _require(content in CONTENT.values(), "it is of another version, or no region")
    _require(set(notes) == {*NOTES, "content"}, "its notes are not those of a region")
    for name in NOTES:
        _require(isinstance(notes[name], dict), f"{name} is no table")
    kind = notes["choices"].get("kind")
    _require(isinstance(kind, str) and kind in GROUPS, "its kind of tail is unknown")
    _require(content == CONTENT[kind], "it is of another version")
    _check_words(notes)
    _check_ranges(notes["low"], notes["high"])
    _check_errors(notes["errors"])
    _check_arrays(arrays, kind, len(notes["errors"]))
    return kind


def _require(holds: Any, otherwise: str) -> None:
    if not holds:
        raise Wrong(otherwise)


def _is_number(value: Any) -> bool:
    real = isinstance(value, (int, float)) and not isinstance(value, bool)
    return real and math.isfinite(value) and abs(value) <= _LARGEST


def _check_words(notes: Mapping[str, Any]) -> None:
    words = notes["choices"]
    _require("shape" in words and all(isinstance(w, str) for w in words.values()), "a choice")
    _require(all(map(_is_number, notes["fixed"].values())), "a fixed number is none")
    reference = notes["about"].get("reference")
    _require(reference in ("rft", "bem", "fem"), "its reference is unknown")


def _check_ranges(low: Mapping[str, Any], high: Mapping[str, Any]) -> None:
    _require(set(low) == set(high), "its ranges have different names")
    for name, least in low.items():
        known = name.startswith(("tail.", "body."))
        numbers = _is_number(least) and _is_number(high[name])
        _require(known and numbers and 0 < least < high[name], "a range makes no sense")


def _check_errors(errors: Mapping[str, Any]) -> None:
    _require(errors and set(errors) <= set(QUANTITIES), "its errors are of unknown quantities")
    _require("mean.us" in errors, "the error of its speed is missing")
    for each in errors.values():
        whole = isinstance(each, dict) and set(each) == {"median", "p90", "worst"}
        _require(whole and all(_is_number(e) and e >= 0 for e in each.values()), "an error is none")


def _check_arrays(arrays: Mapping[str, np.ndarray], kind: str, quantities: int) -> None:
    n, f = (
        len(arrays[name].T) if name in arrays and arrays[name].ndim else 0
        for name in ("N", "columns")
    )
    _require(2 <= n <= MOST_DESIGNS, "its number of designs")
    _require(f <= FEATURES, "its number of features")
    spots = len(arrays["spots"]) if "spots" in arrays and arrays["spots"].ndim else 0
    _require(n <= spots <= 2 * MOST_DESIGNS, "the places of its errors")
    wanted: dict[str, tuple[tuple[int, ...], bool]] = {
        "columns": ((3, f), False),
        "spots": ((spots, f), False),
        "ratios": ((spots, quantities), False),
        "Z": ((n, f), False),
        "N": ((n,), False),
    }
    for i, (m, pairs) in enumerate(GROUPS[kind]):
        wanted |= {f"lengths{i}": ((f,), False), f"phasors{i}": ((3,), False)}
        wanted |= {f"noise{i}": ((), False), f"variance{i}": ((m,), False)}
        wanted |= {f"alpha{i}": ((n, m), pairs), f"mean{i}": ((m,), pairs)}
    _require(set(arrays) == set(wanted), "an array is missing or too many")
    for name, (shape, pairs) in wanted.items():
        array = arrays[name]
        _require(array.shape == shape, f"{name} is not of its size")
        _require(array.dtype.str == ("<c16" if pairs else "<f8"), f"{name} is not of its type")
        _require(np.all(np.abs(array) <= _LARGEST), f"{name} holds what is no number")
    _check_signs(arrays, len(GROUPS[kind]))


def _check_signs(arrays: Mapping[str, np.ndarray], groups: int) -> None:
    used, _, spread = arrays["columns"]
    _require(np.all(np.isin(used, np.arange(FEATURES))), "a feature is unknown")
    _require(np.all(np.diff(used) > 0) and np.all(spread > 0), "its features")
    _require(np.all(arrays["N"] > 0) and np.all(arrays["ratios"] >= 0), "a sign")
    for i in range(groups):
        _require(np.all(arrays[f"lengths{i}"] > 0) and arrays[f"noise{i}"] > 0, "a sign")
        _require(np.all(arrays[f"phasors{i}"] >= 0), "a sign")
        _require(np.all(arrays[f"variance{i}"] >= 0), "a sign")
