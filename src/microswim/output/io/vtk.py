"""VTK files for ParaView, the one writer: surfaces and lines, fields on a box, series in time.

Written here, since it takes a page: XML, binary, little-endian, base64.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from microswim.numerics.rigid_motion import rotation_matrix
from microswim.output.io.surface import Surface, bent, surface
from microswim.path.by_torque import at_phases
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

_TYPES = {"<f4": "Float32", "<f8": "Float64", "<i4": "Int32", "|u1": "UInt8"}


def poly_data(
    points: np.ndarray,
    *,
    polys: np.ndarray | None = None,
    lines: np.ndarray | None = None,
    point_data: dict[str, np.ndarray] | None = None,
    cell_data: dict[str, np.ndarray] | None = None,
) -> str:
    """Return the text of a ``.vtp`` file.

    Parameters
    ----------
    points
        Shape (n, 3).
    polys, lines
        Indices of the points of each face (m, corners), of each polyline (m, points).
    point_data, cell_data
        Named arrays of one row per point, per cell.

    Returns
    -------
    str
        XML.

    Examples
    --------
    >>> import numpy as np
    >>> from microswim.output.io.vtk import poly_data
    >>> poly_data(np.eye(3), polys=np.array([[0, 1, 2]])).splitlines()[0]
    '<?xml version="1.0"?>'
    """
    cells = {"Lines": lines, "Polys": polys}
    count = {name: 0 if c is None else len(c) for name, c in cells.items()}
    piece = f'NumberOfPoints="{len(points)}" NumberOfLines="{count["Lines"]}"'
    out = [
        f'<PolyData><Piece {piece} NumberOfPolys="{count["Polys"]}">',
        *("<Points>", _array("position", points), "</Points>"),
    ]
    for name, c in cells.items():
        if c is not None:
            offsets = np.arange(1, len(c) + 1, dtype="<i4") * np.shape(c)[1]
            indices = _array("connectivity", np.asarray(c, dtype="<i4").reshape(-1))
            out += [f"<{name}>", indices, _array("offsets", offsets), f"</{name}>"]
    out += _data("PointData", point_data) + _data("CellData", cell_data)
    return _file("PolyData", [*out, "</Piece></PolyData>"])


def image_data(
    low: np.ndarray, step: np.ndarray, counts: tuple[int, int, int], data: dict[str, np.ndarray]
) -> str:
    """Return the text of a ``.vti`` file: fields on a box of points.

    Parameters
    ----------
    low, step
        First corner, and distance of the points along each axis.
    counts
        Points along each axis.
    data
        Named arrays of one row per point, the first axis running fastest.

    Returns
    -------
    str
        XML.

    Examples
    --------
    >>> import numpy as np
    >>> from microswim.output.io.vtk import image_data
    >>> "ImageData" in image_data(np.zeros(3), np.ones(3), (2, 1, 1), {"u": np.zeros((2, 3))})
    True
    """
    extent = " ".join(f"0 {n - 1}" for n in counts)
    origin, spacing = (" ".join(f"{float(x)!r}" for x in v) for v in (low, step))
    head = f'<ImageData WholeExtent="{extent}" Origin="{origin}" Spacing="{spacing}">'
    inside = [head, f'<Piece Extent="{extent}">', *_data("PointData", data)]
    return _file("ImageData", [*inside, "</Piece></ImageData>"])


def collection(frames: Iterable[tuple[float, str]]) -> str:
    """Return the text of a ``.pvd`` file: the files of a series with their times.

    Examples
    --------
    >>> from microswim.output.io.vtk import collection
    >>> 'timestep="0.5"' in collection([(0.5, "flow/a.vtu")])
    True
    """
    entries = [f'<DataSet timestep="{t!r}" part="0" file="{name}"/>' for t, name in frames]
    return _file("Collection", ["<Collection>", *entries, "</Collection>"])


def _file(kind: str, inside: list[str]) -> str:
    head = f'<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian" header_type="UInt32">'
    return "\n".join(['<?xml version="1.0"?>', head, *inside, "</VTKFile>", ""])


def _data(tag: str, data: dict[str, np.ndarray] | None) -> list[str]:
    return [f"<{tag}>", *(_array(k, v) for k, v in data.items()), f"</{tag}>"] if data else []


def _array(name: str, values: np.ndarray) -> str:
    values = np.ascontiguousarray(values)
    raw = values.tobytes()
    text = base64.b64encode(np.uint32(len(raw)).astype("<u4").tobytes() + raw).decode()
    columns = values.shape[1] if values.ndim > 1 else 1
    kind = _TYPES[values.dtype.str]
    head = f'type="{kind}" Name="{name}" NumberOfComponents="{columns}" format="binary"'
    return f"<DataArray {head}>{text}</DataArray>"


def surface_at(swimmer: Swimmer, run: xr.Dataset, i: int, fineness: float = 0.75) -> Surface:
    """Return the surface in the lab at a sample of a path: each tail at its own phase and axis, a
    filament as it is bent.
    """
    x, turn = run.position.values[i], rotation_matrix(run.quaternion.values[i])
    if "filament" in run:
        return bent(swimmer, run.filament.values[i], x, turn, fineness=fineness)
    phase = run.motor_phase.values[i]
    if np.ndim(phase):
        axes = run.tail_axis.values[i] if "tail_axis" in run else None
        return surface(at_phases(swimmer, phase, axes), 0.0, fineness=fineness).moved(x, turn)
    return surface(swimmer, float(phase), fineness=fineness).moved(x, turn)


def write_swimmer(folder: Path, swimmer: Swimmer, run: xr.Dataset, frames: int = 120) -> Path:
    """Write ``swimmer.pvd``, its frames in ``vtk/`` and the path in ``path.vtp``.

    Parameters
    ----------
    folder
        Existing folder.
    swimmer
        Whose surface to draw.
    run
        Dataset with ``time``, ``position``, ``quaternion`` and ``motor_phase``, or ``filament``.
    frames
        Most frames to write, evenly spaced in time.

    Returns
    -------
    Path
        The ``.pvd`` file to open in ParaView.
    """
    (folder / "vtk").mkdir()
    time, x = run.time.values, run.position.values
    pick = np.unique(np.linspace(0, len(time) - 1, min(frames, len(time))).astype(int))
    series: list[tuple[float, str]] = []
    for number, i in enumerate(pick):
        mesh = surface_at(swimmer, run, int(i))
        name = f"vtk/swimmer_{number:04d}.vtp"
        points, part = mesh.points.astype("<f4"), mesh.part.astype("|u1")
        text = poly_data(points, polys=mesh.quads, cell_data={"part": part})
        (folder / name).write_text(text, encoding="ascii")
        series.append((float(time[i]), name))
    path = poly_data(
        x.astype("<f8"), lines=np.arange(len(x))[None], point_data={"time": time.astype("<f8")}
    )
    (folder / "path.vtp").write_text(path, encoding="ascii")
    (folder / "swimmer.pvd").write_text(collection(series), encoding="ascii")
    return folder / "swimmer.pvd"
