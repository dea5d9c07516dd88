"""A swimmer of a group by itself, at one phase: its block, and all that a group asks of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import KDTree

from microswim.models.bem.gait import turns_as_a_whole
from microswim.models.bem.levels import Level
from microswim.models.bem.patches.surface import positions
from microswim.models.bem.solution import Solution
from microswim.models.bem.trust import misfit, trusted
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
    misfit : float
        By how much symmetry and reciprocity are missed.
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
    misfit: float
    remarks: tuple[str, ...]

    @cached_property
    def skeleton(self) -> Skeleton | None:
        """What it answers to flows from some way off, if its nodes hold that."""
        return skeleton_of(self.block)

    @cached_property
    def light(self) -> Skeleton | None:
        """The same of few nodes."""
        return skeleton_of(self.block, few=True)

    @cached_property
    def around(self) -> KDTree:
        """Points of its surface from its centre, in the block's axes."""
        return KDTree(positions(self.block.layer.surface, 5).reshape(-1, 3) - self.block.centre)


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
        points=_points(found, dipoles, quadrupoles),
        dipoles=dipoles,
        quadrupoles=quadrupoles,
        rate=rate,
        moments=moments(found) * (rate / found.rate if found.rate else 0.0),
        misfit=misfit(found),
        remarks=found.remarks,
    )


def _motor_rate(alone: Solution) -> float:
    """Return the motor's rate; of a tail's rate in the lab, as the swimmer turns alone.

    rate = rate_lab / (1 + sign w_s),  w_s the body's rate about s at unit motor rate
    """
    if alone.swimmer.motion.frequency_frame != "lab" or alone.rate == 0:
        return alone.rate
    return alone.rate / (1.0 + alone.swimmer.tail.sign * alone.twist[3] / alone.rate)


def _points(alone: Solution, dipoles: Array, quadrupoles: Array) -> tuple[Array, Array]:
    """Return middles (b, 3) of the patches and forces (b, 3, 7) there with all their moments.

    The patches' own forces h miss what lies off the middles; the least change d of them, by area,
    with ``sum d = 0, sum d_j x_k = D_jk - sum h_j x_k`` and the same of Q sets that right.
    """
    area, moment = alone.surface.moments[:2]
    size = area.sum(axis=1)
    middle = moment.sum(axis=1) / size[:, None] - alone.centre
    density = alone.density.reshape(*alone.surface.nodes.shape, 7)
    H = np.einsum("ep,epck->eck", area, density)
    k, l = np.triu_indices(3)
    terms = np.concatenate([np.ones((len(H), 1)), middle, middle[:, k] * middle[:, l]], axis=1)
    nothing = np.zeros((3, 1, 7))
    both = 0.5 * (quadrupoles[:, k, l] + quadrupoles[:, l, k])
    true = np.concatenate([nothing, dipoles, both], axis=1)  # (3, 10, 7)
    true[:, 1:] -= np.einsum("ejw,et->jtw", H, terms[:, 1:])
    # a term that vanishes at all middles, as x y does on the six patches of a ball, says nothing
    far = np.linalg.norm(middle, axis=1).max()
    usual = np.sqrt(len(H)) * far ** np.repeat([0.0, 1.0, 2.0], [1, 3, 6])
    scale = np.maximum(np.linalg.norm(terms, axis=0), 1e-6 * usual)
    scale[4:] *= 1e3  # few patches cannot have all: force and dipole go before the quadrupole
    A = np.sqrt(size)[:, None] * terms / scale
    least = np.linalg.pinv(A.T, rcond=1e-8)  # (e, 10)
    change = np.einsum("e,et,jtw->ejw", np.sqrt(size), least, true / scale[:, None])
    return middle, H + change


def _moments(alone: Solution) -> tuple[Array, Array]:
    """Return dipoles (3, 3, 7) and quadrupoles (3, 3, 3, 7) of six rigid motions and the tail's."""
    s = alone.surface
    area, moment = s.moments[:2]
    f, arm = alone.density.reshape(*s.nodes.shape, 7), moment - area[..., None] * alone.centre
    second = np.einsum("epj...,epk,epl->jkl...", f, arm, s.nodes - alone.centre)
    return np.einsum("epj...,epk->jk...", f, arm), second
