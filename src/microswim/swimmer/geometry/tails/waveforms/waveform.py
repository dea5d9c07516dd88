"""A filmed beat, and the waveform that was found in it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.swimmer.geometry.tails.waveforms.waveform_tail import WaveformTail, mean_curvature


@dataclass(frozen=True, eq=False)
class Beat:
    """Points on a filament, in the frame of its head: base at the origin, x along its axis.

    Parameters
    ----------
    time, s
        Time and arc length of each point, shapes (n,).
    position
        Positions (n, 2) or (n, 3), or None where the film was read as angles.
    angle
        Tangent angles (n,) in rad, or None.
    """

    time: np.ndarray
    s: np.ndarray
    position: np.ndarray | None = None
    angle: np.ndarray | None = None

    @property
    def frames(self) -> np.ndarray:
        """Times of the frames."""
        return np.unique(self.time)

    @property
    def in_space(self) -> bool:
        """Whether the points leave a plane."""
        return self.position is not None and self.position.shape[1] == 3

    @property
    def filmed(self) -> np.ndarray:
        """What was filmed: positions (n, 2) or (n, 3), or angles (n, 1)."""
        found = self.angle[:, None] if self.angle is not None else self.position
        assert found is not None
        return found


@dataclass(frozen=True, eq=False, kw_only=True)
class Waveform:
    """The beat that was found in a film.

    Parameters
    ----------
    modes, modes_out, length, frequency
        As `WaveformTail` takes them.
    frequency_error
        Standard uncertainty of the frequency; zero where it was given.
    misfit
        Root mean square of what is left, per coordinate (length; rad for angles).
    noise
        The same as it would be foretold for frames left out: cross-validation.
    fitted
        What the beat says of each point, of the shape of the data.
    beat
        The points that were fitted.

    Examples
    --------
    >>> import numpy as np
    >>> from microswim.swimmer.geometry.tails.waveforms.waveform_fit import fit
    >>> t, s = (x.ravel() for x in np.meshgrid(np.arange(0, 2, 0.05), np.linspace(0, 1, 20)))
    >>> angle = 0.2 + 0.5 * s * np.cos(2 * np.pi * t)
    >>> found = fit(Beat(t, s, angle=angle))
    >>> round(found.frequency, 4), found.modes.shape, found.tail(radius=0.01).kind
    (1.0, (2, 3), 'waveform')
    """

    modes: np.ndarray
    length: float
    frequency: float
    frequency_error: float
    misfit: float
    noise: float
    fitted: np.ndarray
    beat: Beat
    modes_out: np.ndarray | None = None

    @property
    def filmed(self) -> np.ndarray:
        """The data, of the shape of `fitted`."""
        return self.beat.filmed

    def as_dict(self) -> dict[str, Any]:
        """Return what there is to print or to store as JSON."""
        half = 1.96 * self.frequency_error
        return {
            "frequency": self.frequency,
            "interval_95": {"frequency": [self.frequency - half, self.frequency + half]},
            "length": self.length,
            "wavelength": self.tail(radius=0.01 * self.length).wavelength,
            "mean_curvature": self.mean_curvature,
            "modes": self.modes.tolist(),
            **({} if self.modes_out is None else {"modes_out": self.modes_out.tolist()}),
            "misfit": self.misfit,
            "noise": self.noise,
            "of": "tangent angle (rad)" if self.beat.angle is not None else "position",
            "frames": int(self.beat.frames.size),
            "beats": float(np.ptp(self.beat.time) * abs(self.frequency)),
        }

    def tail(self, *, radius: float, **fields: Any) -> WaveformTail:
        """Return the tail with this beat; fields as `WaveformTail` takes them."""
        own: dict[str, Any] = {"length": self.length, "frequency": self.frequency}
        own |= {"modes": self.modes, "modes_out": self.modes_out}
        return WaveformTail(radius=radius, **{**own, **fields})

    @property
    def mean_curvature(self) -> float:
        """Mean over the filament and the beat of ``d psi / ds``."""
        return mean_curvature(self.modes, self.length)
