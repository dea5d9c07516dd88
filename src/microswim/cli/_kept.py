"""The folder of a run that is kept while it grows, and goes on from there after a kill."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import click

from microswim.cli import _folder
from microswim.errors import SpecError
from microswim.numerics.files import write

CHECKPOINT, SPEC = "checkpoint.npz", "spec.toml"


def check(out: Path, what: str, files: Iterable[str], frames: str, force: bool) -> None:
    """Refuse a folder whose kept run would be lost, before any work; with `force`, clear the way.

    Parameters
    ----------
    out
        The folder.
    what
        What it holds, for people: "run".
    files, frames
        Names of its files, and of its folder of frames: what `force` removes.

    Raises
    ------
    SpecError
        If it holds a kept run, is a file or holds other files, and `force` is not given.
    """
    if (out / CHECKPOINT).exists() and not force:
        raise SpecError(
            f"--out = {out}: holds a {what}; --resume goes on with it, --force replaces it"
        )
    _folder.check(out, force)
    for name in files:
        (out / name).unlink(missing_ok=True)
    shutil.rmtree(out / frames, ignore_errors=True)


def begin(out: Path, spec: str) -> Path:
    """Write the spec of a run that begins, none over that of one that goes on; give its checkpoint.

    A run that may not go on is refused later, and its folder then is as it was.
    """
    if not (out / CHECKPOINT).exists():
        write(out / SPEC, spec)
    return out / CHECKPOINT


@contextmanager
def solves() -> Iterator[None]:
    """Tell whoever interrupts what is within that its solves are kept, if they are."""
    from microswim.numerics.files import cache_folder

    try:
        yield
    except KeyboardInterrupt:
        if cache_folder("poses") is not None:
            click.echo("what was solved is kept: the same command goes on", err=True)
        raise


@contextmanager
def resumable(out: Path | None) -> Iterator[None]:
    """Tell whoever interrupts what is within how it goes on, where something was kept."""
    try:
        yield
    except KeyboardInterrupt:
        if out is not None and (out / CHECKPOINT).exists():
            click.echo("the same command with --resume goes on", err=True)
        raise
