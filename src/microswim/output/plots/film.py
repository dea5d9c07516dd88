"""Film of a path: the swimmer, true to scale, goes its way."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from microswim import checks
from microswim.errors import SpecError
from microswim.gait.readable import prefixed, quantity
from microswim.numerics.files import fresh
from microswim.output.io.surface import BODY as OF_BODY
from microswim.output.io.surface import Surface
from microswim.output.io.vtk import surface_at
from microswim.output.plots.style import (
    BLACK,
    BLUE,
    BODY,
    PALE_BLUE,
    TAIL,
    WIDE,
    blank,
    few_ticks,
    look,
    readable,
)
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DOTS = 100  #: per inch
FINENESS = 0.5  #: of the surface that is drawn
PER_SECOND, COLOURS = 20, 64  #: frames shown, of so many colours
ROOM = 0.6  #: half width of what is seen close by, of twice the swimmer's reach


@checks.given(
    swimmer=checks.swimmer,
    found=checks.dataset,
    file=checks.place,
    frames=checks.at_least(2),
    progress=checks.function,
)
def film(
    swimmer: Swimmer,
    found: xr.Dataset,
    file: str | PathLike[str],
    *,
    frames: int = 120,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Write a film (GIF) of a path: all of it from above, and close by from the side.

    In a tube close by from the side, and along the tube.

    Parameters
    ----------
    swimmer
        Whose path it is.
    found
        What `microswim.path` gives of one path.
    file
        To write, ending in ``.gif``; what stands there is replaced.
    frames
        At most, evenly spaced in time; six seconds for 120.
    progress
        Called with the frames done and of all.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    SpecError
        If there are several paths, or the file is no GIF.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> ms.plots.film(swimmer, ms.path(swimmer, time=1.0), "path.gif", frames=2).name
    'path.gif'
    """
    if "path" in found.dims:
        raise SpecError("found", "many paths", "one path", "found.isel(path=0) is the first")
    if Path(file).suffix.lower() != ".gif":
        raise SpecError("file", file, "a name that ends in .gif")
    run = found.rename(phase="motor_phase") if "phase" in found else found
    drawn = swimmer if "filament" in run else swimmer.settled
    count = len(run.time)
    pick = np.unique(np.linspace(0, count - 1, min(int(frames), count)).astype(int))
    with look():
        scene = _Scene(run, surface_at(drawn, run, 0, FINENESS))
        shots = []
        for i in pick.tolist():
            shots.append(scene.shot(i, surface_at(drawn, run, i, FINENESS)))
            if progress is not None:
                progress(len(shots), len(pick))
    with fresh(file) as part:
        _save(part, shots)
    return Path(file)


def _save(file: Path, shots: list[Any]) -> None:
    """Write pictures as a film without end, all in the colours of one in the middle."""
    from PIL import Image

    frames = [Image.fromarray(shot) for shot in shots]
    common = frames[len(frames) // 2].quantize(COLOURS)
    frames = [frame.quantize(palette=common, dither=Image.Dither.NONE) for frame in frames]
    first, *rest = frames
    first.save(
        file, format="GIF", save_all=True, append_images=rest, duration=1000 // PER_SECOND, loop=0
    )


class _Scene:
    """Two views of a path: drawn once, and over it what moves with time."""

    def __init__(self, run: xr.Dataset, first: Surface) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        self.x, self.times = run.position.values, run.time.values
        self.bounded = "gap" in run
        in_tube = run.attrs.get("boundary") == "tube"
        self.radius = float(run.attrs["tube_radius"]) if in_tube else 0.0
        self.units = run.position.attrs["units"], run.time.attrs["units"]
        self.reach = 2.0 * float(np.linalg.norm(first.points - self.x[0], axis=1).max())
        self.size = max(self.reach, float(np.ptp(self.x, axis=0).max()))
        self.factor, _ = prefixed(self.size, self.units[0])
        figure = blank(WIDE, 3.6)
        figure.set_dpi(DOTS)
        left, right = figure.subplots(1, 2)
        self.clock = figure.suptitle("", x=0.02, ha="left", fontsize=8)
        if self.radius:
            self.near, self.whole = _Near(left, self), _Whole(right, (1, 2), self)
        else:
            self.whole, self.near = _Whole(left, (0, 1), self), _Near(right, self)
        self.moving = [*self.whole.moving, *self.near.moving]
        for artist in (self.clock, *self.moving):
            artist.set_animated(True)
        self.canvas = FigureCanvasAgg(figure)
        self.canvas.draw()
        self.still = self.canvas.copy_from_bbox(figure.bbox)

    def shot(self, i: int, mesh: Surface) -> Any:
        """Return the picture (height, width, 3) of a sample, where the surface is `mesh`."""
        self.whole.show(i, mesh)
        self.near.show(i, mesh)
        self.clock.set_text(f"t = {quantity(float(self.times[i]), self.units[1])}")
        self.canvas.restore_region(self.still)
        for artist in self.moving:
            artist.axes.draw_artist(artist)
        self.clock.draw(self.canvas.get_renderer())
        return np.array(self.canvas.buffer_rgba())[..., :3]


class _View:
    """The swimmer in a plane of the lab."""

    def __init__(self, axes: Axes, plane: tuple[int, int], scene: _Scene) -> None:
        from matplotlib.collections import PolyCollection

        self.axes, self.plane, self.scene = axes, list(plane), scene
        self.skin = PolyCollection([], linewidths=0.4, zorder=3)
        axes.add_collection(self.skin, autolim=False)
        axes.set(aspect="equal")
        self.moving: list[Any] = [self.skin]

    def draw(self, mesh: Surface, middle: Any) -> None:
        """Draw the surface about a place (2,), what is further away first."""
        i, j = self.plane
        away = mesh.points[mesh.quads].mean(axis=1)[:, 3 - i - j]
        order = np.argsort(-away if (i, j) == (0, 2) else away)
        colours = np.where(mesh.part[order] == OF_BODY, BODY, TAIL)
        flat = self.scene.factor * (mesh.points[:, self.plane] - middle)
        self.skin.set_verts(list(flat[mesh.quads[order]]))
        self.skin.set(facecolors=colours, edgecolors=colours)


class _Whole(_View):
    """All of the path from above, or along its tube."""

    def __init__(self, axes: Axes, plane: tuple[int, int], scene: _Scene) -> None:
        super().__init__(axes, plane, scene)
        self.path = scene.factor * scene.x[:, self.plane]
        axes.plot(*self.path.T, color=PALE_BLUE, linewidth=1.0, zorder=1)
        (self.line,) = axes.plot([], [], color=BLUE, linewidth=1.0, zorder=2)
        self.moving.insert(0, self.line)
        if scene.radius:
            turn, wide = np.linspace(0.0, 2.0 * np.pi, 181), scene.factor * scene.radius
            axes.plot(wide * np.cos(turn), wide * np.sin(turn), color=BLACK, linewidth=1.5)
            middle, half = np.zeros(2), 1.1 * wide
        else:
            low, high = self.path.min(axis=0), self.path.max(axis=0)
            middle = 0.5 * (low + high)
            half = 0.5 * float((high - low).max()) + 0.55 * scene.factor * scene.reach
        axes.set(xlim=(middle[0] - half, middle[0] + half))
        axes.set(ylim=(middle[1] - half, middle[1] + half))
        few_ticks(axes, 4)
        names = [readable(scene.size, "xyz"[k], scene.units[0])[1] for k in self.plane]
        names = [name.replace(" (length)", "") for name in names]
        title = "along the tube" if scene.radius else "from above"
        axes.set(xlabel=names[0], ylabel=names[1], title=title)

    def show(self, i: int, mesh: Surface) -> None:
        """Move to a sample."""
        self.draw(mesh, np.zeros(2))
        self.line.set_data(*self.path[: i + 1].T)


class _Near(_View):
    """The swimmer from the side, in the middle of what is seen; the boundary moves."""

    def __init__(self, axes: Axes, scene: _Scene) -> None:
        super().__init__(axes, (0, 2), scene)
        half = scene.factor * ROOM * scene.reach
        axes.set(xlim=(-half, half), ylim=(-half, half), xticks=[], yticks=[])
        axes.set(title="close by, from the side")
        for side in ("left", "bottom"):
            axes.spines[side].set_visible(False)
        sides = (-scene.radius, scene.radius) if scene.radius else (0.0,)
        heights = sides if scene.bounded else ()
        self.walls = [(at, axes.axhline(0.0, color=BLACK, linewidth=1.5)) for at in heights]
        self.moving += [line for _, line in self.walls]
        bar = 10.0 ** np.floor(np.log10(0.3 * scene.reach))
        bar *= max(k for k in (1.0, 2.0, 5.0) if k * bar <= 0.3 * scene.reach)
        wide = scene.factor * bar
        axes.plot([-half, -half + wide], [-half, -half], color=BLACK, linewidth=2.0, clip_on=False)
        name = f"{wide:.3g} {prefixed(scene.size, scene.units[0])[1]}".replace(" length", "")
        axes.text(-half + 0.5 * wide, -0.97 * half, name, ha="center", va="bottom", fontsize=7)

    def show(self, i: int, mesh: Surface) -> None:
        """Move to a sample."""
        middle = self.scene.x[i, self.plane]
        self.draw(mesh, middle)
        for at, line in self.walls:
            line.set_ydata([self.scene.factor * (at - middle[1])] * 2)
