"""The model of Tabak & Yesilyurt, equation by equation, without anything of the package.

Plain arrays and plain quadrature, slow and short, for the tests alone. Three readings of the paper
are arguments here as they are options of the library: the line element of Eqs. (5), (14), the
frame of the tail's rate, and which velocities are free.

Frame sqr of the paper: origin at the joint, s along the tail; the body's centre at (-r_s, 0, 0).
A velocity is six numbers, (U, Omega), about the body's centre.
"""

from dataclasses import dataclass

import numpy as np

PERIODS = 2000  # of the integrals (9), whose rest is below 1 / (alpha^3 (2 pi PERIODS)^2)


@dataclass(frozen=True)
class Tail:
    """A wave on a filament: `length` is the apparent one, along s."""

    length: float
    amplitude: float
    waves: float
    radius: float
    rate: float  # radians per time
    plane: bool = False
    ramp: float = 0.1

    @property
    def k(self):
        """Wavenumber."""
        return 2 * np.pi * self.waves / self.length

    @property
    def alpha(self):
        """Apparent over actual length; a plane wave's is averaged over the wavelength."""
        x = np.linspace(0, 2 * np.pi, 4000, endpoint=False) if self.plane else np.zeros(1)
        return np.mean(1 / np.sqrt(1 + (self.amplitude * self.k * np.cos(x)) ** 2))


def lighthill(tail, viscosity):
    """``c_n, c_t`` of Eqs. (7) and (8)."""
    alpha = tail.alpha
    epsilon = 5.2 * tail.radius * alpha * tail.k / (2 * np.pi)  # Eq. (26)
    edges = np.concatenate([np.geomspace(epsilon, np.pi, 60), np.pi * np.arange(2, 2 * PERIODS)])
    theta, w = panels(edges, 12)
    phi = (alpha**2 * theta**2 + 2 * (1 - alpha**2) * (1 - np.cos(theta))) ** 1.5  # Eq. (25)
    A1 = np.log(epsilon) + np.sum(w * theta * np.sin(theta) / phi)  # Eq. (27)
    A2 = np.log(epsilon) + np.sum(w * np.sin(theta) ** 2 / phi)  # Eq. (28)
    below = -np.log(epsilon)
    c_n = 4 * np.pi * viscosity / (below + (2 * alpha**2 - 1) * A1 + 2 * (1 - alpha**2) * A2)
    c_t = 2 * np.pi * viscosity / (below - 0.5 + alpha**2 * A1 + (1 - alpha**2) * A2)
    return c_n, c_t


def sphere(radius, viscosity, translation, rotation):
    """Diagonal of ``B_b``, Eqs. (21) and (22)."""
    return np.concatenate(
        [
            6 * np.pi * viscosity * radius * np.array(translation),
            8 * np.pi * viscosity * radius**3 * np.array(rotation),
        ]
    )


def spheroid(r_s, r_q, viscosity, translation, rotation):
    """Drag along and about s, Eqs. (18) and (19); the other directions are held."""
    along = translation * 4 * np.pi * viscosity * r_s / (np.log(2 * r_s / r_q) - 0.5)
    about = rotation * 16 / 3 * np.pi * viscosity * r_s * r_q**2
    return np.array([along, 0, 0, about, 0, 0])


def centreline(tail, s, t):
    """``P``, ``dP/ds`` and ``u = dP/dt`` of Eqs. (12) and (11)."""
    grown = 1.0 if tail.ramp == 0 else np.minimum(s / (tail.ramp * tail.length), 1.0)
    slope = 0.0 if tail.ramp == 0 else (s < tail.ramp * tail.length) / (tail.ramp * tail.length)
    b, b_s, x = tail.amplitude * grown, tail.amplitude * slope, tail.k * s - tail.rate * t
    cos, sin, o = np.cos(x), np.sin(x), np.zeros_like(s)
    turning = o if tail.plane else o + 1  # a plane wave has no r
    P = np.stack([s, b * cos, -turning * b * sin], -1)
    P_s = np.stack(
        [o + 1, b_s * cos - tail.k * b * sin, -turning * (b_s * sin + tail.k * b * cos)], -1
    )
    u = tail.rate * np.stack([o, b * sin, turning * b * cos], -1)
    return P, P_s, u


def tail_forces(tail, c_n, c_t, r_s, t, line_element="arc"):
    """``B_t`` of Eq. (5) and ``(F_p, T_p)`` of Eq. (14), about the body's centre."""
    edges = np.unique(np.concatenate([[0, tail.ramp], np.linspace(0, 1, 9)])) * tail.length
    s, w = panels(edges, 16)
    P, P_s, u = centreline(tail, s, t)
    stretch = np.linalg.norm(P_s, axis=-1)
    dl = w * stretch if line_element == "arc" else w
    B, F = np.zeros((6, 6)), np.zeros(6)
    for X, tangent, velocity, weight in zip(P + [r_s, 0, 0], P_s / stretch[:, None], u, dl):
        RCR = c_n * np.eye(3) + (c_t - c_n) * np.outer(tangent, tangent)
        S = np.cross(X, np.eye(3)).T  # S y = X x y
        B += weight * np.block([[RCR, -RCR @ S], [S @ RCR, -S @ RCR @ S]])
        F += weight * np.concatenate([RCR @ velocity, S @ RCR @ velocity])
    return B, F


def velocity(tail, pair, body, r_s, free, t=0.0, line_element="arc", lab=False):
    """Velocity of the swimmer, Eq. (15) with the sign of the reading notes: ``B V = -F_p``.

    In the lab frame the tail turns at its rate whatever the body does: relative to the body at
    ``rate - Omega_s``.
    """
    B, F = tail_forces(tail, *pair, r_s, t, line_element)
    B = B + np.diag(body)
    if lab:
        B[:, 3] -= F / tail.rate
    V, free = np.zeros(6), list(free)
    V[free] = np.linalg.solve(B[np.ix_(free, free)], -F[free])
    return V


def over_a_period(*args, samples=12, **options):
    """Velocity at equal times of a period, (samples, 6)."""
    times = 2 * np.pi / args[0].rate * np.arange(samples) / samples
    return np.array([velocity(*args, t=t, **options) for t in times])


def speed_by_closed_form(tail, c_n, c_t, drag):
    """``u_s`` of the closed form (20), its rate in the lab frame: ``F_s(u_s) = drag u_s``."""
    b, k, alpha = tail.amplitude, tail.k, tail.alpha
    along = alpha * tail.length * (b**2 * k**2 * c_n + c_t)
    push = alpha * tail.length * k * b**2 * tail.rate * (c_n - c_t)
    return -push / (drag + along)


def panels(edges, n):
    """Gauss-Legendre nodes and weights, n between each two edges."""
    x, w = np.polynomial.legendre.leggauss(n)
    half = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()
