"""The Zarr store of a sweep: written block by block, resumed after any death, locked against two.

Every file of the store is replaced atomically, the status of a block after its results; a design
whose status is not written is solved again. Plain ``xarray.open_zarr`` reads the store at any
moment. Why so: docs/decisions/sweep-store.md.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import socket
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.studies.sweeps.space import Space

VECTORS = ("mean_velocity", "velocity_amplitude")
NUMBERS = ("swimming_speed", "mean_power", "mean_torque", "efficiency", "expected_error")
WAITING, DONE, FAILED = 0, 1, 2

# A row holds every output, NaN where it is not known; a failed row says why.
LONG_NAMES = {
    "mean_velocity": "twist averaged over the period, body frame, about the body's centre",
    "velocity_amplitude": "half of peak to peak of each component over the period",
    "swimming_speed": "net displacement along the screw axis per time",
    "mean_power": "power of the motor, averaged over the period",
    "mean_torque": "mean power over the phase rate",
    "efficiency": "hydrodynamic efficiency, Eq. (24)",
    "expected_error": "expected relative error of a calibrated surrogate; NaN if not known",
    "status": "0 not solved yet, 1 solved, 2 failed",
    "reason": "why a design failed; empty if it did not",
}


def blank(rows: int) -> dict[str, np.ndarray]:
    """Rows that hold nothing yet."""
    out: dict[str, np.ndarray] = {name: np.full((rows, 6), np.nan) for name in VECTORS}
    out |= {name: np.full(rows, np.nan) for name in NUMBERS}
    out["status"] = np.zeros(rows, dtype=np.int8)
    out["reason"] = np.full(rows, "", dtype=object)
    return out


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a store; the operating system frees it when its process dies, however.

    Raises
    ------
    MicroswimError
        If another sweep holds it.
    """
    lock = path.parent / (path.name + ".lock")
    lock.parent.mkdir(parents=True, exist_ok=True)
    while True:
        handle = lock.open("a+", encoding="utf-8")
        if not _seize(handle):
            handle.seek(0)
            holder = handle.read().strip() or "another process"
            handle.close()
            raise MicroswimError(
                f"{path}: another sweep is writing it ({holder}); wait for it or stop it, "
                "or give another --out"
            )
        if _same_file(handle, lock):
            break
        handle.close()  # the former holder removed it between our opening and our locking
    handle.truncate(0)
    since = time.strftime("%Y-%m-%d %H:%M:%S")
    handle.write(f"process {os.getpid()} on {socket.gethostname()}, since {since}\n")
    handle.flush()
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)
        handle.close()


def _seize(handle: Any) -> bool:
    """Take an exclusive lock that dies with this process; whether it was free."""
    try:
        import fcntl
    except ModuleNotFoundError:  # Windows
        import msvcrt

        try:
            handle.seek(1 << 20)  # away from the text, which others may read
            msvcrt.locking(handle.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        except OSError:
            return False
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _same_file(handle: Any, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(handle.fileno()), path.stat())
    except FileNotFoundError:
        return False


class SweepStore:
    """Results of a sweep on disk. Use `create` or `resume` inside `locked`.

    Parameters
    ----------
    group
        The Zarr group.
    space
        The designs.
    """

    def __init__(self, group: Any, space: Space) -> None:
        self.space = space
        self._arrays = {name: group[name] for name in LONG_NAMES}

    @classmethod
    def create(cls, path: Path, space: Space, attributes: Mapping[str, Any]) -> SweepStore:
        """A new, empty store: built beside its place and moved there whole."""
        import zarr

        fresh = path.with_name(f"{path.name}.{os.getpid()}.new")
        shutil.rmtree(fresh, ignore_errors=True)
        group = zarr.create_group(fresh, zarr_format=2, attributes=dict(attributes))
        _add_arrays(group, space)
        zarr.consolidate_metadata(fresh)
        fresh.rename(path)
        return cls(zarr.open_group(path, mode="r+"), space)

    @classmethod
    def resume(cls, path: Path, space: Space, attributes: Mapping[str, Any]) -> SweepStore:
        """The store of the same sweep.

        Raises
        ------
        SpecError
            If it holds another sweep, or none.
        """
        import zarr

        try:
            group = zarr.open_group(path, mode="r+")
            there = dict(group.attrs)
        except Exception:  # whatever this version of zarr raises for what is not a store
            raise SpecError(f"{path}: not the store of a sweep; give another --out") from None
        for key in ("microswim_version", "spec", "calibration", "model", "options", "over"):
            if there.get(key) != attributes[key]:
                raise SpecError(
                    f"{path}: it holds another sweep ({_difference(key, there, attributes)}); "
                    "resume with the same, or give another --out"
                )
        for left in path.rglob("*.partial"):  # half a file of a killed process, never in place
            left.unlink(missing_ok=True)
        return cls(group, space)

    def status(self, place: tuple[slice, ...]) -> np.ndarray:
        """Status of the designs of a block."""
        return np.asarray(self._arrays["status"][place]).reshape(-1)

    def read(self, place: tuple[slice, ...]) -> dict[str, np.ndarray]:
        """A block as it stands."""
        block = {}
        for name, array in self._arrays.items():
            values = array[place]
            values = values.astype(object) if name == "reason" else values
            block[name] = values.reshape(-1, *values.shape[len(place) :])
        return block

    def write(self, place: tuple[slice, ...], block: Mapping[str, np.ndarray]) -> None:
        """Write a block, its status last."""
        shape = tuple(s.stop - s.start for s in place)
        for name, array in self._arrays.items():
            if name != "status":
                array[place] = block[name].reshape(*shape, *block[name].shape[1:])
        self._arrays["status"][place] = block["status"].reshape(shape)


def _add_arrays(group: Any, space: Space) -> None:
    dims, shape, chunks = space.dims, space.shape, space.chunks
    for name, note in LONG_NAMES.items():
        vector = name in VECTORS
        kind, fill = {"status": ("i1", None), "reason": (str, None)}.get(name, ("f8", np.nan))
        group.create_array(
            name,
            shape=(*shape, 6) if vector else shape,
            chunks=(*chunks, 6) if vector else chunks,
            dtype=kind,
            fill_value=fill,
            attributes={
                "long_name": note,
                "_ARRAY_DIMENSIONS": [*dims, "component"] if vector else list(dims),
            },
        )
    # A fill value would make xarray read 0 and "" as missing; so every status is written.
    group["status"][...] = 0
    _add_coordinate(group, "component", ("component",), np.array(DEGREES_OF_FREEDOM))
    for name, values in zip(space.names, space.values):
        _add_coordinate(group, name, (name,) if space.grid else ("design",), values)
    group.attrs["coordinates"] = " ".join(space.names) if not space.grid else "component"


def _add_coordinate(group: Any, name: str, dims: tuple[str, ...], values: np.ndarray) -> None:
    words = values.dtype.kind == "U"
    array = group.create_array(
        name,
        shape=values.shape,
        dtype=str if words else values.dtype,
        attributes={"_ARRAY_DIMENSIONS": list(dims)},
    )
    array[...] = values.astype(object) if words else values


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
    if key in ("model", "microswim_version"):
        return f"{key.replace('_', ' ')} {there.get(key)} there, {wanted[key]} here"
    return "its designs differ" if key == "over" else f"its {key} differ"
