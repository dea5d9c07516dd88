"""The corrected surrogate as Python, many designs side by side: what `region.evaluate` compiles.

The same lines run (`Kernel.written`), each number an array of designs, which stand in the last
axis; nodes of the tail stand side by side too. One gait so takes about a millisecond.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.calibration.atlas import alone
from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region import positive_definite as blocks
from microswim.calibration.region.beats import HALF, OTHER_HAND, PHASES, beat, scales
from microswim.calibration.region.surfaces import Surfaces
from microswim.models.rft.plane_wave import fill_rows
from microswim.models.rft.segment import RAMP
from microswim.numerics.matern import matern_of_arrays
from microswim.numerics.series.fourier import MIRROR_Q, MIRROR_R
from microswim.numerics.solve6 import solve
from microswim.swimmer.swimmer import Swimmer

SHARES = slice(10, 13)  #: corrections of a helix: of the force on the body alone


def predicted(surfaces: Surfaces, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
    """Return what `surfaces.predict` writes, of designs Z (k, f) and N (k,): (columns, k)."""
    every, tips, lengths, phasors, cut, alpha, mean = surfaces.packed
    out = np.empty((len(mean), len(Z)), dtype=np.result_type(Z, N))
    turns = _turns(N, tips, int(np.count_nonzero(phasors[:, :3].any(axis=0))))
    for g, nodes in enumerate(every[:, : Z.shape[1]]):
        k = matern_of_arrays(np.array([_squared(nodes - z[:, None]) for z in Z * lengths[g]]))
        part, used = slice(cut[g], cut[g + 1]), [m for m in range(3) if phasors[g, m] > 0]
        even = k * (1.0 + sum(phasors[g, m] * turns[m][0] for m in used))
        if phasors[g, 3] == 0.0:
            out[part] = (even @ alpha[part].T).T
            continue
        odd = k * sum(phasors[g, m] * turns[m][1] for m in used)
        a, b = alpha[part][::2].T, alpha[part][1::2].T
        out[part][::2] = (even @ a + odd @ b).T
        out[part][1::2] = (even @ b - odd @ a).T
    return out + mean[:, None]


def _squared(d: np.ndarray) -> np.ndarray:
    """Return the sums of squares of columns (f, n)."""
    return np.einsum("fn,fn->n", d, d)


def _turns(N: np.ndarray, tips: np.ndarray, most: int) -> list[tuple[Any, Any]]:
    """Return cosine and sine of one, two, ... times the angle between tips, each (k, n)."""
    c0, s0 = np.cos(2.0 * np.pi * N)[:, None], np.sin(2.0 * np.pi * N)[:, None]
    c, s = c0 * tips[0] + s0 * tips[1], s0 * tips[0] - c0 * tips[1]
    out = [(c, s)]
    for _ in range(1, most):
        out.append((out[-1][0] * c - out[-1][1] * s, out[-1][1] * c + out[-1][0] * s))
    return out


def base(swimmer: Swimmer, phases: Any) -> tuple[Any, ...]:
    """Return R_0 (6, 6, ...), F_0 (6, ...), G_0 of the left-handed tail, and D (6, ...).

    Behind the first axes stand those of `phases`, a number or (m,), then the designs'.
    """
    p = np.moveaxis(shaded.parameters(swimmer), -1, 0)
    D = np.array(np.broadcast_arrays(*swimmer.body.diagonal(swimmer.fluid.viscosity)))
    kind, each = np.result_type(p, D), np.broadcast_shapes(p.shape[1:], D.shape[1:])
    p = np.broadcast_to(p.reshape(11, *[1] * (len(each) + 1 - p.ndim), *p.shape[1:]), (11, *each))
    nodes = _nodes(p, shaded.sizes(swimmer.tail.number_of_waves), each)
    lead = np.shape(phases)
    at = np.reshape(phases, (*lead, 1, *[1] * len(each)))
    shape = (*lead, nodes.shape[1], *each)
    R, F = np.zeros((6, 6, *shape), dtype=kind), np.zeros((6, *shape), dtype=kind)
    row = nodes[:, None].reshape(7, 1, *[1] * len(lead), *nodes.shape[1:])
    G = shaded.add_tail.written(R, F, p, row, at, shaded.hand(swimmer))
    along = 2 + len(lead)
    R, F, G = R.sum(axis=along), F.sum(axis=along - 1), G.sum(axis=along - 2)
    for i in range(6):
        R[i, i] += D[i]
    upper = np.triu_indices(6, 1)
    R[upper] = R.swapaxes(0, 1)[upper]
    return R, F, G, D


def _nodes(p: np.ndarray, sizes: Any, each: tuple[int, ...]) -> np.ndarray:
    """Return the nodes of `body_flow.table` in rows (7, nodes, ...); the last is the tip.

    Designs that take fewer nodes than the most repeat the tip, with weight zero; those without a
    ramp on all of its nodes.
    """
    ramp_rule, xi, weight = shaded.rules(int(np.max(sizes)))
    wanted = np.broadcast_to(sizes, each)
    rule = (np.moveaxis(table[wanted], -1, 0) for table in (xi, weight))
    rows = [x.reshape(-1, *[1] * len(each)) for x in ramp_rule]
    nodes = np.zeros((7, len(rows[0]) + xi.shape[1], *each), dtype=p.dtype)
    with np.errstate(all="ignore"):
        fill_rows(nodes, p, rows, tuple(rule))
    flat = np.broadcast_to(p[RAMP] == 0, each)
    if flat.any():
        nodes[:, : len(rows[0])] = np.where(flat, nodes[:, -1:], nodes[:, : len(rows[0])])
    nodes[6, -1] = 1.0
    return nodes


def rebuilt(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, ...]:
    """Return R (n, m, 6, 6), F_p (n, m, 6), G (n, m), the body's share (n, 3), as `matrices` does.

    From corrections y (columns, ...) of n designs, or of one.
    """
    turning = _alone if swimmer.body.is_absent else _helix
    known = turning if swimmer.tail.is_rigid else _wave
    made = known(swimmer, y)
    if made[2].ndim == 1:  # one design
        made = tuple(x[..., None] for x in made)
    return tuple(np.moveaxis(x, -1, 0) for x in made)


def _helix(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, ...]:
    """R (1, 6, 6, ...), F_p (1, 6, ...), G (1, ...) at phase 0 and the body's share (3, ...)."""
    R, F, G, D = base(swimmer, 0.0)
    a, mu = swimmer.body.semi_axes3[0], swimmer.fluid.viscosity
    kind = np.result_type(R, y)
    R, F = R.astype(kind), F.astype(kind)
    lateral = np.concatenate([y[: blocks.REAL], y[SHARES.stop :]])
    G = blocks.decode_helix.written(lateral, R, F, G, a, mu, D[3])
    drag, couple, held = y[SHARES]
    extra = np.array([D[0] * np.exp(drag), couple * mu * a * a, held * mu * a * a])
    if swimmer.tail.sign < 0:
        mirror = MIRROR_R.reshape(-1, *[1] * (F.ndim - 1))
        R, F = R * mirror * mirror[:, None], F * mirror
        extra = extra * OTHER_HAND.reshape(mirror[:3].shape)
    return R[None], F[None], np.asarray(G)[None], extra


def _alone(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, ...]:
    """The same of a helix without a body."""
    R = alone.decode(y, base(swimmer, 0.0)[0], swimmer.tail.apparent_length)
    F, G = np.array(R[:, 3]), R[3, 3]
    if swimmer.tail.sign < 0:
        mirror = MIRROR_R.reshape(-1, *[1] * (F.ndim - 1))
        R, F = R * mirror * mirror[:, None], F * mirror
    return R[None], F[None], G[None], np.zeros((3, *G.shape), R.dtype)


def _wave(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, ...]:
    """R (m, 6, 6, ...), F_p (m, 6, ...), G (m, ...) over the period, the body's share (3, ...)."""
    R, F, G, D = base(swimmer, np.array(PHASES))
    kind = np.result_type(R, y)
    R, F, G = (x.astype(kind) for x in (np.moveaxis(R, 2, 0), np.moveaxis(F, 1, 0), G))
    scale, a = scales.written(R, F, G), shaded.unit(swimmer)
    for j in range(HALF):
        now = beat.written(y, PHASES[j])
        G[j] = blocks.decode_wave.written(now, R[j], F[j], G[j], a, scale)
    mirror = MIRROR_Q.reshape(-1, *[1] * (F.ndim - 2))
    extra = np.zeros((3, *G.shape[1:]), dtype=kind)
    extra[0] = D[0]
    both = (R, R * mirror * mirror[:, None]), (F, F * mirror), (G, G)
    return *(np.concatenate(pair) for pair in both), extra


def twists(R: np.ndarray, F: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return ``-R^-1 F_p`` (n, m, 6) on the free degrees of freedom."""
    A, V = np.array(np.moveaxis(R, (-2, -1), (0, 1))), np.array(np.moveaxis(-F, -1, 0))
    solve.written(A, V, free)
    return np.moveaxis(V, 0, -1)
