"""A filament in space as its strains see it: hook, arm and rod in a row of nodes.

The hook is a joint: nodes of no length and no drag, over which the directors turn by one rotation
vector. The arm leads from there to the root of a filament that does not begin on its axis. Then
comes the rod, its curvatures and twist as Legendre series about those that it has at rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from microswim.models.elastic.rod import Rod, integrals, rod
from microswim.numerics.quadrature import gauss
from microswim.swimmer.geometry.tails.elastic.rest_shape import RestShape

HOOK_NODES = 6


@dataclass(frozen=True, eq=False)
class Filament:
    """Nodes and strains of a filament; of m nodes the last is the free end.

    Parameters
    ----------
    s, weight, end
        Arc length over L, quadrature weight, and 1 at the free end; (m,), no weight before the rod.
    along
        Integration of the heading to the place of each node, (m, m).
    turns
        Integration of the strains to the directors of each node, (m, m).
    heading
        Components of the filament's direction by the directors, (m, 3).
    curvatures
        Of each coordinate at the nodes, (m, n).
    stiffness
        Of each coordinate, of two curvatures and the twist, (3, n).
    rest
        Coordinates at rest, (3, n).
    base
        Directors before the hook, rows ``d_1, d_2, t``, (3, 3).
    """

    s: np.ndarray
    weight: np.ndarray
    end: np.ndarray
    along: np.ndarray
    turns: np.ndarray
    heading: np.ndarray
    curvatures: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    base: np.ndarray

    @property
    def count(self) -> int:
        """Number of coordinates of each strain."""
        return self.curvatures.shape[1]

    @property
    def hooks(self) -> int:
        """Coordinates of each strain that are the hook's turn: 1 with one, else 0."""
        return 0 if self.curvatures[self.on_rod, 0].any() else 1

    @property
    def on_rod(self) -> np.ndarray:
        """Which nodes are the rod's, (m,)."""
        return (self.weight > 0.0) | (self.end > 0.0)

    def over(self, first: float, last: float) -> np.ndarray:
        """Return the weights (m,) with which nodes give an integral over a part of the rod."""
        x, w = self.s[self.weight > 0.0], self.weight[self.weight > 0.0]
        k = np.arange(len(x))
        values = np.polynomial.legendre.legvander(2.0 * x - 1.0, len(x) - 1) * (2.0 * k + 1.0)
        low, high = integrals(np.array([first, last]), len(x))
        weight = np.zeros(len(self.s))
        weight[self.weight > 0.0] = w * (values @ (high - low))
        return weight


def filament(
    modes: int,
    *,
    twisting: float,
    rest: RestShape | None = None,
    tilt: float = 0.0,
    hook: float | None = None,
) -> Filament:
    """Return a filament of so many Legendre polynomials a strain.

    Parameters
    ----------
    modes
        Of each strain.
    twisting
        Twisting over bending stiffness.
    rest
        Its shape at rest, over L; straight by default.
    tilt
        Angle of the base from s towards q.
    hook
        Stiffness of the hook's turning, ``B / L``; 0: a hinge; None: a clamp.
    """
    jointed = hook is not None
    plain = _nodes(modes, jointed)
    c, s = np.cos(tilt), np.sin(tilt)
    zero = 0.0 * tilt
    turned = np.array([[-s, c, zero], [zero, zero, 1.0 + zero], [c, s, zero]])
    bend = np.append(hook, np.ones(modes)) if jointed else np.ones(modes)  # type: ignore[arg-type]
    stiffness = np.stack([bend, bend, twisting * bend])
    made = replace(plain, stiffness=stiffness, base=turned)
    if rest is None:
        return made
    rod_nodes, arm = made.on_rod, rest.arm
    own = (rest.strains(made.s[rod_nodes]) * made.weight[rod_nodes]) @ made.curvatures[rod_nodes]
    about_r = np.array([[c, -s, zero], [s, c, zero], [zero, zero, 1.0 + zero]])
    made = replace(made, rest=own, base=rest.base @ about_r.T)
    size = np.sqrt(arm @ arm)
    if not size:
        return made
    along, heading = (a.astype(arm.dtype) for a in (made.along, made.heading))
    joint = np.flatnonzero(~rod_nodes)[-1]
    along[rod_nodes, joint] = size
    heading[joint] = rest.base @ arm / size
    return replace(made, along=along, heading=heading)


@lru_cache(64)
def _nodes(modes: int, jointed: bool) -> Filament:
    """A straight filament along s: hook (or none), arm of no length, rod."""
    made: Rod = rod(modes)
    m, x, w = len(made.s), *gauss(HOOK_NODES)
    h = HOOK_NODES if jointed else 0
    total = h + 1 + m
    along, turns = np.zeros((2, total, total))
    along[h + 1 :, h + 1 :] = turns[h + 1 :, h + 1 :] = made.along
    first = 1 if jointed else 0
    curvatures = np.zeros((total, first + modes))
    curvatures[h + 1 :, first:] = made.curvatures
    if jointed:
        powers = np.vander(x, h, increasing=True)
        reached = x[:, None] ** np.arange(1, h + 1) / np.arange(1, h + 1)
        turns[:h, :h] = np.linalg.solve(powers.T, reached.T).T
        turns[h:, :h] = w
        curvatures[:h, 0] = 1.0
    heading = np.tile([0.0, 0.0, 1.0], (total, 1))
    padded = np.zeros((3, h + 1))
    s, weight, end = (
        np.concatenate([p, v]) for p, v in zip(padded, (made.s, made.weight, made.end))
    )
    n = first + modes
    return Filament(s, weight, end, along, turns, heading, curvatures, np.ones((3, n)),
                    np.zeros((3, n)), np.eye(3))  # fmt: skip
