"""The scene file: several swimmers, each by its spec, at its pose and phase, under its load.

    [[swimmer]]
    spec = "robot.toml"                      # beside the scene; or preset = "tabak/helix"
    position = ["0 um", "20 um", "0 um"]

    [[swimmer]]                              # one for each row of a table
    spec = "cell.toml"
    places = "cells.csv"

    [wall]                                   # if any: a point of it, its normal into the fluid
    position = ["0 um", "-5 um", "0 um"]
    normal = [0, 1, 0]

    [field]                                  # magnetic, if any: as in a spec, in place of theirs
    kind = "rotating"

Lengths, forces and torques have units if the specs have, and none if they have none.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import Field, ValidationError

from microswim.errors import SpecError, nearest
from microswim.spec import complaint, file, presets
from microswim.spec.named_files import beside
from microswim.spec.readers import text
from microswim.spec.readers.places import read_places
from microswim.spec.types import Angle, Force, Frequency, Length, Number, Table, Torque
from microswim.spec.units import DIMENSIONS
from microswim.swimmer.group import Group
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.member import Member
from microswim.swimmer.swimmer import Swimmer

_OF_ONE = re.compile(r"swimmer\[(\d{1,4})\]\.(.+)")
#: Fields with a unit where the specs have units, and their dimension.
QUANTITIES = {"position": "length", "force": "force", "torque": "torque", "frequency": "frequency"}

#: A preset in either system of units, beside which a table of a spec can be read.
ANY_SPEC = {"SI": "goto/C", "dimensionless": "tabak/helix"}
TABLES = {"swimmer", "wall", "field"}


class SwimmerTable(Table):
    """[[swimmer]] of a scene: what `Member` takes, the spec, and fields of the spec replaced."""

    spec: str | None = None
    preset: str | None = None
    places: str | None = None
    position: list[Length] = Field(default_factory=list)
    direction: list[Number] = Field(default_factory=list)
    roll: Angle = 0.0
    phase: Angle = 0.0
    frequency: Frequency | None = None
    free: str | list[str] | None = None
    force: list[Force] = Field(default_factory=list)
    torque: list[Torque] = Field(default_factory=list)
    set: dict[str, Any] = Field(default_factory=dict)


class WallTable(Table):
    """[wall] of a scene: a plane no-slip wall."""

    position: list[Length] = Field(default_factory=lambda: [0.0, 0.0, 0.0])
    normal: list[Number]


#: Fields of a table that the member takes as they are.
OF_MEMBER = {"position", "direction", "roll", "phase", "force", "torque"}


def read_scene(
    path: str | PathLike[str],
    overrides: Mapping[str, Any] | None = None,
    trust: str | PathLike[str] | None = None,
) -> Group:
    """Return the group of a scene file.

    Parameters
    ----------
    path
        The scene file; the specs that it names stand beside it.
    overrides
        Field to its value: ``swimmer[0].phase`` of one swimmer, ``tail.amplitude`` of all specs,
        ``swimmer[0].tail.amplitude`` of one.
    trust
        Python file whose functions the specs may name. None: they run no code.

    Raises
    ------
    SpecError
        One sentence: the field, its value, what is allowed, how to mend it.
    """
    path = Path(path)
    scene = text.toml(text.read_text(path, mend=_MEND), str(path))
    tables = _swimmer_tables(scene, str(path))
    common = _overridden(tables, dict(overrides or {}))
    specs = _Specs(path.parent, common, trust, "field" in scene)
    members = [member for n, table in enumerate(tables) for member in _members(n, table, specs)]
    units = members[0].swimmer.units
    applied = _field(scene.get("field"), path.parent, units)
    return Group(tuple(members), _wall(scene.get("wall"), units), applied)


def _field(given: Any, folder: Path, units: str) -> AppliedField | None:
    """Return the field of a scene, read as that of a spec in these units; None without one."""
    if given is None:
        return None
    if not isinstance(given, dict):
        raise SpecError("field", given, 'a table, [field] with kind = "rotating" and the like')
    any_spec = text.toml(presets.read(ANY_SPEC[units]), ANY_SPEC[units])
    return file.from_dict(beside({**any_spec, "field": given}, folder)).field


def _wall(given: Any, units: str) -> Any:
    """Return point and normal of the wall of a scene, None without one."""
    if given is None:
        return None
    if not isinstance(given, dict):
        raise SpecError("wall", given, "a table, [wall] with position and normal")
    try:
        table = WallTable.model_validate(given)
    except ValidationError as error:
        raise complaint.sentence(error, {}, "wall") from None
    _check_units("wall", given, units)
    return table.position, table.normal


_MEND = 'a scene holds [[swimmer]] tables with spec = "robot.toml" and position = [x, y, z]'


def _swimmer_tables(tables: dict[str, Any], name: str) -> list[dict[str, Any]]:
    """Return the [[swimmer]] tables of a scene, unchecked."""
    found = tables.get("swimmer")
    if found is None and {"body", "tail"} & tables.keys():
        raise SpecError(f"{name}: this is the spec of one swimmer; {_MEND}")
    for other in tables.keys() - TABLES:
        close = nearest(other, TABLES)
        raise SpecError(f"{other}: no such table in a scene; {close}")
    if not isinstance(found, list) or not found or not all(isinstance(t, dict) for t in found):
        raise SpecError(f"{name}: no [[swimmer]] table, in double brackets; {_MEND}")
    return [dict(t) for t in found]


def _overridden(tables: list[dict[str, Any]], overrides: dict[str, Any]) -> dict[str, Any]:
    """Put what concerns one swimmer into its table; return what concerns all specs."""
    common = {}
    for name, value in overrides.items():
        one = _OF_ONE.fullmatch(name)
        if one is None:
            common[name] = value
            continue
        n, own = int(one[1]), one[2]
        if n >= len(tables):
            raise SpecError(name, value, f"of one of swimmer[0] to swimmer[{len(tables) - 1}]")
        if "." in own and isinstance(tables[n].get("set", {}), dict):
            tables[n]["set"] = {**tables[n].get("set", {}), own: value}
        else:
            tables[n][own] = value
    return common


@dataclass
class _Specs:
    """Where the specs of a scene stand, and those that were read: of one spec one swimmer."""

    folder: Path
    common: dict[str, Any]
    trust: str | PathLike[str] | None
    in_field: bool  #: the scene's, in place of those of the specs
    made: dict[str, Swimmer] = dataclasses.field(default_factory=dict)


def _members(n: int, given: dict[str, Any], specs: _Specs) -> list[Member]:
    """Return the swimmers of a table: one, or one for each of its places."""
    name = f"swimmer[{n}]"
    unknown = [k for k in given if k not in SwimmerTable.model_fields]
    if unknown:
        close = nearest(unknown[0], SwimmerTable.model_fields)
        raise SpecError(f"{name}.{unknown[0]}: no such field of a swimmer in a scene; {close}")
    try:
        table = SwimmerTable.model_validate(given)
    except ValidationError as error:
        raise complaint.sentence(error, {}, name) from None
    if (table.spec is None) == (table.preset is None):
        missing = "missing; add" if table.spec is None else "give one of"
        raise SpecError(f'{name}.spec: {missing} spec = "robot.toml", or preset = "tabak/helix"')
    swimmer = _swimmer(name, table, given, specs)
    _check_units(name, given, swimmer.units)
    own = table.model_dump(exclude_unset=True, include=OF_MEMBER)
    of_table = partial(_places, name, table, own, specs.folder)
    places = [{}] if table.places is None else of_table(swimmer.units)
    try:
        return [Member(swimmer=swimmer, **own | place) for place in places]
    except SpecError as error:
        dot = "." if error.field.partition("[")[0] in SwimmerTable.model_fields else " "
        raise SpecError(f"{name}{dot}{error}") from None


def _places(
    name: str, table: SwimmerTable, own: dict[str, Any], folder: Path, units: str
) -> list[dict[str, Any]]:
    """Return what the rows of the places of a table say."""
    found = read_places(folder / str(table.places), units)
    for field in own.keys() & found[0].keys():
        raise SpecError(f"{name}.{field}: its places say it too; remove one of the two")
    return found


def _swimmer(name: str, table: SwimmerTable, given: dict[str, Any], specs: _Specs) -> Swimmer:
    """Return the swimmer of a table; of one spec with the same changes, the same swimmer."""
    changes = {**specs.common, **table.set}
    changes |= {"tail.frequency": given["frequency"]} if "frequency" in given else {}
    changes |= {"motion.free": table.free} if table.free is not None else {}
    key = repr((table.spec, table.preset, sorted(changes.items())))
    if key not in specs.made:
        swimmer = _read(name, table, changes, specs)
        specs.made[key] = replace(swimmer, field=None) if specs.in_field else swimmer
    return specs.made[key]


def _read(name: str, table: SwimmerTable, changes: dict[str, Any], specs: _Specs) -> Swimmer:
    try:
        if table.spec is not None:
            return file.read(specs.folder / table.spec, changes, specs.trust)
        told = text.toml(presets.read(str(table.preset)), str(table.preset))
        return file.from_dict(beside(told, specs.folder), changes, specs.trust)
    except SpecError as error:
        raise SpecError(f"{name}, {table.spec or table.preset}: {error}") from None


def _check_units(name: str, given: dict[str, Any], units: str) -> None:
    """Refuse quantities without units beside a spec with units, and the other way round."""
    for field, measures in QUANTITIES.items():
        value = given.get(field, [])
        entries = value if isinstance(value, list) else [value]
        for i, entry in enumerate(entries):
            said = f"{name}.{field}" + (f"[{i}]" if isinstance(value, list) else "")
            if units == "SI" and not isinstance(entry, str) and entry != 0:
                raise SpecError(
                    f"{said} = {entry!r}: must have a unit, as in "
                    f'"{DIMENSIONS[measures].example}"; the spec has units'
                )
            if units != "SI" and isinstance(entry, str):
                raise SpecError(said, entry, "a bare number", "the spec has no units")
