"""What pydantic objects to in a spec, as one sentence that knows the physics."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, ValidationError

from microswim.errors import SpecError, nearest
from microswim.spec.tables import FIELDS, TABLES, TAGS, word
from microswim.swimmer.geometry.bodies import SHAPES
from microswim.swimmer.geometry.tails.kinds import TAILS
from microswim.swimmer.magnetism.fields import FIELDS as APPLIED_FIELDS
from microswim.swimmer.surroundings.flow import FLOWS

#: The kinds of the tables that have several.
KINDS: dict[str, Any] = {"body": SHAPES, "tail": TAILS, "field": APPLIED_FIELDS, "flow": FLOWS}
#: Other words for a field.
SYNONYMS = {
    "tail.pitch": "tail.wavelength", "tail.lambda": "tail.wavelength", "tail.turns": "tail.waves",
    "tail.periods": "tail.waves", "tail.helix_radius": "tail.amplitude",
    "tail.chirality": "tail.handedness", "tail.hand": "tail.handedness",
    "tail.diameter": "tail.radius (half of it)", "tail.thickness": "tail.radius (half of it)",
    "tail.rate": "tail.frequency", "tail.omega": "tail.frequency", "tail.rpm": "tail.frequency",
    "body.diameter": "body.radius (half of it)", "body.axes": "body.semi_axes",
    "fluid.mu": "fluid.viscosity", "fluid.nu": "fluid.kinematic_viscosity",
    "fluid.rho": "fluid.density", "magnet.Br": "magnet.remanence", "field.B": "field.strength",
    "field.amplitude": "field.strength", "field.rate": "field.frequency",
    "wall.gap": "wall.distance", "channel.radius": "channel.diameter",
}  # fmt: skip


def sentence(error: ValidationError, tables: dict[str, Any], within: str = "") -> SpecError:
    """Return the first complaint as one sentence; `within` is the table that was checked."""
    first = _apt(error.errors())
    tags = KINDS.get(str(first["loc"][0]), ()) if first["loc"] else ()
    branch = re.compile(r".*\[.*\]")  # of a field that is a number or a list of them
    where = [
        p
        for i, p in enumerate(first["loc"])
        if not (i == 1 and p in tags) and not (isinstance(p, str) and branch.fullmatch(p))
    ]
    path = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in where).lstrip(".")
    path = f"{within}.{path}" if within else path
    value, context = first["input"], first.get("ctx", {})
    match first["type"]:
        case "missing":
            return SpecError(f"{path}: missing; add it")
        case "extra_forbidden":
            return SpecError(f"{path}: no such field here; {_suggest(path, tables)}")
        case "value_error":
            return SpecError(f"{path} = {_short(value)}: {context['error']}")
        case "bool_parsing" | "bool_type":
            return SpecError(path, value, "true or false")
        case "literal_error" if path in FIELDS:
            return _no_choice(path, value, FIELDS[path].choices)
        case "union_tag_not_found" if isinstance(value, dict):
            tag = context["discriminator"].strip("'")
            known = ", ".join(f'"{kind}"' for kind in KINDS[path])
            return SpecError(f"{path}.{tag}: missing; add one of {known}")
        case "union_tag_invalid" | "union_tag_not_found":
            tag = context["discriminator"].strip("'")
            return _no_choice(f"{path}.{tag}", context.get("tag"), KINDS[path])
    message = first["msg"].removeprefix("Input should be ").removeprefix("Value error, ")
    return SpecError(path or "spec", value, message)


def _apt(complaints: list[Any]) -> Any:
    """The first complaint; of a list that might have been a number, that about its entries.

    Where a field is missing beside one that is none, the other is likely its name elsewhere.
    """
    first = complaints[0]
    if first["type"] == "missing":
        within = [c for c in complaints if c["loc"][:-1] == first["loc"][:-1]]
        return next((c for c in within if c["type"] == "extra_forbidden"), first)
    if isinstance(first["input"], list):
        within = [c for c in complaints if c["loc"][:2] == first["loc"][:2]]
        return within[-1]
    return first


def _short(value: Any) -> str:
    shown = repr(value)
    return shown if len(shown) <= 60 else shown[:57] + "..."


def _no_choice(path: str, value: Any, choices: Any) -> SpecError:
    close = nearest(value, choices)
    mend = close if close.startswith("did") else None
    return SpecError(path, value, "one of " + ", ".join(f'"{c}"' for c in choices), mend)


def _suggest(path: str, tables: dict[str, Any]) -> str:
    """What to write in place of an unknown field."""
    part = path.partition(".")[0]
    tag = TAGS.get(part)
    owners = [f'"{word(kind, part)}"' for kind in TABLES.get(part, ()) if tag and _has(kind, path)]
    if owners:
        return f"it belongs to {part}.{tag} = {' or '.join(owners)}"
    if path == "units":
        return 'write a unit with each number, radius = "0.5 mm", or none at all'
    if path in SYNONYMS:
        return f'did you mean "{SYNONYMS[path]}"?'
    return nearest(path, _fields(tables) if "." in path else TABLES)


def _fields(tables: dict[str, Any]) -> Iterator[str]:
    """Dotted names of the fields that a file of this kind may hold."""
    for name, kinds in TABLES.items():
        tag, given = TAGS.get(name), tables.get(name)
        chosen = given.get(tag) if tag and isinstance(given, dict) else None
        for table in kinds:
            if word(table, name) != chosen:
                continue
            yield from (f"{name}.{f}" for f in table.model_fields)


def _has(table: type[BaseModel], path: str) -> bool:
    return path.partition(".")[2] in table.model_fields
