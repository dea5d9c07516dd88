"""Resistive force theory of a ribbon: its sections drag differently along normal and binormal.

``C = c_b I + (c_t - c_b) t t' + (c_n - c_b) n n'``; the sums are those of `rft.gait`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.array import Array


def normals(radial: Array, slope: Array) -> Array:
    """Return the unit vectors (..., 3) across the tangent that `radial` leans to."""
    t = slope / np.sqrt(np.sum(slope**2, axis=-1, keepdims=True))
    n = radial - np.sum(radial * t, axis=-1, keepdims=True) * t
    return n / np.sqrt(np.sum(n**2, axis=-1, keepdims=True))


def sums(
    at: tuple[Array, ...], normal: Array, ds: Array, arc: bool, c: Any, spin: float
) -> tuple[Array, Array, Array]:
    """Return ``B_t``, ``F_p``, G at m phases.

    Parameters
    ----------
    at
        Position from the body's centre, slope and velocity per unit phase rate at nodes, (m, n, 3).
    normal
        Unit normals of the sections, (m, n, 3).
    ds
        Weights of the nodes along s, (n,).
    arc
        Whether the line element is arc length.
    c
        ``(c_t, c_n, c_b, c_r)``, numbers or one for each node (n,).
    spin
        Rate of each section about s per unit phase rate.
    """
    X, slope, U = at
    c_t, c_n, c_b, c_r = c
    alone, across, beside = (np.asarray(x)[..., None, None] for x in (c_b, c_t - c_b, c_n - c_b))
    speed = np.sqrt(np.sum(slope**2, axis=-1))
    t, dl = slope / speed[..., None], ds * (speed if arc else 1.0)

    def dyad(a: Array) -> Array:
        return a[..., :, None] * a[..., None, :]

    C = alone * np.eye(3) + across * dyad(t) + beside * dyad(normal)
    moved = np.zeros((*X.shape, 6), dtype=X.dtype)  # of a section, by unit twists: [I, -X^]
    moved[..., :3] = np.eye(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        moved[..., j, 3 + k], moved[..., k, 3 + j] = X[..., i], -X[..., i]
    R = np.einsum("mnai,mnab,mnbj,mn->mij", moved, C, moved, dl, optimize=True)
    R[:, 3:, 3:] += np.einsum("mn,mni,mnj->mij", c_r * dl, t, t)
    F = np.einsum("mnai,mnab,mnb,mn->mi", moved, C, U, dl, optimize=True)
    turned = spin * t[..., 0]
    F[:, 3:] += np.einsum("mn,mni->mi", c_r * dl * turned, t)
    G = np.einsum("mna,mnab,mnb,mn->m", U, C, U, dl, optimize=True)
    return R, F, G + np.sum(c_r * dl * turned**2, axis=-1)
