r"""Gaussian processes over designs whose answers also turn with the end phase of the wave.

Matern 5/2 with one length per feature, times the phasors of the tail's tip,

.. math:: k(x, x') = M_{5/2}(|x - x'|)\,\Bigl(1 + \sum_m a_m e^{-2\pi i m (N - N')}\Bigr),

for complex targets (lateral vectors, harmonics of a beat); real targets take the real part. Targets
of a group share lengths, phasors and noise; each has its own mean and variance, both closed. The
lengths come from the marginal likelihood, leave-one-out residuals from the inverse [Rasmussen &
Williams 2006, Eqs. 2.30, 5.12].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.numerics.array import read_only
from microswim.numerics.compiling.compiled import compiled
from microswim.numerics.matern import matern_of_arrays

PHASORS = 3
NOISE = (1e-11, 1e-2)  # variance of the noise over that of the signal


def covariance(A: Any, NA: Any, B: Any, NB: Any, lengths: Any, phasors: Any, real: bool) -> Any:
    """Return prior covariance of two sets of designs, features (n, f) and numbers of waves (n,)."""
    r2 = np.zeros((len(A), len(B)))
    for a, b in zip((A / lengths).T, (B / lengths).T):
        r2 += (a[:, None] - b) ** 2
    turn = 2.0 * np.pi * (NA[:, None] - NB[None, :])
    wave: Any = 1.0
    for m, a in enumerate(phasors, 1):
        if a > 0:
            wave = wave + a * (np.cos(m * turn) if real else np.exp(-1j * m * turn))
    return matern_of_arrays(r2) * wave


@dataclass(frozen=True, eq=False)
@read_only
class Kriging:
    """One group of targets.

    Parameters
    ----------
    Z, N
        Features (n, f) and number of waves (n,) of the designs.
    lengths, phasors
        Of the kernel: (f,), (3,).
    noise
        Its variance over the signal's, one for all or of each design (n,).
    alpha, mean
        Weights (n, m) and means (m,), complex for complex targets.
    variance
        Prior variance of each target (m,).
    """

    Z: np.ndarray
    N: np.ndarray
    lengths: np.ndarray
    phasors: np.ndarray
    noise: Any
    alpha: np.ndarray
    mean: np.ndarray
    variance: np.ndarray

    @property
    def real(self) -> bool:
        """Whether the targets are real."""
        return not np.iscomplexobj(self.alpha)

    @cached_property
    def _factor(self) -> tuple[np.ndarray, np.ndarray]:
        """Inverse Cholesky factor ``F`` of the covariance, ``K^-1 = F^* F``, and ``F 1``."""
        from scipy.linalg import solve_triangular  # what answers need not wait for

        K = self._own(self.Z, self.N) + self.noise * np.eye(len(self.Z))
        F = solve_triangular(np.linalg.cholesky(K), np.eye(len(K)), lower=True)
        F = np.ascontiguousarray(F, dtype=complex)
        return F, F.sum(axis=1)

    def _own(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        return covariance(Z, N, self.Z, self.N, self.lengths, self.phasors, self.real)

    def __call__(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Targets (k, m) of other designs."""
        return self._own(Z, N) @ self.alpha + self.mean

    def doubt(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Return the variance (k,) at other designs, in units of the prior's."""
        return self.doubt_of(self._own(Z, N))

    def doubt_of(self, cross: np.ndarray) -> np.ndarray:
        """Return variance (k,) at designs of prior covariance `cross` (k, n) with those solved."""
        least = float(np.min(self.noise))
        top = 1.0 + self.phasors.sum() + least
        return doubts(cross.astype(complex), *self._factor, top, least)

    def left_out(self) -> tuple[np.ndarray, np.ndarray]:
        """Return leave-one-out residuals (n, m), truth less prediction, and their doubt (n,)."""
        F, one = self._factor
        ones = np.sum(F.conj() * one[:, None], axis=0)  # K^-1 1
        whole = np.sum(np.abs(one) ** 2)
        own = np.sum(np.abs(F) ** 2, axis=0) - np.abs(ones) ** 2 / whole
        return self.alpha / own[:, None], 1.0 / own


@compiled(always=True)
def doubts(cross: Any, F: Any, one: Any, top: float, noise: float) -> Any:
    """Return variance of the process at designs, its mean estimated, at least that of the noise.

    ``top - |h|^2 + |1 - h^* F 1|^2 / |F 1|^2`` with ``h = F cross^*``. Nearly all of `top`
    cancels: the sums run in one order, so that the result does not depend on where the arrays
    lie in memory, as it does with matrix products.
    """
    out = np.empty(len(cross))
    weight = 0.0
    for i in range(len(one)):
        weight += abs(one[i]) ** 2
    for k in range(len(cross)):
        own, miss = top, 1.0 + 0.0j
        for i in range(len(F)):
            h = 0.0j
            for j in range(i + 1):
                h += F[i, j] * cross[k, j].conjugate()
            own -= h.real * h.real + h.imag * h.imag
            miss -= h.conjugate() * one[i]
        out[k] = max(own + abs(miss) ** 2 / weight, noise)
    return out


def fit(Z: np.ndarray, N: np.ndarray, Y: np.ndarray, phasors: int, start: Any = None) -> Kriging:
    """Fit a group of targets Y (n, m) by the marginal likelihood.

    Parameters
    ----------
    Z, N
        Features, of about unit spread, and number of waves of the designs.
    Y
        Targets, real or complex.
    phasors
        How many turns of the tip they may follow, 0 to 3.
    start
        A former fit of the same group to start from.
    """
    from scipy.optimize import minimize

    scale = np.sqrt(np.mean(np.abs(Y - Y.mean(axis=0)) ** 2, axis=0))
    flat = scale <= 1e-13 * np.abs(Y).max(axis=0) + 1e-100
    scale = np.where(flat, 1.0, scale)
    use = (Y / scale)[:, ~flat]

    def unpack(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        a = np.zeros(PHASORS)
        a[:phasors] = np.exp(x[Z.shape[1] : -1])
        return np.exp(x[: Z.shape[1]]), a, float(np.exp(x[-1]))

    def misfit(x: np.ndarray) -> float:
        try:
            return -likelihood(Z, N, use, *unpack(x))
        except np.linalg.LinAlgError:
            return 1e12

    first = np.concatenate([np.full(Z.shape[1], 1.5), np.zeros(phasors), [np.log(1e-7)]])
    if start is not None:
        a = np.maximum(start.phasors[:phasors], 1e-3)
        first = np.concatenate([np.log(start.lengths), np.log(a), [np.log(start.noise)]])
    bounds = [(-1.5, 5.0)] * Z.shape[1] + [(-8.0, 4.0)] * phasors + [tuple(np.log(NOISE))]
    best = minimize(
        misfit, first, method="L-BFGS-B", bounds=bounds, options={"maxiter": 60, "ftol": 1e-7}
    ).x
    return conditioned(Z, N, Y, *unpack(best))


def conditioned(Z: Any, N: Any, Y: Any, lengths: Any, phasors: Any, noise: Any) -> Kriging:
    """Condition a process of known kernel on targets Y (n, m); noise of all or of each (n,)."""
    from scipy.linalg import solve_triangular

    L, w, mean, _ = _whitened(Z, N, Y, lengths, phasors, noise)
    alpha = solve_triangular(L, w, lower=True, trans=2)
    variance = np.sum(np.abs(w) ** 2, axis=0) / (len(Z) - 1)
    return Kriging(Z, N, lengths, phasors, noise, alpha, mean, variance)


def likelihood(Z: Any, N: Any, Y: Any, lengths: Any, phasors: Any, noise: Any) -> float:
    """Return the logarithm of the marginal likelihood of targets Y (n, m), as `fit` maximises."""
    L, w, _, weight = _whitened(Z, N, Y, lengths, phasors, noise)
    spread = np.sum(np.abs(w) ** 2, axis=0) / (len(Z) - 1)
    log_det = 2.0 * np.sum(np.log(np.real(np.diag(L)))) + np.log(weight)
    return float(-0.5 * ((len(Z) - 1) * np.sum(np.log(spread + 1e-300)) + Y.shape[1] * log_det))


def _whitened(Z: Any, N: Any, Y: Any, lengths: Any, phasors: Any, noise: Any) -> tuple[Any, ...]:
    """Return L of the covariance, ``L^-1 (Y - mean)``, the mean (m,) and its weight."""
    from scipy.linalg import solve_triangular

    K = covariance(Z, N, Z, N, lengths, phasors, not np.iscomplexobj(Y)) + noise * np.eye(len(Z))
    L = np.linalg.cholesky(K)
    half = solve_triangular(L, np.concatenate([Y, np.ones((len(Z), 1))], axis=1), lower=True)
    w, one = half[:, :-1], half[:, -1]
    weight = np.vdot(one, one).real
    mean = (one.conj() @ w) / weight
    return L, w - np.outer(one, mean), mean, weight
