"""The Zarr store of a sweep: written block by block, resumed after any death, locked against two.

Every file of the store is replaced atomically, the status of a block after its results; a design
whose status is not written is solved again. Plain ``xarray.open_zarr`` reads the store at any
moment.

Nothing on disk is believed: every chunk carries a checksum, and every row one over its number and
all its values. Why so: docs/decisions/0008-sweep-store.md.
"""

from __future__ import annotations

import contextlib
import json
import shutil
import zlib
from collections.abc import Iterator, Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MachineError, SpecError
from microswim.studies.sweeps.layout import (
    DONE,
    FAILED,
    LONG_NAMES,
    MARKS,
    VECTORS,
    WAITING,
    blank,
    built,
    mend,
)
from microswim.studies.sweeps.space import Space

IDENTITY = ("store_format", "microswim_version", "spec", "calibration", "model", "options", "over")
KEPT = ("created", "machine", "libraries")  # of the run that began a store
_PRIME = np.uint64(0x9E3779B97F4A7C15)
_NOT_A_NUMBER = np.array([np.nan]).view(np.uint64)[0]


def marks(block: Mapping[str, np.ndarray], first: int) -> np.ndarray:
    """Return the checksum of each row of a block whose first row has the number `first`.

    Over the row's number and all its values. Each step, ``h = (h ^ word) * odd``, can be undone, so
    that one changed word always changes the result.
    """
    h = (np.arange(len(block["status"]), dtype=np.uint64) + np.uint64(first + 1)) * _PRIME
    numbers = [name for name in LONG_NAMES if name in block and name not in ("status", "reason")]
    words = [block[name].reshape(len(h), -1).T for name in numbers]
    for column in np.concatenate(words):
        bits = np.where(np.isnan(column), _NOT_A_NUMBER, column.view(np.uint64))
        h = (h ^ bits) * _PRIME
        h ^= h >> np.uint64(29)
    said = [zlib.crc32(str(r).encode()) if r else 0 for r in block["reason"]]
    h = (h ^ block["status"].astype(np.uint64)) * _PRIME
    return (h ^ np.array(said, dtype=np.uint64)) * _PRIME


class SweepStore:
    """Results of a sweep on disk. Use `create` or `resume` inside `microswim.jobs.lock.locked`.

    Parameters
    ----------
    path
        The store.
    space
        The designs.
    """

    def __init__(self, path: Path, space: Space) -> None:
        import zarr

        self.path, self.space = path, space
        group = zarr.open_group(path, mode="r+")
        self._arrays = {name: group[name] for name in LONG_NAMES if name in group}
        self._marks: Any = group[MARKS]

    @classmethod
    def create(cls, path: Path, space: Space, attributes: Mapping[str, Any]) -> SweepStore:
        """Return a new, empty store: built beside its place and moved there whole.

        Raises
        ------
        MachineError
            If the disk is full or the place cannot be written.
        """
        with _writing(path):
            built(path, space, attributes).rename(path)
        return cls(path, space)

    @classmethod
    def resume(cls, path: Path, space: Space, attributes: Mapping[str, Any]) -> SweepStore:
        """Return the store of the same sweep, what is damaged mended or left to be solved again.

        Raises
        ------
        SpecError
            If it holds another sweep, or none.
        MachineError
            If it cannot be read or written.
        """
        there = _attributes(path)
        for key in IDENTITY:
            if there.get(key) != attributes[key]:
                raise SpecError(
                    f"{path}: it holds another sweep ({_difference(key, there, attributes)}); "
                    "resume with the same, or give another --out"
                )
        with _writing(path):
            for left in path.rglob("*.partial"):  # half a file of a killed process, never in place
                left.unlink(missing_ok=True)
            kept = {k: v for k in KEPT if isinstance(v := there.get(k), str)}
            mend(path, built(path, space, {**attributes, **kept}))
            store = cls(path, space)
            for place, start, _ in space.blocks():
                store._check(place, start)
        return store

    def status(self, place: Any) -> np.ndarray:
        """Return the status of the designs of a block."""
        return np.asarray(self._arrays["status"][place]).reshape(-1)

    def read(self, place: Any) -> dict[str, np.ndarray]:
        """Return a block as it stands."""
        block = {}
        for name, array in self._arrays.items():
            values = np.asarray(array[place])
            values = values.astype(object) if name == "reason" else values
            block[name] = values.reshape(-1, *values.shape[len(place) :])
        return block

    def write(self, place: Any, first: int, block: Mapping[str, np.ndarray]) -> None:
        """Write a block, its status last.

        Raises
        ------
        MachineError
            If the disk is full, or the store is gone.
        """
        shape = tuple(s.stop - s.start for s in place)
        with _writing(self.path):
            self._require()
            self._marks[place] = marks(block, first).reshape(shape)
            for name, array in self._arrays.items():
                if name != "status":
                    array[place] = block[name].reshape(*shape, *block[name].shape[1:])
            self._arrays["status"][place] = block["status"].reshape(shape)
            self._require()

    def _require(self) -> None:
        """Refuse to write where the store was removed meanwhile, and leave nothing there."""
        if not (self.path / ".zgroup").exists():
            shutil.rmtree(self.path, ignore_errors=True)
            raise MachineError(f"{self.path}: it vanished while the sweep wrote it; start again")

    def _check(self, place: tuple[slice, ...], first: int) -> None:
        """Leave to be solved again what is damaged in a block."""
        rows = prod(s.stop - s.start for s in place)
        try:
            block, marked = self.read(place), np.asarray(self._marks[place]).reshape(-1)
            bad = (marked != marks(block, first)) & (block["status"] != WAITING)
            bad |= ~np.isin(block["status"], (WAITING, DONE, FAILED))
        except Exception:  # whatever zarr and its codecs raise for a damaged chunk
            block, bad = self._blank(rows), np.ones(rows, dtype=bool)
            self._forget(place)
        if bad.any():
            for name, values in self._blank(rows).items():
                block[name][bad] = values[bad]
            self.write(place, first, block)

    def _blank(self, rows: int) -> dict[str, np.ndarray]:
        return blank(rows, [n for n in self._arrays if n not in (*VECTORS, "status", "reason")])

    def _forget(self, place: tuple[slice, ...]) -> None:
        """Remove the files of a block, so that nothing damaged is read when it is written."""
        key = ".".join(str(s.start // n) for s, n in zip(place, self.space.chunks))
        for name in (*self._arrays, MARKS):
            file = self.path / name / (f"{key}.0" if name in VECTORS else key)
            file.unlink(missing_ok=True)


@contextlib.contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Say in one sentence why the store cannot be written."""
    try:
        yield
    except OSError as error:
        for left in path.rglob("*.partial"):
            left.unlink(missing_ok=True)
        raise MachineError(
            f"{path}: cannot be written: {error.strerror or error}; "
            "what is there stays, and --resume goes on with it"
        ) from error


def _attributes(path: Path) -> dict[str, Any]:
    try:
        there = json.loads((path / ".zattrs").read_text(encoding="utf-8"))
        json.loads((path / ".zgroup").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        there = None
    if not isinstance(there, dict):
        raise SpecError(f"{path}: not the store of a sweep, or damaged; give another --out")
    return there


def _difference(key: str, there: Mapping[str, Any], wanted: Mapping[str, Any]) -> str:
    """What differs, in a few words."""
    if key == "spec":
        try:
            old, new = json.loads(there["spec"]), json.loads(wanted["spec"])
        except (KeyError, TypeError, ValueError):
            return "its spec is missing"
        for part in new:
            for field in new[part] if isinstance(new[part], dict) else ():
                was, now = old.get(part, {}).get(field), new[part][field]
                if was != now:
                    return f"{part}.{field} = {was} there, {now} here"
    if key in ("model", "microswim_version", "store_format"):
        return f"{key.replace('_', ' ')} {there.get(key)} there, {wanted[key]} here"
    return "its designs differ" if key == "over" else f"its {key} differ"
