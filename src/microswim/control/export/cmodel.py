"""The model as self-contained C99: one header, one source, the coefficients inside.

The C in ``c/`` mirrors motion line by line; here its placeholders are filled.
"""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass
from functools import partial
from hashlib import sha256
from importlib.resources import files
from typing import Any, Literal

import numpy as np

from microswim import __version__, checks
from microswim.control.export.actuators import actuators_of
from microswim.control.export.boundary import boundary_of
from microswim.control.export.precision import FIGURES, PRECISIONS, check_range, single
from microswim.control.stepper import Stepper
from microswim.control.thermal import energy_of, tumbles_of
from microswim.errors import SpecError
from microswim.gait.readable import origin
from microswim.gait.units import unit

#: Entries ss, qq, rr, sq, sr, qr of the moment per field, in `Stepper.magnetic`.
SOFT = (3, 7, 11, 4, 5, 8)
MEASURED = ("length", "time", "force", "torque", "field", "moment", "viscosity")
BANNER = """\
/* {name}: a swimmer at low Reynolds number, written by microswim {version}.

   Model {model}, units {units}, spec digest sha256:{digest}
{birth}{strain}{boundary}
   CONVENTIONS
   Quaternion qw, qx, qy, qz: unit, turns body components into lab components (body to lab).
   Body frame s, q, r: right-handed, s along the tail away from the body; the swimmer leads with its
   body, so it swims forward with us < 0. Position is that of the body's centre in the lab frame.
   Six-vectors are [linear; angular], body frame, about the body's centre: us, uq, ur, os, oq, or.
   Force and torque act ON the swimmer; R V + F_p rate = W_external, the fluid's is the negative.
   Phase in radians, of the tail relative to the body; a positive motor rate sends the wave away
   from the body{hand}.
   Of a magnetic field: torque m x B and force J' m, J_ij = d B_i / d x_j; m = moment + soft B,
   both fixed in the body. Stokes flow: no inertia.
   A step takes {steps};
   it calls nothing but libm, allocates nothing, keeps no static state. */"""


@checks.by_name
@dataclass(frozen=True)
class CModel:
    """Header and source.

    Parameters
    ----------
    name
        Prefix of every symbol and stem of the files.
    header, source
        Text of the two files.
    banner
        The comment at their head: conventions, units, provenance.

    Examples
    --------
    >>> import microswim as ms
    >>> model = ms.c_model(ms.Stepper(ms.Swimmer.preset("tabak/helix").gait()), "robot")
    >>> "robot_step" in model.header
    True
    """

    name: str
    header: str
    source: str
    banner: str


@checks.given(
    stepper=partial(checks.instance, kind="Stepper"),
    name=checks.text,
    spec=checks.text,
    precision=checks.one_of(*PRECISIONS),
)
def c_model(
    stepper: Stepper,
    name: str = "swimmer",
    spec: str = "",
    precision: Literal["double", "float"] = "double",
) -> CModel:
    """Return C99 of a stepper: `name`.h and `name`.c.

    Parameters
    ----------
    stepper
        The stepper; its moment and the motor's rate become defaults, its resolution and its
        numbers of steps stay.
    name
        A C identifier, and no word of C.
    spec
        Text of the specification, for the digest in the files.
    precision
        ``"double"``, or ``"float"`` for a processor without double: six digits, and the phase is
        kept between 0 and 2 pi, where it has them.

    Raises
    ------
    SpecError
        If the name is no C identifier, or the model's numbers do not fit the precision.

    Examples
    --------
    >>> import microswim as ms
    >>> stepper = ms.Stepper.of(ms.Swimmer.preset("tabak/helix"))
    >>> "int robot_step(" in ms.c_model(stepper, "robot").header
    True
    """
    check_name(name)
    checks.choice("precision", precision, PRECISIONS)
    if not np.isrealobj(stepper.response.twist):
        raise SpecError("the gait holds numbers that are not real; check the swimmer")
    values = _values(stepper, name, spec) | PRECISIONS[precision]
    header, source = (
        (files("microswim.control.export") / "c" / f).read_text("utf-8")
        for f in ("model.h.in", "model.c.in")
    )
    if precision == "float":
        check_range(stepper, viscosity(stepper))
        header, source = single(header), single(source)
        values |= {k: single(values[k]) for k in FIGURES}
    values |= {"actuate": filled(values["actuate"], values)}
    values |= {"boundary": filled(values["boundary"], values)}
    values |= {"declared": filled(values["declared"], values)}
    return CModel(name, filled(header, values), filled(source, values), values["banner"])


def check_name(name: str) -> None:
    """Refuse what no model in C can be called.

    Raises
    ------
    SpecError
        If the name is no C identifier, or a word of C.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,40}", name):
        raise SpecError("name", name, "letters, digits and underscores, a letter first")
    if reserved(name):
        raise SpecError("name", name, "no word of C", f'take another, such as "{name}_robot"')


def reserved(name: str) -> bool:
    """Return whether a name is a word of C or C++, or of a file that an include could mean."""
    words = (files("microswim.control.export") / "c" / "reserved.txt").read_text("utf-8").split()
    return name.lower() in words


def filled(template: str, values: dict[str, str]) -> str:
    """Return the template with every ``@key@`` replaced."""
    return re.sub(r"@(\w+)@", lambda m: values[m[1]], template)


def _values(stepper: Stepper, name: str, spec: str) -> dict[str, str]:
    gait = stepper.gait
    units = {kind: unit(gait.units, kind) for kind in MEASURED}
    digest = sha256(spec.encode() or repr(stepper.response.twist.tolist()).encode()).hexdigest()[
        :16
    ]
    made, around = actuators_of(stepper), boundary_of(stepper)
    values = {
        "name": name,
        "NAME": name.upper(),
        "version": __version__,
        "digest": digest,
        **units,
        "limits": numbers(stepper.limits[:4]),
        "locked": "1.0" if stepper.locked else "0.0",
        "viscosity_value": repr(viscosity(stepper)),
        "moment_values": numbers(stepper.magnetic[:3]),
        "soft_values": numbers(stepper.magnetic[list(SOFT)]),
        "steps": str(stepper.steps or 0),
        "most_steps": str(stepper.most_steps),
        "bound": _about_steps(stepper),
        "energy": repr(energy_of(stepper.swimmer) or 0.0),
        **dict(zip(("run_time", "tumble_angle"), map(repr, tumbles_of(stepper.swimmer)))),
        "rate_value": repr(0.0 if stepper.locked else float(gait.rate)),
        "declared": made.declared + around.declared,
        "bounded": "1" if around.code else "0",
        "boundary": around.code,
        "start_position": numbers(np.array(around.start[:3])),
        "start_quaternion": numbers(np.array(around.start[3:])),
        "actuate": made.code,
        "tables": _tables(stepper, bool(around.code)),
    }
    values["banner"] = BANNER.format(
        name=name,
        version=__version__,
        model=gait.model,
        digest=digest,
        units=gait.units + " (" + ", ".join(f"{k} {v}" for k, v in units.items()) + ")",
        strain="" if around.code else _about_strain(stepper),
        boundary=_wrapped(around.about),
        birth=_about_birth(stepper),
        hand=_about_hand(stepper),
        steps=_about_steps(stepper),
    )
    return values


def _about_birth(stepper: Stepper) -> str:
    """Return where the numbers come from, wrapped, with nothing that would end the comment."""
    said = (" ".join(line.split()).replace("*/", "* /") for line in origin(stepper.gait))
    return "".join(_wrapped(line) for line in said)


def _wrapped(line: str) -> str:
    """Return a line of the banner in its width; nothing of nothing."""
    indent: dict[str, Any] = {"initial_indent": "   ", "subsequent_indent": "     "}
    return textwrap.fill(line, 100, **indent) + "\n" if line else ""


def _tables(stepper: Stepper, bounded: bool) -> str:
    """Return the tables of a swimmer in free fluid; the motor's alone beside a boundary."""
    named = zip(("TWIST", "STRAIN", "MOTOR"), stepper.response.tables)
    return "".join(table(n, t) for n, t in named if n == "MOTOR" or not bounded)


def _about_steps(stepper: Stepper) -> str:
    if stepper.steps:
        return f"{stepper.steps} internal steps, always; what turns too far for them is refused"
    return f"at most {stepper.most_steps} internal steps; what would take more is refused"


def _about_strain(stepper: Stepper) -> str:
    if stepper.swimmer is None:
        return "   Of a background flow only velocity and rotation at the body's centre are felt.\n"
    return "   The strain of a background flow is felt at the level of resistive force theory.\n"


def _about_hand(stepper: Stepper) -> str:
    hand = getattr(getattr(stepper.swimmer, "tail", None), "handedness", None)
    sense = {"left": "about +s", "right": "about -s"}
    return f", a {hand}-handed helix turns {sense[hand]}" if hand else ""


def viscosity(stepper: Stepper) -> float:
    """Return the viscosity at which the coefficients were made; 1 stands for it if nobody told."""
    return 1.0 if stepper.swimmer is None else float(stepper.swimmer.fluid.viscosity)


def numbers(values: np.ndarray) -> str:
    """Return numbers as C has them, exact."""
    return ", ".join(repr(float(v)) for v in values)


def table(name: str, values: np.ndarray) -> str:
    """Return a table of doubles, with the number of its rows."""
    rows = ",\n".join(f"    {numbers(r)}" for r in values)
    head = f"#define {name}_ROWS {len(values)}\n"
    return head + f"static const double {name}[{values.size}] = {{\n{rows}}};\n"
