"""The atlas as a file: one NumPy archive of arrays and a note in JSON."""

from __future__ import annotations

import io
import json
from dataclasses import fields
from typing import Any

import numpy as np

from microswim.calibration.atlas.atlas import Atlas
from microswim.calibration.atlas.near import Misses
from microswim.calibration.region.kriging import Kriging
from microswim.calibration.region.surfaces import Surfaces

_OWN = [f.name for f in fields(Kriging) if f.name not in ("Z", "N")]


def pack(atlas: Atlas) -> bytes:
    """Return the file's content; weights to double, errors to single precision."""
    groups = atlas.surfaces.groups
    first = groups[0]
    arrays: dict[str, Any] = {n: getattr(atlas, n) for n in ("centre", "spread", "exponents")}
    arrays |= {"Z": first.Z, "N": first.N}
    for i, group in enumerate(groups):
        arrays |= {f"{name}{i}": np.asarray(getattr(group, name)) for name in _OWN}
    for name, misses in {"atlas": atlas.misses, **atlas.plain}.items():
        arrays |= {f"missed_{name}": misses.missed.astype(np.float32)}
        arrays |= {f"factor_{name}": misses.factor}
    notes = {"groups": len(groups), "laws": list(atlas.plain), "about": atlas.about}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, notes=np.array(json.dumps(notes)), **arrays)
    return buffer.getvalue()


def unpack(content: bytes) -> Atlas:
    """Return the atlas of a file that `pack` wrote."""
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        held = {name: file[name] for name in file.files}
    notes = json.loads(str(held["notes"]))
    groups = [{n: held[f"{n}{i}"] for n in _OWN} for i in range(notes["groups"])]
    surfaces = Surfaces(tuple(Kriging(held["Z"], held["N"], **group) for group in groups))

    def misses(name: str) -> Misses:
        return Misses(held["Z"], held[f"missed_{name}"].astype(float), held[f"factor_{name}"])

    own = {n: held[n] for n in ("centre", "spread", "exponents")}
    plain = {law: misses(law) for law in notes["laws"]}
    return Atlas(surfaces, **own, misses=misses("atlas"), plain=plain, about=notes["about"])
