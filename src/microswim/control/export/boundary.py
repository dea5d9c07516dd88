"""A wall or a tube inside the exported model: what is known of the poses, as tables and as C.

The C in ``c/boundary.c.in``, ``wall.c.in`` and ``tube.c.in`` mirrors `microswim.gait.poses` and
`microswim.control.posed`.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.resources import files
from typing import Any

import numpy as np

from microswim.calibration.poses.layout import has_three
from microswim.control.stepper import Stepper
from microswim.errors import SpecError
from microswim.gait.poses import beside_wall
from microswim.gait.poses.table import TUBE, WALL
from microswim.gait.readable import percent
from microswim.numerics.array import Array
from microswim.path.contact import REACH
from microswim.swimmer.swimmer import Swimmer

DECLARED = """
/* The smallest distance of the surface to the boundary, negative inside [@length@]. */
double @name@_gap(const @name@_state *state);
"""
WHERE = {
    True: "The tube of radius {radius!r} has the x axis of the lab as its axis. The flow in it is "
    "Poiseuille's; its velocity on the axis is flow[0]. ",
    False: "The wall is the plane z = 0 of the lab, the fluid above it. A flow strains the swimmer "
    "as in free fluid, and presses it onto the wall as there. ",
}
ABOUT = (
    "R and F_p are those of each pose, from poses solved by boundary elements; a short-range "
    "repulsion of range {reach!r} keeps body and tail off. The state starts as the specification "
    "says."
)
DIGITS = 13  #: of the large tables


@dataclass(frozen=True)
class Boundary:
    """What bounds the fluid of an exported model; by default nothing does.

    Parameters
    ----------
    code
        C of it, its tables first.
    about
        A sentence for the head of the files.
    start
        Position and quaternion at the start (7,).
    """

    code: str = ""
    about: str = ""
    start: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)

    @property
    def declared(self) -> str:
        """Declaration in the header, nothing in free fluid."""
        return DECLARED if self.code else ""


def check(swimmer: Swimmer) -> None:
    """Refuse a swimmer of which no C is written beside its wall, before its poses are solved.

    Raises
    ------
    SpecError
        One sentence.
    """
    if swimmer.wall is not None and not has_three(swimmer):
        raise _unknown()


def _unknown() -> SpecError:
    return SpecError(
        "wall: C beside it is written for a body of revolution with a helical tail; leave "
        "[wall] out, or follow the swimmer in Python (ms.path, ms.Stepper.of)"
    )


def boundary_of(stepper: Stepper) -> Boundary:
    """Return what bounds the fluid of a stepper.

    Raises
    ------
    SpecError
        If the export does not know the swimmer's poses there.
    """
    around: Any = getattr(stepper, "around", None)
    if around is None:
        return Boundary()
    if around.table.kind == WALL and around.table.known.size:
        raise _unknown()
    posed: Any = stepper
    tube, table = around.table.kind == TUBE, around.table
    about = WHERE[tube].format(radius=float(table.boundary[6]) if tube else 0.0)
    about += ABOUT.format(reach=float(around.contact[REACH])) + _wrong(posed.poses.expected_error)
    code = _text("boundary").replace("@kind@", _text("tube" if tube else "wall"))
    code = code.replace("@about@", "The axis of the tube is x." if tube else "The wall is z = 0.")
    start = np.concatenate(posed.poses.start)
    tables = _common(around) + (_tube(table) if tube else _wall(around))
    return Boundary(tables + code, about, tuple(map(float, start)))


def _wrong(error: dict[str, Any]) -> str:
    """Return by how much poses are missed, as a sentence."""
    parts = (f"{k} {percent(v)}" for k, v in error.items() if k != "how")
    return f" Poses are met within {', '.join(parts)}: {error['how']}." if error else ""


def _text(name: str) -> str:
    return (files("microswim.control.export") / "c" / f"{name}.c.in").read_text("utf-8")


def _array(name: str, values: Array, digits: int = 17) -> str:
    """Return a table of doubles; one number stands for none."""
    flat = np.ravel(values) if np.size(values) else np.zeros(1)
    listed = ", ".join(_number(v, digits) for v in flat)
    return f"static const double {name}[{len(flat)}] = {{{listed}}};\n"


def _number(value: float, digits: int) -> str:
    """Return a number of C, with a point or an exponent."""
    text = f"{float(value):.{digits}g}"
    return text if "." in text or "e" in text else text + ".0"


def _common(around: Any) -> str:
    table, free = around.table, ", ".join("1" if f else "0" for f in around.free)
    return (
        _array("NUMBERS", table.numbers)
        + _array("CONTACT", around.contact)
        + f"static const int FREE_TO[6] = {{{free}}};\n"
        + f"#define BODY_POINTS {len(table.body)}\n"
        + f"#define BODY_COLUMNS {table.body.shape[1]}\n"
        + _array("BODY", table.body)
        + f"#define TAIL_POINTS {len(table.tail)}\n"
        + _array("TAIL", table.tail)
    )


def _wall(around: Any) -> str:
    table = around.table
    _, gaps, tilts, turns, columns = table.factors.shape
    sizes = {"GAPS": gaps, "TILTS": tilts, "TURNS": turns, "COLUMNS": columns}
    sizes |= {"KINKS_ROWS": len(table.kinks), "PACKED_ROWS": len(table.packed)}
    sizes |= {"SWITCH_ROWS": len(table.switch)}
    sizes |= {"HELD_ROWS": len(around.strain)}
    return (
        "".join(f"#define {name} {size}\n" for name, size in sizes.items())
        + f"static const double CLOSER = {_number(beside_wall.CLOSER, 17)};\n"
        + _array("KINKS", table.kinks)
        + _array("SWITCH", table.switch)
        + _array("PACKED", table.packed)
        + _array("HELD", around.strain)
        + _array("FACTORS", table.factors, DIGITS)
    )


def _tube(table: Any) -> str:
    features, poses = table.known.shape[1] - 1, table.known.shape[2]
    return (
        f"#define POSES {poses}\n#define FEATURES {features}\n"
        + f"static const double TUBE_RADIUS = {_number(table.boundary[6], 17)};\n"
        + _array("ROOT", table.root)
        + _array("KNOWN", table.known, DIGITS)
        + _array("WEIGHTS", table.weights, DIGITS)
        + _array("CARRIED", table.carried, DIGITS)
    )
