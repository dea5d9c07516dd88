"""The flow as VTK files, and off-screen pictures and animations of it (extra ``viz``).

Depends on stokes; PyVista is imported on call.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ngsolve as ngs
import numpy as np

from microswim.errors import MicroswimError

from .stokes import SWIMMER, Stokes


def write(flow: Stokes, solution: np.ndarray, path: str | Path) -> Path:
    """Write velocity and pressure on the moved mesh to ``path.vtu``, the skin to ``path.skin.vtu``.

    Lengths in body diameters, velocities in body diameters times the phase rate, pressure in
    viscosity times the phase rate.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    field = ngs.GridFunction(flow.space)
    field.vec.FV().NumPy()[:] = solution
    velocity, pressure = field.components
    fields = {"coefs": [velocity, pressure], "names": ["velocity", "pressure"], "legacy": False}
    ngs.VTKOutput(flow.mesh, filename=str(path), subdivision=1, **fields).Do()
    chosen = ngs.BitArray(flow.mesh.GetNE(ngs.BND))
    chosen.Clear()
    for element in flow.mesh.Boundaries(SWIMMER).Elements():
        chosen[element.nr] = True
    skin = ngs.VTKOutput(flow.mesh, filename=f"{path}.skin", subdivision=2, **fields)
    skin.Do(vb=ngs.BND, drawelems=chosen)
    return Path(f"{path}.vtu")


def flow_files(folder: str | Path) -> list[Path]:
    """The flow files in a folder, in the order of their names, without the skins."""
    return [f for f in sorted(Path(folder).glob("*.vtu")) if not f.stem.endswith(".skin")]


def _pyvista() -> Any:
    try:
        import pyvista
    except ImportError:
        raise MicroswimError("pictures need PyVista; pip install microswim[viz]") from None
    pyvista.OFF_SCREEN = True
    return pyvista


def _draw(plotter: Any, file: Path, reach: float, fastest: float) -> None:
    """Swimmer's surface over the speed in the plane r = 0, seen along r."""
    pv = _pyvista()
    plotter.set_background("#440154")  # the resting fluid's colour
    grid = pv.read(file)
    grid["speed"] = np.linalg.norm(grid["velocity"], axis=1)
    skin = pv.read(file.with_suffix(".skin.vtu"))
    plotter.add_mesh(skin.extract_surface(algorithm="dataset_surface"), color="#c9a227")
    plane = grid.slice(normal=(0, 0, 1), origin=(0, 0, 0))
    plane = plane.clip_box([-reach, reach + 1.5, -reach, reach, -1, 1], invert=False)
    bar = {"title": "speed / (body diameter x rate)", "color": "white"}
    look = {"scalars": "speed", "cmap": "viridis", "clim": [0.0, fastest]}
    plotter.add_mesh(plane, scalar_bar_args=bar, **look)
    middle = (0.75, 0.0, 0.0)
    plotter.camera_position = [(0.75, -1.6 * reach, 2.6 * reach), middle, (0.0, 1.0, 0.0)]


def render(file: str | Path, out: str | Path, *, reach: float = 1.5, fastest: float = 0.1) -> Path:
    """Picture (PNG) of one VTK file: the swimmer and the speed around it.

    Parameters
    ----------
    file
        A ``.vtu`` of `swim` or `write`.
    out
        Name of the picture.
    reach
        Half width of the view in body diameters.
    fastest
        Upper end of the colour scale.
    """
    plotter = _pyvista().Plotter(off_screen=True, window_size=(1200, 800))
    _draw(plotter, Path(file), reach, fastest)
    plotter.screenshot(str(out))
    plotter.close()
    return Path(out)


def animate(
    folder: str | Path, out: str | Path, *, reach: float = 1.5, fastest: float = 0.1, fps: int = 8
) -> Path:
    """Animation (GIF) of all VTK files in a folder, in the order of their names."""
    files = flow_files(folder)
    if not files:
        raise MicroswimError(f"folder = {folder}: no .vtu in it; run swim(..., vtk=folder) first")
    from PIL import Image

    frames = []
    for file in files:
        plotter = _pyvista().Plotter(off_screen=True, window_size=(900, 600))
        _draw(plotter, file, reach, fastest)
        frames.append(Image.fromarray(plotter.screenshot(return_img=True)))
        plotter.close()
    frames[0].save(out, save_all=True, append_images=frames[1:], duration=1000 // fps, loop=0)
    return Path(out)
