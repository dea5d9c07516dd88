"""What a camera gives, in units of the swimmer: pixels and frames, and how large they are."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.spec.readers import measured
from microswim.spec.readers.measured import FRAME, PIXEL, Table
from microswim.spec.units import DIMENSIONS, to_si

#: What columns may be called, in lower case; in the languages that their programs speak.
TIME = ("time", "t", "position_t", "timestamp", "zeit", "temps", "tiempo", "tempo", "tijd", "tid",
        "czas", "čas", "время", "时间", "時間")  # fmt: skip
FRAMES = ("frame", "frames", "frame_number", "slice", "slice n°", "frameid",
          "imagenumber", "bild",
          "bildnummer", "image", "imagen", "fotograma", "cuadro", "fotogramma",
          "quadro")  # fmt: skip
TRACKS = ("track_id", "track", "track n°", "tid", "particle_id", "particle",
          "trackobjects_label", "trajectory_id", "trajectory", "cell_id", "cell",
          "track_number", "track_no", "spur", "piste", "traza", "traccia", "teilchen",
          "partikel", "zelle", "trajectoire", "particule", "cellule", "trayectoria",
          "partícula", "célula", "traiettoria", "particella", "cellula", "id")  # fmt: skip
#: Columns by number, as ilastik and scikit-image have them: which is which.
_NUMBERED = {"x": ("object_center_0", "center_of_the_object_0", "centroid-1"),
             "y": ("object_center_1", "center_of_the_object_1", "centroid-0"), "z": ()}  # fmt: skip
_PLACES = ("position", "location_center", "pos", "coordinate", "coord", "centroid", "center",
           "centre", "koordinate", "posición", "coordenada", "coordonnée", "posizione",
           "coordinata")  # fmt: skip
NO_LENGTH = "give --pixel, such as --pixel 0.11um, or a unit in the header, {title} (um)"
NO_TIME = "give a unit in the header, {title} (s), or --fps if it counts frames"


def axis(name: str) -> tuple[str, ...]:
    """Return what the column of a coordinate may be called: ``x``, ``x_position``, ``pos x``."""
    both = [(f"{word}{by}{name}", f"{name}{by}{word}") for word in _PLACES for by in "_ -"]
    return (name, *(title for pair in both for title in pair), *_NUMBERED[name])


def given(option: str, value: Any, dimension: str, units: str) -> float | None:
    """Return the number that an option means, quantities as texts; None where there is none.

    Raises
    ------
    SpecError
        If it is no positive quantity, or has no unit where the swimmer has.
    """
    if value is None:
        return None
    if isinstance(value, str):
        try:
            value = float(value)
        except ValueError:
            if units != "SI":
                raise SpecError(option, value, "a bare number", "the swimmer has none") from None
            try:
                value = to_si(value, DIMENSIONS[dimension].si)
            except ValueError as error:
                raise SpecError(f"{option} = {value!r}: {error}") from None
        else:
            if units == "SI" and dimension == "length":
                raise SpecError(option, f"{value:g}", 'a length with its unit, as in "0.11um"')
    checks.positive(option, value)
    return float(value)


def lengths(table: Table, name: str, units: str, pixel: float | None) -> np.ndarray:
    """Return a column of lengths in units of the swimmer.

    Raises
    ------
    SpecError
        If it is in pixels and nobody says how large they are, or the other way round.
    """
    unit, title = measured.plain(table.units[name]), table.titles[name]
    if pixel is not None and unit not in (None, PIXEL):
        raise SpecError(f"{table.path}: {title} is in {unit}, no pixels; leave --pixel out")
    if unit == PIXEL and pixel is None:
        raise SpecError(f"{table.path}: {title} is in pixels; give --pixel, such as --pixel 0.11um")
    mend = NO_LENGTH.format(title=title)
    scale = pixel or measured.factor(table, name, "length", units, mend)
    return scale * table.numbers[name]


def times(table: Table, units: str, rate: float | None) -> tuple[np.ndarray, tuple[str, ...]]:
    """Return times in units of the swimmer, and what is to be said of them.

    Raises
    ------
    SpecError
        If there are none, or frames without their rate.
    """
    counts = table.numbers.get("frame")
    time = table.numbers.get("time")
    if time is None and counts is None:
        raise SpecError(f"{table.path}: no column time; it must have time or frame")
    unit = None if time is None else measured.plain(table.units["time"])
    if time is not None and (unit == FRAME or (unit is None and rate and _whole(time))):
        counts, time = (time if counts is None else counts), None
    if rate is not None and counts is not None:
        said = (
            () if time is None else ("times are frames by --fps; those of the file are not used",)
        )
        return counts / rate, said
    if rate is not None:
        raise SpecError(
            f"{table.path}: {table.titles['time']} counts no frames; leave --fps out and give "
            "its unit in the header if it has none"
        )
    if time is None:
        title = table.titles.get("frame", table.titles.get("time"))
        raise SpecError(f"{table.path}: {title} counts frames; give --fps, such as --fps 25")
    mend = NO_TIME.format(title=table.titles["time"])
    return measured.factor(table, "time", "time", units, mend) * time, ()


def _whole(values: np.ndarray) -> bool:
    kept = values[np.isfinite(values)]
    return bool((kept == np.round(kept)).all())
