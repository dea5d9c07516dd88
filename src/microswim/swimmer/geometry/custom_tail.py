"""A tail from any function P(s, phase): tangent and velocity by spectral differentiation.

The function is sampled once on Chebyshev points along s (panel by panel) and uniform phases, until
its coefficients have decayed to rounding; position and both derivatives then come from the series,
at any s and phase.
"""

from __future__ import annotations

from collections.abc import Callable, Sized
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.tail import Sections, SurfaceMotion, Tail


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class CustomTail(Tail):
    """Tail with any centreline, given by a vectorised function of s and phase.

    Parameters
    ----------
    shape
        ``P(s, phase)``: takes arrays that broadcast, returns positions of shape
        broadcast(s, phase) + (3,) in the frame ``sqr``; 2 pi-periodic in phase; smooth between
        the breaks.
    length
        Range of s, 0 to `length`. Usually s is the axial coordinate; any parameter will do.
    radius
        Radius of the filament (length).
    frequency
        Cycles per time.
    wavelength
        For the laws of local resistance that need one (Lighthill, Gray & Hancock).
    breaks
        Fractions of the length where P has kinks, such as the end of a ramp.
    sign
        Sense of rotation about s (+1 or -1) for ``surface_motion = "rigid"``.
    sections, surface_motion
        As for `WaveTail`.

    Raises
    ------
    SpecError
        If a field is out of range, or P is not finite, not periodic or not smooth.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> def beat(s, phase):
    ...     q = 0.1 * s * np.cos(3 * s - phase)
    ...     return np.stack([s + 0 * q, q, 0 * q], axis=-1)
    >>> tail = ms.CustomTail(shape=beat, length=2.0, radius=0.02, wavelength=2.0)
    >>> tail.centreline(1.0, 0.0)[0].round(3).tolist()
    [1.0, -0.099, 0.0]
    """

    shape: Callable[[Any, Any], np.ndarray]
    length: float
    radius: float
    frequency: float = 1.0
    wavelength: float | None = None
    breaks: tuple[float, ...] = ()
    sign: float = 1.0
    sections: Sections = "perpendicular"
    surface_motion: SurfaceMotion = "translating"
    kind: ClassVar[str] = "custom"

    def __post_init__(self) -> None:
        checks.positive("tail.length", self.length, "length")
        self._check_filament()
        if self.wavelength is not None:
            checks.positive("tail.wavelength", self.wavelength, "length")
        checks.number("tail.sign", self.sign, "+1 or -1")
        if self.sign not in (-1, 1):
            raise SpecError("tail.sign", self.sign, "+1 or -1")
        if not callable(self.shape):
            raise SpecError("tail.shape", self.shape, "a function P(s, phase)")
        count = len(self.breaks) if isinstance(self.breaks, Sized) else 0
        allowed = "fractions from 0 to 1"
        checks.numbers("tail.breaks", self.breaks, count, allowed, least=0, most=1)
        object.__setattr__(self, "breaks", tuple(self.breaks))
        _ = self._series

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
        return [_resolve(self.shape, a * L, b * L) for a, b in zip(self.edges, self.edges[1:])]

    @cached_property
    def _mean_ratio(self) -> tuple[float, float]:
        """Arc length, and mean of apparent over actual length, averaged over the cycle."""
        xi, w = np.polynomial.legendre.leggauss(64)
        L = float(np.real(self.length))
        total, ratio = 0.0, 0.0
        for a, b in zip(self.edges, self.edges[1:]):
            s = L * (a + (b - a) * (xi + 1.0) / 2.0)
            _, slope, _ = self.centreline(s[:, None], np.arange(16) * np.pi / 8)
            speed = np.linalg.norm(slope, axis=-1).mean(axis=1)
            cosine = (slope[..., 0] / np.linalg.norm(slope, axis=-1)).mean(axis=1)
            total += w @ speed * L * (b - a) / 2.0
            ratio += w @ cosine * (b - a) / 2.0
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

    def centreline(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        s, phase = np.broadcast_arrays(s, phase)
        kind = np.result_type(s, phase, np.float64)
        out = np.empty((3, s.size, 3), dtype=kind)
        x, angle = s.reshape(-1), phase.reshape(-1)
        L = float(np.real(self.length))
        which = np.searchsorted(self.edges[1:-1] * L, np.real(x), side="right")
        for p, C in enumerate(self._series):
            here = which == p
            lo, hi = self.edges[p] * L, self.edges[p + 1] * L
            y = (2.0 * x[here] - lo - hi) / (hi - lo)
            T = chebyshev.chebvander(y, len(C) - 1)
            dT = chebyshev.chebvander(y, max(len(C) - 2, 0))
            E, dE = _fourier(angle[here], C.shape[1])
            D = chebyshev.chebder(C, axis=0) * (2.0 / (hi - lo))
            P, P_s = (_along(*pair).reshape(-1, *C.shape[1:]) for pair in ((T, C), (dT, D)))
            out[0, here] = np.einsum("pjc,pj->pc", P, E)
            out[1, here] = np.einsum("pjc,pj->pc", P_s, E)
            out[2, here] = np.einsum("pjc,pj->pc", P, dE)
        return tuple(o.reshape(*s.shape, 3) for o in out)  # type: ignore[return-value]


def _along(basis: np.ndarray, series: np.ndarray) -> np.ndarray:
    """Series along s at the points, its harmonics and components in one row."""
    return basis @ series.reshape(len(series), -1)


def _fourier(phase: np.ndarray, m: int) -> tuple[np.ndarray, np.ndarray]:
    """Basis ``[1, cos, sin, cos 2, ...]`` and its derivative, each (len(phase), m)."""
    h = (np.arange(m) + 1) // 2
    arg = phase[:, None] * h
    sine = np.arange(m) % 2 == 0
    basis = np.where(sine, np.sin(arg), np.cos(arg))
    slope = np.where(sine, h * np.cos(arg), -h * np.sin(arg))
    basis[:, 0] = 1.0
    return basis, slope


def _resolve(shape: Callable[[Any, Any], Any], lo: float, hi: float) -> np.ndarray:
    """Chebyshev-Fourier coefficients of P on [lo, hi], doubled until they have decayed."""
    n, m = 16, 8
    while True:
        x = np.cos(np.pi * (np.arange(n) + 0.5) / n)
        phase = 2.0 * np.pi * np.arange(m) / m
        s = (lo + hi + (hi - lo) * x[:, None]) / 2.0
        P = _sample(shape, s, phase)
        along = chebyshev.chebfit(x, P.reshape(n, -1), n - 1).reshape(n, m, 3)
        F = np.fft.rfft(along, axis=1) / m
        scale = np.abs(P).max() or 1.0
        rough_s = np.abs(F[-max(n // 8, 2) :]).max() > 1e-14 * n * scale
        rough_phase = np.abs(F[:, -max(m // 8, 1) :]).max() > 1e-14 * m * scale
        if not (rough_s or rough_phase):
            break
        n, m = (2 * n if rough_s else n), (2 * m if rough_phase else m)
        if n > 1024 or m > 512:
            raise SpecError(
                "tail.shape",
                getattr(shape, "__name__", "P"),
                "smooth in s between the breaks, and smooth and 2 pi-periodic in phase",
                "put the kinks of P into tail.breaks (fractions of the length)",
            )
    H = m // 2 - 1
    series = np.empty((n, 1 + 2 * H, 3))
    series[:, 0] = F[:, 0].real
    series[:, 1::2], series[:, 2::2] = 2.0 * F[:, 1 : H + 1].real, -2.0 * F[:, 1 : H + 1].imag
    return _trim(series, 1e-16 * scale)


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
