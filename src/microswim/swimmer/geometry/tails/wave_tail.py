"""A tail with a sinusoidal wave [Tabak Eqs. 11, 12]: what helix and plane wave share.

All formulas accept arrays and complex numbers (for design maps and the complex-step derivative);
the fields are checked on construction.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.swimmer.geometry.tails.placed_tail import PlacedTail


@dataclass(frozen=True, kw_only=True)
class WaveTail(PlacedTail, ABC):
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
    amplitude_end
        Amplitude at the tip; the amplitude between goes with s from `amplitude`, `ramp` apart. By
        default the same: the wave is not conical.
    radius
        Radius r_t of the filament (length); left out where `section` is given.
    section
        Half axes (a, b) of an elliptic cross-section: a along the normal (away from the axis of a
        helix, in the plane of a plane wave), b along the binormal. Round by default.
    radius_end
        Radius of the filament at the tip, of a ribbon its mean half axis there; the radius between
        goes with s. By default the same.
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
    position, direction, phase
        Where it stands and how far ahead it beats, as for `PlacedTail`.

    Raises
    ------
    SpecError
        If a field is out of range, both or none of `waves` and `wavelength` are given, or the
        tail would touch itself.
    """

    length: float
    amplitude: float
    radius: float = None  # type: ignore[assignment]
    waves: float | None = None
    wavelength: float | None = None
    frequency: float = 1.0
    ramp: float = 0.1
    length_measure: Literal["apparent", "arc"] = "apparent"
    amplitude_end: float | None = None
    section: tuple[float, float] | None = None
    radius_end: float | None = None

    def __post_init__(self) -> None:
        checks.positive("tail.length", self.length, "length")
        checks.number("tail.amplitude", self.amplitude, "a length of zero or more", least=0.0)
        checks.number("tail.ramp", self.ramp, "a fraction from 0 to 1", least=0.0, most=1.0)
        if self.ramp:
            checks.positive("tail.ramp", self.ramp, "fraction, or zero")
        checks.choice("tail.length_measure", self.length_measure, ("apparent", "arc"))
        self._check_section()
        self._check_filament()
        if self.radius_end is not None:
            checks.positive("tail.radius_end", self.radius_end, "length")
        self._check_place()
        if self.amplitude_end is not None:
            allowed = "a length of zero or more"
            checks.number("tail.amplitude_end", self.amplitude_end, allowed, least=0.0)
            if self.length_measure == "arc":
                raise SpecError("tail.length_measure", "arc", '"apparent" for a conical tail')
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

    def _check_section(self) -> None:
        """Refuse half axes that are none, or beside a radius of their own; they set the radius."""
        if self.section is None:
            if self.radius is None:
                raise SpecError("tail.radius: missing; add it, or tail.section = [a, b]")
            return
        checks.numbers("tail.section", self.section, 2, "two positive half axes", above=0.0)
        object.__setattr__(self, "section", tuple(self.section))
        mean = 0.5 * sum(self.section)
        if self.radius is not None and abs(self.radius - mean) > 1e-9 * mean:
            raise SpecError(
                "tail.radius",
                self.radius,
                f"left out beside tail.section = {self.section!r}, whose mean half axis it is",
            )
        object.__setattr__(self, "radius", mean)

    def _check_shape(self) -> None:
        """Refuse a tail that cannot be built: too short for its turns, or touching itself."""
        shortest = self.wound_length()
        if self.length_measure == "arc" and self.waves and shortest >= self.length:
            raise SpecError(
                "tail.length",
                self.length,
                f"longer than the windings it holds ({measured(shortest, 'tail.length')})",
                "lengthen the filament or reduce amplitude or waves",
            )
        room = min(float(self.room(b)) for b in self._amplitudes())
        name = "tail.radius" if self.section is None else "tail.section"
        widest = float(max(self.half_axes))
        if self.radius_end is not None and self.radius_end > self.radius:
            name, widest = "tail.radius_end", widest * float(self.radius_end / self.radius)
        if room <= widest:
            raise SpecError(
                name,
                widest,
                f"less than {measured(room, name)}, the room that this wave leaves",
                "thin the filament, lengthen the wave or lower it: this tail touches itself",
            )

    @abstractmethod
    def wound_length(self) -> float:
        """Return the arc length of the tail squeezed flat along s: the least that holds its
        windings.
        """

    @property
    def may_touch_itself(self) -> bool:
        """Whether some filament is too thick for such a wave, see `room`."""
        return True

    @abstractmethod
    def room(self, amplitude: Any = None) -> Any:
        """Return the largest filament radius before a wave of an amplitude touches itself."""

    def _amplitudes(self) -> Any:
        """Amplitudes along the tail, the ramp left out, that stand for all."""
        if self.amplitude_end is None:
            return (self.amplitude,)
        return np.linspace(float(self.amplitude), float(self.amplitude_end), 21)

    @property
    def is_along_s(self) -> bool:
        """Whether it is a wave about the straight axis s, by its displacement."""
        return True

    @property
    def is_plain(self) -> bool:
        """Whether the wave is of one amplitude, the filament round, of one radius and at the
        joint.
        """
        given = (self.amplitude_end, self.section, self.radius_end)
        return all(value is None for value in given) and not self.is_placed

    @property
    def in_batches(self) -> bool:
        return self.is_plain

    @property
    def apparent_length(self) -> Any:
        """Length L along s."""
        if self.length_measure == "apparent":
            return self.length
        if self.waves is None:
            return self.length / self.stretch(self.amplitude * self.wavenumber)
        return self._apparent_from_arc(self.wound_length())

    @property
    def wavenumber(self) -> Any:
        """Wavenumber ``k = 2 pi / lambda`` (1/length)."""
        if self.wavelength is not None:
            return 2.0 * np.pi / self.wavelength
        return 2.0 * np.pi * self.number_of_waves / self.apparent_length

    @property
    def number_of_waves(self) -> Any:
        """Number of waves on the tail, ``N = L / lambda``."""
        if self.wavelength is None:
            return self.waves
        return self.apparent_length / self.wavelength

    @abstractmethod
    def stretch(self, bk: Any) -> Any:
        """Return the arc length over apparent length of a wave of amplitude x wavenumber `bk`."""

    @abstractmethod
    def _apparent_from_arc(self, wound: Any) -> Any:
        """Apparent length L that holds the arc length, ``L stretch(wound / L) = length``."""

    @property
    def wavelength_along_s(self) -> Any:
        return 2.0 * np.pi / self.wavenumber if self.wavelength is None else self.wavelength

    @property
    def edges(self) -> np.ndarray:
        return np.unique([0.0, float(np.real(self.ramp)), 1.0])

    @property
    @abstractmethod
    def out_of_plane(self) -> float:
        """Factor of ``b_s sin(ks - phase)`` in r: ``-sign`` of a helix, 0 of a plane wave."""

    @property
    def arc_length(self) -> Any:
        """Length along the filament of the full-amplitude wave (the ramp left out)."""
        if self.amplitude_end is not None:
            return self.apparent_length * np.mean(self._speeds(), axis=(0, 1))
        return self.apparent_length * self.stretch(self.amplitude * self.wavenumber)

    @property
    def alpha(self) -> Any:
        """Apparent over actual length of the full-amplitude wave, averaged along it."""
        if self.amplitude_end is not None:
            return np.mean(1.0 / self._speeds(), axis=(0, 1))
        return self.alpha_of(self.amplitude * self.wavenumber)

    @abstractmethod
    def alpha_of(self, bk: Any) -> Any:
        """Return the apparent over actual length of a wave of amplitude x wavenumber `bk`."""

    def _speeds(self) -> Any:
        """``|dP/ds|`` of a conical wave, its ramp left out, alike over the tail and the period.

        Shape (n, 32, ...), the last axes those of the numbers of many designs.
        """
        waves, k, L = self.number_of_waves, self.wavenumber, self.apparent_length
        more = (1,) * np.ndim(L + k + self.amplitude + self.amplitude_end)
        n = 64 * int(np.ceil(max(1.0, float(np.max(np.real(waves))))))
        s = L * ((np.arange(n) + 0.5) / n).reshape(n, 1, *more)
        angle = (2.0 * np.pi * np.arange(32) / 32).reshape(32, *more)
        b, db = self.taper(s)
        q = db * np.cos(angle) - b * k * np.sin(angle)
        r = self.out_of_plane * (db * np.sin(angle) + b * k * np.cos(angle))
        return np.sqrt(1.0 + q * q + r * r)

    def taper(self, s: Any) -> tuple[Any, Any]:
        """Return amplitude and slope at s, the ramp left out: linear up to `amplitude_end`."""
        end = self.amplitude if self.amplitude_end is None else self.amplitude_end
        slope = (end - self.amplitude) / self.apparent_length
        return self.amplitude + slope * s, slope + 0.0 * s

    def narrowing(self, s: Any) -> Any:
        """Return the half axes at s over those at the root, ``1 + (r_end/r - 1) s/L``."""
        if self.radius_end is None:
            return 1.0 + 0.0 * np.asarray(s)
        along = s / self.apparent_length
        along = np.where(np.real(along) < 0.0, 0.0, along)
        return 1.0 + (self.radius_end / self.radius - 1.0) * along

    def envelope(self, s: Any) -> tuple[Any, Any]:
        """Return ``b_s(s) = min(1, s/s_0) (b + (b_end - b) s/L)`` and its derivative."""
        s = np.asarray(s)
        end = self.ramp * self.apparent_length
        b, db = self.taper(s)
        if np.real(end) == 0:
            return b, db
        grows = np.real(s) < np.real(end)
        return np.where(grows, b * s / end, b), np.where(grows, (b + db * s) / end, db)

    def radial(self, s: Any, phase: Any) -> np.ndarray:
        """Return the unit vector (..., 3) across the axis in which the wave swings out at s."""
        if self.is_placed:
            own: Any = self.own
            return self.placement.turned(own.radial(s, self.own_phase(phase)))
        s, phase = np.broadcast_arrays(s, phase)
        angle = self.wavenumber * s - phase
        if not self.out_of_plane:
            return np.stack([0.0 * angle, 1.0 + 0.0 * angle, 0.0 * angle], axis=-1)
        q, r = np.cos(angle), self.out_of_plane * np.sin(angle)
        return np.stack([0.0 * angle, q, r], axis=-1)

    def continued(self, s: Any, phase: Any) -> np.ndarray:
        """Return the position at s, behind the joint by the same formula."""
        return self.centreline(s, phase)[0]

    @property
    def starts_on_axis(self) -> bool:
        """Whether a ramp starts the wave at the joint."""
        return float(np.real(self.ramp)) > 0.0

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the centreline, slope and velocity per unit phase rate [Tabak Eqs. 11, 12].

        ``P = [s, b_s cos(ks - phase), out b_s sin(ks - phase)]`` with `out_of_plane`.

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
        out = self.out_of_plane
        c, d = np.cos(k * s - phase), np.sin(k * s - phase)
        P = np.stack([s + 0 * c, b * c, out * b * d], axis=-1)
        P_s = np.stack([1 + 0 * c, db * c - b * k * d, out * (db * d + b * k * c)], axis=-1)
        P_phase = np.stack([0 * c, b * d, -out * b * c], axis=-1)
        return P, P_s, P_phase
