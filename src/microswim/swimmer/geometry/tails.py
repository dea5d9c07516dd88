"""Tails: rotating helix and travelling plane wave [Tabak Eq. 12]; see also customtail.

A tail is its centreline ``P(s, phase)`` in the frame ``sqr`` (origin at the joint, s away from the
body) with ``phase = omega t``; tangent and velocity follow from P.

All formulas accept arrays and complex numbers (for design maps and the complex-step derivative);
the fields are checked on construction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.self_contact import nearest_turn

Sections = Literal["perpendicular", "sheared"]
SurfaceMotion = Literal["rigid", "translating", "bending"]


class Tail:
    """What all tails share. Use `HelicalTail`, `PlaneWaveTail` or `CustomTail`."""

    kind: ClassVar[str]
    sign: ClassVar[float] | float = 1.0
    radius: float
    frequency: float
    sections: str
    surface_motion: str

    @property
    def rate(self) -> Any:
        """Phase rate ``2 pi frequency`` (rad per time)."""
        return 2.0 * np.pi * self.frequency

    @property
    def spin(self) -> float:
        """Spin of each section about s per unit phase rate: the sign of a rigid tail, else 0."""
        return self.sign if self.surface_motion == "rigid" else 0.0

    def centreline(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, derivative along s, derivative in phase; each broadcast(s, phase) + (3,)."""
        raise TypeError("a tail is a HelicalTail, PlaneWaveTail or CustomTail")

    def _check_filament(self) -> None:
        checks.positive("tail.radius", self.radius, "length")
        checks.number("tail.frequency", self.frequency, "a finite number")
        checks.choice("tail.sections", self.sections, get_args(Sections))
        checks.choice("tail.surface_motion", self.surface_motion, get_args(SurfaceMotion))


@dataclass(frozen=True, kw_only=True)
class WaveTail(Tail):
    """A tail with a sinusoidal wave: the fields that helix and plane wave share.

    Parameters
    ----------
    length
        Length of the tail, along s or along the filament (`length_measure`).
    amplitude
        Amplitude b of the wave (length), the helix radius.
    waves, wavelength
        Number of waves ``N = L / lambda`` on the apparent length, or the wavelength along s:
        one of the two.
    radius
        Radius r_t of the filament (length).
    frequency
        Motor frequency: revolutions or beats per time, of the tail relative to the body. A
        negative frequency reverses it.
    ramp
        Fraction of the length over which the amplitude grows linearly from zero, 0 to 1.
    length_measure
        ``"apparent"``: `length` is along s. ``"arc"``: along the filament, converted with the
        ratio alpha of the full-amplitude wave (the ramp left out, as in Eq. 20).
    sections
        Cross-sections for the reference solvers: circles normal to the centreline
        (``"perpendicular"``) or in planes of constant s (``"sheared"``).
    surface_motion
        How the surface moves: with a rigid tail turning about s, spin of the filament included
        (``"rigid"``), each section translating (``"translating"``), or translating and turning
        with the tangent (``"bending"``). In the surrogate only the spin matters.

    Raises
    ------
    SpecError
        If a field is out of range, both or none of `waves` and `wavelength` are given, or the
        tail would touch itself.
    """

    length: float
    amplitude: float
    radius: float
    waves: float | None = None
    wavelength: float | None = None
    frequency: float = 1.0
    ramp: float = 0.1
    length_measure: Literal["apparent", "arc"] = "apparent"

    def __post_init__(self) -> None:
        checks.positive("tail.length", self.length, "length")
        checks.number("tail.amplitude", self.amplitude, "a length of zero or more", least=0.0)
        checks.number("tail.ramp", self.ramp, "a fraction from 0 to 1", least=0.0, most=1.0)
        checks.choice("tail.length_measure", self.length_measure, ("apparent", "arc"))
        self._check_filament()
        given = {"waves": self.waves, "wavelength": self.wavelength}
        if (self.waves is None) == (self.wavelength is None):
            raise SpecError(
                "tail.waves, tail.wavelength",
                tuple(given.values()),
                "one of the two",
                "leave one of them out; waves = length / wavelength",
            )
        for name, value in given.items():
            if value is not None:
                checks.positive(f"tail.{name}", value)
        self._check_shape()

    def _check_shape(self) -> None:
        """Refuse a tail that cannot be built: too short for its turns, or touching itself."""
        shortest = self._wound_length()
        if self.length_measure == "arc" and self.waves and shortest >= self.length:
            raise SpecError(
                "tail.length",
                self.length,
                f"longer than the windings it holds ({shortest:.6g})",
                "lengthen the filament or reduce amplitude or waves",
            )
        room = float(self.room())
        if room <= self.radius:
            raise SpecError(
                "tail.radius",
                self.radius,
                f"less than {room:.6g}, the room that this wave leaves",
                "thin the filament, lengthen the wave or lower it: this tail touches itself",
            )

    def _wound_length(self) -> float:
        """Arc length of the tail squeezed flat along s: the least that holds its windings."""
        raise TypeError("a wave is a HelicalTail or a PlaneWaveTail")

    def room(self) -> Any:
        """Largest filament radius before the tail touches itself."""
        raise TypeError("a wave is a HelicalTail or a PlaneWaveTail")

    @property
    def apparent_length(self) -> Any:
        """Length L along s."""
        if self.length_measure == "apparent":
            return self.length
        if self.waves is None:
            return self.length / self.stretch(self.amplitude * self.wavenumber)
        return self._apparent_from_arc(self._wound_length())

    @property
    def wavenumber(self) -> Any:
        """Wavenumber ``k = 2 pi / lambda`` (1/length)."""
        if self.wavelength is not None:
            return 2.0 * np.pi / self.wavelength
        return 2.0 * np.pi * self.waves / self.apparent_length

    @property
    def number_of_waves(self) -> Any:
        """Number of waves on the tail, ``N = L / lambda``."""
        if self.waves is not None:
            return self.waves
        return self.apparent_length / self.wavelength

    def stretch(self, bk: Any) -> Any:
        """Arc length over apparent length of a wave of amplitude x wavenumber `bk`."""
        raise TypeError("a wave is a HelicalTail or a PlaneWaveTail")

    def _apparent_from_arc(self, wound: Any) -> Any:
        """Apparent length L that holds the arc length, ``L stretch(wound / L) = length``."""
        raise TypeError("a wave is a HelicalTail or a PlaneWaveTail")

    @property
    def arc_length(self) -> Any:
        """Length along the filament of the full-amplitude wave (the ramp left out)."""
        return self.apparent_length * self.stretch(self.amplitude * self.wavenumber)

    @property
    def alpha(self) -> Any:
        """Apparent over actual length of the full-amplitude wave (for a plane wave: mean)."""
        raise TypeError("a wave is a HelicalTail or a PlaneWaveTail")

    def envelope(self, s: Any) -> tuple[Any, Any]:
        """Local amplitude ``b_s(s)`` and its derivative: linear on the ramp, then b."""
        s = np.asarray(s)
        end = self.ramp * self.apparent_length
        if np.real(end) == 0:
            return self.amplitude + 0 * s, 0 * s
        grows = np.real(s) < np.real(end)
        slope = self.amplitude / end
        return np.where(grows, slope * s, self.amplitude), np.where(grows, slope, 0.0)

    def centreline(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Centreline, slope and velocity per unit phase rate [Tabak Eqs. 11, 12].

        ``P = [s, b_s cos(ks - phase), -sign b_s sin(ks - phase)]`` (plane wave: r = 0).

        Parameters
        ----------
        s
            Coordinate along the axis, 0 to `apparent_length`.
        phase
            Phase (rad), broadcast against `s`.

        Returns
        -------
        tuple of ndarray
            ``(P, dP/ds, dP/dphase)``, each of shape broadcast(s, phase) + (3,).
        """
        s, phase = np.broadcast_arrays(s, phase)
        b, db = self.envelope(s)
        k = self.wavenumber
        out = -self.sign if self.kind == "helix" else 0.0
        c, d = np.cos(k * s - phase), np.sin(k * s - phase)
        P = np.stack([s + 0 * c, b * c, out * b * d], axis=-1)
        P_s = np.stack([1 + 0 * c, db * c - b * k * d, out * (db * d + b * k * c)], axis=-1)
        P_phase = np.stack([0 * c, b * d, -out * b * c], axis=-1)
        return P, P_s, P_phase


@dataclass(frozen=True, kw_only=True)
class HelicalTail(WaveTail):
    """Rotating rigid helix of either hand.

    A positive frequency turns a left-handed helix in the positive sense about s and a
    right-handed one in the negative sense: both push the body ahead (``u_s < 0``), and the two
    are mirror images.

    Parameters are those of `WaveTail`, and `handedness`.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> round(float(tail.alpha), 6)
    0.727727
    """

    handedness: Literal["left", "right"] = "left"
    sections: Sections = "perpendicular"
    surface_motion: SurfaceMotion = "rigid"
    kind: ClassVar[str] = "helix"

    def __post_init__(self) -> None:
        checks.choice("tail.handedness", self.handedness, ("left", "right"))
        super().__post_init__()

    @property
    def sign(self) -> float:
        """Sense of rotation about s at positive frequency: +1 left-handed, -1 right-handed."""
        return 1.0 if self.handedness == "left" else -1.0

    def stretch(self, bk: Any) -> Any:
        return np.sqrt(1.0 + bk**2)

    def _apparent_from_arc(self, wound: Any) -> Any:
        return np.sqrt(self.length**2 - wound**2)

    @property
    def alpha(self) -> Any:
        """``alpha = (1 + b^2 k^2)^-1/2``, apparent over actual length."""
        return 1.0 / self.stretch(self.amplitude * self.wavenumber)

    def _wound_length(self) -> float:
        return 2.0 * np.pi * self.amplitude * self.number_of_waves

    def room(self) -> Any:
        """Least of the radius of curvature and half the distance of neighbouring turns."""
        b, k = self.amplitude, self.wavenumber
        B2 = np.asarray((b * k) ** 2)
        with np.errstate(divide="ignore", over="ignore"):
            bend = (1.0 + B2) / np.asarray(b * k**2)
        near = np.asarray(nearest_turn(B2, self.number_of_waves))
        far = np.isinf(near)  # stays infinite: over a complex wavenumber it would not be a number
        return np.minimum(bend, np.where(far, np.inf, np.where(far, 1.0, near) / k / 2.0))


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

    def stretch(self, bk: Any) -> Any:
        """Arc length over apparent length, the mean of ``sqrt(1 + (bk cos x)^2)``."""
        x = np.linspace(0.0, np.pi, 512, endpoint=False)
        return np.mean(np.sqrt(1.0 + np.multiply.outer(bk**2, np.cos(x) ** 2)), axis=-1)

    def _apparent_from_arc(self, wound: Any) -> Any:
        """Newton's method; the slope ``d(L stretch)/dL`` is the mean local alpha."""
        wave = 0.5 * np.pi * wound
        L = self.length + 0.0 * wound
        for _ in range(60):
            L = L - (L * self.stretch(wave / L) - self.length) / _mean_alpha(wave / L)
        return L

    @property
    def alpha(self) -> Any:
        """Wavelength average of the local alpha, ``mean (1 + (bk cos x)^2)^-1/2``."""
        return _mean_alpha(self.amplitude * self.wavenumber)

    def _wound_length(self) -> float:
        return 4.0 * self.amplitude * self.number_of_waves

    def room(self) -> Any:
        """Least of the radius of curvature and half the distance of neighbouring limbs.

        A tail displaced section by section in q (sheared sections) never touches itself.
        """
        b, k = self.amplitude, self.wavenumber
        if self.sections == "sheared":
            return np.inf + 0.0 * b
        limbs = np.pi / k / np.sqrt(1.0 + (b * k) ** 2) / 2.0
        with np.errstate(divide="ignore", over="ignore"):
            bend = 1.0 / np.asarray(b * k**2)
        return np.minimum(bend, np.where(np.asarray(self.number_of_waves) > 0.5, limbs, np.inf))


def _mean_alpha(bk: Any) -> Any:
    """Mean of ``(1 + (bk cos x)^2)^-1/2`` over a wave: ``1 / agm(1, sqrt(1 + b^2 k^2))``."""
    a, g = 1.0, np.sqrt(1.0 + bk**2)
    for _ in range(7):
        a, g = (a + g) / 2.0, np.sqrt(a * g)
    return 1.0 / a
