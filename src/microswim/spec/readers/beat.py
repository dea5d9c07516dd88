"""Beats that were filmed: a table of points on the filament, and what the spec says beside it.

Columns t (or frame), s, x, y, or t, s, angle, in the frame of the head: base at the origin, x along
the axis of the head, away from it. Filmed in the lab, the head's track brings them there: head_x,
head_y, head_angle (where its axis points, from the head to the tail).
"""

from __future__ import annotations

from os import PathLike
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers import film, measured
from microswim.spec.readers.delimited import cells
from microswim.spec.readers.measured import Table
from microswim.swimmer.geometry.tails.waveforms.waveform import Beat, Waveform
from microswim.swimmer.geometry.tails.waveforms.waveform_fit import fit

KNOWN = {
    "time": film.TIME, "frame": film.FRAMES,
    "s": ("s", "arc", "arclength", "arc_length", "arc length"),
    "x": ("x",), "y": ("y",), "z": ("z",),
    "angle": ("angle", "psi", "tangent_angle", "tangent angle", "theta"),
    "head_x": ("head_x", "xh"), "head_y": ("head_y", "yh"), "head_angle": ("head_angle",),
}  # fmt: skip
SETTING = ("file", "pixel", "fps", "mode_count", "harmonics")
STILL = 0.02  #: of the length, that a base may move before it is no base


def is_beat(path: str | PathLike[str]) -> bool:
    """Return whether a table is that of a beat: it has arc length, and positions or angles."""
    if str(path).lower().endswith(".xml"):
        return False
    found = {measured.name_of(title, KNOWN) for title in next(cells(path), [])}
    return "s" in found and ("angle" in found or {"x", "y"} <= found)


def read_waveform(
    path: str | PathLike[str],
    *,
    units: str = "SI",
    pixel: Any = None,
    fps: Any = None,
    length: float | None = None,
    frequency: float | None = None,
    modes: int | None = None,
    harmonics: int | None = None,
) -> Waveform:
    r"""Read the beat of a filament that was traced frame by frame, and fit it.

    Parameters
    ----------
    path
        A table with time or frame, arc length s, and x and y or the tangent angle; units in the
        header. Frames may be uneven and points missing.
    units
        ``"SI"``, or ``"dimensionless"`` for bare numbers.
    pixel, fps
        Size of a pixel and frames per second, where the file does not say them.
    length
        Of the filament; the largest arc length by default.
    frequency
        Beats per time; found by default.
    modes, harmonics
        Number of modes along the filament and of harmonics in time; by default those that
        foretell frames left out best.

    Returns
    -------
    Waveform

    Raises
    ------
    SpecError
        If the file is none, lacks what is not given, or shows too little of a beat.

    Examples
    --------
    >>> import tempfile, numpy as np, microswim as ms
    >>> from pathlib import Path
    >>> lines = [f"{t},{s},{0.3 * s * np.cos(6.2832 * 4 * t - 2 * s)}"
    ...          for t in np.arange(0, 0.5, 0.02) for s in np.linspace(0, 2, 20)]
    >>> file = Path(tempfile.mkdtemp()) / "beat.csv"
    >>> _ = file.write_text("\n".join(["t,s,angle", *lines]))
    >>> beat = ms.read_waveform(file, units="dimensionless")
    >>> round(beat.frequency, 3), round(beat.tail(radius=0.02).wavelength, 2)
    (4.0, 3.14)
    """
    if not is_beat(path):
        raise SpecError(f"{path}: no beat; it must have time or frame, s, and x and y or angle")
    table = measured.read(path, KNOWN, ("s",))
    size = film.given("pixel", pixel, "length", units)
    rate = film.given("fps", fps, "frequency", units)
    time, _ = film.times(table, units, rate)
    s = film.lengths(table, "s", units, size)
    return fit(_beat(table, time, s, units, size), length, frequency, modes, harmonics)


def _beat(table: Table, time: np.ndarray, s: np.ndarray, units: str, size: float | None) -> Beat:
    if "angle" in table.numbers:
        angle = table.numbers["angle"] * measured.factor(table, "angle", "angle", units, "")
        whole = np.isfinite(time) & np.isfinite(s) & np.isfinite(angle)
        _check_arc(table, s[whole])
        return Beat(time[whole], s[whole], angle=angle[whole])
    x = np.stack([film.lengths(table, name, units, size) for name in ("x", "y")], axis=-1)
    x = _from_head(table, x, units, size)
    depth = table.numbers.get("z")
    if depth is not None and np.nanstd(depth) > 0:
        x = np.column_stack([x, film.lengths(table, "z", units, size)])
    whole = np.isfinite(time) & np.isfinite(s) & np.isfinite(x).all(axis=1)
    _check_arc(table, s[whole])
    return _based(table, Beat(time[whole], s[whole], position=x[whole]))


def _check_arc(table: Table, s: np.ndarray) -> None:
    if s.size == 0 or s.min() < 0 or not s.max() > 0:
        raise SpecError(f"{table.path}: s must be arc length from the head, zero or more")


def _from_head(table: Table, x: np.ndarray, units: str, size: float | None) -> np.ndarray:
    """Positions in the frame of the head, where its track is there."""
    there = [name for name in ("head_x", "head_y", "head_angle") if name in table.numbers]
    if not there:
        return x
    if len(there) < 3:
        raise SpecError(f"{table.path}: the head's track is head_x, head_y and head_angle")
    head = np.stack([film.lengths(table, name, units, size) for name in there[:2]], axis=-1)
    turn = table.numbers["head_angle"] * measured.factor(table, there[2], "angle", units, "")
    z: Any = ((x - head) @ np.array([1.0, 1.0j])) * np.exp(-1j * turn)
    return np.stack([z.real, z.imag], axis=-1)


def _based(table: Table, beat: Beat) -> Beat:
    """The beat with its base at the origin; one whose base moves is not in the head's frame."""
    assert beat.position is not None
    L = float(beat.s.max())
    near = beat.s <= beat.s.min() + 1e-9 * L
    base = beat.position[near]
    spread = float(np.linalg.norm(base - np.median(base, axis=0), axis=1).mean())
    start = np.median(base, axis=0) if beat.s.min() < STILL * L else 0.0 * base[0]
    if spread > STILL * L and len(base) > 1 and beat.s.min() < STILL * L:
        raise SpecError(
            f"{table.path}: the base moves by {spread / L:.2g} of the length: give the head's "
            "track, head_x, head_y, head_angle, or positions in the frame of the head"
        )
    tip = beat.position[beat.s > 0.5 * L] - start
    if tip.size and tip[:, 0].mean() < 0:
        raise SpecError(
            f"{table.path}: the filament runs towards negative x; x must point from the head "
            "along the tail"
        )
    return Beat(beat.time, beat.s, position=beat.position - start)


def tail_fields(table: dict[str, Any], units: str) -> dict[str, Any]:
    """Return what `WaveformTail` takes: the modes of the spec, or those of the file it names.

    Raises
    ------
    SpecError
        If neither or both are there, or as `read_waveform`.
    """
    setting = {name: table.pop(name) for name in SETTING if name in table}
    if ("file" in setting) == ("modes" in table):
        raise SpecError("tail.file, tail.modes: give one of the two")
    if "modes" in table:
        if "length" not in table:
            raise SpecError("tail.length: missing; add it")
        return table
    found = read_waveform(
        setting["file"], units=units, pixel=setting.get("pixel"), fps=setting.get("fps"),
        length=table.get("length"), frequency=table.get("frequency"),
        modes=_count("tail.mode_count", setting), harmonics=_count("tail.harmonics", setting),
    )  # fmt: skip
    known = {"modes": found.modes, "length": found.length, "frequency": found.frequency}
    known |= {} if found.modes_out is None else {"modes_out": found.modes_out}
    return {**known, **table}


def _count(name: str, setting: dict[str, Any]) -> int | None:
    value = setting.get(name.partition(".")[2])
    if value is None:
        return None
    if not float(value).is_integer() or not 1 <= value <= 24:
        raise SpecError(name, value, "a whole number from 1 to 24")
    return int(value)
