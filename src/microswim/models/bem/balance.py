"""Resistances that balance: symmetric, and of a turning tail from the densities of its propulsion.

Of a helix that turns rigidly about its axis, by a twist w at unit phase rate, ``R w - F_p`` is the
wrench that turning the *body alone* takes. A small body on a large helix turns nearly by itself:
its swimming velocity hangs on that small difference, to which the asymmetry of the computed R, a
thousandth of a large part, may be several times over. ``F_p,i = int f_i . u_hat dS`` is made of the
densities f_i of rigid motions, and so must ``R w`` be, whose difference is then the integral over
the body, which is small by itself: ``(R w)_i = int f_i . (w's motion) dS``. R is the symmetric
matrix nearest to the computed one that has these products.
"""

from __future__ import annotations

import numpy as np

from microswim.models.bem.patches.surface import Surface
from microswim.models.bem.system import rigid_modes
from microswim.numerics.array import Array

RIGID = 1e-6  #: of its motion, within which a tail's surface turns rigidly


def turning_of(surface: Surface, centre: Array) -> Array:
    """Return the twist (6, 1) at unit phase rate of a surface's only tail, if it turns rigidly.

    Otherwise (6, 0): of several tails none leaves the body to turn alone.
    """
    own = surface.of_tail == 1
    modes = rigid_modes(surface.nodes[own], centre).reshape(-1, 6)
    motion = surface.node_motion[own].ravel()
    if motion.any() and surface.of_tail.max() == 1:
        twist = np.linalg.lstsq(modes, motion, rcond=None)[0]
        if np.abs(modes @ twist - motion).max() < RIGID * np.abs(motion).max():
            return np.asarray(twist[:, None], dtype=float)
    return np.zeros((6, 0))


def balanced(raw: Array, turning: Array) -> Array:
    """Return the symmetric matrix nearest to a resistance whose products with twists are its own.

    Nearest in the norm of the resistance itself, which no choice of axes changes; among the twists
    themselves the mean counts.

    Parameters
    ----------
    raw : (6m, 6m)
        As computed, columns of motions.
    turning : (6m, n)
        Twists of tails at unit rate, one of a swimmer.
    """
    R = 0.5 * (raw + raw.T)
    drag, missing = R @ turning, 0.5 * (raw.T - raw) @ turning
    inverse = np.linalg.inv(turning.T @ drag)
    beside = (missing - drag @ inverse @ turning.T @ missing) @ inverse @ drag.T
    return R + beside + beside.T
