"""Elastic filaments in resistive force theory, apart from the package.

Small amplitude in closed form: ``c_n y_t = -B y_xxxx`` by its four exponentials. Any amplitude by
a chain of points joined by stiff springs, which knows no angles and no polynomials.
"""

import numpy as np
from scipy.integrate import solve_ivp


def thrust(sperm_number, base="clamped", drive="heave", hook=None):
    """Mean thrust on the held base of a filament of length 1, per amplitude squared.

    In units of ``(c_n - c_t) w``. With ``y = Re Y(x) exp(i t)`` and ``Y = sum_j a_j exp(k_j x)``,
    ``k^4 = -i Sp^4``, the force along x, away from the base, is
    ``(c_n - c_t) int y_x y_t dx``, of which thrust is the opposite. With a hook, of so much moment
    per angle over B / L, the base's slope lags the drive's by ``y_xx / hook``.
    """
    k = sperm_number * np.exp(1j * (-np.pi / 8 + np.pi / 2 * np.arange(4)))
    tip = np.exp(k)
    place, slope = (1, 0) if drive == "heave" else (0, 1)
    second = k if base == "clamped" else k**2
    if hook is not None:
        second = k - k**2 / hook
    rows = [np.ones(4), second, k**2 * tip, k**3 * tip]
    a = np.linalg.solve(np.array(rows), [place, slope, 0, 0])
    x, w = np.polynomial.legendre.leggauss(80)
    x, w = (x + 1) / 2, w / 2
    waves = np.exp(np.outer(x, k))
    Y, Y_x = waves @ a, (waves * k) @ a
    return -float(w @ np.real(Y_x * np.conj(1j * Y)) / 2)


def turning_torque(sperm_number):
    """Torque of a small tilt that turns about the axis, ``Sp^4 int |Y|^2 dx``, in ``B / L``."""
    k = sperm_number * np.exp(1j * (-np.pi / 8 + np.pi / 2 * np.arange(4)))
    tip = np.exp(k)
    a = np.linalg.solve(np.array([np.ones(4), k, k**2 * tip, k**3 * tip]), [0, 1, 0, 0])
    x, w = np.polynomial.legendre.leggauss(80)
    Y = np.exp(np.outer((x + 1) / 2, k)) @ a
    return float(sperm_number**4 * (w / 2 @ np.abs(Y) ** 2))


def moment_thrust(sperm_number, waves):
    """The same for a clamped base that stands still, by waves of inner moment, per size squared.

    The size is over ``B / L``, and ``c_n y_t = -(B y_xx - M)_xx`` with ``M = Re exp(i (t - q x))``.
    """
    k, q = sperm_number * np.exp(1j * (-np.pi / 8 + np.pi / 2 * np.arange(4))), 2 * np.pi * waves
    own = -(q**2) / (1j * sperm_number**4 + q**4)  # of exp(-i q x), forced
    tip, end = np.exp(k), np.exp(-1j * q)
    rows = [np.ones(4), k, k**2 * tip, k**3 * tip]
    right = [-own, 1j * q * own, (1 + q**2 * own) * end, -1j * q * (1 + q**2 * own) * end]
    a = np.linalg.solve(np.array(rows), right)
    x, w = np.polynomial.legendre.leggauss(80)
    x, w = (x + 1) / 2, w / 2
    powers, a = np.append(k, -1j * q), np.append(a, own)
    waves = np.exp(np.outer(x, powers))
    Y, Y_x = waves @ a, (waves * powers) @ a
    return -float(w @ np.real(Y_x * np.conj(1j * Y)) / 2)


def chain_thrust(sperm_number, amplitude, ratio, points=30, periods=4):
    """Mean thrust on a clamped base heaved by `amplitude`, by a chain of points.

    Lengths in L, forces in B / L^2, ``ratio = c_t / c_n``; positive thrust points from tip to base.
    """
    h, Sp4 = 1.0 / points, sperm_number**4
    stretch = 3e4
    joint = np.append(2.0, np.ones(points - 1)) / h
    x0 = np.concatenate([np.arange(-1, points + 1) * h, np.zeros(points + 2)])

    def forces(x, y):
        dx, dy = np.diff(x), np.diff(y)
        ell = np.hypot(dx, dy)
        tx, ty = dx / ell, dy / ell
        pull = stretch * (ell / h - 1)
        fx, fy = np.zeros_like(x), np.zeros_like(y)
        fx[:-1] += pull * tx
        fx[1:] -= pull * tx
        fy[:-1] += pull * ty
        fy[1:] -= pull * ty
        # bending: energy sum (1 - t.t') / h at the inner points, twice that at the clamp, from
        # which the first angle is only h / 2 away
        cos = tx[1:] * tx[:-1] + ty[1:] * ty[:-1]
        gx1 = joint * (tx[:-1] - cos * tx[1:]) / ell[1:]
        gy1 = joint * (ty[:-1] - cos * ty[1:]) / ell[1:]
        gx0 = joint * (tx[1:] - cos * tx[:-1]) / ell[:-1]
        gy0 = joint * (ty[1:] - cos * ty[:-1]) / ell[:-1]
        fx[2:] += gx1
        fy[2:] += gy1
        fx[1:-1] += gx0 - gx1
        fy[1:-1] += gy0 - gy1
        fx[:-2] -= gx0
        fy[:-2] -= gy0
        return fx, fy

    def place(t, z):
        x, y = x0[: points + 2].copy(), np.empty(points + 2)
        x[2:], y[2:] = z[:points], z[points:]
        y[:2] = amplitude * np.cos(t)
        return x, y

    width = np.full(points, h)
    width[-1] = h / 2

    def rate(t, z):
        x, y = place(t, z)
        fx, fy = forces(x, y)
        gx, gy = np.gradient(x)[2:], np.gradient(y)[2:]
        gx[-1], gy[-1] = x[-1] - x[-2], y[-1] - y[-2]
        size = np.hypot(gx, gy)
        gx, gy = gx / size, gy / size
        fx, fy = fx[2:], fy[2:]
        along = fx * gx + fy * gy
        vx = (fx + (1 / ratio - 1) * along * gx) / (Sp4 * width)
        vy = (fy + (1 / ratio - 1) * along * gy) / (Sp4 * width)
        return np.concatenate([vx, vy])

    start = np.concatenate([x0[2 : points + 2], np.full(points, amplitude)])
    times = 2 * np.pi * (periods - 1 + np.linspace(0, 1, 129))
    found = solve_ivp(rate, (0, times[-1]), start, "BDF", times, rtol=1e-6, atol=1e-8)
    # by the fluid on the filament is minus what bending and stretching do to the moving points
    total = [-forces(*place(t, z))[0][2:].sum() for t, z in zip(found.t, found.y.T)]
    return -np.trapezoid(total, found.t) / (2 * np.pi) / Sp4
