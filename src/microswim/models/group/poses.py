"""The same swimmers at many poses: each a solve of the couplings alone, several at a time."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace

from threadpoolctl import threadpool_limits

from microswim.errors import SpecError
from microswim.models.group.alone import solve_alone
from microswim.models.group.blocks import Blocks, key
from microswim.models.group.motion import Motion
from microswim.models.group.quick import solve_quickly
from microswim.models.group.solution import solve
from microswim.numerics.array import Array, read_only
from microswim.swimmer.group import Group

#: Poses at one phase from which on a block is kept for them, and skeletons are made.
MANY = 8


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


def ready(groups: Sequence[Group], blocks: Blocks) -> tuple[Blocks, bool]:
    """Return blocks for all phases that many poses share, and whether skeletons pay."""
    often = Counter(key(m) for g in groups for m in g.members)
    made = dict(blocks.made)
    for member in (m for g in groups for m in g.members):
        if key(member) not in made and often[key(member)] >= MANY:
            made[key(member)] = solve_alone(member, blocks.level)
    quickly = len(groups) >= MANY and groups[0].wall is None
    for name, own in made.items():
        if quickly and often[name] >= MANY:
            _ = own.skeleton  # made here, not by several threads at once
    return replace(blocks, made=made), quickly


@contextmanager
def solving(
    groups: Sequence[Group], blocks: Blocks, workers: int, first: int = 0
) -> Iterator[Iterator[Motion | SpecError]]:
    """Give the solutions of many poses from the `first` on in their order, several at a time.

    Poses that were not begun when the block is left are not solved. How one is solved depends on
    all of them, so that those of a run that goes on come out the same.
    """
    blocks, quickly = ready(groups, blocks)

    def one(group: Group) -> Motion | SpecError:
        try:
            return solve_quickly(group, blocks) if quickly else solve(group, blocks=blocks)
        except SpecError as error:
            return error

    with threadpool_limits(1), ThreadPoolExecutor(workers) as pool:
        try:
            yield pool.map(one, groups[first:])
        finally:
            pool.shutdown(cancel_futures=True)
