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
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.matern import matern, matern_of_arrays

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
    lengths, phasors, noise
        Of the kernel: (f,), (3,), relative variance of the noise.
    alpha, mean
        Weights (n, m) and means (m,), complex for complex targets.
    variance
        Prior variance of each target (m,).
    """

    Z: np.ndarray
    N: np.ndarray
    lengths: np.ndarray
    phasors: np.ndarray
    noise: float
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
        top = 1.0 + self.phasors.sum() + self.noise
        return doubts(cross.astype(complex), *self._factor, top, self.noise)

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
    y, real, n = Y / scale, not np.iscomplexobj(Y), len(Z)
    use = y[:, ~flat]

    def unpack(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        a = np.zeros(PHASORS)
        a[:phasors] = np.exp(x[Z.shape[1] : -1])
        return np.exp(x[: Z.shape[1]]), a, float(np.exp(x[-1]))

    def solved(x: np.ndarray, y: np.ndarray) -> Any:
        lengths, a, noise = unpack(x)
        K = covariance(Z, N, Z, N, lengths, a, real) + noise * np.eye(n)
        L = np.linalg.cholesky(K)
        half = np.linalg.solve(L, np.concatenate([y, np.ones((n, 1))], axis=1))
        w, one = half[:, :-1], half[:, -1]
        weight = np.vdot(one, one).real
        mean = (one.conj() @ w) / weight
        w = w - np.outer(one, mean)
        spread = np.sum(np.abs(w) ** 2, axis=0) / (n - 1)
        return L, w, mean, spread, weight

    def misfit(x: np.ndarray) -> float:
        try:
            L, _, _, spread, weight = solved(x, use)
        except np.linalg.LinAlgError:
            return 1e12
        log_det = 2.0 * np.sum(np.log(np.real(np.diag(L)))) + np.log(weight)
        return 0.5 * ((n - 1) * np.sum(np.log(spread + 1e-300)) + use.shape[1] * log_det)

    first = np.concatenate([np.full(Z.shape[1], 1.5), np.zeros(phasors), [np.log(1e-7)]])
    if start is not None:
        a = np.maximum(start.phasors[:phasors], 1e-3)
        first = np.concatenate([np.log(start.lengths), np.log(a), [np.log(start.noise)]])
    bounds = [(-1.5, 5.0)] * Z.shape[1] + [(-8.0, 4.0)] * phasors + [tuple(np.log(NOISE))]
    best = minimize(
        misfit, first, method="L-BFGS-B", bounds=bounds, options={"maxiter": 60, "ftol": 1e-7}
    ).x
    return conditioned(Z, N, Y, *unpack(best))


def conditioned(Z: Any, N: Any, Y: Any, lengths: Any, phasors: Any, noise: float) -> Kriging:
    """Condition a process of known kernel on targets Y (n, m)."""
    from scipy.linalg import solve_triangular

    K = covariance(Z, N, Z, N, lengths, phasors, not np.iscomplexobj(Y)) + noise * np.eye(len(Z))
    L = np.linalg.cholesky(K)
    half = solve_triangular(L, np.concatenate([Y, np.ones((len(Z), 1))], axis=1), lower=True)
    w, one = half[:, :-1], half[:, -1]
    mean = (one.conj() @ w) / np.vdot(one, one).real
    w = w - np.outer(one, mean)
    alpha = solve_triangular(L, w, lower=True, trans=2)
    variance = np.sum(np.abs(w) ** 2, axis=0) / (len(Z) - 1)
    return Kriging(Z, N, lengths, phasors, noise, alpha, mean, variance)


@compiled(always=True, fastmath=FAST, error_model="numpy")
def predict(
    out: Any,
    z: Any,
    waves: Any,
    Z: Any,
    tips: Any,
    lengths: Any,
    phasors: Any,
    cut: Any,
    alpha: Any,
    mean: Any,
    work: Any,
) -> None:
    """Write the targets of one design to `out` (m,).

    Group g has the rows ``cut[g] .. cut[g + 1]`` of `alpha` (m, n); complex targets take two
    rows each, real and imaginary parts, and are told by ``phasors[g, 3] > 0``. `Z` (f, n); `tips`
    (2, n) are cosine and sine of ``2 pi N``; `work` (2, n) is scratch. The inner loops run over
    the designs that were solved, several at once.
    """
    for j in range(len(mean)):
        out[j] = mean[j]
    n = Z.shape[1]
    even, odd = work[0], work[1]
    c0, s0 = np.cos(2.0 * np.pi * waves), np.sin(2.0 * np.pi * waves)
    for g in range(lengths.shape[0]):
        even[:] = 0.0
        for f in range(Z.shape[0]):
            for t in range(n):
                d = (z[f] - Z[f, t]) * lengths[g, f]
                even[t] += d * d
        a, b, c = phasors[g, 0], phasors[g, 1], phasors[g, 2]
        for t in range(n):
            c1 = c0 * tips[0, t] + s0 * tips[1, t]
            s1 = s0 * tips[0, t] - c0 * tips[1, t]
            c2, s2 = c1 * c1 - s1 * s1, 2.0 * s1 * c1
            k = matern(even[t])
            even[t] = k * (1.0 + a * c1 + b * c2 + c * (c2 * c1 - s2 * s1))
            odd[t] = k * (a * s1 + b * s2 + c * (s2 * c1 + c2 * s1))
        step = 1 if phasors[g, 3] == 0.0 else 2
        for j in range(cut[g], cut[g + 1], step):
            real = 0 * z[0]
            for t in range(n):
                real += even[t] * alpha[j, t]
            out[j] += real
            if step == 2:
                real, imag = 0 * z[0], 0 * z[0]
                for t in range(n):
                    real += odd[t] * alpha[j + 1, t]
                    imag += even[t] * alpha[j + 1, t] - odd[t] * alpha[j, t]
                out[j] += real
                out[j + 1] += imag


@compiled(always=True)
def crossings(z: Any, waves: Any, Z: Any, tips: Any, lengths: Any, phasors: Any) -> Any:
    """Return the prior covariance (groups, n) of one design with those solved, as in `predict`."""
    out = np.empty((lengths.shape[0], Z.shape[1]), dtype=np.complex128)
    c0, s0 = np.cos(2.0 * np.pi * waves), np.sin(2.0 * np.pi * waves)
    for t in range(Z.shape[1]):
        c1 = c0 * tips[0, t] + s0 * tips[1, t]
        s1 = s0 * tips[0, t] - c0 * tips[1, t]
        c2, s2 = c1 * c1 - s1 * s1, 2.0 * s1 * c1
        c3, s3 = c2 * c1 - s2 * s1, s2 * c1 + c2 * s1
        for g in range(lengths.shape[0]):
            r2 = 0.0
            for f in range(Z.shape[0]):
                d = (z[f] - Z[f, t]) * lengths[g, f]
                r2 += d * d
            a, b, c = phasors[g, 0], phasors[g, 1], phasors[g, 2]
            even, odd = 1.0 + a * c1 + b * c2 + c * c3, a * s1 + b * s2 + c * s3
            out[g, t] = matern(r2) * complex(even, -odd)
    return out


@dataclass(frozen=True, eq=False)
class Surfaces:
    """Several groups over the same designs, packed for the compiled evaluation."""

    groups: tuple[Kriging, ...]

    def __call__(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Targets (k, columns) at other designs, complex ones as pairs."""
        return np.concatenate([interleaved(g(Z, N)) for g in self.groups], axis=1)

    def doubt(self, Z: np.ndarray, N: np.ndarray) -> np.ndarray:
        """Return the variance (k,) at other designs over that of a design left out, mean of the
        groups.
        """
        each = [g.doubt(Z, N) / typical for g, typical in zip(self.groups, self._typical)]
        return np.mean(each, axis=0)

    def doubt_of_one(self, z: np.ndarray, waves: float) -> float:
        """Return `doubt` at one design, its features z (f,), at the cost of one evaluation."""
        Z, tips, lengths, phasors, *_ = self.packed
        cross = crossings(z, waves, Z, tips, lengths, phasors)
        each = [
            g.doubt_of((c.real if g.real else c)[None])[0] / typical
            for c, g, typical in zip(cross, self.groups, self._typical)
        ]
        return float(np.mean(each))

    def left_out_doubt(self) -> np.ndarray:
        """Return `variance` (n,) at each design when it is left out."""
        each = [g.left_out()[1] / typical for g, typical in zip(self.groups, self._typical)]
        return np.mean(each, axis=0)

    @cached_property
    def _typical(self) -> list[float]:
        return [float(np.mean(g.left_out()[1])) for g in self.groups]

    @cached_property
    def in_lengths(self) -> list[np.ndarray]:
        """Features (f, n) of the designs in lengths of each group's kernel."""
        return [np.ascontiguousarray((g.Z / g.lengths).T) for g in self.groups]

    @cached_property
    def packed(self) -> tuple[np.ndarray, ...]:
        """Arguments of `predict` after the number of waves, and the means."""
        first = self.groups[0]
        tips = np.stack([np.cos(2.0 * np.pi * first.N), np.sin(2.0 * np.pi * first.N)])
        lengths = np.array([1.0 / g.lengths for g in self.groups])
        phasors = np.array([[*g.phasors, 0.0 if g.real else 1.0] for g in self.groups])
        columns = [interleaved(g.alpha) for g in self.groups]
        cut = np.cumsum([0, *(c.shape[1] for c in columns)])
        mean = np.concatenate([interleaved(g.mean[None])[0] for g in self.groups])
        alpha = np.ascontiguousarray(np.concatenate(columns, axis=1).T)
        return np.array(first.Z.T, order="C"), tips, lengths, phasors, cut, alpha, mean


def interleaved(values: np.ndarray) -> np.ndarray:
    """Return the complex columns as pairs of real ones."""
    if not np.iscomplexobj(values):
        return values
    return np.stack([np.real(values), np.imag(values)], axis=-1).reshape(len(values), -1)
