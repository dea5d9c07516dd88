"""Corrections of R and F_p between a base and the truth, positive definite by construction.

Rigid helix at phase 0, blocks axial ``a = (us, os)``, lateral forces ``u = (uq, ur)`` and lateral
turns ``o = (oq, or)``:  ``R = L diag(A, S, T) L'`` with ``W = R_ua,oa A^-1`` (4x2), ``K`` (2x2).
Whatever the corrections y say, A, S, T come out positive definite:

    y0 ln F_s/F_s0    y1 ln T_s/T_s0    y2 B_s - B_s0    y3 ln B_O/D    y4 ln A_s/A_s0    y5 ln G/G0
    y6 ln tr S/tr S0  y7 ln tr T/tr T0  y8, y9 K - K0 (turn-invariant part)    y10... W - W0, B_lat

``B = R e_os - F_p`` is the wrench that turns the body alone (whole less tail), D the isolated
resistance, ``A_s = R_ss - R_sO^2/R_OO``. Lateral vectors are complex numbers q + i r: they turn
with the tail. A plane wave splits by its mirror plane into (us, uq, or) and (ur, os, oq), each
``R = L D L'``. Lengths are in units of r_s.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import compiled

REAL, VECTORS = 10, 6  #: helix: invariant corrections, and lateral vectors
PLANES = ((0, 1, 5), (2, 3, 4))  #: plane wave: in the plane of the wave, and out of it
EVEN = (6, 0, 3, 4, 5, 9, 10, 12, 13, 15)  #: plane wave: corrections alike after half a period
ODD = (1, 2, 7, 8, 11, 14)  #: and those that change sign
_ORDER = (0, 3, 1, 2, 4, 5)


@compiled()
def split(R: Any) -> Any:
    """Return the unit lower L and block diagonal C with ``P R P' = L C L'``, P the order 0, 3, 1,
    2, 4, 5.
    """
    L, C = np.zeros_like(R), np.empty_like(R)
    for i in range(6):
        L[i, i] += 1.0
        for j in range(6):
            C[i, j] = R[_ORDER[i], _ORDER[j]]
    for i in (0, 2):
        j = i + 1
        det = C[i, i] * C[j, j] - C[i, j] * C[j, i]
        for r in range(i + 2, 6):
            L[r, i] = (C[r, i] * C[j, j] - C[r, j] * C[j, i]) / det
            L[r, j] = (C[r, j] * C[i, i] - C[r, i] * C[i, j]) / det
        for r in range(i + 2, 6):
            for s in range(i + 2, 6):
                C[r, s] -= L[r, i] * C[i, s] + L[r, j] * C[j, s]
        for r in range(i + 2, 6):
            C[r, i] = C[r, j] = C[i, r] = C[j, r] = 0 * det
    return L, C


@compiled()
def join(R: Any, L: Any, C: Any) -> None:
    """Fill R (6, 6) from L and C."""
    for i in range(6):
        for j in range(i + 1):
            total = 0 * C[0, 0]
            for k in range(0, j + 1, 2):
                a, b = L[i, k], L[i, k + 1]
                total += (a * C[k, k] + b * C[k + 1, k]) * L[j, k]
                total += (a * C[k, k + 1] + b * C[k + 1, k + 1]) * L[j, k + 1]
            R[_ORDER[i], _ORDER[j]] = R[_ORDER[j], _ORDER[i]] = total


def encode_helix(R: Any, F: Any, G: Any, R0: Any, F0: Any, G0: Any, a: Any, mu: Any, D: Any) -> Any:
    """Return corrections y (22,): 10 invariant, then real and imaginary parts of 6 vectors."""
    (L, C), (L0, C0) = split(R), split(R0)
    force, torque = mu * a**2, mu * a**3
    B, B0 = R[:, 3] - F, R0[:, 3] - F0
    axial = [x[0, 0] - x[0, 1] ** 2 / x[1, 1] for x in (C, C0)]
    lateral = [[x[i, i] + x[i + 1, i + 1] for x in (C, C0)] for i in (2, 4)]
    K, W = (L - L0)[4:, 2:4] / a, (L - L0)[2:, :2]
    invariant = [
        *(np.log(F[0] / F0[0]), np.log(F[3] / F0[3])),
        *((B[0] - B0[0]) / force, np.log(B[3] / D), np.log(axial[0] / axial[1]), np.log(G / G0)),
        *(np.log(pair[0] / pair[1]) for pair in lateral),
        *((K[0, 0] + K[1, 1]) / 2.0, (K[1, 0] - K[0, 1]) / 2.0),
    ]
    vectors = [W[:2, 0], W[:2, 1] * a, W[2:, 0] / a, W[2:, 1]]
    vectors += [-(B - B0)[1:3] / force, -(B - B0)[4:] / torque]
    return np.concatenate([invariant, *vectors])


@compiled()
def decode_helix(y: Any, R: Any, F: Any, G: Any, a: Any, mu: Any, D: Any) -> Any:
    """Apply the corrections to R and ``F_p``, and return G; undoes `encode_helix`."""
    L, C = split(R)
    force, torque = mu * a * a, mu * a * a * a
    for i in (1, 2, 4, 5):
        F[i] -= R[i, 3]
    turning = R[0, 3] - F[0]
    F[0] *= np.exp(y[0])
    F[3] *= np.exp(y[1])
    axial = (C[0, 0] - C[0, 1] * C[0, 1] / C[1, 1]) * np.exp(y[4])
    C[0, 1] = C[1, 0] = F[0] + turning + y[2] * force
    C[1, 1] = F[3] + D * np.exp(y[3])
    C[0, 0] = axial + C[0, 1] * C[0, 1] / C[1, 1]
    s, t = np.exp(y[6]), np.exp(y[7])
    for i in range(2):
        for j in range(2):
            C[2 + i, 2 + j] *= s
            C[4 + i, 4 + j] *= t
        L[4 + i, 2 + i] += y[8] * a
        L[2 + i, 0] += y[10 + i]
        L[2 + i, 1] += y[12 + i] / a
        L[4 + i, 0] += y[14 + i] * a
        L[4 + i, 1] += y[16 + i]
    L[5, 2] += y[9] * a
    L[4, 3] -= y[9] * a
    join(R, L, C)
    for i in range(2):
        F[1 + i] += R[1 + i, 3] + y[18 + i] * force
        F[4 + i] += R[4 + i, 3] + y[20 + i] * torque
    return G * np.exp(y[5])


@compiled()
def _ldl(R: Any, plane: Any) -> Any:
    """Diagonal (3,) and the three entries of L below it (10, 20, 21)."""
    i, j, k = plane
    d, l = np.empty((3, *R.shape[2:]), R.dtype), np.empty((3, *R.shape[2:]), R.dtype)
    d[0] = R[i, i]
    l[0], l[1] = R[j, i] / d[0], R[k, i] / d[0]
    d[1] = R[j, j] - l[0] ** 2 * d[0]
    l[2] = (R[k, j] - l[0] * l[1] * d[0]) / d[1]
    d[2] = R[k, k] - l[1] ** 2 * d[0] - l[2] ** 2 * d[1]
    return d, l


@compiled()
def _units(a: Any) -> Any:
    """Lengths that make the entries of L numbers, for the two planes."""
    return ((1.0 + 0 * a, a, a), (a, a, 1.0 + 0 * a))


def encode_wave(R: Any, F: Any, G: Any, R0: Any, F0: Any, G0: Any, a: Any, scale: Any) -> Any:
    """Return corrections y (16,) of a plane wave at one phase; scale of F_s, F_q, T_r and of G."""
    y = np.empty(16, dtype=R.dtype)
    units = _units(a)
    for m in range(2):
        d, l = _ldl(R, PLANES[m])
        d0, l0 = _ldl(R0, PLANES[m])
        at = 0 if m == 0 else 10
        y[at], y[at + 3] = np.log(d[0] / d0[0]), np.log(d[1] / d0[1])
        y[at + 5] = np.log(d[2] / d0[2])
        y[at + 1] = (l[0] - l0[0]) / units[m][0]
        y[at + 2] = (l[1] - l0[1]) / units[m][1]
        y[at + 4] = (l[2] - l0[2]) / units[m][2]
    for n in range(3):
        y[6 + n] = (F[PLANES[0][n]] - F0[PLANES[0][n]]) / scale[n]
    y[9] = (G - G0) / scale[3]
    return y


@compiled()
def decode_wave(y: Any, R: Any, F: Any, G: Any, a: Any, scale: Any) -> Any:
    """Apply the corrections to R and ``F_p``, and return G; undoes `encode_wave`."""
    units = _units(a)
    for m in range(2):
        i, j, k = PLANES[m]
        d, l = _ldl(R, PLANES[m])
        at = 0 if m == 0 else 10
        d0 = d[0] * np.exp(y[at])
        d1 = d[1] * np.exp(y[at + 3])
        d2 = d[2] * np.exp(y[at + 5])
        l0 = l[0] + y[at + 1] * units[m][0]
        l1 = l[1] + y[at + 2] * units[m][1]
        l2 = l[2] + y[at + 4] * units[m][2]
        R[i, i] = d0
        R[j, i] = R[i, j] = l0 * d0
        R[k, i] = R[i, k] = l1 * d0
        R[j, j] = d1 + l0 * l0 * d0
        R[k, j] = R[j, k] = l2 * d1 + l0 * l1 * d0
        R[k, k] = d2 + l1 * l1 * d0 + l2 * l2 * d1
    for n in range(3):
        F[PLANES[0][n]] += y[6 + n] * scale[n]
    return G + y[9] * scale[3]
