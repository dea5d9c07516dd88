"""Isolated resistance of a body without closed form, solved once for each shape and kept.

Kept in memory, and in the user's cache folder where that can be written, under a name made of the
shape and of what solves it.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import numpy as np

from microswim import __version__
from microswim.errors import MachineError
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.surface import sampled, still
from microswim.models.bem.patches.triangles import RULE
from microswim.models.bem.patches.triangles import surface_of as of_triangles
from microswim.models.bem.system import resistance as of_surface
from microswim.numerics import archive
from microswim.numerics.files import cache_folder, write
from microswim.swimmer.geometry.body import Body

#: Patches along a quarter of the girth, and the level whose order and quadrature are used.
SPLITS, LEVEL = 1, "standard"
#: Named anew when patches or quadrature of the solve change.
VERSION = 1


def resistance(body: Body) -> np.ndarray:
    """Return R / mu (6, 6) of a body about its centre, by boundary elements or from the cache."""
    return _kept(body, body.identity).copy()


@lru_cache(maxsize=256)
def _kept(body: Body, identity: str) -> np.ndarray:
    name = hashlib.sha256(f"{VERSION} {__version__} {identity}".encode()).hexdigest()[:20]
    folder = cache_folder("bodies")
    path = None if folder is None else folder / f"{name}.npz"
    found = None if path is None else _read(path, identity)
    if found is not None:
        return found
    R = solved(body)
    if path is not None:
        with suppress(MachineError):  # where home cannot be written the next process solves anew
            write(path, archive.pack({"body": identity}, {"resistance": R}))
    return R


def solved(body: Body, splits: int = SPLITS) -> np.ndarray:
    """Return R / mu (6, 6) about the centre, symmetric; solved now."""
    if body.triangles is not None:
        surface, _ = of_triangles(body.triangles)
        R = of_surface(surface, 1.0, body.centre, RULE)
        return 0.5 * (R + R.T)
    level = get_level(LEVEL)
    surface = still(sampled(body.facets(splits)) - body.centre, level.resolution.order)
    R = of_surface(surface, 1.0, rule=level.rule)
    return 0.5 * (R + R.T)


def _read(path: Path, body: str) -> np.ndarray | None:
    """Return what was kept; None if there is nothing, or nothing that is whole."""
    try:
        notes, arrays = archive.unpack(path.read_bytes())
    except (OSError, ValueError):
        return None
    R = arrays.get("resistance")
    return R if notes.get("body") == body and R is not None and R.shape == (6, 6) else None
