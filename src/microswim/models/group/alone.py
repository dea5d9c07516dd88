"""A swimmer of a group by itself, at one phase: its block, and all that a group asks of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from microswim.models.bem.gait import turns_as_a_whole
from microswim.models.bem.levels import Level
from microswim.models.bem.solution import Solution
from microswim.models.bem.trust import trusted
from microswim.models.group.coupled import Block
from microswim.models.group.far_field import moments
from microswim.models.group.skeleton import Skeleton, skeleton_of
from microswim.numerics.array import Array
from microswim.swimmer.member import Member, about_s


@dataclass(frozen=True, eq=False)
class Alone:
    """A swimmer by itself, at its phase or, if it turns with that as a whole, at phase zero.

    Parameters
    ----------
    block : Block
        Its surface with the factorised system.
    resistance, propulsion : (6, 6), (6,)
        Its own.
    points : (b, 3), (b, 3, 7)
        Middles of the patches from the centre, and their forces in six rigid motions and the
        tail's.
    dipoles, quadrupoles : (3, 3, 7), (3, 3, 3, 7)
        ``int f_j x_k dS`` and ``int f_j x_k x_l dS`` in these motions, x from the centre.
    rate : float
        Phase rate of the motor, relative to the body (rad per time).
    moments : (5,)
        Of its far field as it swims (`far_field.moments`).
    remarks : tuple of str
        What is extreme about the geometry.
    """

    block: Block
    resistance: Array
    propulsion: Array
    points: tuple[Array, Array]
    dipoles: Array
    quadrupoles: Array
    rate: float
    moments: Array
    remarks: tuple[str, ...]

    @cached_property
    def skeleton(self) -> Skeleton | None:
        """What it answers to flows from some way off, if its nodes hold that."""
        return skeleton_of(self.block)


def phase_of_block(member: Member) -> float:
    """Return the phase at which a member's block is made."""
    return 0.0 if turns_as_a_whole(member.swimmer) else member.phase


def rotation_of_block(member: Member) -> Array:
    """Return the rotation (3, 3) from the block's axes to the scene's."""
    if not turns_as_a_whole(member.swimmer):
        return member.rotation
    return member.rotation @ about_s(member.swimmer.tail.sign * member.phase)


def solve_alone(member: Member, level: Level) -> Alone:
    """Solve for a swimmer alone at its phase."""
    found = trusted(member.swimmer.settled, phase_of_block(member), level, keep=True)
    assert found.factors is not None
    rate = _motor_rate(found)
    dipoles, quadrupoles = _moments(found)
    return Alone(
        block=Block(found.layer, found.factors, found.centre),
        resistance=found.resistance,
        propulsion=found.propulsion,
        points=_points(found),
        dipoles=dipoles,
        quadrupoles=quadrupoles,
        rate=rate,
        moments=moments(found) * (rate / found.rate if found.rate else 0.0),
        remarks=found.remarks,
    )


def _motor_rate(alone: Solution) -> float:
    """Return the motor's rate; of a tail's rate in the lab, as the swimmer turns alone.

    rate = rate_lab / (1 + sign w_s),  w_s the body's rate about s at unit motor rate
    """
    if alone.swimmer.motion.frequency_frame != "lab" or alone.rate == 0:
        return alone.rate
    return alone.rate / (1.0 + alone.swimmer.tail.sign * alone.twist[3] / alone.rate)


def _points(alone: Solution) -> tuple[Array, Array]:
    """Return middles (b, 3) of the patches and their forces (b, 3, 7)."""
    area, moment = alone.surface.moments[:2]
    middle = moment.sum(axis=1) / area.sum(axis=1)[:, None] - alone.centre
    density = alone.density.reshape(*alone.surface.nodes.shape, 7)
    return middle, np.einsum("ep,epck->eck", area, density)


def _moments(alone: Solution) -> tuple[Array, Array]:
    """Return dipoles (3, 3, 7) and quadrupoles (3, 3, 3, 7) of six rigid motions and the tail's."""
    s = alone.surface
    area, moment = s.moments[:2]
    f, arm = alone.density.reshape(*s.nodes.shape, 7), moment - area[..., None] * alone.centre
    second = np.einsum("epj...,epk,epl->jkl...", f, arm, s.nodes - alone.centre)
    return np.einsum("epj...,epk->jk...", f, arm), second
