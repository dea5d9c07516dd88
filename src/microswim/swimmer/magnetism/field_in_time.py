"""Fields told by tables in time: B itself, and the pose of a magnet that an arm moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.swimmer.magnetism.applied_field import AppliedField


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class SequenceField(AppliedField):
    r"""A field that follows a table in time, the same everywhere.

    Straight between the rows; before the first row and after the last it stays as there.

    Parameters
    ----------
    file
        Table of t, Bx, By, Bz, lab frame, each with its unit in the header: ``t (s),Bx (mT)``.
    repeat
        Whether it begins anew after the last row, which then is the first again.

    Raises
    ------
    SpecError
        If the file is no such table.

    Examples
    --------
    >>> import tempfile, pathlib, microswim as ms
    >>> file = pathlib.Path(tempfile.mkdtemp()) / "field.csv"
    >>> _ = file.write_text("t (s),Bx (mT),By (mT),Bz (mT)\n0,0,0,5\n1,5,0,5\n")
    >>> ms.SequenceField(file=str(file)).at(0.5)
    array([0.0025, 0.    , 0.005 ])
    """

    kind: ClassVar[str] = "sequence"
    is_periodic: ClassVar[bool] = False
    needs_si: ClassVar[bool] = True

    file: str
    repeat: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.file, str) or not self.file:
            raise SpecError("field.file", self.file, "the name of a table")
        checks.truth("field.repeat", self.repeat)
        values = self.table[1]
        if self.repeat and np.abs(values[0] - values[-1]).max() > 1e-6 * np.abs(values).max():
            raise SpecError(
                "field.repeat", True, "with a last row that is the first again", "add that row"
            )

    @cached_property
    def table(self) -> tuple[np.ndarray, np.ndarray]:
        """Times (n,) and B (n, 3) of the file."""
        return doors.go(doors.READ_SERIES, self.file)

    def at(self, times: Any, places: Any = (0.0, 0.0, 0.0)) -> np.ndarray:
        """Return B (..., 3) at the times, the same everywhere."""
        t, B = self.table
        now = np.asarray(times, float)
        if self.repeat:
            now = t[0] + np.mod(now - t[0], t[-1] - t[0])
        return np.stack([np.interp(now, t, column) for column in B.T], axis=-1)

    @property
    def rate(self) -> float:
        """A quarter turn in the shortest time between two rows (rad per time)."""
        return float(np.pi / 4.0 / np.diff(self.table[0]).min())


class Arm:
    """The pose of a magnet in time, smooth through the rows of a table.

    Parameters
    ----------
    file
        Table of t, x, y, z and, where the magnet turns, mx, my, mz.
    """

    def __init__(self, file: str) -> None:
        from scipy.interpolate import PchipInterpolator  # nobody waits for it without such a field

        self.times, places, moments = doors.go(doors.READ_POSES, file)
        self.place = PchipInterpolator(self.times, places)
        self.moment = None if moments is None else PchipInterpolator(self.times, moments)

    def within(self, times: Any) -> np.ndarray:
        """Return times no earlier than the first row and no later than the last."""
        return np.clip(np.asarray(times, float), self.times[0], self.times[-1])
