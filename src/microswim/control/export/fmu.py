"""The model as a Functional Mock-up Unit for co-simulation, FMI 3.0 or 2.0, no Python inside.

An FMU is a zip: modelDescription.xml, the C sources with their CMakeLists.txt, so that it can be
built for another platform, and their binary for this one. The C of the interface (``c/fmu.c.in``,
``c/fmi2.c.in``, ``c/fmi3.c.in``) stands on the C of cmodel.
"""

from __future__ import annotations

import platform
import sys
import zipfile
from functools import partial
from hashlib import sha256
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any, Literal
from xml.sax.saxutils import quoteattr

from microswim import __version__, checks
from microswim.control.export import cmodel, compiler
from microswim.control.export.actuators import Actuators, actuators_of
from microswim.control.export.boundary import boundary_of
from microswim.control.stepper import Stepper
from microswim.control.thermal import energy_of, tumbles_of
from microswim.errors import MicroswimError
from microswim.numerics.files import scratch

VERSIONS = ("3.0", "2.0")
_EPOCH = (1980, 1, 1, 0, 0, 0)  # of every entry, so that the same model gives the same bytes
SI_UNITS = {
    "m": 'm="1"', "s": 's="1"', "N": 'kg="1" m="1" s="-2"', "N.m": 'kg="1" m="2" s="-2"',
    "T": 'kg="1" s="-2" A="-1"', "A.m2": 'A="1" m="2"', "A": 'A="1"',
    "Pa.s": 'kg="1" m="-1" s="-1"',
    "m/s": 'm="1" s="-1"', "rad/s": 's="-1" rad="1"', "rad": 'rad="1"', "1/s": 's="-1"',
    "J": 'kg="1" m="2" s="-2"',
    "T/m": 'kg="1" m="-1" s="-2" A="-1"', "A.m2/T": 'kg="-1" m="2" s="2" A="2"',
}  # fmt: skip


def variables(stepper: Stepper) -> list[dict[str, Any]]:
    """Return variables of the FMU in the order of their value references."""
    made: list[dict[str, Any]] = []

    def add(names: str, kind: str, unit: str, about: str, start: Any = ()) -> None:
        names_ = names.split()
        start = list(start) or [0.0] * len(names_)
        for name, value in zip(names_, start):
            number = len(made)
            start_value = None if kind in ("time", "calculated") else float(value)
            made.append({"name": name, "reference": number, "kind": kind, "unit": unit})
            made[-1] |= {"about": about, "start": start_value}

    add("time", "time", "s", "simulation time")
    add("viscosity", "tunable", "Pa.s", "of the fluid, positive", [cmodel.viscosity(stepper)])
    add("moment_s moment_q moment_r", "tunable", "A.m2", "magnetic moment, body frame",
        stepper.magnetic[:3])  # fmt: skip
    add(" ".join(f"soft_{i}" for i in ("ss", "qq", "rr", "sq", "sr", "qr")), "tunable", "A.m2/T",
        "moment per field of a soft magnet, body frame",
        stepper.magnetic[list(cmodel.SOFT)])  # fmt: skip
    add("thermal_energy", "tunable", "J", "k_B T of the noise of each step, 0 for none",
        [energy_of(stepper.swimmer) or 0.0])  # fmt: skip
    run_time, angle = tumbles_of(stepper.swimmer)
    add("run_time", "tunable", "s", "mean time of a run that a tumble ends, 0 for no tumbles",
        [run_time])  # fmt: skip
    add("tumble_angle", "tunable", "rad", "by which a tumble turns the body's axis, 0 to pi",
        [angle])  # fmt: skip
    around = boundary_of(stepper)
    add("start_x start_y start_z", "fixed", "m", "position of the body's centre at the start, lab",
        around.start[:3])  # fmt: skip
    add("start_qw start_qx start_qy start_qz", "fixed", "", "attitude at the start, body to lab",
        around.start[3:])  # fmt: skip
    add("start_phase", "fixed", "rad", "phase of the tail at the start")
    add("noise_seed", "fixed", "", "seed of the noise, a whole number")
    add("motor_rate", "input", "rad/s", "phase rate of the motor, negative = reversed",
        [0.0 if stepper.locked else float(stepper.gait.rate)])  # fmt: skip
    for name, unit, about in (
        ("force", "N", "external force on the body at its centre, lab frame"),
        ("torque", "N.m", "external torque on the body about its centre, lab frame"),
        ("field", "T", "magnetic field at the start of a step, lab frame"),
        ("field_rate", "rad/s", "angular velocity with which the field turns in a step, lab frame"),
        ("flow", "m/s", "background velocity at the lab's origin"),
    ):
        add(" ".join(f"{name}_{i}" for i in "xyz"), "input", unit, about)
    add(" ".join(f"gradient_{i}{j}" for i in "xyz" for j in "xyz"), "input", "1/s",
        "gradient of the background velocity, d u_i / d x_j, free of trace")  # fmt: skip
    add(" ".join(f"field_gradient_{i}{j}" for i in "xyz" for j in "xyz"), "input", "T/m",
        "gradient of the magnetic field, d B_i / d x_j")  # fmt: skip
    add("field_place_x field_place_y field_place_z", "input", "m", "place where B is field, lab")
    outside = actuators_of(stepper)
    for one in zip(outside.names, outside.units, outside.abouts, outside.start):
        add(one[0], "input", one[1], one[2], [one[3]])
    add("x y z", "calculated", "m", "position of the body's centre, lab frame")
    add("qw qx qy qz", "calculated", "", "unit quaternion, body to lab")
    add("phase", "calculated", "rad", "phase of the tail relative to the body")
    add("us uq ur", "calculated", "m/s", "velocity of the body's centre, body frame")
    add("os oq or", "calculated", "rad/s", "angular velocity, body frame")
    add("motor_torque", "calculated", "N.m", "torque of the motor, power per unit phase rate")
    if around.code:
        add("gap", "calculated", "m", "smallest distance of the surface to the boundary")
    if stepper.gait.units != "SI":
        for v in made:
            v["unit"] = ""
    return made


@checks.given(
    stepper=partial(checks.instance, kind="Stepper"),
    path=checks.place,
    name=checks.text,
    fmi=checks.one_of(*VERSIONS),
    spec=checks.text,
)
def export_fmu(
    stepper: Stepper,
    path: Any,
    *,
    name: str = "swimmer",
    fmi: Literal["3.0", "2.0"] = "3.0",
    spec: str = "",
) -> dict[str, Any]:
    """Write a co-simulation FMU for this platform; sources are included.

    Parameters
    ----------
    stepper
        The stepper; its moment, viscosity and rate are the start values.
    path
        The file, usually ``name.fmu``; written as a whole or not at all.
    name
        Model identifier, a C identifier.
    fmi
        ``"3.0"`` or ``"2.0"``.
    spec
        Text of the specification, for the digest.

    Returns
    -------
    dict
        ``path``, ``bytes``, ``fmi``, ``platform`` and the names of the variables.

    Raises
    ------
    SpecError
        If an argument makes no sense.
    MicroswimError
        If there is no C compiler.

    Examples
    --------
    >>> import microswim as ms
    >>> stepper = ms.Stepper.of(ms.Swimmer.preset("tabak/helix"))
    >>> ms.export_fmu(stepper, "robot.fmu", fmi="1.0")
    Traceback (most recent call last):
    microswim.errors.SpecError: fmi = '1.0': must be one of "3.0", "2.0"
    """
    checks.choice("fmi", fmi, VERSIONS)
    path = Path(path)
    model, known = cmodel.c_model(stepper, name, spec), variables(stepper)
    wrapper = _wrapper(model, actuators_of(stepper), known, fmi)
    token = _token(model, wrapper, fmi)
    wrapper = wrapper.replace("@token@", token)
    with scratch(path) as here:
        _, source = compiler.write(model, here)
        (here / "fmu.c").write_text(wrapper, encoding="utf-8")
        binary = here / ("model" + _suffix())
        compiler.shared_library([source, here / "fmu.c"], binary)
        entries = {
            "modelDescription.xml": description(model, stepper, known, fmi, token),
            f"sources/{name}.h": model.header,
            f"sources/{name}.c": model.source,
            "sources/fmu.c": wrapper,
            "sources/CMakeLists.txt": _cmake(model),
            "documentation/index.html": f"<!DOCTYPE html><title>{name}</title>"
            f"<pre>{escape(model.banner)}</pre>\n",
            f"binaries/{folder(fmi)}/{name}{_suffix()}": binary.read_bytes(),
        }
        if fmi == "3.0":
            entries["sources/buildDescription.xml"] = _build(model)
        _zip(here / "unit.fmu", entries)
        (here / "unit.fmu").replace(path)
    return {
        "path": str(path), "bytes": path.stat().st_size, "fmi": fmi, "platform": folder(fmi),
        "variables": [v["name"] for v in known],
    }  # fmt: skip


def folder(fmi: str) -> str:
    """Return the name of this platform in an FMU.

    Raises
    ------
    MicroswimError
        If the standard has none.
    """
    machine = {"amd64": "x86_64", "x64": "x86_64", "arm64": "aarch64"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    system = {"linux": "linux", "darwin": "darwin", "win32": "windows"}.get(sys.platform)
    if system is None:
        raise MicroswimError(f"an FMU has no binaries for {sys.platform}; export with --format c")
    if fmi == "3.0":
        return f"{machine}-{system}"
    short = {"linux": "linux", "darwin": "darwin", "windows": "win"}[system]
    return short + ("64" if sys.maxsize > 2**32 else "32")


def _suffix() -> str:
    return {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")


def _token(model: cmodel.CModel, wrapper: str, fmi: str) -> str:
    digest = sha256((fmi + model.header + model.source + wrapper).encode()).hexdigest()
    return "-".join((digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32]))


def _wrapper(model: cmodel.CModel, made: Actuators, known: list[dict[str, Any]], fmi: str) -> str:
    first = {
        k: next(v["reference"] for v in known if v["kind"] == k)
        for k in ("fixed", "input", "calculated")
    }
    values = {
        "name": model.name,
        "NAME": model.name.upper(),
        "banner": model.banner,
        "token": "@token@",
        "first_start": str(first["fixed"]),
        "first_input": str(first["input"]),
        "first_output": str(first["calculated"]),
        "variables": str(len(known)),
        "gap": f"{model.name}_gap(y)" if known[-1]["name"] == "gap" else "0.0",
        "actuators": str(len(made.names)),
        "actuators_start": ", ".join(map(repr, (*made.start, 0.0))),
    }
    parts = (files("microswim.control.export") / "c" / f for f in ("fmu.c.in", f"fmi{fmi[0]}.c.in"))
    return "".join(cmodel.filled(p.read_text("utf-8"), values) for p in parts)


def _zip(path: Path, entries: dict[str, str | bytes]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as z:
        for name, content in entries.items():
            info = zipfile.ZipInfo(name, _EPOCH)
            info.compress_type, info.external_attr = zipfile.ZIP_DEFLATED, 0o644 << 16
            z.writestr(info, content)


def description(
    model: cmodel.CModel, stepper: Stepper, known: list[dict[str, Any]], fmi: str, token: str
) -> str:
    """Return modelDescription.xml."""
    about = " ".join(model.banner.strip("/* \n").split())
    three = fmi == "3.0"
    head = {
        "fmiVersion": fmi, "modelName": model.name, "description": about,
        "instantiationToken" if three else "guid": token,
        "generationTool": f"microswim {__version__}", "variableNamingConvention": "flat",
    }  # fmt: skip
    state = "FMUState" if three else "FMUstate"
    flags = f'canGetAndSet{state}="true" canSerialize{state}="true"'
    if not three:
        flags += ' canNotUseMemoryManagementFunctions="true"'
    flags += ' canHandleVariableCommunicationStepSize="true"'
    sources = "" if three else _source_files(model.name)
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        "<fmiModelDescription" + "".join(f" {k}={quoteattr(v)}" for k, v in head.items()) + ">",
        f'<CoSimulation modelIdentifier="{model.name}" {flags}>{sources}</CoSimulation>',
        _units(stepper),
        '<LogCategories><Category name="logStatusError"/></LogCategories>',
        _experiment(stepper),
        "<ModelVariables>",
        *(_variable(v, three) for v in known),
        "</ModelVariables>",
        _structure(known, three),
        "</fmiModelDescription>",
    ]
    return "\n".join(line for line in lines if line) + "\n"


def _source_files(name: str) -> str:
    return f'<SourceFiles><File name="{name}.c"/><File name="fmu.c"/></SourceFiles>'


def _build(model: cmodel.CModel) -> str:
    name = model.name
    about = model.banner.strip("/* \n").replace("--", "- -")  # two would end a comment
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {about} -->\n'
        '<fmiBuildDescription fmiVersion="3.0">'
        f'<BuildConfiguration modelIdentifier="{name}"><SourceFileSet language="C99">'
        f'<SourceFile name="{name}.c"/><SourceFile name="fmu.c"/></SourceFileSet>'
        "</BuildConfiguration></fmiBuildDescription>\n"
    )


def _cmake(model: cmodel.CModel) -> str:
    values = {"name": model.name, "banner": model.banner.strip("/* \n").replace("\n", "\n# ")}
    return cmodel.filled(
        (files("microswim.control.export") / "c" / "CMakeLists.txt.in").read_text("utf-8"), values
    )


def _units(stepper: Stepper) -> str:
    if stepper.gait.units != "SI":
        return ""
    units = (f'<Unit name="{u}"><BaseUnit {base}/></Unit>' for u, base in SI_UNITS.items())
    return "<UnitDefinitions>" + "".join(units) + "</UnitDefinitions>"


def _experiment(stepper: Stepper) -> str:
    period = float(stepper.gait.period) if stepper.gait.rate and not stepper.locked else 1.0
    return (
        f'<DefaultExperiment startTime="0" stopTime="{10 * period!r}" stepSize="{period / 20!r}"/>'
    )


def _variable(v: dict[str, Any], three: bool) -> str:
    causality, variability, initial = {
        "time": ("independent", "continuous", None),
        "tunable": ("parameter", "tunable", "exact"),
        "fixed": ("parameter", "fixed", "exact"),
        "input": ("input", "continuous", None),
        "calculated": ("output", "continuous", "calculated"),
    }[v["kind"]]
    common = f'name="{v["name"]}" valueReference="{v["reference"]}" causality="{causality}" '
    common += f'variability="{variability}" description={quoteattr(v["about"])}'
    if initial:
        common += f' initial="{initial}"'
    own = f' unit="{v["unit"]}"' if v["unit"] else ""
    own += "" if v["start"] is None else f' start="{v["start"]!r}"'
    if three:
        return f"<Float64 {common}{own}/>"
    return f"<ScalarVariable {common}><Real{own}/></ScalarVariable>"


def _structure(known: list[dict[str, Any]], three: bool) -> str:
    outputs = [v["reference"] for v in known if v["kind"] == "calculated"]
    if three:
        lines = [
            f'<{tag} valueReference="{r}"/>'
            for tag in ("Output", "InitialUnknown")
            for r in outputs
        ]
        return "<ModelStructure>" + "".join(lines) + "</ModelStructure>"
    entries = "".join(f'<Unknown index="{r + 1}"/>' for r in outputs)
    return (
        f"<ModelStructure><Outputs>{entries}</Outputs>"
        f"<InitialUnknowns>{entries}</InitialUnknowns></ModelStructure>"
    )
