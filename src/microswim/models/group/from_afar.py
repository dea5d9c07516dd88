"""A swimmer seen from afar, averaged over its period: what it does to the fluid, and answers.

    on the fluid    F_j = int f_j dS,  D_jk = int f_j x_k dS,  Q_jkl = int f_j x_k x_l dS
    by the fluid    V = R^-1 int f' (u + grad u . x) dS                   (reciprocal theorem)

f are the tractions of the swimmer alone in its motions (V, rate), x counts from its body's centre.
Both are linear in the external wrench W, so each is an array over (W, 1). On average a helix on a
body of revolution is the same from all sides of s: then the mean runs over the turns about s too,
and the mean path is straight along s.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim.gait.screw import screw
from microswim.models.bem.gait import gait, turns_as_a_whole
from microswim.models.bem.levels import get_level
from microswim.models.group.alone import Alone, solve_alone
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import twist_along
from microswim.swimmer.member import Member, about_s
from microswim.swimmer.swimmer import Swimmer

#: Phases, and turns about s, that a swimmer is averaged over: exact for the third harmonic.
PHASES, TURNS = 12, 8
#: Signs of the permutations of three axes.
PERMUTED = np.array([[[(i - j) * (j - k) * (k - i) / 2.0 for k in range(3)] for j in range(3)]
                     for i in range(3)])  # fmt: skip


@dataclass(frozen=True, eq=False)
class FromAfar:
    """A swimmer seen from afar, in its own axes about its body's centre.

    Parameters
    ----------
    motion : (6, 7)
        Velocity, over external force and torque, and as it swims without either.
    force, dipole, quadrupole : (3, 7), (3, 3, 7), (3, 3, 3, 7)
        F, D and Q on the fluid, over the same.
    response : (6, 3, 4)
        Velocity in a flow, over its components j and u_j at the centre, d_1 u_j, d_2 u_j, d_3 u_j.
    axis : (3,)
        Along the mean path at phase zero: of a helix the axis of its screw, about which s goes
        round; else s.
    rate : float
        Phase rate of the motor.
    size : float
        Largest distance of the surface from the centre.
    """

    motion: Array
    force: Array
    dipole: Array
    quadrupole: Array
    response: Array
    axis: Array
    rate: float
    size: float


def from_afar(swimmer: Swimmer, level: str = "standard") -> FromAfar:
    """Return a swimmer seen from afar, by boundary elements at the phases of its period."""
    whole = turns_as_a_whole(swimmer)
    still = whole or swimmer.tail.rate == 0
    phases = 2.0 * np.pi * np.arange(1 if still else PHASES) / PHASES
    alone = [solve_alone(Member(swimmer=swimmer, phase=p), get_level(level)) for p in phases]
    is_round = whole and swimmer.body.is_axisymmetric
    turns = [about_s(2.0 * np.pi * i / TURNS) for i in range(TURNS)] if is_round else [np.eye(3)]
    parts = [_turned(_seen(one, swimmer), Q) for one in alone for Q in turns]
    motion, *others = (np.mean(part, axis=0) for part in zip(*parts, strict=True))
    rate, axis = alone[0].rate, np.eye(3)[0]
    if is_round:
        motion[:, 6], axis = _along_s(alone[0], swimmer)
    elif len(alone) > 1:
        moved = screw(gait(swimmer, level=level))
        motion[:, 6] = twist_along(moved.displacement, moved.quaternion) / moved.period
    size = max(float(np.linalg.norm(one.points[0], axis=1).max()) for one in alone)
    return FromAfar(motion, *others, axis=axis, rate=rate, size=size)


def _seen(alone: Alone, swimmer: Swimmer) -> tuple[Array, ...]:
    """Return motion, force, dipole, quadrupole and response at one phase."""
    free = np.flatnonzero(swimmer.motion.mask)
    inverse = np.zeros((6, 6))
    inverse[np.ix_(free, free)] = np.linalg.inv(alone.resistance[np.ix_(free, free)])
    driven = -alone.propulsion * alone.rate
    motion = np.concatenate([inverse, (inverse @ driven)[:, None]], axis=1)
    moved = np.concatenate([motion, alone.rate * np.eye(7)[6:]])  # over the seven motions
    wrench = alone.resistance @ motion
    wrench[:, 6] -= driven
    dipole, quadrupole = alone.dipoles @ moved, alone.quadrupoles @ moved
    turning = 0.5 * np.einsum("ikj,iw->jkw", PERMUTED, wrench[3:])  # as the torque has it
    dipole = 0.5 * (dipole + dipole.swapaxes(0, 1)) + turning
    response = np.empty((6, 3, 4))
    response[:, :, 0] = inverse @ alone.resistance[:, :3]
    response[:, :, 1:] = np.einsum("ab,jkb->ajk", inverse, alone.dipoles[..., :6])
    return motion, wrench[:3], dipole, quadrupole, response


def _turned(seen: tuple[Array, ...], Q: Array) -> tuple[Array, ...]:
    """Return the same seen from axes in which the swimmer is turned by Q."""
    motion, force, dipole, quadrupole, response = seen
    six, load, four = np.zeros((6, 6)), np.eye(7), np.eye(4)
    six[:3, :3] = six[3:, 3:] = Q
    load[:6, :6], four[1:, 1:] = six, Q
    return (
        six @ motion @ load.T,
        Q @ force @ load.T,
        np.einsum("ja,kb,wv,abv->jkw", Q, Q, load, dipole),
        np.einsum("ja,kb,lc,wv,abcv->jklw", Q, Q, Q, load, quadrupole, optimize=True),
        np.einsum("sr,ja,kb,rab->sjk", six, Q, four, response),
    )


def _along_s(alone: Alone, swimmer: Swimmer) -> tuple[Array, Array]:
    """Return mean velocity (6,) and axis (3,) of a swimmer that follows a screw.

    Seen from axes that turn with the tail its twist is constant; what is along the axis of the
    screw stays.
    """
    free = np.flatnonzero(swimmer.motion.mask)
    V = np.zeros(6)
    load = -alone.propulsion[free] * alone.rate
    V[free] = np.linalg.solve(alone.resistance[np.ix_(free, free)], load)
    turning = V[3:].copy()
    if not swimmer.tail.is_absent:
        turning[0] += swimmer.tail.sign * alone.rate
    size = float(np.linalg.norm(turning))
    if size == 0.0:
        return np.zeros(6), np.eye(3)[0]
    axis = np.copysign(1.0, turning[0]) * turning / size
    return np.concatenate([[V[:3] @ axis], np.zeros(5)]), axis
