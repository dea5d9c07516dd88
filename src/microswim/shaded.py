"""Resistive force theory in the flow that the moving body drives: base of the region calibration.

A sphere of radius a moving with ``V = [U; W]`` drives the flow ``u = M U + (a/r)^3 W x x``,

    M = (3q/4 + q^3/4) I + (3q/4 - 3q^3/4) e e',     q = a/r, e = x/r,

so the filament at x meets the fluid at ``H V``, ``H = [I - M, -(1 - q^3) x^]``, and with the local
resistance C of Eq. (5) and the tail's own velocity u_hat

    R = B_b + int H' C H dl,     F_p = int H' C u_hat dl,     C = c_n I + (c_t - c_n) t t'.

H' carries a force on the filament to the force it leaves on the whole swimmer (reciprocal theorem),
so R stays symmetric and positive definite. The tip is half a sphere, with half its drag,
``3 pi mu r_t`` in all directions at s = L: a wave of a whole number of turns cancels along its
length, and what its end feels is then the larger part of the lateral wrench. Bodies that are not
spheres shade like the sphere of radius r_s. Depends on kernels.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from .coefficients import GrayHancock
from .kernels import HELIX, PLANE_WAVE, gauss, wave_nodes
from .swimmer import Swimmer

_LAW = GrayHancock()


@njit(cache=True)
def fill_shade(H: Any, x: Any, y: Any, z: Any, a: Any) -> None:
    """Write H (3, 6) at the position (x, y, z) from the centre of a sphere of radius a."""
    r2 = x * x + y * y + z * z
    q2 = a * a / r2
    q = np.sqrt(q2)
    all_round, along = 0.25 * q * (3.0 + q2), 0.75 * q * (1.0 - q2) / r2
    turn = 1.0 - q2 * q
    H[0, 0] = 1.0 - all_round - along * x * x
    H[1, 1] = 1.0 - all_round - along * y * y
    H[2, 2] = 1.0 - all_round - along * z * z
    H[0, 1] = H[1, 0] = -along * x * y
    H[0, 2] = H[2, 0] = -along * x * z
    H[1, 2] = H[2, 1] = -along * y * z
    H[0, 4], H[0, 5] = turn * z, -turn * y
    H[1, 3], H[1, 5] = -turn * z, turn * x
    H[2, 3], H[2, 4] = turn * y, -turn * x


@njit(cache=True)
def shaded_tail(kind: int, p: Any, mu: Any, phase: Any, ramp_rule: Any, rule: Any) -> Any:
    """``(R_t, F_p, G)`` of a wave tail at one phase; p as `microswim.kernels.PARAMETERS`.

    With ``c_r = 4 pi mu r_t^2`` the drag of the tip is ``3/2 sqrt(pi mu c_r)``.
    """
    R = np.zeros((6, 6), dtype=p.dtype)
    F = np.zeros(6, dtype=p.dtype)
    G = 0 * p[0]
    H = np.zeros((3, 6), dtype=p.dtype)
    a, spin = p[8], p[9]
    for panel in range(2):
        xi, weight = ramp_rule if panel == 0 else rule
        start = 0 * p[3] if panel == 0 else p[3]
        width = p[3] if panel == 0 else 1.0 - p[3]
        for i in range(xi.size):
            s, q, r, q_s, r_s, u, v = wave_nodes(kind, start + width * xi[i], phase, panel == 0, p)
            speed = np.sqrt(1.0 + q_s * q_s + r_s * r_s)
            dl = weight[i] * width * p[0] * speed
            t0, t1, t2 = 1.0 / speed, q_s / speed, r_s / speed
            fill_shade(H, s + a, q, r, a)
            n, d, w = p[6] * dl, (p[5] - p[6]) * dl, p[7] * dl
            slip = t1 * u + t2 * v
            for j in range(6):
                h0, h1, h2 = H[0, j], H[1, j], H[2, j]
                g = t0 * h0 + t1 * h1 + t2 * h2
                F[j] += n * (h1 * u + h2 * v) + d * g * slip
                for m in range(j + 1):
                    along = t0 * H[0, m] + t1 * H[1, m] + t2 * H[2, m]
                    across = h0 * H[0, m] + h1 * H[1, m] + h2 * H[2, m]
                    R[j, m] += n * across + d * g * along
            tangent = (t0, t1, t2)
            for j in range(3):
                F[3 + j] += w * tangent[j] * t0 * spin
                for m in range(j + 1):
                    R[3 + j, 3 + m] += w * tangent[j] * tangent[m]
            G += n * (u * u + v * v) + d * slip * slip + w * t0 * t0 * spin * spin
    tip = 1.5 * np.sqrt(np.pi * mu * p[7])
    s, q, r, q_s, r_s, u, v = wave_nodes(kind, 1.0 + 0 * p[3], phase, False, p)
    fill_shade(H, s + a, q, r, a)
    for j in range(6):
        F[j] += tip * (H[1, j] * u + H[2, j] * v)
        for m in range(j + 1):
            R[j, m] += tip * (H[0, j] * H[0, m] + H[1, j] * H[1, m] + H[2, j] * H[2, m])
    G += tip * (u * u + v * v)
    for j in range(6):
        for m in range(j):
            R[m, j] = R[j, m]
    return R, F, G


def parameters(swimmer: Swimmer) -> np.ndarray:
    """Kernel parameters (..., 10) of the left-handed tail, Gray and Hancock's law with spin."""
    tail = swimmer.tail
    local = _LAW.local(tail, swimmer.fluid.viscosity)
    values = (
        *(tail.apparent_length, tail.amplitude, tail.wavenumber, tail.ramp, 1.0),
        *(*local, swimmer.body.semi_axes3[0], tail.spin * tail.sign),
    )
    if not any(isinstance(v, np.ndarray) for v in values):
        return np.array(values) + 0.0
    kind = np.result_type(np.float64, *values)
    return np.stack(np.broadcast_arrays(*values), axis=-1).astype(kind, copy=False)


def nodes(kind: int, waves: Any) -> tuple[Any, Any]:
    """Quadrature rules for about 1e-5: enough below a correction of 1e-3."""
    most = float(np.max(np.real(waves)))
    return gauss(8), gauss(6 + int(np.ceil(4.5 * most)))


def code(swimmer: Swimmer) -> int:
    """Kind of wave tail, as the kernels count them."""
    return HELIX if swimmer.tail.kind == "helix" else PLANE_WAVE
