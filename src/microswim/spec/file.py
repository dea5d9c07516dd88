"""The spec file: TOML to `Swimmer`. Units live at this door and nowhere else.

pydantic says what a file may hold, pint what a unit means; what makes physical sense is checked by
the parts themselves. A file holds either quantities with units (converted to SI) or bare numbers
(dimensionless), never a mix.
"""

from __future__ import annotations

import importlib
import tomllib
from collections.abc import Iterator
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ValidationError

from microswim.errors import SpecError
from microswim.spec import presets
from microswim.spec.tables import SpecTable
from microswim.swimmer import doors
from microswim.swimmer.drag.coefficients import LAWS
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.fluid import Fluid
from microswim.swimmer.geometry.bodies import SHAPES
from microswim.swimmer.geometry.custom_tail import CustomTail
from microswim.swimmer.geometry.surroundings import Channel, Wall
from microswim.swimmer.geometry.tails import HelicalTail, PlaneWaveTail
from microswim.swimmer.motion import Motion
from microswim.swimmer.swimmer import Swimmer

TAILS = {"helix": HelicalTail, "plane_wave": PlaneWaveTail, "custom": CustomTail}


def read(path: str | PathLike[str], overrides: dict[str, Any] | None = None) -> Swimmer:
    """Swimmer from a spec file; `overrides` maps dotted fields to values.

    Raises
    ------
    SpecError
        One sentence: the field, its value, what is allowed, how to mend it.
    """
    return from_dict(load(path), overrides)


def load(path: str | PathLike[str]) -> dict[str, Any]:
    """The tables of a TOML file, unchecked.

    Raises
    ------
    SpecError
        If the file is missing, unreadable or not TOML.
    """
    try:
        return tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise SpecError(
            f'{path}: no such file; "microswim new {path}" writes one to start from'
        ) from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        what = "not valid TOML" if isinstance(error, tomllib.TOMLDecodeError) else "cannot be read"
        raise SpecError(f"{path}: {what}: {' '.join(str(error).split())}") from None


def read_preset(name: str, overrides: dict[str, Any] | None = None) -> Swimmer:
    """Swimmer that comes with the package, such as ``"tabak/helix"``.

    Raises
    ------
    SpecError
        If there is no such preset, or as `read`.
    """
    return from_dict(tomllib.loads(presets.read(name)), overrides)


def override(tables: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    """Tables with fields or whole tables replaced; `waves` and `wavelength` replace each other."""
    new = {k: dict(v) if isinstance(v, dict) else v for k, v in tables.items()}
    for path, value in overrides.items():
        *parents, name = path.split(".")
        if not parents and isinstance(value, dict):
            new[name] = value
            continue
        if len(parents) != 1 or not name:
            raise SpecError(path, value, "a field as in tail.amplitude (table.name)")
        table = new.setdefault(parents[0], {})
        if not isinstance(table, dict):
            raise SpecError(parents[0], table, "a table")
        other = {"waves": "wavelength", "wavelength": "waves"}.get(name)
        if other and f"tail.{other}" not in overrides:
            table.pop(other, None)
        table[name] = value
    return new


def from_dict(tables: dict[str, Any], overrides: dict[str, Any] | None = None) -> Swimmer:
    """Swimmer from the tables of a spec file.

    Raises
    ------
    SpecError
        One sentence: the field, its value, what is allowed, how to mend it.
    """
    tables = override(tables, overrides or {})
    context: dict[str, list[str]] = {}
    try:
        spec = SpecTable.model_validate(tables, context=context)
    except ValidationError as error:
        raise _sentence(error, tables) from None
    if context.get("units") and context.get("bare"):
        raise SpecError(
            f"{context['bare'][0]}: must have a unit, since {context['units'][0]} has one; "
            "give units to all quantities or to none"
        )
    return _build(spec, "SI" if context.get("units") else "dimensionless")


def _build(spec: SpecTable, units: Literal["SI", "dimensionless"]) -> Swimmer:
    body, tail, law = (_given(t) for t in (spec.body, spec.tail, spec.coefficients))
    if spec.tail.kind == "custom":
        tail["shape"] = _import_shape(tail["shape"])
    name = law.pop("law", "lighthill")
    if name == "constant" and not {"normal", "tangential"} <= law.keys():
        raise SpecError(
            'coefficients: law = "constant" needs both normal and tangential; add the missing one'
        )
    if name != "constant" and law.keys() & {"normal", "tangential"}:
        raise SpecError("coefficients.law", name, '"constant" when normal and tangential are given')
    return Swimmer(
        body=SHAPES[body.pop("shape")](**body),
        tail=TAILS[tail.pop("kind")](**tail),
        fluid=Fluid(**_given(spec.fluid)),
        coefficients=LAWS[name](**law),
        interaction=Interaction(**_given(spec.interaction)),
        motion=Motion(**_given(spec.motion)),
        units=units,
        region=None if spec.region is None else doors.go(doors.UNPACK_REGION, spec.region.data),
        wall=None if spec.wall is None else Wall(**_given(spec.wall)),
        channel=None if spec.channel is None else Channel(**_given(spec.channel)),
    )


def _given(table: BaseModel) -> dict[str, Any]:
    """What the file says, lists as tuples; what it leaves out is left to the defaults."""

    def frozen(value: Any) -> Any:
        return tuple(frozen(v) for v in value) if isinstance(value, list) else value

    given = table.model_dump(exclude_unset=True)
    return {k: frozen(v) for k, v in given.items() if v is not None}


def _import_shape(name: str) -> Any:
    module, _, function = name.partition(":")
    try:
        return getattr(importlib.import_module(module), function)
    except (ImportError, AttributeError, ValueError):
        raise SpecError("tail.shape", name, 'an importable function, "module:function"') from None


def _sentence(error: ValidationError, tables: dict[str, Any]) -> SpecError:
    """The first complaint as one sentence."""
    first = error.errors()[0]
    tags = {"sphere", "spheroid", "ellipsoid", "none", "helix", "plane_wave", "custom"}
    where = [p for i, p in enumerate(first["loc"]) if not (i == 1 and p in tags)]
    path = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in where).lstrip(".")
    value, context = first["input"], first.get("ctx", {})
    match first["type"]:
        case "missing":
            return SpecError(f"{path}: missing; add it")
        case "extra_forbidden":
            known = list(_fields(tables))
            return SpecError(f"{path}: no such field here; {_suggest(path, known)}")
        case "value_error":
            return SpecError(f"{path} = {value!r}: {context['error']}")
        case "bool_parsing" | "bool_type":
            return SpecError(path, value, "true or false")
        case "union_tag_invalid" | "union_tag_not_found":
            tag = context["discriminator"].strip("'")
            shown = context.get("tag")
            expected = context.get("expected_tags") or ", ".join(
                f"'{t}'" for t in (SHAPES if tag == "shape" else TAILS)
            )
            return SpecError(f"{path}.{tag}", shown, f"one of {expected}")
    message = first["msg"].removeprefix("Input should be ").removeprefix("Value error, ")
    return SpecError(path or "spec", value, message)


def _fields(tables: dict[str, Any]) -> Iterator[str]:
    """Dotted names of the fields that a file of this kind may hold."""
    choose = {"body": "shape", "tail": "kind"}
    for name, info in SpecTable.model_fields.items():
        options: Any = getattr(info.annotation, "__args__", (info.annotation,))
        for table in options:
            tag = choose.get(name)
            given = tables.get(name)
            given = given if isinstance(given, dict) else {}
            if tag and table.model_fields[tag].annotation.__args__[0] != given.get(tag):
                continue
            yield from (f"{name}.{f}" for f in table.model_fields)
        yield name


def _suggest(name: str, known: list[str]) -> str:
    close = get_close_matches(name, known, n=1, cutoff=0.6)
    if close:
        return f'did you mean "{close[0]}"?'
    table = name.partition(".")[0] + "."
    near = [k for k in known if k.startswith(table)] or known
    return "known: " + ", ".join(near)
