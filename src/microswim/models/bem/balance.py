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
from scipy.linalg import orth

from microswim.models.bem.patches.surface import Surface
from microswim.models.bem.system import rigid_modes
from microswim.numerics.array import Array

RIGID = 1e-6  #: of its motion, within which a tail's surface turns rigidly


def turnings(surface: Surface, centre: Array) -> Array:
    """Return the twists (6, n) at unit phase rate of the n tails of a surface that turn rigidly."""
    found = []
    for tail in range(1, int(surface.of_tail.max(initial=0)) + 1):
        own = surface.of_tail == tail
        modes = rigid_modes(surface.nodes[own], centre).reshape(-1, 6)
        motion = surface.node_motion[own].ravel()
        twist = np.linalg.lstsq(modes, motion, rcond=None)[0]
        if np.abs(modes @ twist - motion).max() < RIGID * np.abs(motion).max():
            found.append(twist)
    return np.array(found).reshape(-1, 6).T


def balanced(raw: Array, turning: Array) -> Array:
    """Return the symmetric matrix nearest to a resistance whose products with twists are its own.

    Nearest with each entry over ``sqrt(R_ii R_jj)``; among the twists themselves the mean counts.

    Parameters
    ----------
    raw : (6m, 6m)
        As computed, columns of motions; no diagonal entry negative.
    turning : (6m, n)
        Twists of tails at unit rate.
    """
    size = np.sqrt(np.abs(raw.diagonal()))
    size[size == 0.0] = 1.0
    A = raw / np.outer(size, size)
    Q = orth(size[:, None] * turning) if turning.size else np.zeros((len(A), 0))
    onto = Q @ Q.T
    beside = (np.eye(len(A)) - onto) @ (0.5 * (A - A.T)) @ onto
    return (0.5 * (A + A.T) - beside - beside.T) * np.outer(size, size)
