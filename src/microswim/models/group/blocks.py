"""The swimmers' own blocks of a group: factorised once, turned and moved to every pose.

A helix on a body of revolution turns with its phase as a whole, so one block serves all phases;
another tail has a block for each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from microswim.errors import SpecError, measured
from microswim.models import memory
from microswim.models.bem.levels import Level, get_level
from microswim.models.bem.patches import near_wall
from microswim.models.bem.patches.surface import Surface, positions
from microswim.models.bem.system import factorised
from microswim.models.group.alone import Alone, phase_of_block, rotation_of_block, solve_alone
from microswim.models.group.coupled import Block, Placed
from microswim.models.group.nearness import refined
from microswim.numerics.array import Array
from microswim.swimmer.group import Group
from microswim.swimmer.member import Member
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True, eq=False)
class Blocks:
    """Some swimmers alone at some phases, and the level they are solved at.

    Parameters
    ----------
    level : Level
    made : dict
        By the swimmer's identity and the phase; `swimmers` keeps them alive.
    swimmers : tuple of Swimmer
    """

    level: Level
    made: dict[tuple[int, float], Alone]
    swimmers: tuple[Swimmer, ...]

    def of(self, member: Member) -> Alone:
        """Return a member alone; one that was not prepared is solved now."""
        return self.made.get(key(member)) or solve_alone(member, self.level)

    def holds(self, member: Member) -> bool:
        """Return whether a member was prepared at its phase."""
        return key(member) in self.made


def key(member: Member) -> tuple[int, float]:
    """Return what the block of a member is known by: its swimmer and the phase."""
    return id(member.swimmer), phase_of_block(member)


def prepare(group: Group, level: str | Level = "standard") -> Blocks:
    """Return all members alone at their phases."""
    chosen = level if isinstance(level, Level) else get_level(level)
    made: dict[tuple[int, float], Alone] = {}
    for member in group.members:
        if key(member) not in made:
            made[key(member)] = solve_alone(member, chosen)
    return Blocks(chosen, made, tuple(m.swimmer for m in group.members))


def placed(group: Group, alone: Sequence[Alone]) -> tuple[list[Placed], float]:
    """Return all members' blocks at their poses, with finer patches where they are near.

    Returns
    -------
    tuple
        The blocks in place, and the smallest gap between two swimmers.

    Raises
    ------
    SpecError
        If two overlap, or are too near to be resolved.
    MachineError
        If the system does not fit into memory.
    """
    there = [
        Placed(own.block, rotation_of_block(m), np.array(m.position))
        for m, own in zip(group.members, alone, strict=True)
    ]
    surfaces = [p.surface for p in there]
    if group.plane is not None:
        surfaces = [_beside(n, s, group.plane) for n, s in enumerate(surfaces)]
    surfaces, gap = refined(surfaces)
    made = [p if p.surface is s else _anew(p, s) for p, s in zip(there, surfaces, strict=True)]
    _require_room([p.unknowns for p in made], group.plane is not None)
    return made, gap


def _beside(n: int, surface: Surface, plane: Array) -> Surface:
    """Return the surface of swimmer n with patches that resolve the gap to a wall."""
    height = float(((positions(surface, 9) - plane[:3]) @ plane[3:]).min())
    if height <= 0.0:
        into = f"reaches {measured(-height)} into the wall"
        raise SpecError(f"swimmer[{n}].position: swimmer {n} {into}; move it away")
    return near_wall.refined(surface, near_wall.over(plane))


def _require_room(sizes: list[int], wall: bool) -> None:
    """Refuse couplings that do not fit into memory."""
    total = sum(sizes)
    need = 8.0 * (total**2 - (0 if wall else sum(n**2 for n in sizes)))
    memory.require(need, total, "choose a coarser level or fewer swimmers")


def _anew(there: Placed, surface: Surface) -> Placed:
    """Return a block with other patches, in place already, factorised anew."""
    layer = replace(there.layer, surface=surface)
    return Placed(Block(layer, factorised(layer), there.position), np.eye(3), there.position)
