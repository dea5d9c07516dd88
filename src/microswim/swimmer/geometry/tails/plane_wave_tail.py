"""The travelling plane wave [Tabak Eq. 12]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.numerics.series.fourier import MIRROR_Q
from microswim.swimmer.geometry.tails.flagellum import Flagellum
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion
from microswim.swimmer.geometry.tails.wave_tail import WaveTail

STEPS = 7  #: of the arithmetic-geometric mean, to rounding where a wave is not absurdly steep


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class PlaneWaveTail(WaveTail):
    """Travelling plane wave in the plane s-q, moving away from the body.

    Parameters
    ----------
    mean_curvature
        Of a beat that is not symmetric (1/length), towards q where positive: its swimmer circles.
        The tangent angle then is the wave, as flagella beat, and s goes along the filament:
        ``K s - k b sin(ks - phase)``. Arc length and number of waves are those of the straight
        wave. Sections are perpendicular by default.
    length, amplitude, ...
        All others are those of `WaveTail`.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.PlaneWaveTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> tail.surface_motion
    'translating'
    """

    mean_curvature: float | None = None
    sections: Sections = None  # type: ignore[assignment]
    surface_motion: SurfaceMotion = "translating"
    kind: ClassVar[str] = "plane_wave"
    rft_loop: ClassVar[str] = "plane_wave"
    #: The field that is chosen anew where another comes or goes.
    chosen_by: ClassVar[dict[str, str]] = {"mean_curvature": "sections"}
    beats_in_plane: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.surface_motion == "rigid":
            raise SpecError(
                "tail.surface_motion", "rigid", "translating or bending", "a plane wave cannot turn"
            )
        bent = self.mean_curvature is not None
        if self.sections is None:
            object.__setattr__(self, "sections", "perpendicular" if bent else "sheared")
        super().__post_init__()
        if bent:
            self._check_bent()

    def _check_bent(self) -> None:
        """Refuse an axis that closes to a circle."""
        K, most = self.mean_curvature, 2.0 * np.pi / float(np.real(self.arc_length))
        checks.number("tail.mean_curvature", K, "a finite curvature, 1/length")
        if abs(K) >= most:  # type: ignore[arg-type]
            raise SpecError(
                "tail.mean_curvature",
                K,
                f"less than {measured(most, 'tail.mean_curvature')} in magnitude",
                "the tail would close to a circle",
            )

    @property
    def half_period_signs(self) -> np.ndarray | None:  # type: ignore[override]
        """Signs of the mirror image half a period on, which a bent axis has none of."""
        return MIRROR_Q if self.mean_curvature is None else None

    @property
    def is_plain(self) -> bool:
        return self.is_along_s and super().is_plain

    @property
    def is_along_s(self) -> bool:
        return self.mean_curvature is None

    @property
    def flagellum(self) -> Flagellum | None:
        """Shape of a beat with a mean curvature, by its tangent angle; None of a straight one."""
        if self.mean_curvature is None:
            return None
        L, waves = self.arc_length, self.number_of_waves
        return Flagellum(
            curvature=self.mean_curvature,
            wavenumber=2.0 * np.pi * waves / L,
            length=L,
            envelope=lambda s: self.envelope(s)[0],
            ramp=self.ramp * L,
        )

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        shape = self.flagellum
        return super().curve(s, phase) if shape is None else shape.curve(s, phase)

    def radial(self, s: Any, phase: Any) -> np.ndarray:
        if self.mean_curvature is None or self.is_placed:
            return super().radial(s, phase)
        slope = self.curve(s, phase)[1]
        return np.stack([-slope[..., 1], slope[..., 0], slope[..., 2]], axis=-1)

    @property
    def bend(self) -> Any:
        return self.mean_curvature or 0.0

    @property
    def apparent_length(self) -> Any:
        """Length L along s; along the filament if the tail has a mean curvature."""
        return super().apparent_length if self.mean_curvature is None else self.arc_length

    @property
    def arc_length(self) -> Any:
        if self.mean_curvature is None:
            return super().arc_length
        if self.length_measure == "arc":
            return self.length
        return self.length * self.stretch(
            2.0 * np.pi * self.amplitude * self.number_of_waves / self.length
        )

    @property
    def number_of_waves(self) -> Any:
        if self.mean_curvature is None or self.wavelength is None:
            return super().number_of_waves
        return self.length / self.wavelength

    @property
    def wavelength_along_s(self) -> Any:
        if self.mean_curvature is None:
            return super().wavelength_along_s
        return self.arc_length / self.number_of_waves

    @property
    def wavenumber(self) -> Any:
        if self.mean_curvature is None:
            return super().wavenumber
        return 2.0 * np.pi / self.wavelength_along_s

    @property
    def alpha(self) -> Any:
        shape = self.flagellum
        return super().alpha if shape is None else shape.alpha

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
        if self.mean_curvature is not None:
            return 0.0  # a filament that is given its angle holds any
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
