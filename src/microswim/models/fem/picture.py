"""The flow as VTK files, and off-screen pictures and animations of it (extra ``viz``)."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import ngsolve as ngs
import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.gait import doors, palette
from microswim.models.fem.stokes import SWIMMER, Stokes
from microswim.numerics import files as whole


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
    """Return the flow files in a folder, in the order of their names, without the skins."""
    return [f for f in sorted(Path(folder).glob("*.vtu")) if not f.stem.endswith(".skin")]


def step_of(file: Path) -> int:
    """Return the number of the time step in the name of a flow file, ``flow-00012.vtu``."""
    return int(file.stem.rpartition("-")[2])


def write_collection(folder: str | Path, step: float) -> list[Path]:
    """Write ``flow.pvd`` and ``skin.pvd`` beside a folder of flow files, for ParaView.

    Parameters
    ----------
    folder
        Where the flow files are.
    step
        Time step between two numbers of their names.
    """
    folder, written = Path(folder), []
    for name, ending in (("flow", ".vtu"), ("skin", ".skin.vtu")):
        frames = [
            (step * step_of(f), f"{folder.name}/{f.with_suffix(ending).name}")
            for f in flow_files(folder)
        ]
        written.append(folder.parent / f"{name}.pvd")
        whole.write(written[-1], doors.go(doors.COLLECTION, frames))
    return written


def require_viewer() -> None:
    """Refuse to start what will want pictures where PyVista is not installed.

    Raises
    ------
    SpecError
        One sentence that says what to install.
    """
    if find_spec("pyvista") is None:
        raise SpecError('pictures of the flow need PyVista: pip install "microswim[viz]"')


def _pyvista() -> Any:
    require_viewer()
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)  # it warns where there is no screen
    pyvista.OFF_SCREEN = True
    return pyvista


@dataclass(frozen=True)
class View:
    """Middle of the view, its half width along s, and the upper end of the colour scale."""

    middle: tuple[float, float, float]
    reach: float
    fastest: float

    @classmethod
    def of(cls, file: Path, reach: float | None, fastest: float | None) -> View:
        """Return the speed around the swimmer of a flow file, coloured up to its fastest point."""
        skin = _pyvista().read(file.with_suffix(".skin.vtu"))
        low, high = np.array(skin.bounds).reshape(3, 2).T
        if fastest is None:
            fastest = float(np.linalg.norm(skin["velocity"], axis=1).max())
        half = 0.5 * (high[0] - low[0]) + 0.5 if reach is None else reach
        return cls(tuple(0.5 * (low + high)), float(half), fastest)


def _draw(plotter: Any, file: Path, view: View) -> None:
    """Swimmer's surface over the speed in the plane r = 0, seen along r."""
    pv = _pyvista()
    plotter.set_background(palette.EDGE)  # the resting fluid's colour
    grid = pv.read(file).clean(tolerance=1e-7)  # the elements come apart, each with its points
    grid["speed"] = np.linalg.norm(grid["velocity"], axis=1)
    skin = pv.read(file.with_suffix(".skin.vtu")).extract_surface(algorithm="dataset_surface")
    plotter.add_mesh(skin.clean(), color=palette.BODY, smooth_shading=True)
    (s, q, _), half = view.middle, view.reach
    bar = {"title": "speed / (body diameter x rate)\n", "color": "white", "n_labels": 3}
    look = {"scalars": "speed", "cmap": "viridis", "clim": [0.0, view.fastest]}
    for r in (0.0, -0.02):  # the second shows through where flat pieces of curved elements gape
        plane = grid.slice(normal=(0, 0, 1), origin=(0, 0, r))
        plane = plane.clip_box([s - half, s + half, q - half, q + half, -1, 1], invert=False)
        plotter.add_mesh(plane, scalar_bar_args={**bar, "fmt": "%.2g"}, **look)
    eye = (s, q - 1.6 * half, 2.6 * half)
    plotter.camera_position = [eye, (s, q, 0.0), (0.0, 1.0, 0.0)]


def render(
    file: str | Path, out: str | Path, *, reach: float | None = None, fastest: float | None = None
) -> Path:
    """Return the picture (PNG) of one VTK file: the swimmer and the speed around it.

    Parameters
    ----------
    file
        A ``.vtu`` of `swim` or `write`.
    out
        Name of the picture.
    reach
        Half width of the view in body diameters; by default the swimmer and a half on each side.
    fastest
        Upper end of the colour scale; by default the swimmer's fastest point.
    """
    view = View.of(Path(file), reach, fastest)
    plotter = _pyvista().Plotter(off_screen=True, window_size=(1200, 800))
    _draw(plotter, Path(file), view)
    plotter.screenshot(str(out))
    plotter.close()
    return Path(out)


def animate(
    folder: str | Path,
    out: str | Path,
    *,
    reach: float | None = None,
    fastest: float | None = None,
    fps: int = 8,
) -> Path:
    """Return the animation (GIF) of all VTK files in a folder, in the order of their names."""
    files = flow_files(folder)
    if not files:
        raise MicroswimError(f"folder = {folder}: no .vtu in it; run swim(..., vtk=folder) first")
    from PIL import Image

    view, frames = View.of(files[-1], reach, fastest), []
    for file in files:
        plotter = _pyvista().Plotter(off_screen=True, window_size=(900, 600))
        _draw(plotter, file, view)
        frames.append(Image.fromarray(plotter.screenshot(return_img=True)))
        plotter.close()
    frames[0].save(out, save_all=True, append_images=frames[1:], duration=1000 // fps, loop=0)
    return Path(out)
