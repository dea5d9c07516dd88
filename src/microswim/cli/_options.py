"""Options that the commands share: where the swimmer comes from, the model, how to print."""

from __future__ import annotations

import functools
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from microswim.errors import SpecError, writing
from microswim.gait import doors
from microswim.numerics.plain import plain

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer

#: Those that a user chooses for themselves.
MODELS = tuple(model for model in doors.MODELS if model not in ("auto", "atlas"))

SAY_THEMSELVES = ("run", "show")  #: what is odd about a swimmer, among the remarks of its gait


@dataclass(frozen=True)
class Given:
    """The swimmer that the user gave: its name, its tables (``--set`` applied), its spec text."""

    name: str
    tables: dict[str, Any]
    text: str
    swimmer: Swimmer


def swimmer_options(command: Callable[..., Any], *, needed: bool = True) -> Callable[..., Any]:
    """Add SPEC, --preset, --set and --trust; the command gets them as ``given``, a `Given`.

    Where a swimmer is not `needed` and none is given, ``given`` is None.
    """

    @click.argument("spec", required=False, type=click.Path(path_type=Path))
    @click.option("--preset", metavar="NAME", help="A swimmer that comes along: microswim presets.")
    @click.option(
        "--set",
        "changes",
        metavar="FIELD=VALUE",
        multiple=True,
        help="Override a field of the spec: tail.amplitude=0.12 (repeatable).",
    )
    @click.option(
        "--trust",
        metavar="FILE.py",
        type=click.Path(path_type=Path),
        help="Python file whose functions the spec may name; it is run.",
    )
    @functools.wraps(command)
    def wrapped(
        *,
        spec: Path | None,
        preset: str | None,
        changes: tuple[str, ...],
        trust: Path | None,
        **rest: Any,
    ):
        if not needed and spec is None and preset is None and not changes:
            return command(given=None, **rest)
        from microswim.spec.writing import as_written

        given = read(spec, preset, changes, trust)
        if click.get_current_context().info_name not in SAY_THEMSELVES:
            _say(given.swimmer)
        with writing(as_written(given.tables)):
            return command(given=given, **rest)

    return wrapped


def _say(swimmer: Swimmer) -> None:
    """Say on stderr what can hardly be meant by a swimmer."""
    for remark in (*swimmer.remarks, *swimmer.remarks_on_drag):
        click.echo(f"note: {remark}", err=True)


model_option = click.option(
    "--model",
    type=click.Choice(MODELS),
    default="rft",
    show_default=True,
    help="rft: the surrogate (elastic: of an elastic tail). bem, fem: the reference solvers.",
)
auto_option = click.option(
    "--model",
    type=click.Choice(tuple(doors.MODELS)),
    default="auto",
    show_default=True,
    help="auto: the atlas where it covers the swimmer and the spec chooses no law or coefficients, "
    "else rft, or elastic for an elastic tail. atlas: rft with corrections that come along. "
    "bem, fem: the reference solvers.",
)
accuracy_option = click.option(
    "--accuracy",
    metavar="2%",
    help="Largest error of u_s and Omega_s: the cheapest model that holds it, up to bem.",
)
level_option = click.option(
    "--level",
    type=click.Choice(["coarse", "standard", "fine", "paper"]),
    help="Resolution of bem and fem; standard by default. paper: fem alone, 310,000 unknowns of "
    "second order, as the paper's.",
)


def leveled(model: str, level: str | None) -> dict[str, Any]:
    """Return the options of a model at a level of resolution.

    Raises
    ------
    SpecError
        If the model has none.
    """
    if level is not None and model not in ("bem", "fem"):
        raise SpecError(
            "--level", level, f"left out with --model {model}", "bem and fem have levels"
        )
    return {} if level is None else {"level": level}


json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
out_option = click.option(
    "--out", metavar="DIR", type=click.Path(path_type=Path), help="Folder for files and pictures."
)
solver_option = click.option(
    "--option",
    "options",
    multiple=True,
    metavar="NAME=VALUE",
    help='For the reference: level="fine".',
)
workers_option = click.option(
    "--workers", type=click.IntRange(0, 1024), help="Processes (default: all cores)."
)
force_option = click.option("--force", is_flag=True, help="Replace what is in the way.")


def example(*lines: str) -> str:
    """Return the epilog of a command's help: examples, one per line."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def read(
    spec: Path | None,
    preset: str | None,
    changes: tuple[str, ...] = (),
    trust: Path | None = None,
) -> Given:
    """Return the swimmer of a spec file or a preset, with ``FIELD=VALUE`` overrides.

    Raises
    ------
    SpecError
        One sentence.
    """
    from microswim.spec import presets
    from microswim.spec.describe import to_text
    from microswim.spec.file import from_dict, override
    from microswim.spec.named_files import beside
    from microswim.spec.readers.text import read_text, toml
    from microswim.spec.several import several
    from microswim.spec.toml import to_toml

    if (spec is None) == (preset is None):
        raise SpecError(
            "give a spec file or --preset NAME, one of the two; "
            '"microswim new" writes a spec, "microswim presets" lists the presets'
        )
    overrides = dict(change(text) for text in changes)
    if spec is not None:
        name = spec.stem
        text = read_text(spec, mend=f'"microswim new {spec}" writes one to start from')
    else:
        name, text = str(preset), presets.read(str(preset))
    tables = beside(toml(text, str(spec or preset)), spec.parent if spec else Path())
    swimmer = from_dict(tables, overrides, trust)
    tables = override(tables, overrides)
    if overrides:
        text = to_toml(tables, f"{name}, with --set {' '.join(changes)}")
    if any(
        tail.get("file") for tail in several(tables.get("tail"))
    ):  # the beat itself, so that the text stands alone
        text = to_text(swimmer)
    return Given(name, tables, text, swimmer)


def share(text: str | None) -> float | None:
    """Return the share that ``2%`` or ``0.02`` means.

    Raises
    ------
    SpecError
        If it is neither.
    """
    if text is None:
        return None
    try:
        return float(text.strip().removesuffix("%")) * (0.01 if text.strip().endswith("%") else 1.0)
    except ValueError:
        raise SpecError("--accuracy", text, "a share", "such as 2% or 0.02") from None


def change(text: str) -> tuple[str, Any]:
    """Return the field and value of ``FIELD=VALUE``; the value is TOML, or a bare word or quantity.

    Raises
    ------
    SpecError
        If there is no equals sign.
    """
    from microswim.spec.readers.text import toml

    field, equals, value = text.partition("=")
    if not equals or not field.strip():
        raise SpecError("--set", text, "FIELD=VALUE", "for example --set tail.amplitude=0.12")
    try:
        (parsed,) = toml(f"value = {value}", "--set").values()
    except ValueError:  # of which a SpecError is one
        parsed = value.strip()
    return field.strip(), parsed


def print_json(result: dict[str, Any]) -> None:
    """Print one JSON object; NaN and infinities as null, arrays as lists."""
    click.echo(json.dumps(plain(result), allow_nan=False, ensure_ascii=False))
