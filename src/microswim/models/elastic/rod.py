"""A rod of length 1 that cannot stretch, by the Legendre series of its curvature.

With the tangent angle ``theta(s) = theta_0 + sum_k q_k Phi_k(s)``, ``Phi_k' = p_k`` orthonormal
Legendre polynomials on [0, 1], the bending energy of stiffness 1 is ``sum q_k^2 / 2``; that the
length stays holds by itself, and a free end needs no condition. A base that can turn has one
coordinate more, ``Phi = 1``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from microswim.numerics.quadrature import gauss
from microswim.swimmer.geometry.tails.elastic.rest_shape import RestShape


@dataclass(frozen=True, eq=False)
class Rod:
    """Nodes and shapes of a rod; the last node is its free end, with no weight.

    Parameters
    ----------
    s
        Gauss-Legendre nodes on [0, 1], then 1; shape (m,).
    weight
        Of each node, shape (m,).
    along
        Integration from 0 to each node, shape (m, m).
    shapes
        ``Phi_k`` at the nodes, shape (m, n).
    curvatures
        ``p_k`` at the nodes, shape (m, n).
    stiffness
        Of each coordinate, shape (n,): 1 for bending, the base's own for its turning.
    rest
        Coordinates at rest, shape (n,).
    tilt
        Angle at each node of what is straight, from the base, shape (m,).
    """

    s: np.ndarray
    weight: np.ndarray
    along: np.ndarray
    shapes: np.ndarray
    curvatures: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    tilt: np.ndarray

    @property
    def end(self) -> np.ndarray:
        """1 at the free end, 0 at the other nodes, (m,)."""
        return np.where(self.s == 1.0, 1.0, 0.0)

    @property
    def count(self) -> int:
        """Number of coordinates n."""
        return len(self.stiffness)


@lru_cache(64)
def rod(modes: int, base: float | None = None) -> Rod:
    """Return a rod of so many curvatures.

    Parameters
    ----------
    modes
        Legendre polynomials of the curvature.
    base
        Stiffness of the base's turning, torque per angle; 0 for a hinge, None for a clamp.
    """
    x, w = gauss(2 * modes + 8)
    m = len(x)
    degree = np.sqrt(2.0 * np.arange(m) + 1.0)
    values = legendre.legvander(2.0 * x - 1.0, m - 1) * degree
    along = np.zeros((m + 1, m + 1))
    along[:m, :m] = integrals(x, m) * degree @ (values.T * w)
    along[m, :m] = w
    s = np.append(x, 1.0)
    shapes = integrals(s, modes) * degree[:modes]
    curvatures = legendre.legvander(2.0 * s - 1.0, modes - 1) * degree[:modes]
    stiffness = np.ones(modes)
    if base is not None:
        shapes = np.column_stack([np.ones(m + 1), shapes])
        curvatures = np.column_stack([np.zeros(m + 1), curvatures])
        stiffness = np.append(base, stiffness)
    straight = np.zeros(len(stiffness)), np.zeros(m + 1)
    return Rod(s, np.append(w, 0.0), along, shapes, curvatures, stiffness, *straight)


def bent(straight: Rod, rest: RestShape) -> Rod:
    """Return a rod with a shape at rest in the plane; an arm without drag leads to its root."""
    own = (rest.strains(straight.s)[1] * straight.weight) @ straight.curvatures
    angle, arm = rest.root_in_plane
    tilt = straight.tilt + angle
    made, size = replace(straight, rest=own, tilt=tilt), np.hypot(*arm)
    if not size:
        return made
    along = np.pad(made.along, ((1, 0), (1, 0)))
    along[1:, 0] = size
    turns = np.zeros((1, made.count))
    turns[0, 0] = 0.0 if made.curvatures[:, 0].any() else 1.0  # with the base, where it can turn
    return replace(
        made,
        s=np.append(0.0, made.s),
        weight=np.append(0.0, made.weight),
        along=along,
        shapes=np.vstack([turns, made.shapes]),
        curvatures=np.pad(made.curvatures, ((1, 0), (0, 0))),
        tilt=np.append(np.arctan2(arm[1], arm[0]), tilt),
    )


def integrals(s: np.ndarray, count: int) -> np.ndarray:
    """Return ``int_0^s P_k(2 x - 1) dx = (P_{k+1} - P_{k-1}) / (2 (2 k + 1))``, and ``s`` for k =
    0.
    """
    P = legendre.legvander(2.0 * s - 1.0, count)
    out = np.empty((len(s), count))
    out[:, 0] = s
    k = np.arange(1, count)
    out[:, 1:] = (P[:, 2:] - P[:, :-2]) / (2.0 * (2.0 * k + 1.0))
    return out
