"""A path on disk while it grows: arrays, and a digest of all that the path depends on."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.files import write


def keep(place: Path, digest: str, **known: Any) -> None:
    """Write what is known of a path, as a whole or not at all."""
    out = io.BytesIO()
    np.savez(out, digest=digest, format=1, **known)
    write(place, out.getvalue())


def kept(place: Path, digest: str, names: tuple[str, ...]) -> dict[str, Any]:
    """Return what a file holds of a path, by name.

    Raises
    ------
    SpecError
        If it is of another path, or cannot be read.
    """
    try:
        with np.load(place, allow_pickle=False) as data:
            if str(data["digest"]) != digest:
                raise SpecError(
                    f"{place}: holds another path than the one asked for; ask for the same spec, "
                    "start and time, or begin anew with --force"
                )
            return {name: data[name] for name in names}
    except (OSError, KeyError, ValueError) as error:
        if isinstance(error, SpecError):
            raise
        raise SpecError(f"{place}: no path that can be gone on with; begin anew") from None
