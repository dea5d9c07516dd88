"""Arrays with notes as bytes: NumPy's npz with a checksum over everything, checked when read.

Nothing of an archive is believed before the checksum holds: sizes are looked at before memory is
taken, and no object is unpickled.
"""

from __future__ import annotations

import hashlib
import io
import json
import math
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np

FORMAT = 1
MOST_BYTES = 1 << 28
_MOST_MEMBERS = 500
_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


class DamagedError(ValueError):
    """An archive is not what `pack` wrote."""


def pack(notes: Mapping[str, Any], arrays: Mapping[str, Any]) -> bytes:
    """Return an archive of notes (what JSON can hold) and arrays, the same bytes every time."""
    held = _held(notes, arrays)
    buffer = io.BytesIO()
    whole: dict[str, Any] = {**held, "checksum": np.array(_digest(held))}
    np.savez_compressed(buffer, **whole)
    return buffer.getvalue()


def digest(notes: Mapping[str, Any], arrays: Mapping[str, Any]) -> str:
    """Return the checksum of what `pack` would write; it does not depend on the compression."""
    return _digest(_held(notes, arrays))


def _held(notes: Mapping[str, Any], arrays: Mapping[str, Any]) -> dict[str, np.ndarray]:
    text = json.dumps({"format": FORMAT, **notes})
    return {
        "notes": np.array(text),
        **{name: np.asarray(v, order="C") for name, v in arrays.items()},
    }


def unpack(raw: bytes, most: int = MOST_BYTES) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Return notes and arrays of an archive that `pack` wrote.

    Parameters
    ----------
    raw
        The archive.
    most
        Bytes that it may hold when unpacked.

    Raises
    ------
    DamagedError
        If it is damaged, of another format, or too large.
    """
    try:
        held = _members(raw, most)
        checksum = str(held.pop("checksum"))
        if checksum != _digest(held):
            raise DamagedError("its checksum does not hold")
        notes = json.loads(str(held.pop("notes")))
        if notes.pop("format") != FORMAT:
            raise DamagedError("it is of another format")
    except DamagedError:
        raise
    except Exception:  # whatever zipfile, zlib, json and NumPy raise for what is no archive
        raise DamagedError("it is damaged") from None
    return notes, held


def _members(raw: bytes, most: int) -> dict[str, np.ndarray]:
    with zipfile.ZipFile(io.BytesIO(raw)) as file:
        inside = file.infolist()
        if len(inside) > _MOST_MEMBERS or sum(m.file_size for m in inside) > most:
            raise DamagedError("it is too large")
        return {m.filename.removesuffix(".npy"): _array(file.read(m)) for m in inside}


def _array(raw: bytes) -> np.ndarray:
    """Return an array of the npy format, its size checked before it is made."""
    file = io.BytesIO(raw)
    shape, fortran, dtype = _HEADERS[np.lib.format.read_magic(file)](file)
    content = raw[file.tell() :]
    if dtype.hasobject or math.prod(shape) * dtype.itemsize != len(content):
        raise DamagedError("an array is not of its size")
    flat = np.frombuffer(content, dtype) if len(content) else np.empty(0, dtype)
    return flat.reshape(shape, order="F" if fortran else "C").copy()


def _digest(held: Mapping[str, np.ndarray]) -> str:
    whole = hashlib.sha256()
    for name in sorted(held):
        array = held[name]
        whole.update(f"{name} {array.dtype.str} {array.shape};".encode())
        whole.update(array.tobytes())
    return whole.hexdigest()
