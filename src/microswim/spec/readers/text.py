"""Text that comes from elsewhere: the one reader of spec files and of what tables are made of.

UTF-8, with or without the mark that some programs put before it, and UTF-16 with its mark; tables
of other programs may be in the Windows code page 1252 as well. What is no text, no file or too long
to be what it should be is refused in a sentence.
"""

from __future__ import annotations

import tomllib
from codecs import BOM_UTF8, BOM_UTF16_BE, BOM_UTF16_LE
from os import PathLike
from pathlib import Path
from typing import Any

from microswim.errors import SpecError

LARGEST_SPEC = 4 * 1024**2  #: bytes; a region calibration is the most of it
LARGEST_TABLE = 256 * 1024**2
DEEPEST = 32  #: brackets within brackets: far beyond any spec
TABLES = (".csv", ".tsv", ".xml", ".txt", ".dat")  #: endings of what films and series come in


def read_text(
    path: str | PathLike[str], largest: int = LARGEST_SPEC, mend: str = "", windows: bool = False
) -> str:
    """Return the text of a file.

    Parameters
    ----------
    path
        A file, not a device or a pipe.
    largest
        Bytes that it may have.
    mend
        What to say where there is no such file.
    windows
        Whether what is no UTF-8 may be in the Windows code page 1252.

    Raises
    ------
    SpecError
        If it cannot be read, is too long or is not text.
    """
    path = Path(path)
    try:
        _require_file(path)
        with path.open("rb") as file:
            data = file.read(largest + 1)
    except FileNotFoundError:
        raise SpecError(f"{path}: no such file{mend and '; ' + mend}") from None
    except SpecError:
        raise
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or " ".join(str(error).split())
        raise SpecError(f"{path}: cannot be read: {why}") from None
    if len(data) > largest:
        raise SpecError(f"{path}: longer than {largest // 1024} KiB, which is too long for this")
    return decoded(data, str(path), windows)


def _require_file(path: Path) -> None:
    if path.exists() and not path.is_file():
        what = "a folder" if path.is_dir() else "no file but a device or a pipe"
        raise SpecError(f"{path}: cannot be read: it is {what}")


def decoded(data: bytes, name: str, windows: bool = False) -> str:
    """Return the text that bytes hold.

    Raises
    ------
    SpecError
        If they hold none.
    """
    coding = "utf-16" if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) else "utf-8"
    try:
        text = data.removeprefix(BOM_UTF8).decode(coding)
    except UnicodeDecodeError:
        if windows and coding == "utf-8":
            return _of_windows(data, name)
        raise SpecError(
            f"{name}: cannot be read: not UTF-8 text; save it as UTF-8 in your editor"
        ) from None
    if "\0" in text:
        raise SpecError(f"{name}: cannot be read: it holds binary data, not text")
    return text


def _of_windows(data: bytes, name: str) -> str:
    try:
        text = data.decode("cp1252")
    except UnicodeDecodeError:
        text = "\0"
    if any(ord(c) < 32 and c not in "\t\n\r\f" for c in text):
        raise SpecError(f"{name}: cannot be read: it holds binary data, not text")
    return text


def toml(text: str, name: str) -> dict[str, Any]:
    """Return the tables of a TOML text.

    Raises
    ------
    SpecError
        If it is not TOML, or nested beyond sense.
    """
    try:
        tables = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        why = " ".join(str(error).split()) if isinstance(error, ValueError) else "nested too deeply"
        if name.lower().endswith(TABLES):
            raise SpecError(
                f"{name}: a table where the spec belongs (a TOML file); --help shows the order"
            ) from None
        raise SpecError(f"{name}: not valid TOML: {why}") from None
    if _depth(tables) > DEEPEST:
        raise SpecError(f"{name}: not a spec: nested more than {DEEPEST} deep")
    return tables


def _depth(tables: Any) -> int:
    level, depth = [tables], 0
    while level and depth <= DEEPEST:
        inner = [v for v in level if isinstance(v, (dict, list))]
        level = [w for v in inner for w in (v.values() if isinstance(v, dict) else v)]
        depth += 1
    return depth
