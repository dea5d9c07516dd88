"""A region calibration as text, for the table [region] of a spec file.

Arrays go through NumPy's npz and base64, so the file holds them to the last bit and stays one file.
"""

from __future__ import annotations

import base64
import binascii
import io
import json
import textwrap
import zipfile
from dataclasses import fields

import numpy as np

from microswim.calibration.region.correction import Correction
from microswim.calibration.region.kriging import Kriging, Surfaces
from microswim.errors import SpecError

_NOTES = ("low", "high", "fixed", "choices", "errors", "about")


def pack(correction: Correction) -> str:
    """Text of a correction, in lines of 100 characters."""
    notes = {name: getattr(correction, name) for name in _NOTES}
    groups = correction.surfaces.groups
    arrays = {"columns": correction.columns, "notes": np.array(json.dumps(notes))}
    arrays |= {"spots": correction.spots, "ratios": correction.ratios}
    arrays |= {"Z": groups[0].Z, "N": groups[0].N, "groups": np.array(len(groups))}
    for i, group in enumerate(groups):
        own = {f.name: getattr(group, f.name) for f in fields(group) if f.name not in ("Z", "N")}
        arrays |= {f"{name}{i}": np.asarray(value) for name, value in own.items()}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return "\n".join(textwrap.wrap(base64.b64encode(buffer.getvalue()).decode("ascii"), 100))


def unpack(text: str) -> Correction:
    """Correction of a text that `pack` wrote.

    Raises
    ------
    SpecError
        If it is damaged.
    """
    try:
        raw = base64.b64decode("".join(text.split()), validate=True)
        with np.load(io.BytesIO(raw), allow_pickle=False) as file:
            held = {name: file[name] for name in file.files}
        notes = json.loads(str(held["notes"]))
        names = [f.name for f in fields(Kriging) if f.name not in ("Z", "N")]
        groups = tuple(
            Kriging(held["Z"], held["N"], **{n: _value(held[f"{n}{i}"]) for n in names})
            for i in range(int(held["groups"]))
        )
        own = {name: held[name] for name in ("columns", "spots", "ratios")}
        return Correction(surfaces=Surfaces(groups), **own, **notes)
    except (binascii.Error, ValueError, KeyError, TypeError, OSError, zipfile.BadZipFile):
        raise SpecError(
            "region.data: must be what microswim calibrate wrote; calibrate again"
        ) from None


def _value(array: np.ndarray) -> np.ndarray | float:
    return array if array.ndim else float(array)
