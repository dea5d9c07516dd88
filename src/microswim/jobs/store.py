"""Solves on disk: a file each, named by what was solved and by the code that solved it.

A file is written whole or not at all, and read only if its checksum holds; one that is damaged, or
of another version of the model, counts as not there.
"""

from __future__ import annotations

import ast
import hashlib
import re
import sys
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

import numpy as np

from microswim import __version__
from microswim.gait.gait import Gait
from microswim.numerics import archive
from microswim.numerics.files import write
from microswim.numerics.plain import plain
from microswim.swimmer.swimmer import Swimmer

_SERIES = (
    "resistance_series",
    "propulsion_series",
    "activity_series",
    "body_resistance_series",
    "body_propulsion_series",
)


def place(folder: Path, swimmer: Swimmer, model: str, options: dict[str, Any]) -> Path | None:
    """Return the file of a solve; None for what has no name that lasts, such as a function.

    The name is a digest of all that the model sees of the swimmer, its options, and its code.
    """
    seen = [swimmer.body, swimmer.tail, swimmer.fluid, swimmer.motion, swimmer.wall]
    seen += [swimmer.channel, model, sorted(options.items()), __version__, version(model)]
    if swimmer.tail.settles:
        seen += [version("elastic"), swimmer.hook]
    if model in ("rft", "elastic") or swimmer.tail.settles:
        seen += [swimmer.coefficients, swimmer.interaction]
        if swimmer.region is not None:
            return None
    with np.printoptions(threshold=sys.maxsize, floatmode="unique"):
        text = repr(seen)
    if re.search(r" at 0x[0-9a-f]+", text):
        return None
    return folder / f"{hashlib.sha256(text.encode()).hexdigest()[:20]}.npz"


@cache
def version(model: str) -> str:
    """Return a digest of a model's own code; comments and docstrings do not count."""
    whole = hashlib.sha256()
    above = files("microswim.models")
    for file in (*_modules(above), *_modules(above / model, deep=True)):
        whole.update(ast.dump(_Bare().visit(ast.parse(file.read_text("utf-8")))).encode())
    return whole.hexdigest()[:16]


def _modules(folder: Traversable, deep: bool = False) -> Iterator[Traversable]:
    """The modules of a folder, those of its folders too if `deep`, in order."""
    for entry in sorted(folder.iterdir(), key=lambda f: f.name):
        if entry.name.endswith(".py"):
            yield entry
        elif deep and entry.is_dir():
            yield from _modules(entry, deep)


class _Bare(ast.NodeTransformer):
    """Code without the texts that only people read."""

    def visit_Expr(self, node: ast.Expr) -> ast.Expr | None:
        text = isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        return None if text else node


def keep(path: Path, result: Gait | str) -> None:
    """Write a gait, or the reason why there is none, at once or not at all."""
    notes: dict[str, Any] = {"key": path.stem}
    arrays = {}
    if isinstance(result, str):
        notes["reason"] = result
    else:
        arrays = {n: v for n in _SERIES if (v := getattr(result, n)) is not None}
        notes |= {"rate": float(result.rate), "free": list(map(bool, result.free))}
        notes |= {
            "model": result.model,
            "units": result.units,
            "info": plain(result.info, nan=True),
        }
    write(path, archive.pack(notes, arrays))


def find(path: Path) -> Gait | str | None:
    """Read a solve; None if there is none, or none that is whole."""
    try:
        held: tuple[dict[str, Any], dict[str, Any]] = archive.unpack(path.read_bytes())
        notes, arrays = held
        if notes.pop("key") != path.stem:
            return None
        if "reason" in notes:
            return str(notes["reason"])
        notes["free"] = tuple(notes["free"])
        return Gait(**arrays, **notes)
    except (OSError, KeyError, TypeError, ValueError):
        return None
