"""The flow about several swimmers, in a plane through them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.models.bem.output import quads_of
from microswim.models.bem.patches.surface import positions
from microswim.output.plots.flow import cut
from microswim.output.plots.style import WIDE, blank

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from microswim.models.group.solution import GroupSolution

AXES = {"x": 0, "y": 1, "z": 2}
#: Points a side of a patch in the shadows; decades of speed, which falls off as 1/r^2.
SIDE, DECADES = 9, 2.5


@checks.given(found=lambda name, value: checks.instance(name, value, "GroupSolution"))
def group(
    found: GroupSolution,
    *,
    plane: str = "xy",
    resolution: int = 90,
    ax: Axes | None = None,
) -> Figure:
    """Draw speed and streamlines of the fluid in a plane, the swimmers' shadows over them.

    Parameters
    ----------
    found
        What ``Group.solve`` returned, or ``Group.swim(...).solution``.
    plane
        Two of x, y, z, the scene's axes across and up; the plane lies through the mean position.
    resolution
        Points across.
    ax
        Where to draw; a new figure by default.

    Raises
    ------
    SpecError
        If the plane is none.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> one = ms.Group((ms.Member(swimmer=helix),)).solve(level="coarse")
    >>> ms.plots.group(one, resolution=12).axes[0].get_xlabel()
    'x'
    """
    if len(plane) != 2 or plane[0] == plane[1] or not set(plane) <= AXES.keys():
        raise SpecError("plane", plane, 'two of x, y, z, as in "xy"')
    i, j = (AXES[c] for c in plane)
    hull = np.concatenate([positions(p.surface, SIDE).reshape(-1, 3) for p in found.placed])
    low, high = hull.min(axis=0), hull.max(axis=0)
    margin = 0.2 * float((high - low).max())
    x = np.linspace(low[i] - margin, high[i] + margin, resolution)
    rows = max(8, round(resolution * (high[j] - low[j] + 2 * margin) / (x[-1] - x[0])))
    y = np.linspace(low[j] - margin, high[j] + margin, rows)
    points = np.empty((y.size, x.size, 3))
    points[..., 3 - i - j] = np.mean([p.position[3 - i - j] for p in found.placed])
    points[..., i], points[..., j] = x[None, :], y[:, None]
    u = found.flow(points)[..., [i, j, 3 - i - j]]
    shadows = [
        positions(p.surface, SIDE)[..., [i, j]].reshape(-1, 2)[quads_of(p.surface.patches, SIDE)]
        for p in found.placed
    ]
    if ax is None:
        height = float(np.clip(0.75 * WIDE * np.ptp(y) / np.ptp(x), 2.0, 1.2 * WIDE))
        ax = blank(WIDE, height).subplots()
    sides = {plane[0]: x, plane[1]: y}
    return cut(sides, u, np.concatenate(shadows), found.units, ax=ax, decades=DECADES)
