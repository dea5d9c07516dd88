"""Files and folders that are written whole or not at all."""

from __future__ import annotations

import glob
import os
import platform
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from microswim.errors import MachineError


@contextmanager
def fresh(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a path to write to, which takes the place of `path` once the block has ended well.

    What stood at `path` stays until then, and for good if the block fails. A device or a pipe is
    written to directly. Folders on the way are made.

    Raises
    ------
    MachineError
        If the disk is full, or the place cannot be written; the sentence names `path`.
    """
    asked = Path(path)
    place = Path(os.path.realpath(asked))
    direct = place.exists() and not place.is_file()
    part = place if direct else _beside(place, f".part{place.suffix}")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        yield part
        if not direct:
            if place.exists():
                shutil.copymode(place, part)
            part.replace(place)
    except OSError as error:
        raise MachineError(f"{asked}: not written: {error.strerror or error}") from error
    finally:
        if not direct:
            with suppress(NotADirectoryError):  # a file stands where a folder is asked for
                part.unlink(missing_ok=True)


def write(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a text (UTF-8) or bytes as the whole of a file; see `fresh`."""
    raw = content.encode() if isinstance(content, str) else content
    with fresh(path) as part:
        part.write_bytes(raw)


@contextmanager
def scratch(folder: Path, said: Path | None = None) -> Iterator[Path]:
    """Give an empty folder beside `folder`, removed when the block ends.

    One that a killed process left is removed by the next. Errors call it `said`, where what is
    made in it goes elsewhere.

    Raises
    ------
    MachineError
        If anything in the block cannot be written; the sentence names `said`.
    """
    made, said = _beside(Path(os.path.realpath(folder)), ".new"), said or folder
    try:
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir(parents=True)
        yield made
    except OSError as error:
        raise MachineError(f"{said}: not written: {error.strerror or error}") from error
    except MachineError as error:
        raise MachineError(str(error).replace(str(made), str(said))) from error
    finally:
        shutil.rmtree(made, ignore_errors=True)


def cache_folder(name: str) -> Path | None:
    """Return a folder of the user's cache, None where it is not to be had."""
    given = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = (Path(given) if given else Path.home() / ".cache") / "microswim" / name
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, RuntimeError):
        return None
    return folder if os.access(folder, os.W_OK) else None


def _beside(place: Path, ending: str) -> Path:
    """Return a hidden name beside a place, of this process; those of dead ones are removed."""
    host = re.sub(r"\W", "_", platform.node())
    others = f".{glob.escape(place.stem)}.{host}-*{glob.escape(ending)}"
    for left in place.parent.glob(others):
        number = left.name.removesuffix(ending).rpartition("-")[2]
        if number.isdecimal() and not _alive(int(number)):
            shutil.rmtree(left) if left.is_dir() else left.unlink(missing_ok=True)
    return place.with_name(f".{place.stem}.{host}-{os.getpid()}{ending}")


def _alive(process: int) -> bool:
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
