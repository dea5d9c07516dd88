r"""Helices without a body: R alone, since a tail that turns against nothing turns itself.

    F_p = R e_os,    G = R_OO

R at phase 0 of the left-handed helix is ``L diag(A, S, T) L'`` in the order (us, os), (uq, ur),
(oq, or), as in `region.positive_definite`, of which K and W are blocks of L; with a nought that of
the base, and l the tail's length. The traceless part of a logarithm is a complex number c,
``S = s exp [[Re c, Im c], [Im c, -Re c]]``. Whatever the corrections y say, A, S and T come out
positive definite:

    y0 ln A'/A'_0    y1 ln A_OO/A_OO,0    y2 ln A_sO/A_sO,0    y3 ln s/s_0    y4 ln t/t_0
    y5, y6 turn-invariant part of (K - K_0)/l
    y7... as complex numbers: c_S, c_T, the rest of K, the columns of W, less those of the base

with ``A' = A_ss - A_sO^2/A_OO``. Vectors q + i r turn with the tail, c and K by twice its angle.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.calibration.region.positive_definite import split

ORDER = np.array([0, 3, 1, 2, 4, 5])
REAL, COLUMNS = 7, 21  #: invariant corrections; with the real and imaginary parts of others
PAIRS = ((2, 3), (4, 5))  #: where S and T stand


def encode(R: Any, R0: Any, length: Any) -> np.ndarray:
    """Return the corrections y (21, ...) that take R0 to R, both (6, 6, ...)."""
    (axial, logs, K, complex_), base = _parts(R, length), _parts(R0, length)
    invariant = [np.log(a / b) for a, b in zip(axial, base[0])]
    invariant += [a - b for a, b in zip((*logs, *K), (*base[1], *base[2]))]
    return np.array([*invariant, *(a - b for a, b in zip(complex_, base[3]))])


def _parts(R: Any, length: Any) -> tuple[list[Any], ...]:
    """Return A', A_OO, A_sO; ln s, ln t; K's invariant part; and what turns with the tail."""
    L, C = split.written(np.asarray(R))
    axial = [C[0, 0] - C[0, 1] ** 2 / C[1, 1], C[1, 1], C[0, 1]]
    logs, turning = [], []
    for i, j in PAIRS:
        log, *c = _logarithm(C[i, i], C[i, j], C[j, j])
        logs.append(log)
        turning += c
    K, W = L[4:, 2:4] / length, L[2:, :2]
    turning += [(K[0, 0] - K[1, 1]) / 2.0, (K[1, 0] + K[0, 1]) / 2.0]
    for column in (W[:2, 0], W[:2, 1] * length, W[2:, 0] / length, W[2:, 1]):
        turning += [*column]
    return axial, logs, [(K[0, 0] + K[1, 1]) / 2.0, (K[1, 0] - K[0, 1]) / 2.0], turning


def decode(y: Any, R0: Any, length: Any) -> Any:
    """Return R (6, 6, ...) from corrections y (21, ...) of R0; undoes `encode`, analytic."""
    axial, logs, K, turning = _parts(R0, length)
    known = [*logs, *K, *turning]
    first, rotation, couple = (a * np.exp(log) for a, log in zip(axial, y[:3]))
    s, t, k0, k1, *c = (a + b for a, b in zip(known, y[3:]))
    L, C = (np.zeros((6, 6, *np.shape(first)), np.result_type(first, s)) for _ in range(2))
    for i in range(6):
        L[i, i] = 1.0
    C[1, 1], C[0, 1], C[1, 0] = rotation, couple, couple
    C[0, 0] = first + couple**2 / rotation
    for (i, j), log, (x, z) in zip(PAIRS, (s, t), (c[:2], c[2:4])):
        even, odd = _exponential(x * x + z * z)
        C[i, i], C[j, j] = np.exp(log) * (even + odd * x), np.exp(log) * (even - odd * x)
        C[i, j] = C[j, i] = np.exp(log) * odd * z
    L[4, 2], L[5, 3] = (k0 + c[4]) * length, (k0 - c[4]) * length
    L[5, 2], L[4, 3] = (c[5] + k1) * length, (c[5] - k1) * length
    (L[2, 0], L[3, 0]), (L[2, 1], L[3, 1]) = c[6:8], (c[8] / length, c[9] / length)
    (L[4, 0], L[5, 0]), (L[4, 1], L[5, 1]) = (c[10] * length, c[11] * length), c[12:14]
    R = np.empty_like(C)
    R[np.ix_(ORDER, ORDER)] = np.einsum("ij...,jk...,lk...->il...", L, C, L)
    return R


def _logarithm(p: Any, q: Any, r: Any) -> tuple[Any, Any, Any]:
    """Return ln s and c of a block [[p, q], [q, r]]."""
    middle, x, z = (p + r) / 2.0, (p - r) / 2.0, q
    share = np.sqrt((x * x + z * z) / (middle * middle) + 1e-30)
    size = np.log((1.0 + share) / (1.0 - share)) / (2.0 * share * middle)
    return np.log(p * r - q * q) / 2.0, x * size, z * size


def _exponential(square: Any) -> tuple[Any, Any]:
    """Return cosh and sinh over its argument, by the argument's square, analytic."""
    root = np.sqrt(square + 1e-30)
    return np.cosh(root), np.sinh(root) / root
