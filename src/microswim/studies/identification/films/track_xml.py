"""XML of TrackMate, its whole model (spots and the edges between them) or the tracks; of Icy."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np

from microswim.errors import SpecError
from microswim.spec.readers.measured import Table

COLUMNS = ("time", "frame", "x", "y", "z")


def table_of_xml(path: str, text: str) -> Table:
    """Return the positions of an XML of TrackMate or Icy as a table.

    Parameters
    ----------
    path
        Of the file, for errors.
    text
        What it holds.

    Raises
    ------
    SpecError
        If it is no XML, defines entities, or holds no tracks.
    """
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise SpecError(f"{path}: an XML that defines entities is not read")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise SpecError(f"{path}: not an XML: {' '.join(str(error).split())}") from None
    try:
        if root.tag == "Tracks":
            return _of_tracks(path, root)
        if root.find("trackgroup") is not None:
            return _of_groups(path, root)
        model = root if root.tag == "Model" else root.find("Model")
        if model is not None:
            return _of_model(path, model)
    except (TypeError, ValueError, KeyError) as error:
        why = " ".join(str(error).split())
        raise SpecError(f"{path}: a spot without its numbers ({why})") from None
    raise SpecError(
        f"{path}: no XML of TrackMate or Icy; it has no <Model>, <Tracks> or <trackgroup>"
    )


def _of_tracks(path: str, root: ElementTree.Element) -> Table:
    """``<Tracks><particle><detection t= x= y= z=>``: "Export tracks to XML file"."""
    rows, labels = [], []
    interval = float(root.get("frameInterval", "nan"))
    for number, particle in enumerate(root.iter("particle")):
        for spot in particle.iter("detection"):
            frame = float(spot.attrib["t"])
            z = float(spot.get("z", "0"))
            rows.append(
                (frame * interval, frame, float(spot.attrib["x"]), float(spot.attrib["y"]), z)
            )
            labels.append(str(number))
    return _table(path, rows, labels, root.get("spaceUnits"), root.get("timeUnits"))


def _of_groups(path: str, root: ElementTree.Element) -> Table:
    """``<trackgroup><track><detection t= x= y= z=>`` of Icy: frames and pixels."""
    rows, labels = [], []
    for number, track in enumerate(root.iter("track")):
        for spot in track.iter("detection"):
            x, y, z = (float(spot.get(axis, "0" if axis == "z" else "")) for axis in "xyz")
            rows.append((np.nan, float(spot.attrib["t"]), x, y, z))
            labels.append(str(number))
    return _table(path, rows, labels, "px", None)


def _of_model(path: str, model: ElementTree.Element) -> Table:
    """``<Model>`` with ``<AllSpots>`` and ``<AllTracks>``: TrackMate's own file."""
    names = ("POSITION_T", "FRAME", "POSITION_X", "POSITION_Y", "POSITION_Z")
    spots = {
        spot.attrib["ID"]: tuple(float(spot.attrib[name]) for name in names)
        for spot in model.iter("Spot")
    }
    rows, labels = [], []
    for track in model.iter("Track"):
        ends = (edge.attrib[f"SPOT_{end}_ID"] for edge in track.iter("Edge") for end in _ENDS)
        for spot in dict.fromkeys(ends):
            rows.append(spots[spot])
            labels.append(track.attrib["TRACK_ID"])
    return _table(path, rows, labels, model.get("spatialunits"), model.get("timeunits"))


_ENDS = ("SOURCE", "TARGET")


def _table(path: str, rows: list, labels: list[str], length: str | None, time: str | None) -> Table:
    if not rows:
        raise SpecError(f"{path}: holds no tracks; let the spots be linked first")
    numbers: dict[str, np.ndarray] = dict(zip(COLUMNS, np.array(rows, dtype=float).T))
    units = dict.fromkeys("xyz", length) | {"time": time, "frame": None}
    if not np.isfinite(numbers["time"]).all():
        del numbers["time"], units["time"]
    titles = {name: name for name in numbers}
    return Table(path, titles, units, numbers, labels, ())
