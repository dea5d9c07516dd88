"""What makes the field, inside the exported model: coils by their currents, a magnet by its pose.

A spec whose field depends on place is exported with it: ``robot_actuate`` in C, inputs of the FMU.
Before each step the field and its gradient at the swimmer's place are set, as
`microswim.swimmer.magnetism.applied_field.AppliedField.felt` does it in Python.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np

from microswim.control.stepper import Stepper
from microswim.errors import SpecError
from microswim.swimmer.magnetism.applied_field import unit
from microswim.swimmer.magnetism.field_in_space import CoilField, DipoleField
from microswim.swimmer.magnetism.finite_magnet import MagnetField
from microswim.swimmer.magnetism.grid import GridCoil
from microswim.swimmer.magnetism.magnet import MU_0
from microswim.swimmer.magnetism.outside import magpylib
from microswim.swimmer.magnetism.winding import Winding

MOST_NUMBERS = 2_000_000  #: of a grid, in a source file
#: Nodes on the faces of a magnet, along an edge and round a cylinder: 1e-9 of B where it is half of
#: half an edge away, half of its radius.
NODES, ROUND = 24, 64

DECLARED = """
/* What makes the field: {about}. */
#define @NAME@_ACTUATORS {count}
/* Set field, field_gradient and field_place to those of the actuators at the place of the state,
   and field_rate to zero; call it before each step. Returns 0, or a status. */
int @name@_actuate(const double actuators[@NAME@_ACTUATORS], const @name@_state *state,
                   @name@_inputs *inputs);
"""


@dataclass(frozen=True)
class Actuators:
    """What makes the field of an exported model.

    Parameters
    ----------
    names, units, abouts, start
        Of each number, as an FMU says them, and its value at the start.
    code
        C of the field.
    """

    names: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    abouts: tuple[str, ...] = ()
    start: tuple[float, ...] = ()
    code: str = ""

    @property
    def declared(self) -> str:
        """Declaration in the header, nothing where the model has none."""
        if not self.names:
            return ""
        listed = ", ".join(n + f" [{u}]" * bool(u) for n, u in zip(self.names, self.units))
        return DECLARED.format(about=listed, count=len(self.names))


def actuators_of(stepper: Stepper) -> Actuators:
    """Return what makes the field of a stepper's swimmer; of a field in formulas, nothing.

    Raises
    ------
    SpecError
        If a grid is too large for a source file.
    """
    field = stepper.swimmer.field if stepper.swimmer is not None else None
    if isinstance(field, DipoleField):
        return _magnet(*field.pose(0.0))
    if isinstance(field, MagnetField):
        return _finite(field)
    return _coils(field) if isinstance(field, CoilField) else Actuators()


def _text(*names: str) -> str:
    folder = files("microswim.control.export") / "c"
    return "".join((folder / f"{name}.c.in").read_text("utf-8") for name in names)


def _magnet(place: Any, moment: Any) -> Actuators:
    code = _text("multipoles", "magnet", "actuate").replace("@sources@\n", "")
    return Actuators(
        names=tuple(f"magnet_{n}" for n in ("x", "y", "z", "mx", "my", "mz")),
        units=("m",) * 3 + ("A.m2",) * 3,
        abouts=("place of the magnet, lab frame",) * 3 + ("moment of the magnet, lab frame",) * 3,
        start=(*map(float, place), *map(float, moment)),
        code=code.replace("@vacuum@", repr(MU_0 / (4.0 * np.pi))),
    )


def _finite(field: MagnetField) -> Actuators:
    """Return a magnet of finite size by its place and attitude; a sphere is a dipole outside."""
    if len(field.size) == 1:
        return _magnet(field.position, field.moment)
    shape = "cylinder" if len(field.size) == 2 else "block"
    half = np.array((field.size[0], *field.size[-2:])) / 2.0
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    told = {"nodes": str(NODES), "round": str(ROUND), "shape": _text(shape)}
    told |= {"node_values": _numbers(nodes), "weight_values": _numbers(weights)}
    told |= {
        "half": _numbers(half),
        "polarisation": _numbers(field.remanence * unit(field.direction)),
    }
    code = re.sub(r"@(nodes|round|shape|\w+_values|half|polarisation)@", lambda m: told[m[1]],
                  _text("body_magnet"))  # fmt: skip
    return Actuators(
        names=tuple(f"magnet_{n}" for n in ("x", "y", "z", "qw", "qx", "qy", "qz")),
        units=("m",) * 3 + ("",) * 4,
        abouts=("place of the magnet, lab frame",) * 3
        + ("quaternion of the magnet, from its pose in the specification",) * 4,
        start=(*field.position, 1.0, 0.0, 0.0, 0.0),
        code=code + _text("actuate"),
    )


def _coils(field: CoilField) -> Actuators:
    coils: Any = field.coils
    if isinstance(coils[0], GridCoil):
        code = _text("grid", "actuate")
        code = code.replace("@degree@", str(coils[0].degree)).replace("@splines@", _grids(coils))
    elif isinstance(coils[0], Winding):
        code = _text("loops", "actuate").replace("@sources@", _loops(coils))
        code = code.replace("@vacuum@", repr(float(magpylib().mu_0) / (2.0 * np.pi)))
    else:
        code = _text("multipoles", "coils", "actuate").replace("@sources@", _sources(coils))
    names = _distinct([coil.name for coil in coils])
    return Actuators(
        names=tuple(f"current_{name}" for name in names),
        units=("A",) * len(coils),
        abouts=tuple(f"current of {coil.name}" for coil in coils),
        start=tuple(map(float, field.at_rest)),
        code=code,
    )


def _distinct(names: list[str]) -> list[str]:
    """Names as parts of identifiers, by their number where they would be the same."""
    plain = [re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") for name in names]
    if len(set(plain)) == len(plain) and all(plain):
        return plain
    return [str(i + 1) for i in range(len(plain))]


def _numbers(values: Any) -> str:
    return ", ".join(repr(float(v)) for v in np.ravel(values))


def _sources(coils: Any) -> str:
    """Sources of all coils as C."""
    tables, rows = [], []
    for i, coil in enumerate(coils):
        for s in coil.sources:
            name = f"COEFFICIENTS_{len(rows)}"
            both = _numbers((*s.inner, *s.outer))
            tables.append(f"static const double {name}[] = {{{both}}};")
            counts = f"{i}, {len(s.inner)}, {len(s.outer)}"
            at = f"{{{_numbers(s.position)}}}, {{{_numbers(s.direction)}}}"
            rows.append(f"    {{{counts}, {at}, {name}}}")
    listed = ",\n".join(rows)
    return "\n".join([*tables, f"static const multipoles SOURCES[] = {{\n{listed}}};\n"])


def _loops(coils: Any) -> str:
    """Loops and measures of all windings as C."""
    rows = [
        f"    {{{i}, {_numbers((radius, turns))}, {{{_numbers(place)}}}, "
        f"{{{_numbers(unit(coil.axis))}}}}}"
        for i, coil in enumerate(coils)
        for radius, turns, place in coil.loops
    ]
    measures = [
        f"    {{{{{_numbers(coil.position)}}}, {{{_numbers(unit(coil.axis))}}}, "
        f"{_numbers((coil.diameter / 2.0, coil.thickness / 2.0, coil.length / 2.0))}}}"
        for coil in coils
    ]
    loops, windings = (",\n".join(part) for part in (rows, measures))
    return (
        f"static const loop LOOPS[] = {{\n{loops}}};\n"
        f"static const winding WINDINGS[] = {{\n{windings}}};\n\n"
    )


def _grids(coils: Any) -> str:
    """Splines of all coils as C."""
    total = sum(coil.values.size for coil in coils)
    if total > MOST_NUMBERS:
        raise SpecError(
            "field.file", f"{total} numbers", f"at most {MOST_NUMBERS} in an exported model",
            "take a coarser grid",
        )  # fmt: skip
    lines, rows = [], []
    for i, coil in enumerate(coils):
        knots, values = coil.splines
        for a, t in zip("XYZ", knots):
            lines.append(f"static const double KNOTS_{i}{a}[] = {{{_numbers(t)}}};")
        for a, c in zip("XYZ", values):
            lines.append(f"static const double SPLINE_{i}{a}[] = {{{_numbers(c)}}};")
        points = ", ".join(str(len(axis)) for axis in coil.axes)
        refer = [", ".join(f"{word}_{i}{a}" for a in "XYZ") for word in ("KNOTS", "SPLINE")]
        rows.append(f"    {{{{{points}}}, {{{refer[0]}}}, {{{refer[1]}}}}}")
    kind = (
        "typedef struct {\n    int points[3];\n    const double *knots[3], *values[3];\n} grid;\n"
    )
    listed = ",\n".join(rows)
    head = f"#define COILS {len(coils)}\n"
    return kind + head + "\n".join([*lines, f"static const grid GRIDS[] = {{\n{listed}}};"])
