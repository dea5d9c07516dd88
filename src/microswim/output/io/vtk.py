"""VTK files for ParaView: the swimmer in time (XML PolyData, a .pvd collection) and its path.

Written here, since it takes a page. Binary, little-endian, base64.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from microswim.numerics.rigid_motion import rotation_matrix
from microswim.output.io.surface import surface
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
    """Text of a ``.vtp`` file.

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
        '<?xml version="1.0"?>',
        '<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt32">',
        f'<PolyData><Piece {piece} NumberOfPolys="{count["Polys"]}">',
        *("<Points>", _array("position", points), "</Points>"),
    ]
    for name, c in cells.items():
        if c is not None:
            offsets = np.arange(1, len(c) + 1, dtype="<i4") * np.shape(c)[1]
            indices = _array("connectivity", np.asarray(c, dtype="<i4").reshape(-1))
            out += [f"<{name}>", indices, _array("offsets", offsets), f"</{name}>"]
    for tag, data in (("PointData", point_data), ("CellData", cell_data)):
        if data:
            out += [f"<{tag}>", *(_array(k, v) for k, v in data.items()), f"</{tag}>"]
    return "\n".join([*out, "</Piece></PolyData>", "</VTKFile>", ""])


def _array(name: str, values: np.ndarray) -> str:
    values = np.ascontiguousarray(values)
    raw = values.tobytes()
    text = base64.b64encode(np.uint32(len(raw)).astype("<u4").tobytes() + raw).decode()
    columns = values.shape[1] if values.ndim > 1 else 1
    kind = _TYPES[values.dtype.str]
    head = f'type="{kind}" Name="{name}" NumberOfComponents="{columns}" format="binary"'
    return f"<DataArray {head}>{text}</DataArray>"


def write_swimmer(folder: Path, swimmer: Swimmer, run: xr.Dataset, frames: int = 120) -> Path:
    """Write ``swimmer.pvd``, its frames in ``vtk/`` and the path in ``path.vtp``.

    Parameters
    ----------
    folder
        Existing folder.
    swimmer
        Whose surface to draw.
    run
        Dataset with ``time``, ``position``, ``quaternion`` and ``motor_phase``.
    frames
        Most frames to write, evenly spaced in time.

    Returns
    -------
    Path
        The ``.pvd`` file to open in ParaView.
    """
    (folder / "vtk").mkdir()
    time, x, q = run.time.values, run.position.values, run.quaternion.values
    pick = np.unique(np.linspace(0, len(time) - 1, min(frames, len(time))).astype(int))
    entries = []
    for number, i in enumerate(pick):
        mesh = surface(swimmer, float(run.motor_phase[i]), fineness=0.75)
        mesh = mesh.moved(x[i], rotation_matrix(q[i]))
        name = f"vtk/swimmer_{number:04d}.vtp"
        points, part = mesh.points.astype("<f4"), mesh.part.astype("|u1")
        text = poly_data(points, polys=mesh.quads, cell_data={"part": part})
        (folder / name).write_text(text, encoding="ascii")
        entries.append(f'<DataSet timestep="{float(time[i])!r}" part="0" file="{name}"/>')
    path = poly_data(
        x.astype("<f8"), lines=np.arange(len(x))[None], point_data={"time": time.astype("<f8")}
    )
    (folder / "path.vtp").write_text(path, encoding="ascii")
    collection = '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian"><Collection>'
    text = ['<?xml version="1.0"?>', collection, *entries, "</Collection></VTKFile>", ""]
    (folder / "swimmer.pvd").write_text("\n".join(text), encoding="ascii")
    return folder / "swimmer.pvd"
