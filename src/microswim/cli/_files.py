"""Files that a command will write: refused before the work, which no full disk takes away."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from microswim.errors import SpecError


def check_file(option: str, path: Path, force: bool) -> None:
    """Refuse a file that cannot be written, before any work is done.

    Raises
    ------
    SpecError
        If it is a folder, stands in no place that can be written, or is there and `force` is not
        given.
    """
    if path.is_dir():
        raise SpecError(option, str(path), "a file", "this is a folder")
    _check_place(option, path.parent)
    if path.exists() and not force:
        raise SpecError(option, str(path), "a new file", "--force replaces the one that is there")


def check_files(option: str, folder: Path, names: Iterable[str], force: bool) -> None:
    """Refuse a folder in which the files `names` cannot be written, before any work is done.

    Raises
    ------
    SpecError
        If it is a file, cannot be written, or holds one of them and `force` is not given.
    """
    if folder.exists() and not folder.is_dir():
        raise SpecError(option, str(folder), "a folder", "this is a file")
    _check_place(option, folder)
    there = [name for name in names if (folder / name).exists()]
    if there and not force:
        raise SpecError(
            option, str(folder), f"a folder without {there[0]}", "--force replaces what is there"
        )


@contextmanager
def or_else(show: Callable[[], None]) -> Iterator[None]:
    """Show what was found if the block, which writes it, fails; the error goes on."""
    try:
        yield
    except (Exception, KeyboardInterrupt):
        show()
        raise


def _check_place(option: str, folder: Path) -> None:
    """Refuse a folder that neither can be written in nor made."""
    while not folder.exists():
        folder = folder.parent
    if not folder.is_dir():
        raise SpecError(option, str(folder), "a folder", "this is a file")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise SpecError(option, str(folder), "a folder that you may write in")
