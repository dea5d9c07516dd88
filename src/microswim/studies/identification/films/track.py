"""Tracks: times and positions of a swimmer's body centre, 2-D or 3-D, optionally its attitude.

The frequency of the wobble comes from a track's spectrum, which needs no model of the swimmer.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.array import kept, read_only
from microswim.studies.identification.spectrum import power

FEWEST = 12


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False)
@read_only
class Track:
    """Track of the centre of a swimmer's body.

    Parameters
    ----------
    time
        Times, increasing, shape (n,), n at least 12.
    position
        Positions in the lab frame, shape (n, 2) or (n, 3); two columns are the projection of the
        path onto the plane x-y.
    quaternion
        Attitude ``wxyz``, body to lab, shape (n, 4), or None.

    Raises
    ------
    SpecError
        If shapes do not fit, times do not increase or a number is not finite.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> t = np.linspace(0, 3, 31)
    >>> ms.Track(time=t, position=np.stack([t, 0 * t], axis=-1)).dimensions
    2
    """

    time: np.ndarray
    position: np.ndarray
    quaternion: np.ndarray | None = None

    def __post_init__(self) -> None:
        for name in ("time", "position", "quaternion"):
            value = getattr(self, name)
            if value is None and name == "quaternion":
                continue
            if isinstance(value, np.ndarray) and value.dtype.kind == "f" and np.isnan(value).any():
                raise SpecError(f"track.{name}", "a hole", "finite numbers", "drop that row")
            checks.series(f"track.{name}", value)
            object.__setattr__(self, name, np.asarray(value, dtype=float))
        n = self.time.size
        if self.time.ndim != 1 or n < FEWEST or (np.diff(self.time) <= 0).any():
            raise SpecError("track.time", f"{n} times", f"at least {FEWEST} increasing times")
        if scattered(self.time):
            raise SpecError(f"track.time: {scattered(self.time)}")
        if self.position.shape not in ((n, 2), (n, 3)):
            raise SpecError("track.position", self.position.shape, f"of shape ({n}, 2) or ({n}, 3)")
        if self.quaternion is not None:
            if self.quaternion.shape != (n, 4):
                raise SpecError("track.quaternion", self.quaternion.shape, f"of shape ({n}, 4)")
            norm = np.linalg.norm(self.quaternion, axis=1, keepdims=True)
            if (np.abs(norm - 1.0) > 0.2).any():
                raise SpecError("track.quaternion", "not unit", "unit quaternions wxyz")
            object.__setattr__(self, "quaternion", self.quaternion / norm)

    @property
    def dimensions(self) -> int:
        """2 or 3."""
        return self.position.shape[1]

    @property
    def duration(self) -> float:
        """Time from first to last sample."""
        return float(self.time[-1] - self.time[0])

    @cached_property
    def smooth(self) -> np.ndarray:
        """The path without its wobble: a polynomial of degree 4 through each coordinate."""
        x = 2.0 * (self.time - self.time[0]) / self.duration - 1.0
        basis = np.polynomial.legendre.legvander(x, 4)
        return kept(basis @ np.linalg.lstsq(basis, self.position, rcond=None)[0])

    @property
    def speed(self) -> float:
        """Speed along the smoothed path."""
        steps = np.linalg.norm(np.diff(self.smooth, axis=0), axis=1)
        return float(steps.sum() / self.duration)

    def spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        """Return frequencies and power of the wobble, from two cycles in the track to the Nyquist
        limit.

        Least squares of a sine at each frequency (Lomb 1976), so uneven sampling is allowed.
        """
        return power(self.time, self.position - self.smooth)

    def wobble(self) -> tuple[float, float, float]:
        """Return the frequency, amplitude and share of the strongest line of the spectrum.

        Raises
        ------
        SpecError
            If the track is too short or too coarse for any wobble.
        """
        f, share = self.spectrum()
        if f.size < 3:
            raise SpecError(
                "track.time", f"{self.duration:g} long", "long and dense enough for a few beats"
            )
        i = int(np.argmax(share))
        peak = f[i]
        if 0 < i < f.size - 1:
            bend = share[i - 1] - 2 * share[i] + share[i + 1]
            peak += 0.5 * (share[i - 1] - share[i + 1]) / bend * (f[1] - f[0]) if bend else 0.0
        left = self.position - self.smooth
        amplitude = np.sqrt(2.0 * share[i] * np.sum(left**2) / len(left))
        return float(peak), float(amplitude), float(share[i])


def scattered(time: np.ndarray) -> str:
    """Return why times are too far apart for a film, as by a wrong number; or nothing."""
    span = checks.nearly_empty(time)
    return f"{time.size} positions in {span:.3g} frames' time: is a time wrong?" if span else ""
