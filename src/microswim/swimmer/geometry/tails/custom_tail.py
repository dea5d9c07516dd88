"""A tail from any function P(s, phase) that Python gives."""

from __future__ import annotations

from collections.abc import Callable, Sized
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait.readable import percent
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion
from microswim.swimmer.geometry.tails.waveforms.sampled_tail import SampledTail

#: Share of its motion that a rigid tail may lack of turning as a whole.
RIGID = 1e-3


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
        Sense of rotation about s (+1 or -1) for ``surface_motion = "rigid"``; found from P, and
        refused where P turns the other way.
    sections, surface_motion, position, direction, phase
        As for `WaveTail`; P is in the tail's own frame.

    Raises
    ------
    SpecError
        If a field is out of range, P is not finite, not periodic or not smooth, or said to be
        rigid and does not turn as a whole about s.

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
    sign: float = None  # type: ignore[assignment]
    sections: Sections = "perpendicular"
    surface_motion: SurfaceMotion = "translating"
    kind: ClassVar[str] = "custom"

    def __post_init__(self) -> None:
        checks.positive("tail.length", self.length, "length")
        self._check_filament()
        self._check_place()
        if self.wavelength is not None:
            checks.positive("tail.wavelength", self.wavelength, "length")
        if self.sign is not None:
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
        object.__setattr__(self, "sign", self._sense())

    def _sense(self) -> float:
        """Return the sign of a rigid tail's turning, ``dP/dphase = sign e_s x P``, else that given.

        By least squares over the tail and the period; what is left over says whether it is rigid.
        """
        given = 1.0 if self.sign is None else float(self.sign)
        if self.surface_motion != "rigid":
            return given
        length = float(np.real(self.length))
        s, phase = np.linspace(0.0, length, 33)[:, None], np.arange(8) * np.pi / 4.0
        P, _, moved = self.curve(s, phase)
        turned = np.stack([0.0 * P[..., 0], -P[..., 2], P[..., 1]], axis=-1)
        size = float(np.sum(turned**2))
        if size <= (1e-9 * length) ** 2:
            return given  # straight along s: it may turn either way
        sense = float(np.sum(turned * moved)) / size
        found = 1.0 if sense > 0 else -1.0
        left = float(np.sqrt(np.sum((moved - found * turned) ** 2) / size))
        if left > RIGID + 100.0 * self.tolerance:
            raise SpecError(
                "tail.surface_motion", "rigid", "a motion of P(s, phase) that turns it as a whole "
                f"about s by the phase (dP/dphase misses e_s x P by {percent(left)})",
                "translating or bending, or another P",
            )  # fmt: skip
        if self.sign is not None and given != found:
            raise SpecError(
                "tail.sign", given, f"{found:+g}, the sense in which P(s, phase) itself turns",
                "leave it out: it is found",
            )  # fmt: skip
        return found

    @property
    def centre(self) -> Callable[[Any, Any], np.ndarray]:
        return self.shape
