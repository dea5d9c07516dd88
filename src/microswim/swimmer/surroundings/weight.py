"""What a swimmer weighs in its fluid and where: force, and arm about the body's centre.

    F = sum (rho_i - rho_f) V_i g       d(phi) = sum (rho_i - rho_f) V_i r_i,    torque d x g

over body and tail, r_i the middle of each volume; mass off the middle of the body adds
``rho_b V_b c`` to d.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.quadrature import gauss
from microswim.swimmer.geometry.solids.volume import volume_and_middle
from microswim.swimmer.geometry.tails.kinds import Tail

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer

NODES = 48  #: along each smooth panel of a tail, per wave


def excess(swimmer: Swimmer) -> float:
    """Return the mass beyond that of the fluid displaced; zero without gravity."""
    if swimmer.gravity is None:
        return 0.0
    body, tail = swimmer.gravity.densities
    volume, _ = volume_and_middle(swimmer.body)
    filament, _ = _tails(swimmer, np.zeros(1))
    rho = swimmer.fluid.density
    return float((body - rho) * volume + (tail - rho) * filament[0])


def pull(swimmer: Swimmer) -> Array:
    """Return the weight (3,) in the fluid, lab frame; zero without gravity."""
    if swimmer.gravity is None:
        return np.zeros(3)
    return excess(swimmer) * swimmer.gravity.vector


def arm(swimmer: Swimmer, phases: Array) -> Array:
    """Return d (n, 3) at the phases, body frame; zero without gravity."""
    if swimmer.gravity is None:
        return np.zeros((len(phases), 3))
    body, tail = swimmer.gravity.densities
    volume, middle = volume_and_middle(swimmer.body)
    filament, moment = _tails(swimmer, phases)
    rho, centre = swimmer.fluid.density, swimmer.body.centre
    own = (body - rho) * volume * (middle - centre)
    own = own + body * volume * np.array(swimmer.gravity.centre_of_mass)
    return own + (tail - rho) * (moment - filament[:, None] * centre)


def _tails(swimmer: Swimmer, phases: Array) -> tuple[Array, Array]:
    """Volume (n,) of the filaments and its first moment (n, 3), frame ``sqr``."""
    volume, moment = zip(*(_of_one(tail, phases) for tail in swimmer.tail.each))
    return np.sum(volume, axis=0), np.sum(moment, axis=0)


def _of_one(tail: Tail, phases: Array) -> tuple[Array, Array]:
    length, area = float(tail.apparent_length), np.pi * float(np.prod(tail.half_axes))
    x, w = gauss(int(NODES * (1 + np.ceil(float(tail.number_of_waves)))))
    volume, moment = np.zeros(len(phases)), np.zeros((len(phases), 3))
    for a, b in zip(tail.edges, tail.edges[1:]):
        s = length * (a + (b - a) * x)
        P, slope, _ = tail.centreline(s[None], np.asarray(phases)[:, None])
        weight = (
            area * tail.narrowing(s) ** 2 * length * (b - a) * w * np.linalg.norm(slope, axis=-1)
        )
        volume += weight.sum(axis=1)
        moment += np.einsum("nk,nki->ni", weight, P)
    return volume, moment
