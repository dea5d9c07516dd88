"""Loops over patches and targets: matrix blocks, own patches, stress.

The interpreter's lock is released; threads take every n-th patch.
"""

from __future__ import annotations

import numpy as np

from microswim.models.bem.kernels import (
    CELLS,
    add_nodal,
    add_nodal_image,
    add_patch,
    add_stress,
    frame_cell,
)
from microswim.numerics.compiling.compiled import njit


@njit(cache=True, nogil=True)
def layer_blocks(
    start, step, targets, own, wall, mode, near, far,
    controls, nodes, areas, V, D, M, S, B, W, half, out,
):  # fmt: skip
    """Fill out[3 i + k, 3 b + j] with the integrals of G_kj phi_b for every target i.

    Parameters
    ----------
    start, step : the patches start, start + step, ... are done; columns of others are left alone,
        so threads may share `out` (the interpreter's lock is released).
    targets : (t, 3); own : (t,) patch that holds the target, which is left out, or -1; with -2 all
        are left out and the image alone is filled.
    wall : (6,) point and normal; mode 0: free space alone, 1: with Blake's image added.
    near, far : half lengths away at which a cell is whole, at which the plain rule serves.
    controls (e, q, q, 3), nodes (e, p*p, 3), areas (e, p*p): the patches.
    V, D, M, S, B, W, half : tables of the cells.
    out : (>= 3 t, 3 e p^2), Fortran order.
    """
    patches, p2 = areas.shape
    free = np.int64(0) * mode
    g = V.shape[1]
    frames = np.empty((CELLS * CELLS, 5))
    points = np.empty((CELLS * CELLS, 4, g * g))
    known = np.empty(CELLS * CELLS, dtype=np.uint8)
    K = np.empty((9, g * g))
    stack = np.empty((256, 4), dtype=np.int64)
    acc = np.empty((p2, 9))
    none = np.empty((0, 3))
    y = np.empty(3)
    for e in range(start, patches, step):
        known[:] = 0
        C = controls[e]
        frame_cell(C, M, S, half, free, free, frames[0])
        known[0] = 1
        f = frames[0].copy()
        reach = far * max(f[3], f[4])
        for i in range(targets.shape[0]):
            x = targets[i]
            row = 3 * i
            if own[i] != e and own[i] != -2:
                acc[:] = 0.0
                d0, d1, d2 = x[0] - f[0], x[1] - f[1], x[2] - f[2]
                if d0 * d0 + d1 * d1 + d2 * d2 > reach * reach:
                    add_nodal(x, nodes[e], areas[e], acc)
                else:
                    add_patch(
                        x, x, wall, free, near, C, V, D, M, S, B, W, half, none,
                        frames, points, known, K, stack, acc,
                    )  # fmt: skip
                for b in range(p2):
                    col = 3 * (e * p2 + b)
                    out[row, col] = acc[b, 0]
                    out[row + 1, col] = acc[b, 1]
                    out[row + 2, col] = acc[b, 2]
                    out[row, col + 1] = acc[b, 1]
                    out[row + 1, col + 1] = acc[b, 3]
                    out[row + 2, col + 1] = acc[b, 4]
                    out[row, col + 2] = acc[b, 2]
                    out[row + 1, col + 2] = acc[b, 4]
                    out[row + 2, col + 2] = acc[b, 5]
            if mode == 1:
                acc[:] = 0.0
                height = 0.0
                for c in range(3):
                    height += (x[c] - wall[c]) * wall[3 + c]
                for c in range(3):
                    y[c] = x[c] - 2.0 * height * wall[3 + c]
                d0, d1, d2 = y[0] - f[0], y[1] - f[1], y[2] - f[2]
                if d0 * d0 + d1 * d1 + d2 * d2 > reach * reach:
                    add_nodal_image(x, wall, nodes[e], areas[e], acc)
                else:
                    add_patch(
                        x, y, wall, mode, near, C, V, D, M, S, B, W, half, none,
                        frames, points, known, K, stack, acc,
                    )  # fmt: skip
                for b in range(p2):
                    for k in range(3):
                        for j in range(3):
                            out[row + k, 3 * (e * p2 + b) + j] += acc[b, 3 * k + j]


@njit(cache=True, fastmath=True)
def own_blocks(patches, rows, nodes, points, areas, basis, p2, out):
    """Fill the blocks of each node on its own patch by the singular rule.

    Parameters
    ----------
    patches : (n,) indices of the patches; rows : place of each node's rows, -1 if it has none;
    nodes : (n, p*p, 3) their collocation points.
    points : (n, p*p, m, 3), areas : (n, p*p, m) the rule's points and weighted areas.
    basis : (p*p, m, p*p) densities at the points.
    """
    acc = np.empty((p2, 6))
    for n in range(patches.size):
        for i in range(p2):
            row = 3 * rows[patches[n] * p2 + i]
            if row < 0:
                continue
            x = nodes[n, i]
            acc[:] = 0.0
            for k in range(points.shape[2]):
                d0 = x[0] - points[n, i, k, 0]
                d1 = x[1] - points[n, i, k, 1]
                d2 = x[2] - points[n, i, k, 2]
                inverse = 1.0 / np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
                w = areas[n, i, k] * inverse
                t = w * inverse * inverse
                k0, k1, k2 = w + t * d0 * d0, t * d0 * d1, t * d0 * d2
                k3, k4, k5 = w + t * d1 * d1, t * d1 * d2, w + t * d2 * d2
                for b in range(p2):
                    phi = basis[i, k, b]
                    acc[b, 0] += phi * k0
                    acc[b, 1] += phi * k1
                    acc[b, 2] += phi * k2
                    acc[b, 3] += phi * k3
                    acc[b, 4] += phi * k4
                    acc[b, 5] += phi * k5
            for b in range(p2):
                col = 3 * (patches[n] * p2 + b)
                for j in range(3):
                    for c in range(3):
                        low, high = min(c, j), max(c, j)
                        out[row + c, col + j] += acc[b, low * (5 - low) // 2 + high]


@njit(cache=True, nogil=True)
def stress_sums(
    start, step, targets, normals, own, near, far, controls, nodes, areas, density,
    V, D, M, S, B, W, half, out,
):  # fmt: skip
    """Add int r_i r_j f_j (r . n) / r^5 dS over other patches than the target's own to out (t, 3).

    density : (e, p*p, 3) of one flow; the patches start, start + step, ... are done.
    """
    patches, p2 = density.shape[:2]
    g = V.shape[1]
    frames = np.empty((CELLS * CELLS, 5))
    points = np.empty((CELLS * CELLS, 7, g * g))
    known = np.empty(CELLS * CELLS, dtype=np.uint8)
    stack = np.empty((256, 4), dtype=np.int64)
    K, acc = np.empty((0, 0)), np.empty((1, 3))
    plane, node = np.zeros(6), np.empty((7, p2))
    mode = np.int64(2)
    for e in range(start, patches, step):
        known[:] = 0
        frame_cell(controls[e], M, S, half, 0 * mode, 0 * mode, frames[0])
        known[0] = 1
        f = frames[0].copy()
        reach = far * max(f[3], f[4])
        node[:3], node[3], node[4:] = nodes[e].T, areas[e], density[e].T
        for i in range(targets.shape[0]):
            if own[i] == e:
                continue
            x = targets[i]
            acc[:] = 0.0
            plane[3:] = normals[i]
            d0, d1, d2 = x[0] - f[0], x[1] - f[1], x[2] - f[2]
            if d0 * d0 + d1 * d1 + d2 * d2 > reach * reach:
                add_stress(x, plane[3], plane[4], plane[5], node, acc[0])
            else:
                add_patch(
                    x, x, plane, mode, near, controls[e], V, D, M, S, B, W, half, density[e],
                    frames, points, known, K, stack, acc,
                )  # fmt: skip
            out[i] += acc[0]
