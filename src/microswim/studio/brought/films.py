"""Tables of filmed cells that are dropped: tracks are described, a traced beat becomes a tail."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.numerics.plain import plain
from microswim.spec.readers.beat import is_beat, read_waveform
from microswim.studies.identification.films.tracks import Tracks, read_tracks
from microswim.studies.identification.without_model import describe_track
from microswim.studio import budget
from microswim.studio.spec_tables import canonical, swimmer_of
from microswim.swimmer.geometry.tails.waveforms.waveform import Waveform

FORMATS = (".csv", ".tsv", ".txt", ".xml")
MOST_TRACKS = 200
MOST_POINTS = 400  #: of a track, that are drawn
HEAD = (0.05, 0.03, 0.01)  #: semi-axes of a sperm's head over the length of its tail
SLENDER = 200.0  #: length over radius of a traced tail, whose radius no table holds
NUMBERS = ("speed", "curvilinear_velocity", "straight_line_velocity", "linearity", "turning_rate")
WATER = {"viscosity": "1 mPa s", "density": "1000 kg/m^3"}


def read(name: str, content: bytes, asked: dict[str, Any]) -> dict[str, Any]:
    """Return what a table holds: ``kind`` is ``"tracks"`` or ``"beat"``.

    Parameters
    ----------
    name
        The file's own name, for its ending and for sentences.
    content
        The file.
    asked
        ``tables`` of the design on show, ``pixel`` (``"0.11um"``) and ``fps`` if they are known.

    Raises
    ------
    SpecError
        If it is no such table, or does not say how long a pixel or a frame is.
    """
    ending = Path(name).suffix.lower()
    if ending not in FORMATS:
        raise SpecError("file", name[:80], "a table of tracks or of a beat: CSV or TrackMate's XML")
    how: dict[str, Any] = {k: str(asked[k]) for k in ("pixel", "fps") if asked.get(k)}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"table{ending}"
        path.write_bytes(content)
        try:
            if is_beat(path):
                return _beat(read_waveform(path, **how), asked.get("tables"))
            return _tracks(read_tracks(path, **how))
        except SpecError as error:
            raise SpecError(str(error).replace(str(path), name).replace("--", "")) from None


def _tracks(tracks: Tracks) -> dict[str, Any]:
    rows = []
    for name, track in list(tracks.items())[:MOST_TRACKS]:
        budget.check()
        found = describe_track(track, name)
        every = -(-track.time.size // MOST_POINTS)
        drawn = np.round(track.position[::every, :2] * 1e9) / 1e9
        rows.append(
            {
                "name": name,
                "x": drawn[:, 0].tolist(),
                "y": drawn[:, 1].tolist(),
                "numbers": {k: _estimate(found.numbers[k]) for k in NUMBERS},
                "duration": found.duration,
            }
        )
    said = [*tracks.remarks]
    if tracks.left_out:
        said.append(f"{len(tracks.left_out)} tracks left out, most of them too short")
    if len(tracks) > MOST_TRACKS:
        said.append(f"the first {MOST_TRACKS} of {len(tracks)} tracks")
    return plain({"kind": "tracks", "cells": rows, "notes": said})


def _short(modes: Any) -> list[list[float]]:
    return [[float(f"{v:.5g}") for v in row] for row in modes]


def _estimate(found: Any) -> list[float] | None:
    return None if found is None else [found.value, found.low, found.high]


def _beat(found: Waveform, tables: Any) -> dict[str, Any]:
    """The design with the traced tail, and a head in proportion where its own is not."""
    length = float(found.length)
    swimmer, own = swimmer_of(tables), {}
    if swimmer.units == "SI":
        own = {k: v for k, v in canonical(swimmer).items() if k in ("fluid", "body")}
    said = [f"{found.frequency:.4g} Hz, misfit {1e6 * found.misfit:.2g} µm"]
    if found.beat.angle is not None:
        said = [f"{found.frequency:.4g} Hz, misfit {found.misfit:.2g} rad"]
    size = float(swimmer.body.semi_axes3[0]) if own else 0.0
    if not 0.01 * length < size < 0.2 * length:
        axes = [f"{float(f'{1e6 * share * length:.3g}')} um" for share in HEAD]
        own["body"] = {"shape": "ellipsoid", "semi_axes": axes}
        said.append("the head is a guess: a table of a tail holds none")
    tail = {
        "kind": "waveform",
        "modes": _short(found.modes),
        **({} if found.modes_out is None else {"modes_out": _short(found.modes_out)}),
        "length": f"{1e6 * length!r} um",
        "frequency": f"{float(found.frequency)!r} Hz",
        "radius": f"{float(f'{1e6 * length / SLENDER:.3g}')} um",
    }
    said.append("so is the filament's radius")
    made = {"fluid": own.get("fluid", WATER), "body": own["body"], "tail": tail}
    if found.modes_out is None:
        made["motion"] = {"free": ["us", "uq", "or"]}
    try:
        full = canonical(swimmer_of(made))
    except MicroswimError as error:
        raise SpecError(f"the beat was read, but it makes no swimmer here: {error}") from None
    return {"kind": "beat", "tables": full, "notes": said}
