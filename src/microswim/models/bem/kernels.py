"""Numba kernels of the single layer: u(x) = 1/(8 pi mu) int G(x, y) f(y) dS(y).

    G_ij = delta_ij / r + r_i r_j / r^3,  r = x - y                         (free space)

Far patches take the plain Gauss rule, nearer ones a finer rule on cells that are halved until each
lies `near` half lengths from the target. Cells of a patch are evaluated once and kept for all
targets. Everything here is without the factor 1/(8 pi mu).
"""

from __future__ import annotations

import numpy as np

from microswim.numerics.compiling.compiled import njit

LEVELS = 8
CELLS = 2**LEVELS - 1


@njit(cache=True, fastmath=True)
def evaluate_cell(C, V, D, W, a, b, out):
    """Return points and weighted areas (4, g*g) of the cell (a, b) of a patch with geometry C (q,
    q,
    3).
    """
    g, q = V.shape[1], V.shape[2]
    for m in range(g):
        for n in range(g):
            X0 = X1 = X2 = U0 = U1 = U2 = T0 = T1 = T2 = 0.0
            for i in range(q):
                p0 = p1 = p2 = s0 = s1 = s2 = 0.0
                for j in range(q):
                    v, d = V[b, n, j], D[b, n, j]
                    p0 += v * C[i, j, 0]
                    p1 += v * C[i, j, 1]
                    p2 += v * C[i, j, 2]
                    s0 += d * C[i, j, 0]
                    s1 += d * C[i, j, 1]
                    s2 += d * C[i, j, 2]
                v, d = V[a, m, i], D[a, m, i]
                X0 += v * p0
                X1 += v * p1
                X2 += v * p2
                U0 += d * p0
                U1 += d * p1
                U2 += d * p2
                T0 += v * s0
                T1 += v * s1
                T2 += v * s2
            n0, n1, n2 = U1 * T2 - U2 * T1, U2 * T0 - U0 * T2, U0 * T1 - U1 * T0
            k = m * g + n
            out[0, k], out[1, k], out[2, k] = X0, X1, X2
            out[3, k] = W[a, m] * W[b, n] * np.sqrt(n0 * n0 + n1 * n1 + n2 * n2)


@njit(cache=True, fastmath=True)
def frame_cell(C, M, S, half, a, b, out):
    """Return the centre and half lengths (5,) of the cell (a, b)."""
    q = M.shape[1]
    out[:] = 0.0
    u = np.zeros(3)
    v = np.zeros(3)
    for i in range(q):
        for j in range(q):
            for c in range(3):
                x = C[i, j, c]
                out[c] += M[a, i] * M[b, j] * x
                u[c] += S[a, i] * M[b, j] * x
                v[c] += M[a, i] * S[b, j] * x
    out[3] = half[a] * np.sqrt(u[0] ** 2 + u[1] ** 2 + u[2] ** 2)
    out[4] = half[b] * np.sqrt(v[0] ** 2 + v[1] ** 2 + v[2] ** 2)


@njit(cache=True, fastmath=True)
def add_free(x, P, Ba, Bb, K, acc):
    """Add the free-space integral over one cell to acc (p*p, 9): rows i, columns j of G."""
    n = P.shape[1]
    for k in range(n):
        d0, d1, d2 = x[0] - P[0, k], x[1] - P[1, k], x[2] - P[2, k]
        inverse = 1.0 / np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        w = P[3, k] * inverse
        t = w * inverse * inverse
        K[0, k] = w + t * d0 * d0
        K[1, k] = t * d0 * d1
        K[2, k] = t * d0 * d2
        K[3, k] = w + t * d1 * d1
        K[4, k] = t * d1 * d2
        K[5, k] = w + t * d2 * d2
    add_products(K, 6, Ba, Bb, acc)


@njit(cache=True, fastmath=True)
def image(x, wall, y0, y1, y2, G):
    """Write Blake's image tensor, rows i, columns j, to G (9,); wall = (point, normal into fluid).

    With R = x - y', y' the mirror image of y at height h, n the normal, Delta_jk = delta - 2 n n:
    G^im_ij = -(delta_ij/R + R_i R_j/R^3)
              + 2 h Delta_jk d/dR_k [ h R_i/R^3 - (n_i/R + R_i R_n/R^3) ]          [Blake 1971]
    """
    N = (wall[3], wall[4], wall[5])
    h = (y0 - wall[0]) * N[0] + (y1 - wall[1]) * N[1] + (y2 - wall[2]) * N[2]
    R = (x[0] - y0 + 2.0 * h * N[0], x[1] - y1 + 2.0 * h * N[1], x[2] - y2 + 2.0 * h * N[2])
    i2 = 1.0 / (R[0] * R[0] + R[1] * R[1] + R[2] * R[2])
    i1 = np.sqrt(i2)
    i3 = i1 * i2
    Rn = R[0] * N[0] + R[1] * N[1] + R[2] * N[2]
    for i in range(3):
        # M_in = M_ik n_k, M_ik the derivative in R_k of the bracket above
        Mn = h * i3 * (N[i] - 3.0 * R[i] * Rn * i2) + i3 * (3.0 * R[i] * Rn * Rn * i2 - R[i])
        for j in range(3):
            same = 1.0 if i == j else 0.0
            M = h * i3 * (same - 3.0 * R[i] * R[j] * i2)
            M += i3 * (N[i] * R[j] - same * Rn - R[i] * N[j] + 3.0 * i2 * R[i] * Rn * R[j])
            G[3 * i + j] = 2.0 * h * (M - 2.0 * Mn * N[j]) - i1 * (same + R[i] * R[j] * i2)


@njit(cache=True, fastmath=True)
def add_image(x, wall, P, Ba, Bb, K, acc):
    """Add the integral of Blake's image over one cell to acc (p*p, 9); K (>= 9, g*g) is scratch."""
    G = np.empty(9)
    for k in range(P.shape[1]):
        image(x, wall, P[0, k], P[1, k], P[2, k], G)
        for c in range(9):
            K[c, k] = P[3, k] * G[c]
    add_products(K, 9, Ba, Bb, acc)


@njit(cache=True, fastmath=True)
def add_products(K, rows, Ba, Bb, acc):
    """Add sum_mk K[c, m k] Ba[m, a] Bb[k, b] to acc[a b, c] for the first rows c of K."""
    g, p = Ba.shape
    for c in range(rows):
        for bv in range(p):
            for m in range(g):
                part = 0.0
                for k in range(g):
                    part += Bb[k, bv] * K[c, m * g + k]
                for bu in range(p):
                    acc[bu * p + bv, c] += Ba[m, bu] * part


@njit(cache=True, fastmath=True)
def add_nodal_image(x, wall, X, A, acc):
    """Add the plain rule for Blake's image: nodes X (p*p, 3) with areas A (p*p,)."""
    G = np.empty(9)
    for b in range(A.size):
        image(x, wall, X[b, 0], X[b, 1], X[b, 2], G)
        for c in range(9):
            acc[b, c] += A[b] * G[c]


@njit(cache=True, fastmath=True)
def evaluate_flow(flow, Ba, Bb, out):
    """Write the density of a flow with values (p*p, 3) at the nodes to out (3, g*g) of a cell."""
    g, p = Ba.shape
    for c in range(3):
        for m in range(g):
            for q in range(g):
                value = 0.0
                for bu in range(p):
                    for bv in range(p):
                        value += Ba[m, bu] * Bb[q, bv] * flow[bu * p + bv, c]
                out[c, m * g + q] = value


@njit(cache=True, fastmath=True)
def add_stress(x, n0, n1, n2, P, acc):
    """Add sum_k w r (r . f) (r . n) / r^5 to acc (3,), r = x - y, n the target's normal.

    P : (7, m), rows y, w, f of the points.
    """
    s0, s1, s2 = 0.0, 0.0, 0.0
    for k in range(P.shape[1]):
        d0, d1, d2 = x[0] - P[0, k], x[1] - P[1, k], x[2] - P[2, k]
        i2 = 1.0 / (d0 * d0 + d1 * d1 + d2 * d2)
        w = P[3, k] * (d0 * n0 + d1 * n1 + d2 * n2) * i2 * i2 * np.sqrt(i2)
        w *= d0 * P[4, k] + d1 * P[5, k] + d2 * P[6, k]
        s0 += w * d0
        s1 += w * d1
        s2 += w * d2
    acc[0] += s0
    acc[1] += s1
    acc[2] += s2


@njit(cache=True, fastmath=True)
def add_patch(
    x, y, wall, image, near, C, V, D, M, S, B, W, half, flow, frames, points, known, K, stack, acc
):
    """Add one patch's integral for the target x; y = x or, for the image, x mirrored at the wall.

    image: 0 free space, 1 Blake's image, 2 stress of `flow` (p*p, 3) on the plane through x with
    normal wall[3:6], then to acc[0].
    """
    top = 1
    stack[0, :] = 0
    while top > 0:
        top -= 1
        lu, iu, lv, iv = stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3]
        a, b = (1 << lu) - 1 + iu, (1 << lv) - 1 + iv
        cell = a * CELLS + b
        if known[cell] == 0:
            frame_cell(C, M, S, half, a, b, frames[cell])
            known[cell] = 1
        f = frames[cell]
        d0, d1, d2 = y[0] - f[0], y[1] - f[1], y[2] - f[2]
        distance = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        cut_u = distance < near * f[3] and lu < LEVELS - 1
        cut_v = distance < near * f[4] and lv < LEVELS - 1
        if not (cut_u or cut_v):
            if known[cell] == 1:
                evaluate_cell(C, V, D, W, a, b, points[cell])
                if image == 2:
                    evaluate_flow(flow, B[a], B[b], points[cell, 4:])
                known[cell] = 2
            if image == 1:
                add_image(x, wall, points[cell], B[a], B[b], K, acc)
            elif image == 2:
                add_stress(x, wall[3], wall[4], wall[5], points[cell], acc[0])
            else:
                add_free(x, points[cell], B[a], B[b], K, acc)
            continue
        for cu in range(2 if cut_u else 1):
            for cv in range(2 if cut_v else 1):
                stack[top, 0], stack[top, 1] = (lu + 1, 2 * iu + cu) if cut_u else (lu, iu)
                stack[top, 2], stack[top, 3] = (lv + 1, 2 * iv + cv) if cut_v else (lv, iv)
                top += 1


@njit(cache=True, fastmath=True)
def add_nodal(x, X, A, acc):
    """Add the plain rule: nodes X (p*p, 3) with areas A (p*p,), in free space."""
    for b in range(A.size):
        d0, d1, d2 = x[0] - X[b, 0], x[1] - X[b, 1], x[2] - X[b, 2]
        inverse = 1.0 / np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        w = A[b] * inverse
        t = w * inverse * inverse
        acc[b, 0] += w + t * d0 * d0
        acc[b, 1] += t * d0 * d1
        acc[b, 2] += t * d0 * d2
        acc[b, 3] += w + t * d1 * d1
        acc[b, 4] += t * d1 * d2
        acc[b, 5] += w + t * d2 * d2
