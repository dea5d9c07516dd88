"""A free sphere with a tail of rigid links joined by springs, marched in time; no shared code."""

import numpy as np
from scipy.integrate import solve_ivp


def way_in_a_period(links, *, drive, size, bending, normal, tangential, radius, periods):
    """Return how far it comes in the last of the periods; tail length, viscosity and rate 1."""
    h, rate = 1.0 / links, 2.0 * np.pi
    springs = np.append(2.0 * bending / h, np.full(links - 1, bending / h))
    body = np.array([6.0 * np.pi * radius, 6.0 * np.pi * radius, 8.0 * np.pi * radius**3])

    def rates(t, z):
        at, speed = size * np.cos(rate * t), -size * rate * np.sin(rate * t)
        heave, moved = (at, speed) if drive == "heave" else (0.0, 0.0)
        (c0, s0), angles = (np.cos(z[2]), np.sin(z[2])), z[3:]
        J = np.zeros((2, 3 + links))  # of the joint, then of the end of each link
        J[:, :3] = [[1.0, 0.0, -s0 * radius - c0 * heave], [0.0, 1.0, c0 * radius - s0 * heave]]
        given = moved * np.array([-s0, c0])
        M, F = np.diag(np.append(body, np.full(links, normal * h**3 / 12.0))), np.zeros(3 + links)
        for i, angle in enumerate(angles, start=3):
            t1, n1 = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            drag = h * (tangential * np.outer(t1, t1) + normal * np.outer(n1, n1))
            middle = J.copy()
            middle[:, i] += n1 * h / 2.0
            M += middle.T @ drag @ middle
            F -= middle.T @ drag @ given
            J[:, i] += n1 * h
        base = z[2] + (at if drive == "pivot" else 0.0)
        moments = springs * np.diff(np.append(base, angles))
        F[3:] -= moments
        F[3:-1] += moments[1:]
        F[2] += moments[0]
        return np.linalg.solve(M, F)

    ends = [periods - 1.0, float(periods)]
    found = solve_ivp(rates, (0.0, ends[1]), np.zeros(3 + links), "BDF", ends, rtol=1e-6, atol=1e-8)
    return float(np.hypot(*(found.y[:2, 1] - found.y[:2, 0])))
