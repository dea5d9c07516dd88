"""The spec file: TOML to `Swimmer`. Units live at this door and nowhere else.

pydantic says what a file may hold, pint what a unit means; what makes physical sense is checked by
the parts themselves. A file holds either quantities with units (converted to SI) or bare numbers
(dimensionless), never a mix.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from microswim.errors import SpecError, writing
from microswim.gait import doors
from microswim.spec import complaint, presets
from microswim.spec.named_files import beside
from microswim.spec.readers import beat, rest, text
from microswim.spec.several import apart, several, to_set
from microswim.spec.tables import ALTERNATIVES, FIELDS, of_file
from microswim.spec.trusted import Trusted
from microswim.spec.units import DIMENSIONS, has_unit, to_si
from microswim.spec.writing import as_written
from microswim.swimmer.drag.coefficients import LAWS, Unchosen
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.geometry.bodies import SHAPES
from microswim.swimmer.geometry.surroundings import Channel, Wall
from microswim.swimmer.geometry.tails.elastic.hook import Hook
from microswim.swimmer.geometry.tails.kinds import TAILS, Tail, of_tails
from microswim.swimmer.magnetism.fields import FIELDS as APPLIED_FIELDS
from microswim.swimmer.magnetism.magnet import Magnet
from microswim.swimmer.motion import Motion
from microswim.swimmer.motor import Motor
from microswim.swimmer.parts import numbered, without_number
from microswim.swimmer.provenance import Provenance
from microswim.swimmer.surroundings.flow import FLOWS, Flow
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.surroundings.gravity import Gravity
from microswim.swimmer.surroundings.noise import Noise
from microswim.swimmer.swimmer import Swimmer


def read(
    path: str | PathLike[str],
    overrides: dict[str, Any] | None = None,
    trust: str | PathLike[str] | None = None,
) -> Swimmer:
    """Return the swimmer of a spec file; `overrides` maps dotted fields to values.

    Parameters
    ----------
    path
        The spec file.
    overrides
        Dotted field to its value, in place of the file's.
    trust
        Python file whose functions the spec may name, ``"module:function"``. None: the spec runs
        no code.

    Raises
    ------
    SpecError
        One sentence: the field, its value, what is allowed, how to mend it.
    """
    return from_dict(beside(load(path), Path(path).parent), overrides, trust)


def load(path: str | PathLike[str]) -> dict[str, Any]:
    """Return the tables of a TOML file, unchecked.

    Raises
    ------
    SpecError
        If the file is missing, unreadable or not TOML.
    """
    mend = f'"microswim new {path}" writes one to start from'
    return text.toml(text.read_text(path, mend=mend), str(path))


def read_preset(name: str, overrides: dict[str, Any] | None = None) -> Swimmer:
    """Return the swimmer that comes with the package, such as ``"tabak/helix"``.

    Raises
    ------
    SpecError
        If there is no such preset, or as `read`.
    """
    return from_dict(text.toml(presets.read(name), name), overrides)


def override(tables: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    """Return tables with fields or tables replaced; of two names for one thing the other goes."""
    new = {k: _copy(v) for k, v in tables.items()}
    for part, tag in (("body", "shape"), ("tail", "kind")):
        if overrides.get(f"{part}.{tag}") == "none":
            new[part] = {}  # the fields of what is there no more
    for path, value in overrides.items():
        *parents, name = path.split(".")
        if not parents and isinstance(value, dict):
            new[name] = value
            continue
        if len(parents) != 1 or not name:
            raise SpecError(path, value, "a field as in tail.amplitude (table.name)")
        other = ALTERNATIVES.get(without_number(path), "").partition(".")[2]
        for table in to_set(new, parents[0], path, value):
            table[name] = value
            if other and f"{parents[0]}.{other}" not in overrides:
                table.pop(other, None)
    return new


def _copy(value: Any) -> Any:
    """Return a table, or a list of them, that may be changed."""
    if isinstance(value, list):
        return [_copy(one) for one in value]
    return dict(value) if isinstance(value, dict) else value


def from_dict(
    tables: dict[str, Any],
    overrides: dict[str, Any] | None = None,
    trust: str | PathLike[str] | None = None,
) -> Swimmer:
    """Return the swimmer of the tables of a spec file.

    Raises
    ------
    SpecError
        One sentence: the field, its value, what is allowed, how to mend it.
    """
    tables = override(tables, overrides or {})
    with writing(as_written(tables)):
        specs = {name: numbered(name, _checked, one) for name, one in apart(tables).items()}
        return _build(specs, units_of(tables), Trusted.file(trust))


def _checked(tables: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """Return what the tables of a spec with one tail say, in numbers; lists as tuples."""
    try:
        checked = of_file(tables).model_validate(_with_dynamic_viscosity(tables))
    except ValidationError as error:
        raise complaint.sentence(error, tables) from None
    said = checked.model_dump(exclude_unset=True)
    return {name: _given(table) for name, table in said.items()}


def _given(table: dict[str, Any]) -> dict[str, Any]:
    """What a table says, lists as tuples; what it leaves out is left to the defaults."""

    def frozen(value: Any) -> Any:
        return tuple(frozen(v) for v in value) if isinstance(value, list) else value

    return {k: frozen(v) for k, v in table.items() if v is not None}


def units_of(tables: dict[str, Any]) -> Literal["SI", "dimensionless"]:
    """Return whether the quantities of a spec have units; all have, or none has.

    Raises
    ------
    SpecError
        If some have and some have not.
    """
    with_units, bare = [], []
    for path, value in _quantities(tables):
        if isinstance(value, str):
            with_units.append(path)
        elif value != 0:
            bare.append(path)
    if with_units and bare:
        few = f"{bare[0]}: must have a unit, since {with_units[0]} has one"
        if len(with_units) == 1 and len(bare) > 1:
            few = f"{with_units[0]}: must be a bare number, since {bare[0]} and others are"
        raise SpecError(f"{few}; give units to all quantities or to none")
    return "SI" if with_units else "dimensionless"


def _quantities(tables: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Every number or text given for a quantity, entries of lists one by one; not the angles."""
    for part, table in tables.items():
        for name, value in (entry for one in several(table) for entry in one.items()):
            field = FIELDS.get(f"{part}.{name}")
            if field is not None and field.kind == "quantity" and field.measures != "angle":
                for entry in _flat(value):
                    yield field.path, entry


def _flat(value: Any) -> Iterator[Any]:
    """The entries of a list, of lists in it, or the value itself."""
    if isinstance(value, list):
        for entry in value:
            yield from _flat(entry)
    else:
        yield value


def _with_dynamic_viscosity(tables: dict[str, Any]) -> dict[str, Any]:
    """Tables with mu = nu rho in place of a kinematic viscosity nu."""
    fluid = tables.get("fluid")
    if not isinstance(fluid, dict):
        return tables
    given = fluid.get("kinematic_viscosity")
    if given is not None and "viscosity" in fluid:
        raise SpecError("fluid.viscosity, fluid.kinematic_viscosity: give one of the two")
    path = "fluid.kinematic_viscosity"
    if given is None:
        path, given = "fluid.viscosity", fluid.get("viscosity")
        if given is None or not has_unit(given) or not _measures(given, "kinematic viscosity"):
            return tables
    nu, rho = _number(path, given, "kinematic viscosity"), fluid.get("density", 0)
    rho = _number("fluid.density", rho, "density")
    if not rho > 0:
        raise SpecError(path, given, "given together with fluid.density", "mu = nu rho")
    rest = {k: v for k, v in fluid.items() if k not in ("viscosity", "kinematic_viscosity")}
    return tables | {"fluid": rest | {"viscosity": nu * rho}}


def _measures(text: str, dimension: str) -> bool:
    try:
        to_si(text, DIMENSIONS["viscosity"].si)
    except ValueError:
        try:
            to_si(text, DIMENSIONS[dimension].si)
        except ValueError:
            return False
        return True
    return False


def _number(path: str, value: Any, dimension: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise SpecError(path, value, "a number, or a quantity in quotes")
    try:
        number = to_si(value, DIMENSIONS[dimension].si) if isinstance(value, str) else float(value)
    except (ValueError, OverflowError) as error:
        raise SpecError(f"{path} = {value!r}: {error}") from None
    if not (math.isfinite(number) and number >= 0):
        raise SpecError(path, value, "a positive number")
    return number


def _tail(
    spec: dict[str, dict[str, Any]], units: Literal["SI", "dimensionless"], trusted: Trusted
) -> Tail:
    tail = spec["tail"]
    if tail["kind"] == "custom":
        tail |= {"shape": trusted.function("tail.shape", tail["shape"])}
    elif tail["kind"] == "waveform":
        tail = beat.tail_fields(tail, units)
    elif tail["kind"] == "elastic":
        tail = rest.with_points(tail)
    return _of_kind(TAILS, tail, "kind")


def _build(
    specs: dict[str, dict[str, dict[str, Any]]],
    units: Literal["SI", "dimensionless"],
    trusted: Trusted,
) -> Swimmer:
    tails = [numbered(name, _tail, one, units, trusted) for name, one in specs.items()]
    spec = next(iter(specs.values()))

    def part(name: str, of: Callable[..., Any]) -> Any:
        return of(**spec[name]) if name in spec else None

    return Swimmer(
        body=_of_kind(SHAPES, spec["body"], "shape"),
        tail=of_tails(tails),
        fluid=Fluid(**spec["fluid"]),
        coefficients=_law(spec.get("coefficients", {})),
        interaction=Interaction(**spec.get("interaction", {})),
        motion=Motion(**spec.get("motion", {})),
        units=units,
        region=part("region", _region),
        hook=part("hook", Hook),
        motor=part("motor", Motor),
        wall=part("wall", Wall),
        channel=part("channel", Channel),
        magnet=part("magnet", Magnet),
        field=_of_kind(APPLIED_FIELDS, spec["field"], "kind") if "field" in spec else None,
        gravity=part("gravity", Gravity),
        flow=_flow(spec) if "flow" in spec else None,
        noise=part("noise", Noise),
        calibration=part("calibration", Provenance),
    )


def _region(data: str) -> Any:
    return doors.go(doors.UNPACK_REGION, data)


def _of_kind(kinds: Mapping[str, Callable[..., Any]], table: dict[str, Any], tag: str) -> Any:
    """Return the part that a table says, of the kind that it says."""
    return kinds[table[tag]](**{k: v for k, v in table.items() if k != tag})


def _law(table: dict[str, Any]) -> Any:
    """Return the drag law of [coefficients], or that none was chosen."""
    name = table.get("law", "lighthill")
    if name == "constant" and not {"normal", "tangential"} <= table.keys():
        raise SpecError(
            'coefficients: law = "constant" needs both normal and tangential; add the missing one'
        )
    if name != "constant" and table.keys() & {"normal", "tangential"}:
        raise SpecError("coefficients.law", name, '"constant" when normal and tangential are given')
    return _of_kind(LAWS, table, "law") if "law" in table else Unchosen(**table)


def _flow(spec: dict[str, dict[str, Any]]) -> Flow:
    """Return the flow of a spec; one in a tube is as wide as the channel if it does not say."""
    flow = spec["flow"]
    if flow["kind"] == "poiseuille" and "diameter" not in flow:
        if "channel" not in spec:
            raise SpecError("flow.diameter: missing; add it, or a [channel]")
        flow = flow | {"diameter": spec["channel"]["diameter"]}
    return _of_kind(FLOWS, flow, "kind")
