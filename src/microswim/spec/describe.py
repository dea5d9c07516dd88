"""A swimmer as plain data: the tables of a spec file, as numbers, words and lists."""

from __future__ import annotations

import json
from dataclasses import fields
from typing import Any

import numpy as np

from microswim.swimmer.swimmer import Swimmer


def describe(swimmer: Swimmer) -> dict[str, Any]:
    """Return the swimmer as the tables of a spec file, plain numbers and strings only."""
    tags = {"body": "shape", "tail": "kind", "coefficients": "law"}
    tables: dict[str, Any] = {}
    for part in swimmer.parts:
        owner = getattr(swimmer, part)
        table = {tags[part]: getattr(owner, tags[part])} if part in tags else {}
        for f in fields(owner):
            value = getattr(owner, f.name)
            if value is not None:
                table[f.name] = _name_of(value) if callable(value) else value
        tables[part] = table
    return tables | {"units": swimmer.units}


def _name_of(function: Any) -> str:
    return f"{function.__module__}:{getattr(function, '__qualname__', type(function).__name__)}"


def spec_json(swimmer: Swimmer) -> str:
    """Return `describe` as canonical JSON, for provenance and comparison."""
    return json.dumps(describe(swimmer), sort_keys=True, default=_jsonable)


def _jsonable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.tolist()
    return value.item() if isinstance(value, np.generic) else str(value)
