"""One writer at a time: a lock beside what is written, freed when its process dies, however."""

from __future__ import annotations

import contextlib
import errno
import os
import socket
import time
import warnings
from collections.abc import Iterator
from pathlib import Path

from microswim.errors import MachineError

_NO_LOCKS = {getattr(errno, name, -1) for name in ("ENOLCK", "ENOSYS", "ENOTSUP", "EOPNOTSUPP")}


class NoLockWarning(UserWarning):
    """The file system has no locks."""


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock of a store of a sweep.

    Where the file system has no locks, a warning says so and the work goes on.

    Raises
    ------
    MachineError
        If another sweep holds it, or the folder cannot be written.
    """
    from filelock import FileLock, Timeout

    file = path.parent / (path.name + ".lock")
    lock = FileLock(file, timeout=0, fallback_to_soft=False, is_singleton=False)
    with contextlib.ExitStack() as held:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
            held.enter_context(lock)
            while not file.exists():  # the former holder removed it while we took it
                lock.release()
                lock.acquire()
            since = time.strftime("%Y-%m-%d %H:%M:%S")
            who = f"process {os.getpid()} on {socket.gethostname()}, since {since}\n"
            file.write_text(who, encoding="utf-8")
        except Timeout:
            if not file.exists():
                raise MachineError(f"{path}: cannot be written: no lock beside it") from None
            holder = _said(file) or "another process"
            raise MachineError(
                f"{path}: another sweep is writing it ({holder}); wait for it or stop it, "
                "or give another --out"
            ) from None
        except OSError as error:
            if error.errno not in _NO_LOCKS:
                raise MachineError(f"{path}: cannot be written: {error.strerror}") from None
            warnings.warn(
                f"{path}: its file system has no locks, so nothing keeps a second sweep from "
                "writing there at the same time; see to it that none does",
                NoLockWarning,
                stacklevel=4,
            )
        try:
            yield
        finally:
            file.unlink(missing_ok=True)


def _said(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8").strip()
    except (OSError, ValueError):
        return ""
