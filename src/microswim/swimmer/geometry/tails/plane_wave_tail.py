"""The travelling plane wave [Tabak Eq. 12]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.series.fourier import MIRROR_Q
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion
from microswim.swimmer.geometry.tails.wave_tail import WaveTail

STEPS = 7  #: of the arithmetic-geometric mean, to rounding where a wave is not absurdly steep


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class PlaneWaveTail(WaveTail):
    """Travelling plane wave in the plane s-q, moving away from the body.

    Parameters are those of `WaveTail`.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.PlaneWaveTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> tail.surface_motion
    'translating'
    """

    sections: Sections = "sheared"
    surface_motion: SurfaceMotion = "translating"
    kind: ClassVar[str] = "plane_wave"
    rft_loop: ClassVar[str] = "plane_wave"
    beats_in_plane: ClassVar[bool] = True
    half_period_signs: ClassVar[np.ndarray | None] = MIRROR_Q

    def __post_init__(self) -> None:
        if self.surface_motion == "rigid":
            raise SpecError(
                "tail.surface_motion", "rigid", "translating or bending", "a plane wave cannot turn"
            )
        super().__post_init__()

    @property
    def sign(self) -> float:
        return 1.0

    @property
    def out_of_plane(self) -> float:
        return 0.0

    def stretch(self, bk: Any) -> Any:
        """Return the arc length over apparent length, the mean of ``sqrt(1 + (bk cos x)^2)``.

        It is ``2/pi sqrt(1 + B^2) E(k)`` with ``k^2 = B^2 / (1 + B^2)``, and E by the
        arithmetic-geometric mean [Abramowitz and Stegun 17.6.4]: ``1 - sum 2^(n-1) c_n^2`` over it.
        """
        square = bk * bk
        whole = np.sqrt(1.0 + square)
        a, g, left = 1.0, 1.0 / whole, 1.0 - 0.5 * square / (1.0 + square)
        for n in range(STEPS):
            left = left - 2.0 ** (n - 2) * (a - g) ** 2
            a, g = (a + g) / 2.0, np.sqrt(a * g)
        return whole * left / a

    def _apparent_from_arc(self, wound: Any) -> Any:
        """Newton's method; the slope ``d(L stretch)/dL`` is the mean local alpha.

        Not a number where so much cannot be wound up. From above the arc length, convex in L, comes
        down to the root; once it stands still one step more settles what a complex number's
        imaginary part lags behind.
        """
        wave, holds = 0.5 * np.pi * wound, np.real(wound) < np.real(self.length)
        L, still = np.where(holds, self.length + 0.0 * wound, np.nan)[()], False
        for _ in range(60):
            step = (L * self.stretch(wave / L) - self.length) / _mean_alpha(wave / L)
            L = L - step
            if still:
                break
            still = not np.any(abs(step) > 1e-12 * abs(L))
        return L

    def alpha_of(self, bk: Any) -> Any:
        """Return the wavelength average of the local alpha, ``mean (1 + (bk cos x)^2)^-1/2``."""
        return _mean_alpha(bk)

    def wound_length(self) -> float:
        return 4.0 * self.amplitude * self.number_of_waves

    @property
    def may_touch_itself(self) -> bool:
        return self.sections != "sheared"

    def room(self, amplitude: Any = None) -> Any:
        """Return the least of the radius of curvature and half the distance of neighbouring limbs.

        A tail displaced section by section in q (sheared sections) never touches itself.
        """
        b, k = self.amplitude if amplitude is None else amplitude, self.wavenumber
        if not self.may_touch_itself:
            return np.inf + 0.0 * b
        limbs = np.pi / k / np.sqrt(1.0 + (b * k) ** 2) / 2.0
        with np.errstate(divide="ignore", over="ignore"):
            bend = 1.0 / np.asarray(b * k**2)
        return np.minimum(bend, np.where(np.asarray(self.number_of_waves) > 0.5, limbs, np.inf))


def _mean_alpha(bk: Any) -> Any:
    """Mean of ``(1 + (bk cos x)^2)^-1/2`` over a wave: ``1 / agm(1, sqrt(1 + b^2 k^2))``."""
    a, g = 1.0, np.sqrt(1.0 + bk**2)
    for _ in range(STEPS):
        a, g = (a + g) / 2.0, np.sqrt(a * g)
    return 1.0 / a
