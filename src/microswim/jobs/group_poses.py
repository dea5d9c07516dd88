"""Many poses of a group: solved several at a time, and kept in a file as they come."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from microswim import __version__
from microswim.errors import SpecError
from microswim.jobs.processes import cores
from microswim.models.group.blocks import Blocks, prepare
from microswim.models.group.poses import GroupPoses, solving
from microswim.numerics import archive
from microswim.numerics.files import write
from microswim.swimmer.group import Group

#: Seconds between two times that the file is written.
OFTEN = 5.0
_ARRAYS = ("resistance", "propulsion", "velocity", "gap")


def at_poses(
    group: Group,
    given: Mapping[str, Any],
    *,
    level: str = "standard",
    blocks: Blocks | None = None,
    workers: int | None = None,
    keep: str | PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> GroupPoses:
    """Solve for a group at many poses, so many at a time (default: all cores).

    Parameters
    ----------
    group, level, blocks, workers
        As of `Group.at_poses`.
    given
        ``positions`` and what else changes from pose to pose, by name.
    keep
        File in which what is solved is kept.
    progress
        Called with (poses done, poses in all).

    Raises
    ------
    SpecError
        If `keep` holds other poses.
    """
    m = len(given["positions"])
    groups = [group.moved(**{name: v[k] for name, v in given.items()}) for k in range(m)]
    place = None if keep is None else Path(keep)
    asked = blocks.level.name if blocks is not None else level
    digest = _digest(group, given, asked)
    arrays, refused = _empty(m, len(group.members)), [""] * m
    done = _begun(place, digest, arrays, refused)
    if progress is not None:
        progress(done, m)
    if done < m:
        blocks = prepare(group, level) if blocks is None else blocks
        kept_at = time.monotonic()
        try:
            with solving(groups, blocks, workers or cores(), done) as solutions:
                for found in solutions:
                    if isinstance(found, SpecError):
                        refused[done] = str(found)
                    else:
                        for name in _ARRAYS:
                            arrays[name][done] = getattr(found, name)
                    done += 1
                    if progress is not None:
                        progress(done, m)
                    if place is not None and time.monotonic() - kept_at > OFTEN:
                        _keep(place, digest, done, arrays, refused)
                        kept_at = time.monotonic()
        finally:
            if place is not None:
                _keep(place, digest, done, arrays, refused)
    return GroupPoses(**arrays, refused=tuple(refused))


def _empty(m: int, n: int) -> dict[str, np.ndarray]:
    shapes = ((m, 6 * n, 6 * n), (m, 6 * n, n), (m, n, 6), (m,))
    return {name: np.full(shape, np.nan) for name, shape in zip(_ARRAYS, shapes, strict=True)}


def _digest(group: Group, given: Mapping[str, Any], level: str) -> str:
    """Return a digest of all that the answers depend on."""
    told = {name: np.asarray(v, float).tolist() for name, v in given.items()}
    return sha256(repr((group, told, level, __version__)).encode()).hexdigest()


def _keep(
    place: Path,
    digest: str,
    done: int,
    arrays: Mapping[str, np.ndarray],
    refused: Sequence[str],
) -> None:
    notes = {"poses": digest, "done": done, "refused": list(refused[:done])}
    write(place, archive.pack(notes, {name: arrays[name][:done] for name in _ARRAYS}))


def _begun(
    place: Path | None, digest: str, arrays: Mapping[str, np.ndarray], refused: list[str]
) -> int:
    """Take over what a file holds; return the number of poses that it holds."""
    if place is None or not place.exists():
        return 0
    notes: dict[str, Any] = {}
    with suppress(OSError, ValueError, KeyError):
        notes, held = archive.unpack(place.read_bytes())
    if "poses" not in notes:
        raise SpecError(f"{place}: no poses that can be gone on with; begin anew")
    if notes["poses"] != digest:
        raise SpecError(
            f"{place}: holds other poses than those asked for; ask for the same scene, poses and "
            "level, or begin anew with --force"
        )
    done = int(notes["done"])
    for name in _ARRAYS:
        arrays[name][:done] = held[name]
    refused[:done] = notes["refused"]
    return done
