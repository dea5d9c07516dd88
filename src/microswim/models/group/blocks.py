"""The swimmers' own blocks of a group: factorised once, turned and moved to every pose.

A helix on a body of revolution turns with its phase as a whole, so one block serves all phases;
another tail has a block for each.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from microswim.models import memory
from microswim.models.bem.gait import turns_as_a_whole
from microswim.models.bem.levels import Level, get_level
from microswim.models.bem.solution import Solution
from microswim.models.bem.surface import Surface
from microswim.models.bem.system import factorised
from microswim.models.bem.trust import trusted
from microswim.models.group.coupled import Block, Placed
from microswim.models.group.nearness import refined
from microswim.swimmer.group import Group
from microswim.swimmer.member import Member, about_s
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True, eq=False)
class Blocks:
    """Own blocks of some swimmers at some phases, and the level they are of.

    Parameters
    ----------
    level : Level
    made : dict
        Block by the swimmer's identity and the phase; `swimmers` keeps them alive.
    swimmers : tuple of Swimmer
    """

    level: Level
    made: dict[tuple[int, float], Block]
    swimmers: tuple[Swimmer, ...]

    def of(self, member: Member) -> Block:
        """Return the block of a member; one that was not prepared is factorised now."""
        return self.made.get(_key(member)) or own_block(member, self.level)


def _key(member: Member) -> tuple[int, float]:
    phase = 0.0 if turns_as_a_whole(member.swimmer) else member.phase
    return id(member.swimmer), phase


def own_block(member: Member, level: Level) -> Block:
    """Return the block of a swimmer alone, at its phase or, if it turns as a whole, at zero."""
    alone = trusted(member.swimmer.settled, _key(member)[1], level, keep=True)
    assert alone.factors is not None
    return Block(alone.layer, alone.factors, alone.centre, _motor_rate(alone), alone.remarks)


def _motor_rate(alone: Solution) -> float:
    """Return the motor's rate; of a tail's rate in the lab, as the swimmer turns alone.

    rate = rate_lab / (1 + sign w_s),  w_s the body's rate about s at unit motor rate
    """
    if alone.swimmer.motion.frequency_frame != "lab" or alone.rate == 0:
        return alone.rate
    return alone.rate / (1.0 + alone.swimmer.tail.sign * alone.twist[3] / alone.rate)


def prepare(group: Group, level: str | Level = "standard") -> Blocks:
    """Return the own blocks of all members at their phases."""
    chosen = level if isinstance(level, Level) else get_level(level)
    made: dict[tuple[int, float], Block] = {}
    for member in group.members:
        if _key(member) not in made:
            made[_key(member)] = own_block(member, chosen)
    return Blocks(chosen, made, tuple(m.swimmer for m in group.members))


def placed(group: Group, blocks: Blocks) -> tuple[list[Placed], float]:
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
    there = [_placed(m, blocks.of(m)) for m in group.members]
    surfaces, gap = refined([p.surface for p in there])
    made = [p if p.surface is s else _anew(p, s) for p, s in zip(there, surfaces, strict=True)]
    _require_room([p.unknowns for p in made])
    return made, gap


def _require_room(sizes: list[int]) -> None:
    """Refuse couplings that do not fit into memory."""
    total = sum(sizes)
    need = 8.0 * (total**2 - sum(n**2 for n in sizes))
    memory.require(need, total, "choose a coarser level or fewer swimmers")


def _placed(member: Member, block: Block) -> Placed:
    turn = member.rotation
    if turns_as_a_whole(member.swimmer):
        turn = turn @ about_s(member.swimmer.tail.sign * member.phase)
    return Placed(block, turn, np.array(member.position))


def _anew(there: Placed, surface: Surface) -> Placed:
    """Return a block with other patches, in place already, factorised anew."""
    layer = replace(there.layer, surface=surface)
    old = there.block
    block = Block(layer, factorised(layer), there.position, old.rate, old.remarks)
    return Placed(block, np.eye(3), there.position)
