"""Surface files dropped onto the page, and files of a spec of this machine, a field's as well:
kept in the user's cache under their digest.

The page names such a file in its spec by ``dropped/<digest>/<name>``. Whoever has the digest has
had the file, so that nothing is kept about anyone, and a link to a design holds on this machine.
"""

from __future__ import annotations

import hashlib
import re
import shutil
from pathlib import Path
from typing import Any

from microswim.errors import MicroswimError, SpecError
from microswim.numerics.files import cache_folder, write
from microswim.swimmer.geometry.solids.reading import FORMATS

LARGEST = 16 << 20  #: bytes of a file
MOST_FILES = 40
#: Endings of the files that a table may name.
ENDINGS: dict[str, tuple[str, ...]] = {"body": FORMATS, "field": (".yaml", ".yml", ".csv", ".toml")}
TOKEN = re.compile(r"dropped/([0-9a-f]{64})/([\w-]{1,60}(\.\w{3,4}))")


def keep(name: str, content: bytes, part: str = "body") -> str:
    """Return what a spec names a surface file by, or that of a field, once it is kept.

    Raises
    ------
    SpecError
        If it is not called as such a file is.
    MicroswimError
        If there is no place to keep it.
    """
    if not content or not name.lower().endswith(ENDINGS[part]):
        kinds = ", ".join(ending[1:].upper() for ending in ENDINGS[part])
        raise SpecError("file", name[:80], f"one of {kinds} with something in it")
    stem, _, ending = name.rpartition(".")
    plain = re.sub(r"[^\w-]", "_", stem, flags=re.ASCII)[:60] or "surface"
    folder = _folder()
    place = folder / hashlib.sha256(content).hexdigest() / f"{plain}.{ending.lower()}"
    write(place, content)
    _forget(folder)
    return f"dropped/{place.parent.name}/{place.name}"


def admitted(tables: dict[str, Any]) -> dict[str, Any]:
    """Return tables of a spec of this machine: its files are kept as if they had been dropped."""
    return tables | {part: _admitted(part, tables[part]) for part in ENDINGS if part in tables}


def _admitted(part: str, table: Any) -> Any:
    if not isinstance(table, dict) or "file" not in table or _kept(part, table["file"]):
        return table
    place = Path(str(table["file"]))
    return {**table, "file": keep(place.name, place.read_bytes(), part)}


def _kept(part: str, file: Any) -> re.Match[str] | None:
    """Match of what names a kept file that this table may have."""
    token = TOKEN.fullmatch(str(file))
    return token if token and token[3] in ENDINGS.get(part, ()) else None


def located(tables: dict[str, Any]) -> dict[str, Any]:
    """Return the tables with the files on this machine in place of what names them.

    Raises
    ------
    SpecError
        If a table names any other file, or one that is no longer kept.
    """
    return {name: _located(name, table) for name, table in tables.items()}


def _located(name: str, table: Any) -> Any:
    if isinstance(table, list):
        return [_located(f"{name}[{n}]", one) for n, one in enumerate(table)]
    if not isinstance(table, dict) or "file" not in table:
        return table
    token = _kept(name, table["file"])
    if token is None:
        way = "start it with the spec, microswim studio SPEC" if name == "field" else "drop it here"
        raise SpecError(f"{name}.file: the studio reads no file that a spec names; {way}")
    return {**table, "file": str(place_of(token[0]))}


def place_of(token: str) -> Path:
    """Return where a file is that was dropped.

    Raises
    ------
    SpecError
        If it is no longer kept.
    """
    _, digest, name = token.split("/")
    place = _folder() / digest / name
    if not place.is_file():
        raise SpecError(
            "file",
            name,
            "a file that is still kept",
            "drop it here again, or start the studio with its spec",
        )
    return place


def named(tables: dict[str, Any]) -> dict[str, Any]:
    """Return the tables with files as the page names them."""
    return {name: _renamed(table, "dropped/{}/{}") for name, table in tables.items()}


def beside(tables: dict[str, Any]) -> dict[str, Any]:
    """Return the tables with files as they stand beside a spec file that one takes away."""
    return {name: _renamed(table, "{1}") for name, table in tables.items()}


def _renamed(table: Any, form: str) -> Any:
    if not isinstance(table, dict) or "file" not in table:
        return table
    place = Path(str(table["file"]))
    return {**table, "file": form.format(place.parent.name, place.name)}


def _folder() -> Path:
    folder = cache_folder("studio")
    if folder is None:
        raise MicroswimError("there is no place to keep a dropped file: no cache can be written")
    return folder


def _forget(folder: Path) -> None:
    """Leave the newest files."""
    there = sorted(folder.iterdir(), key=lambda p: p.stat().st_mtime)
    for old in there[:-MOST_FILES]:
        shutil.rmtree(old, ignore_errors=True)
