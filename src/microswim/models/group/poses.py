"""The same swimmers at many poses: each a solve of the couplings alone, several at a time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from microswim.errors import SpecError
from microswim.models.group.blocks import Blocks
from microswim.models.group.solution import GroupSolution, solve
from microswim.numerics.array import Array, read_only
from microswim.numerics.compiling.compiled import numba
from microswim.swimmer.group import Group


@dataclass(frozen=True, eq=False, kw_only=True)
@read_only
class GroupPoses:
    """How the same swimmers move at many poses; NaN where a pose was refused.

    Parameters
    ----------
    resistance : (m, 6n, 6n)
    propulsion : (m, 6n, n)
    velocity : (m, n, 6)
        In the swimmers' own axes, as of a `GroupSolution`.
    gap : (m,)
        Smallest distance between two swimmers.
    refused : tuple of str
        Why a pose was refused, empty where it was not.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> pair = ms.Group((ms.Member(swimmer=helix), ms.Member(swimmer=helix, position=(0, 3, 0))))
    >>> found = pair.at_poses([[(0, 0, 0), (0, y, 0)] for y in (0.5, 2.0, 4.0)], level="coarse")
    >>> found.velocity.shape, found.refused[0]
    ((3, 2, 6), 'swimmer[1].position: swimmer 1 overlaps or touches swimmer 0; move it away')
    """

    resistance: Array
    propulsion: Array
    velocity: Array
    gap: Array
    refused: tuple[str, ...]


def at_poses(
    groups: Sequence[Group],
    blocks: Blocks,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> GroupPoses:
    """Solve for the same swimmers at many poses, so many at a time (default: all cores)."""
    workers = numba().get_num_threads() if workers is None else workers
    m, n = len(groups), len(groups[0].members)
    R, F = np.full((m, 6 * n, 6 * n), np.nan), np.full((m, 6 * n, n), np.nan)
    V, gap = np.full((m, n, 6), np.nan), np.full(m, np.nan)
    refused = [""] * m

    def one(group: Group) -> GroupSolution | SpecError:
        try:
            return solve(group, blocks=blocks)
        except SpecError as error:
            return error

    with threadpool_limits(1), ThreadPoolExecutor(workers) as pool:
        for k, found in enumerate(pool.map(one, groups)):
            if isinstance(found, SpecError):
                refused[k] = str(found)
            else:
                R[k], F[k], V[k] = found.resistance, found.propulsion, found.velocity
                gap[k] = found.gap
            if progress is not None:
                progress(k + 1, m)
    return GroupPoses(resistance=R, propulsion=F, velocity=V, gap=gap, refused=tuple(refused))
