"""Response: a gait solved once for all phases, so that a step needs no linear solve.

    V   = M(phi) W + v(phi) rate + K(phi) e       M = R^-1, v = -R^-1 F_p, K = R^-1 S
    tau = F_p(phi) . V + G(phi) rate - g(phi) . e

V is the twist *relative to the background flow* at the body's centre, W the external wrench, e the
strain of that flow, all in the body frame, tau the motor's torque. The products are periodic, so
they are Fourier series too: for a rigid helix on a body of revolution exact with two (K: three)
harmonics, else resolved to rounding. Degrees of freedom that are held have zero rows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait.gait import Gait
from microswim.gait.stepping import LOWER
from microswim.numerics.array import read_only
from microswim.numerics.series.fourier import series_of
from microswim.path import strain
from microswim.swimmer.swimmer import Swimmer

FINEST = 1024


@dataclass(frozen=True, eq=False)
@read_only
class Response:
    """Fourier series in the phase, rows ``[mean, cos 1, sin 1, ...]``.

    Parameters
    ----------
    twist
        (1 + 2 H, 27): lower triangle of M, then v.
    strain
        (1 + 2 H', 36): K, row by row; one row of zeros if the strain is left out.
    motor
        (1 + 2 H'', 13): F_p, G, g.
    """

    twist: np.ndarray
    strain: np.ndarray
    motor: np.ndarray

    def at(self, phase: float) -> Response:
        """Return the response with the motor locked at a phase: one row each."""
        h = np.arange(1, FINEST)
        wave = np.stack([np.cos(h * phase), np.sin(h * phase)], axis=-1).ravel()
        basis = np.concatenate([[1.0], wave])
        return Response(*((basis[: len(t)] @ t)[None] for t in self.tables))

    @property
    def tables(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The three tables."""
        return self.twist, self.strain, self.motor


def response(gait: Gait, swimmer: Swimmer | None = None) -> Response:
    """Solve a gait for all phases; with its swimmer the strain of a flow is felt too.

    Raises
    ------
    MicroswimError
        If the resistance matrix is singular, or the response is not finite.
    """
    n = 16
    while True:
        with np.errstate(over="ignore", invalid="ignore"):
            samples = _samples(gait, swimmer, n)
        if not all(np.isfinite(x).all() for x in samples):
            raise MicroswimError(
                "the response of the gait is not finite: viscosity or lengths are too near to "
                "zero or too large; take other units"
            )
        series = [series_of(x) for x in samples]
        scales = [scale(x) for x in samples]
        felt = [np.abs(x / s) for x, s in zip(series, scales)]
        if n >= FINEST or max(f[-4:].max() for f in felt) < 1e-13:
            return Response(*(_trimmed(x, f) for x, f in zip(series, felt)))
        n *= 2


def _samples(gait: Gait, swimmer: Swimmer | None, n: int) -> list[np.ndarray]:
    phase = 2.0 * np.pi * np.arange(n) / n
    f = np.flatnonzero(gait.free)
    M = np.zeros((n, 6, 6))
    try:
        M[:, f[:, None], f] = np.linalg.inv(gait.resistance(phase)[:, f[:, None], f])
    except np.linalg.LinAlgError:
        raise MicroswimError(
            "the resistance matrix is singular: a swimmer needs a body or a tail that "
            "resists every free motion"
        ) from None
    F, G = gait.propulsion(phase), gait.activity(phase)
    v = -np.einsum("nij,nj->ni", M, F)
    S, g = np.zeros((n, 6, 6)), np.zeros((n, 6))
    if swimmer is not None:
        S, g = strain.coupling(swimmer, phase)
    lower = np.stack([M[:, i, j] for i, j in LOWER], axis=-1)
    return [
        np.concatenate([lower, v], axis=1),
        (M @ S).reshape(n, 36),
        np.concatenate([F, G[:, None], g], axis=1),
    ]


def scale(samples: np.ndarray) -> np.ndarray:
    """Return the size of each column's kind: linear and angular parts differ by powers of the
    length.
    """
    kinds = {
        27: [3 * (i // 3) + j // 3 for i, j in LOWER] + [10 + i // 3 for i in range(6)],
        36: [i // 18 for i in range(36)],
        13: [0] * 3 + [1] * 3 + [2] + [3] * 6,
    }
    kind = np.array(kinds[samples.shape[1]])
    top = np.abs(samples).max(axis=0)
    size = np.array([top[kind == k].max() for k in kind])
    return np.where(size > 0, size, 1.0)


def _trimmed(series: np.ndarray, felt: np.ndarray) -> np.ndarray:
    last = np.flatnonzero(felt.max(axis=1) > 1e-14).max(initial=0)
    return np.ascontiguousarray(series[: 1 + 2 * ((last + 1) // 2)])


def step_limits(solved: Response, resolution: float, magnetic: np.ndarray) -> np.ndarray:
    """Return the largest turn of a step, the body's rotation per unit of what drives it, and the
    sizes of m_0 and C of its moment (12,).
    """
    n = 1 if len(solved.twist) == 1 else 32
    tables = np.array([solved.at(2.0 * np.pi * i / n).twist[0] for i in range(n)])
    M = np.zeros((n, 6, 6))
    for m, (i, j) in enumerate(LOWER):
        M[:, i, j] = M[:, j, i] = tables[:, m]
    turns = [
        np.linalg.norm(tables[:, 24:27], axis=1).max(),
        np.linalg.norm(M[:, 3:, :3], 2, axis=(1, 2)).max(),
        np.linalg.norm(M[:, 3:, 3:], 2, axis=(1, 2)).max(),
    ]
    sizes = np.linalg.norm(magnetic[:3]), np.linalg.norm(magnetic[3:])
    return np.array([2.0 * np.pi / resolution, *turns, *sizes])
