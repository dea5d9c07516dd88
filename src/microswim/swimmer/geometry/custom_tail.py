"""A tail from any function P(s, phase) that Python gives."""

from __future__ import annotations

from collections.abc import Callable, Sized
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.sampled_tail import SampledTail
from microswim.swimmer.geometry.tail import Sections, SurfaceMotion


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class CustomTail(SampledTail):
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
    tolerance
        How exactly P is followed, relative to its largest position: rounding by default, up to
        0.01 for a P that is not smooth, such as splines.
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
    tolerance: float = 0.0
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
        allowed = "a fraction from 0 to 0.01"
        checks.number("tail.tolerance", self.tolerance, allowed, least=0, most=0.01)
        _ = self._series

    @property
    def centre(self) -> Callable[[Any, Any], np.ndarray]:
        return self.shape
