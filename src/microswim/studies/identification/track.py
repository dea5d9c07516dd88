"""Tracks: times and positions of a swimmer's body centre, 2-D or 3-D, optionally its attitude.

Reads the CSV of `identify`, and finds the frequency of the wobble in a track's spectrum, which
needs no model of the swimmer.
"""

from __future__ import annotations

import csv
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.spec.text import LARGEST_TABLE, read_text

_NAMES = {"t": "time", "qw": "w", "qx": "i", "qy": "j", "qz": "k"}
_ATTITUDE = ("w", "i", "j", "k")
FEWEST = 12


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False)
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
            object.__setattr__(self, name, checks.kept(value))
        n = self.time.size
        if self.time.ndim != 1 or n < FEWEST or (np.diff(self.time) <= 0).any():
            raise SpecError("track.time", f"{n} times", f"at least {FEWEST} increasing times")
        if self.position.shape not in ((n, 2), (n, 3)):
            raise SpecError("track.position", self.position.shape, f"of shape ({n}, 2) or ({n}, 3)")
        if self.quaternion is not None:
            if self.quaternion.shape != (n, 4):
                raise SpecError("track.quaternion", self.quaternion.shape, f"of shape ({n}, 4)")
            norm = np.linalg.norm(self.quaternion, axis=1, keepdims=True)
            if (np.abs(norm - 1.0) > 0.2).any():
                raise SpecError("track.quaternion", "not unit", "unit quaternions wxyz")
            object.__setattr__(self, "quaternion", checks.kept(self.quaternion / norm))

    @classmethod
    def from_csv(cls, path: str | PathLike[str], *, si: bool = False) -> Track:
        """Read ``time, x, y[, z][, qw, qx, qy, qz]``; a column may name its unit: ``x (um)``.

        Parameters
        ----------
        path
            CSV file with a header.
        si
            Whether the swimmer is in SI units: then units in the header are converted; without
            units the numbers are taken as they are.

        Raises
        ------
        SpecError
            If a column is missing, a number cannot be read or a unit does not fit.
        """
        header, rows = _rows(path)
        columns: dict[str, np.ndarray] = {}
        for i, title in enumerate(header):
            name, factor = _column(title, si, path)
            columns[name] = factor * np.array([_number(row, i, path) for row in rows])
        missing = [name for name in ("time", "x", "y") if name not in columns]
        if missing:
            raise SpecError(
                f"{path}: no column {missing[0]}; a track has the columns time, x, y and if known "
                "z, qw, qx, qy, qz"
            )
        axes = ["x", "y", "z"] if "z" in columns else ["x", "y"]
        attitude = None
        if all(name in columns for name in _ATTITUDE):
            attitude = np.stack([columns[name] for name in _ATTITUDE], axis=-1)
        position = np.stack([columns[name] for name in axes], axis=-1)
        return cls(time=columns["time"], position=position, quaternion=attitude)

    @property
    def dimensions(self) -> int:
        """2 or 3."""
        return self.position.shape[1]

    @property
    def duration(self) -> float:
        """Time from first to last sample."""
        return float(self.time[-1] - self.time[0])

    @property
    def smooth(self) -> np.ndarray:
        """The path without its wobble: a polynomial of degree 4 through each coordinate."""
        x = 2.0 * (self.time - self.time[0]) / self.duration - 1.0
        basis = np.polynomial.legendre.legvander(x, 4)
        return basis @ np.linalg.lstsq(basis, self.position, rcond=None)[0]

    @property
    def speed(self) -> float:
        """Speed along the smoothed path."""
        steps = np.linalg.norm(np.diff(self.smooth, axis=0), axis=1)
        return float(steps.sum() / self.duration)

    def spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies and power of the wobble, from two cycles in the track to the Nyquist limit.

        Least squares of a sine at each frequency (Lomb 1976), so uneven sampling is allowed.
        """
        t, left = self.time - self.time.mean(), self.position - self.smooth
        low, high = 2.0 / self.duration, 0.5 / float(np.median(np.diff(self.time)))
        f = np.arange(low, high, 0.1 / self.duration)
        power = np.zeros(f.size)
        for i, frequency in enumerate(f):
            c, s = np.cos(2 * np.pi * frequency * t), np.sin(2 * np.pi * frequency * t)
            basis = np.stack([c, s, np.ones_like(t)], axis=-1)
            fit = basis @ np.linalg.lstsq(basis, left, rcond=None)[0]
            power[i] = np.sum((fit - fit.mean(axis=0)) ** 2)
        return f, power / max(float(np.sum(left**2)), 1e-300)

    def wobble(self) -> tuple[float, float, float]:
        """Frequency, amplitude and share of the strongest line of the spectrum.

        Raises
        ------
        SpecError
            If the track is too short or too coarse for any wobble.
        """
        f, power = self.spectrum()
        if f.size < 3:
            raise SpecError(
                "track.time", f"{self.duration:g} long", "long and dense enough for a few beats"
            )
        i = int(np.argmax(power))
        peak = f[i]
        if 0 < i < f.size - 1:
            bend = power[i - 1] - 2 * power[i] + power[i + 1]
            peak += 0.5 * (power[i - 1] - power[i + 1]) / bend * (f[1] - f[0]) if bend else 0.0
        left = self.position - self.smooth
        amplitude = np.sqrt(2.0 * power[i] * np.sum(left**2) / len(left))
        return float(peak), float(amplitude), float(power[i])


def _rows(path: str | PathLike[str]) -> tuple[list[str], list[list[str]]]:
    lines = read_text(path, LARGEST_TABLE).splitlines()
    try:
        rows = [r for r in csv.reader(line for line in lines if not line.startswith("#")) if r]
    except csv.Error as error:
        raise SpecError(f"{path}: not a CSV: {error}") from None
    if len(rows) < 2:
        raise SpecError(f"{path}: no rows; a track has a header and at least {FEWEST} rows")
    return rows[0], rows[1:]


def _number(row: list[str], i: int, path: Any) -> float:
    try:
        return float(row[i])
    except (ValueError, IndexError):
        raise SpecError(f"{path}: a number is missing in the row {', '.join(row)[:60]}") from None


def _column(title: str, si: bool, path: Any) -> tuple[str, float]:
    """Name and factor to the swimmer's units of a column."""
    name, _, unit = title.strip().lower().partition("(")
    name = _NAMES.get(name.strip(), name.strip())
    unit = title.strip().partition("(")[2].rstrip(") ").strip()
    if not unit:
        return name, 1.0
    if not si:
        raise SpecError(
            f"{path}: the column {title.strip()} has a unit and the swimmer has none; "
            "give both units or neither"
        )
    from microswim.spec.units import to_si

    try:
        return name, to_si(f"1 {unit}", "s" if name == "time" else "m")
    except ValueError as error:
        raise SpecError(f"{path}: column {title.strip()} {error}") from None
