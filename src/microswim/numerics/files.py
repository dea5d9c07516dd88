"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from microswim.errors import MachineError


@contextmanager
def fresh(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a path to write to, which takes the place of `path` once the block has ended well.

    What stood at `path` stays until then, and for good if the block fails. A device or a pipe is
    written to directly.

    Raises
    ------
    MachineError
        If the disk is full, or the place cannot be written; the sentence names `path`.
    """
    asked = Path(path)
    place = Path(os.path.realpath(asked))
    direct = place.exists() and not place.is_file()
    part = place if direct else place.with_name(f".{place.stem}.{os.getpid()}.part{place.suffix}")
    try:
        yield part
        if not direct:
            if place.exists():
                shutil.copymode(place, part)
            part.replace(place)
    except OSError as error:
        raise MachineError(f"{asked}: cannot be written: {error.strerror or error}") from error
    finally:
        if not direct:
            part.unlink(missing_ok=True)


def write(path: str | os.PathLike[str], content: str | bytes) -> None:
    """Write a text (UTF-8) or bytes as the whole of a file; see `fresh`."""
    raw = content.encode() if isinstance(content, str) else content
    with fresh(path) as part:
        part.write_bytes(raw)
