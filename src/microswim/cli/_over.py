"""``--over``: what varies and how far, as text; quantities carry units: ``1mm:3mm:5``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError
from microswim.spec.values import from_text

if TYPE_CHECKING:
    from microswim.cli._options import Given

MOST_VALUES = 1_000_000  #: of one axis
MEND = "for example tail.amplitude=0.01:0.5:50,tail.waves=1,2,3"


def split(texts: tuple[str, ...], option: str = "--over") -> dict[str, str]:
    """Return the dotted name to the text of its values.

    Raises
    ------
    SpecError
        If a piece has no name, or a name comes twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        for piece in re.split(r",(?=\s*[A-Za-z_][\w.\[\]]*\s*=)", text):
            name, equals, values = piece.partition("=")
            name = name.strip()
            if not equals or not name or not values.strip():
                raise SpecError(option, text, "NAME=VALUES", MEND)
            if name in found:
                raise SpecError(option, text, f"each name once ({name} comes twice)")
            found[name] = values.strip()
    return found


def axes(texts: tuple[str, ...], units: str) -> dict[str, Any]:
    """Return the axes of a grid: every name with its values.

    Raises
    ------
    SpecError
        If a range does not say how many values, or a value is none of its field.
    """
    return {
        name: values_of(name, text, units, f"--over {name}") for name, text in split(texts).items()
    }


def bounds(texts: tuple[str, ...], units: str, option: str = "--over") -> dict[str, Any]:
    """Return what a design may vary: a pair of bounds, or a list of choices.

    Raises
    ------
    SpecError
        If a range is no range, or a value is none of its field.
    """
    return {k: _bounds(k, text, units, option) for k, text in split(texts, option).items()}


def spreads(texts: tuple[str, ...], units: str) -> dict[str, Any]:
    """Return uncertain numbers: ``5%`` as it stands, ``LOW:HIGH`` as a pair.

    Raises
    ------
    SpecError
        If a range is no range.
    """
    option = "--uncertain"
    pieces = split(texts, option).items()
    return {k: t if t.endswith("%") else _bounds(k, t, units, option) for k, t in pieces}


def values_of(name: str, text: str, units: str, said: str) -> Any:
    """Return the values of one field: FIRST:LAST:COUNT, FIRST:LAST:COUNT:log or a list.

    Parameters
    ----------
    name
        Dotted name of the field.
    text
        As it was written.
    units
        Of the swimmer.
    said
        What an error calls it.

    Raises
    ------
    SpecError
        If a range does not say how many values, or a value is none of its field.
    """
    if ":" not in text:
        return [from_text(name, part, units, said) for part in text.split(",")]
    first, last, *rest = text.split(":")
    count = rest[0].strip() if rest else ""
    if not re.fullmatch("[0-9]+", count) or rest[1:] not in ([], ["log"]):
        allowed = "FIRST:LAST:COUNT, FIRST:LAST:COUNT:log or a list"
        raise SpecError(said, text, allowed, MEND)
    if not 1 <= int(count[:12]) <= MOST_VALUES:
        raise SpecError(said, text, f"of 1 to {MOST_VALUES} values")
    a, b = (_number(name, end, units, said, text) for end in (first, last))
    if rest[1:] and not (a > 0 and b > 0):
        raise SpecError(said, text, "of positive ends for a logarithmic range")
    return (np.geomspace if rest[1:] else np.linspace)(a, b, int(count))


def _bounds(name: str, text: str, units: str, option: str) -> Any:
    said = f"{option} {name}"
    if ":" not in text:
        return [from_text(name, part, units, said) for part in text.split(",")]
    ends = text.split(":")
    if len(ends) != 2:
        raise SpecError(said, text, "LOW:HIGH, or a list of choices", MEND)
    return tuple(_number(name, end, units, said, text) for end in ends)


def _number(name: str, end: str, units: str, said: str, text: str) -> float:
    """Value of an end of a range."""
    value = from_text(name, end, units, said)
    if isinstance(value, (bool, str)):
        raise SpecError(said, text, "a range of numbers, or a list of words", MEND)
    return value


def of_starts(texts: tuple[str, ...], units: str) -> dict[str, Any]:
    """Return the axes of a map of starts: places and angles of the start, and fields.

    Raises
    ------
    SpecError
        As of `axes`.
    """
    from microswim.studies.sweeps.starts import STARTS

    found: dict[str, Any] = {}
    for name, text in split(texts).items():
        said = f"--over {name}"
        if name not in STARTS:
            found[name] = values_of(name, text, units, said)
            continue
        kind, own = ("rad", "SI") if STARTS[name] == "angle" else ("m", units)
        ends = text.split(":")
        if len(ends) == 1:
            found[name] = [_plain(said, part, kind, own) for part in text.split(",")]
        elif len(ends) == 3 and re.fullmatch("[0-9]{1,6}", ends[2].strip()) and int(ends[2]):
            a, b = (_plain(said, end, kind, own) for end in ends[:2])
            found[name] = np.linspace(a, b, int(ends[2]))
        else:
            raise SpecError(said, text, "FIRST:LAST:COUNT or a list", "such as tilt=0:60deg:7")
    return found


def _plain(said: str, text: str, kind: str, units: str) -> float:
    """Return a length or an angle; a bare number is one of radians."""
    from microswim.spec.values import in_unit

    bare = text.strip().lstrip("+-").replace(".", "", 1).isdecimal()
    return float(text) if bare and kind == "rad" else in_unit(said, text.strip(), kind, units)


def _solve_poses(given: Given, over: dict[str, Any]) -> None:
    """Solve the poses of each design of a map, seen to come, so that the paths find them kept."""
    from microswim.calibration.poses.around import around
    from microswim.cli import _kept
    from microswim.cli._progress import bar
    from microswim.numerics.files import cache_folder
    from microswim.studies.sweeps.starts import with_poses

    if cache_folder("poses") is None:
        return
    designs = with_poses(given.swimmer, over)
    for n, design in enumerate(designs):
        of = f", design {n + 1} of {len(designs)}" if len(designs) > 1 else ""
        with _kept.solves(), bar(f"poses of {given.name}{of}") as progress:
            around(design, progress=progress)


def map_starts(
    given: Given, texts: tuple[str, ...], time: float, model: Any, out: Path | None, as_json: bool
) -> None:
    """Follow the paths of a map of starts; print how they end, and write map and picture."""
    from collections import Counter

    import click

    from microswim.cli._options import print_json
    from microswim.cli._progress import bar
    from microswim.numerics.files import write
    from microswim.output.io import run as io
    from microswim.output.plots.starts import starts as picture
    from microswim.output.report.html import png
    from microswim.studies.sweeps.starts import starts

    over = of_starts(texts, given.swimmer.units)
    _solve_poses(given, over)
    with bar(f"starts of {given.name}") as progress:
        found = starts(
            given.swimmer, time, over, model=model, progress=progress,
            keep=None if out is None else out / "starts.json",
        )  # fmt: skip
    ends = Counter(map(str, found.outcome.values.ravel()))
    about = {"swimmer": given.name, "units": given.swimmer.units, "time": time}
    report = about | {"starts": int(found.outcome.size), "outcomes": dict(ends.most_common())}
    if out is not None:
        io.save(found, out / "starts.nc")
        if found.outcome.ndim <= 2:
            write(out / "starts.png", png(picture(found)))
    if as_json:
        print_json(report | {"over": {k: list(v) for k, v in over.items()},
                             "outcome": found.outcome.values.tolist()})  # fmt: skip
        return
    for how, count in ends.most_common():
        click.echo(f"  {count:>6}  {how}")
    if out is not None:
        click.echo(f"written to {out}/: starts.nc, starts.json, starts.png", err=True)
