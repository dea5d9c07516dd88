"""A region calibration as text, for the table [region] of a spec file.

An archive with a checksum (`microswim.numerics.archive`) in base64 holds the arrays to the last
bit, and the file stays one file. What comes from a file is checked whole, in `schema`, before
anything is computed with it.
"""

from __future__ import annotations

import base64
import binascii
import textwrap
from dataclasses import fields
from typing import Any

import numpy as np

from microswim.calibration.region import schema
from microswim.calibration.region.correction import Correction
from microswim.calibration.region.kriging import Kriging
from microswim.calibration.region.surfaces import Surfaces
from microswim.errors import SpecError
from microswim.numerics import archive

MOST_CHARACTERS = 1 << 25
_MOST_BYTES = 1 << 26  # unpacked
_OWN = [f.name for f in fields(Kriging) if f.name not in ("Z", "N")]


def pack(correction: Correction) -> str:
    """Return the text of a correction, in lines of 100 characters."""
    raw = archive.pack(*_parts(correction))
    return "\n".join(textwrap.wrap(base64.b64encode(raw).decode("ascii"), 100))


def digest(correction: Correction) -> str:
    """Return what tells one correction from another, however it is compressed."""
    return archive.digest(*_parts(correction))


def _parts(correction: Correction) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return the notes and the arrays of a correction."""
    groups = correction.surfaces.groups
    notes = {name: getattr(correction, name) for name in schema.NOTES}
    arrays: dict[str, Any] = {name: getattr(correction, name) for name in schema.ARRAYS}
    arrays |= {"Z": groups[0].Z, "N": groups[0].N}
    for i, group in enumerate(groups):
        arrays |= {f"{name}{i}": np.asarray(getattr(group, name)) for name in _OWN}
    return notes | {"content": schema.CONTENT[correction.choices["kind"]]}, arrays


def unpack(text: str) -> Correction:
    """Return the correction of a text that `pack` wrote.

    Raises
    ------
    SpecError
        If it is damaged, too long, or not what `microswim calibrate` writes.
    """
    try:
        if len(text) > MOST_CHARACTERS:
            raise schema.Wrong("it is too long")
        raw = base64.b64decode("".join(text.split()).encode("ascii"), validate=True)
        notes, arrays = archive.unpack(raw, _MOST_BYTES)
        kind = schema.check(notes, arrays)
        groups = tuple(
            Kriging(arrays["Z"], arrays["N"], **{n: _value(arrays[f"{n}{i}"]) for n in _OWN})
            for i in range(len(schema.GROUPS[kind]))
        )
        _require_definite(groups)
    except (binascii.Error, UnicodeError, archive.DamagedError, schema.Wrong) as error:
        why = str(error) if isinstance(error, (archive.DamagedError, schema.Wrong)) else "damaged"
        raise SpecError(
            f"region.data: must be what microswim calibrate wrote, and is not ({why}); "
            "take the file anew from where it came, or calibrate again"
        ) from None
    own = {name: arrays[name] for name in schema.ARRAYS}
    return Correction(
        surfaces=Surfaces(groups), **own, **{name: notes[name] for name in schema.NOTES}
    )


def _require_definite(groups: tuple[Kriging, ...]) -> None:
    """Refuse processes whose covariance no expected error can be computed from."""
    try:
        for group in groups:
            _ = group._factor
    except np.linalg.LinAlgError:
        raise schema.Wrong("a covariance is not positive definite") from None


def _value(array: np.ndarray) -> Any:
    return array if array.ndim else float(array)
