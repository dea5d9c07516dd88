"""Files that a spec names: they stand beside it, wherever the command was called."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def beside(tables: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Return the tables with every ``file`` that they name looked for beside the spec.

    Examples
    --------
    >>> from pathlib import Path
    >>> beside({"tail": {"file": "beat.csv"}}, Path("cells"))
    {'tail': {'file': 'cells/beat.csv'}}
    """
    return {name: _located(table, folder) for name, table in tables.items()}


def _located(table: Any, folder: Path) -> Any:
    if isinstance(table, list):
        return [_located(one, folder) for one in table]
    name = table.get("file") if isinstance(table, dict) else None
    if not isinstance(name, str) or Path(name).is_absolute():
        return table
    return {**table, "file": str(folder / name)}
