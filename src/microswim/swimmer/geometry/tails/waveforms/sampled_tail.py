"""A tail sampled from a function P(s, phase): tangent and velocity by spectral differentiation.

The function is sampled once on Chebyshev points along s (panel by panel) and uniform phases, until
its coefficients have decayed to a tolerance; position and both derivatives then come from the
series, at any s and phase.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev

from microswim.errors import SpecError
from microswim.numerics.quadrature import gauss
from microswim.swimmer.geometry.tails.placed_tail import PlacedTail


class SampledTail(PlacedTail):
    """A tail whose centreline is a function of s and phase, sampled into a series.

    Attributes
    ----------
    breaks
        Fractions of the length where the function has kinks.
    tolerance
        Of the series, relative to the largest position; rounding by default.
    """

    wavelength: float | None
    breaks: tuple[float, ...] = ()
    tolerance: float = 0.0

    @property
    @abstractmethod
    def centre(self) -> Callable[[Any, Any], np.ndarray]:
        """The function P(s, phase)."""

    @property
    def apparent_length(self) -> Any:
        """Range of s."""
        return self.length

    @property
    def wavelength_along_s(self) -> float | None:
        return self.wavelength

    @property
    def edges(self) -> np.ndarray:
        """Ends of the smooth panels, as fractions of the length."""
        return np.unique([0.0, *self.breaks, 1.0])

    @cached_property
    def _series(self) -> list[np.ndarray]:
        """Per panel: Chebyshev-Fourier coefficients, shape (n, 1 + 2 H, 3)."""
        L = float(np.real(self.length))
        return [
            _resolve(self.centre, a * L, b * L, self.tolerance)
            for a, b in zip(self.edges, self.edges[1:])
        ]

    @cached_property
    def _mean_ratio(self) -> tuple[float, float]:
        """Arc length, and mean of apparent over actual length, averaged over the cycle."""
        share, w = gauss(64)
        L = float(np.real(self.length))
        total, ratio = 0.0, 0.0
        for a, b in zip(self.edges, self.edges[1:]):
            s = L * (a + (b - a) * share)
            _, slope, _ = self.curve(s[:, None], np.arange(16) * np.pi / 8)
            speed = np.linalg.norm(slope, axis=-1).mean(axis=1)
            cosine = (slope[..., 0] / np.linalg.norm(slope, axis=-1)).mean(axis=1)
            total += w @ speed * L * (b - a)
            ratio += w @ cosine * (b - a)
        return float(total), float(ratio)

    @property
    def arc_length(self) -> float:
        """Length along the filament, averaged over the cycle."""
        return self._mean_ratio[0]

    @property
    def alpha(self) -> float:
        """Local apparent over actual length, averaged along s and over the cycle."""
        return self._mean_ratio[1]

    @property
    def number_of_waves(self) -> float:
        """Number of waves: of the given wavelength, else as many as the series has resolved."""
        if self.wavelength is not None:
            return float(np.real(self.length / self.wavelength))
        return max(len(c) for c in self._series) / 12.0

    @cached_property
    def _panels(self) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
        """Ends of the panels; series of each and of its derivative along s, all of one width."""
        ends = self.edges * float(np.real(self.length))
        most = max(C.shape[1] for C in self._series)
        both = []
        for C, width in zip(self._series, np.diff(ends)):
            whole = np.zeros((len(C), most, 3))
            whole[:, : C.shape[1]] = C
            both.append((whole, chebyshev.chebder(whole, axis=0) * 2.0 / width))
        return ends, both

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        s, phase = np.broadcast_arrays(s, phase)
        x, of_x = np.unique(s.reshape(-1), return_inverse=True)
        angle, of_angle = np.unique(phase.reshape(-1), return_inverse=True)
        if x.size * angle.size <= 2 * s.size:
            P, P_s = self._along(x)
            E, dE = _fourier(angle, P.shape[1])
            on_grid = (np.matmul(basis, series) for basis, series in ((E, P), (E, P_s), (dE, P)))
            found = [values[of_x, of_angle] for values in on_grid]
        else:
            P, P_s = (series[of_x] for series in self._along(x))
            E, dE = (basis[of_angle] for basis in _fourier(angle, P.shape[1]))
            pairs = ((E, P), (E, P_s), (dE, P))
            found = [np.einsum("pj,pjc->pc", basis, series) for basis, series in pairs]
        return tuple(v.reshape(*s.shape, 3) for v in found)  # type: ignore[return-value]

    def _along(self, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Harmonics of position and of its derivative along s, (points, harmonics, 3) each; s in
        order.
        """
        ends, panels = self._panels
        cuts = [0, *np.searchsorted(np.real(s), ends[1:-1], side="left").tolist(), len(s)]
        found = []
        for low, high, a, b, both in zip(cuts, cuts[1:], ends, ends[1:], panels):
            y = (2.0 * s[low:high] - a - b) / (b - a)
            T = chebyshev.chebvander(y, len(both[0]) - 1)
            found.append([_summed(T, series) for series in both])
        P, P_s = (np.concatenate(parts) for parts in zip(*found))
        return P, P_s


def _summed(basis: np.ndarray, series: np.ndarray) -> np.ndarray:
    """Series along s at the points, its harmonics and components in one row."""
    n, *others = series.shape
    return (basis[:, :n] @ series.reshape(n, -1)).reshape(-1, *others)


def _fourier(phase: np.ndarray, m: int) -> tuple[np.ndarray, np.ndarray]:
    """Basis ``[1, cos, sin, cos 2, ...]`` and its derivative, each (len(phase), m)."""
    h = (np.arange(m) + 1) // 2
    arg = phase[:, None] * h
    sine = np.arange(m) % 2 == 0
    basis = np.where(sine, np.sin(arg), np.cos(arg))
    slope = np.where(sine, h * np.cos(arg), -h * np.sin(arg))
    basis[:, 0] = 1.0
    return basis, slope


def _resolve(
    shape: Callable[[Any, Any], Any], lo: float, hi: float, tolerance: float
) -> np.ndarray:
    """Chebyshev-Fourier coefficients of P on [lo, hi], doubled until they have decayed."""
    n, m = 16, 8
    while True:
        x = np.cos(np.pi * (np.arange(n) + 0.5) / n)
        phase = 2.0 * np.pi * np.arange(m) / m
        s = (lo + hi + (hi - lo) * x[:, None]) / 2.0
        P = _sample(shape, s, phase)
        along = _interpolated(x, P)
        F = np.fft.rfft(along, axis=1) / m
        scale = np.abs(P).max() or 1.0
        rough_s = np.abs(F[-max(n // 8, 2) :]).max() > max(tolerance, 1e-14 * n) * scale
        rough_phase = np.abs(F[:, -max(m // 8, 1) :]).max() > max(tolerance, 1e-14 * m) * scale
        if not (rough_s or rough_phase):
            break
        n, m = (2 * n if rough_s else n), (2 * m if rough_phase else m)
        if n > 1024 or m > 512:
            raise SpecError(
                "tail.shape",
                getattr(shape, "__name__", "P"),
                "smooth in s between the breaks, and smooth and 2 pi-periodic in phase",
                "put the kinks of P into tail.breaks (fractions of the length), or say with "
                "tail.tolerance, such as 1e-6, how exactly it is to be followed",
            )
    H = m // 2 - 1
    series = np.empty((n, 1 + 2 * H, 3))
    series[:, 0] = F[:, 0].real
    series[:, 1::2], series[:, 2::2] = 2.0 * F[:, 1 : H + 1].real, -2.0 * F[:, 1 : H + 1].imag
    return _trim(series, max(0.1 * tolerance, 1e-16) * scale)


def _interpolated(x: np.ndarray, P: np.ndarray) -> np.ndarray:
    """Chebyshev series through values at the zeros x_k of T_n, along the first axis.

    ``c_j = 2/n sum_k P(x_k) T_j(x_k)``, half of it for j = 0: the T_j are orthogonal there.
    """
    n = len(x)
    c = 2.0 / n * (chebyshev.chebvander(x, n - 1).T @ P.reshape(n, -1))
    c[0] /= 2.0
    return c.reshape(P.shape)


def _sample(shape: Callable[[Any, Any], Any], s: np.ndarray, phase: np.ndarray) -> np.ndarray:
    P = _called(shape, s, phase[None, :])
    P = np.broadcast_to(P, (s.shape[0], phase.size, 3)) if P.shape[-1:] == (3,) else P
    again = _called(shape, s, phase[None, :] + 2.0 * np.pi)
    if P.shape != (s.shape[0], phase.size, 3) or not np.isfinite(P).all():
        raise SpecError(
            "tail.shape",
            getattr(shape, "__name__", "P"),
            "vectorised, with finite positions of shape broadcast(s, phase) + (3,) as its result",
        )
    if np.abs(P - again).max() > 1e-9 * np.abs(P).max():
        raise SpecError("tail.shape", getattr(shape, "__name__", "P"), "2 pi-periodic in phase")
    return P


def _called(shape: Callable[[Any, Any], Any], s: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Positions by the user's function; what it raises, as a sentence."""
    try:
        return np.asarray(shape(s, phase), dtype=float)
    except Exception as error:
        why = " ".join(f"{type(error).__name__}: {error}".split())
        name = getattr(shape, "__name__", "P")
        raise SpecError(f'tail.shape: "{name}" fails for arrays s and phase: {why}') from error


def _trim(series: np.ndarray, floor: float) -> np.ndarray:
    """Drop trailing coefficients at rounding level (their derivatives would only be noise)."""
    keep_s = np.flatnonzero(np.abs(series).max(axis=(1, 2)) > floor)
    keep_h = np.flatnonzero(np.abs(series).max(axis=(0, 2)) > floor)
    n = keep_s[-1] + 1 if keep_s.size else 1
    h = (keep_h[-1] + 1) // 2 if keep_h.size else 0
    return series[: max(n, 2), : 1 + 2 * h]
