"""No tail: a body alone, which a field, a flow or a force moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion, Tail


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class NoTail(Tail):
    """A robot without a tail: its surface is its body's, and nothing moves on it.

    It resists and does not propel: its gait has R and no F_p, and a rate of zero.

    Examples
    --------
    >>> import microswim as ms
    >>> fluid = ms.Fluid(viscosity=1.0)
    >>> robot = ms.Swimmer(body=ms.Sphere(radius=1.0), tail=ms.NoTail(), fluid=fluid)
    >>> R = robot.gait().resistance(0.0)
    >>> round(float(R[0, 0] / (6 * 3.141592653589793)), 6)
    1.0
    """

    kind: ClassVar[str] = "none"
    is_absent: ClassVar[bool] = True
    radius: ClassVar[float] = 0.0  # type: ignore[misc]
    frequency: ClassVar[float] = 0.0  # type: ignore[misc]
    length: ClassVar[float] = 0.0  # type: ignore[misc]
    sections: ClassVar[Sections] = "perpendicular"  # type: ignore[misc]
    surface_motion: ClassVar[SurfaceMotion] = "translating"  # type: ignore[misc]

    @property
    def sign(self) -> float:
        return 1.0

    @property
    def apparent_length(self) -> Any:
        return 0.0

    @property
    def arc_length(self) -> Any:
        return 0.0

    @property
    def alpha(self) -> Any:
        return 1.0

    @property
    def number_of_waves(self) -> Any:
        return 0.0

    @property
    def wavelength_along_s(self) -> Any:
        return None

    @property
    def edges(self) -> np.ndarray:
        return np.array([0.0, 1.0])

    @property
    def starts_on_axis(self) -> bool:
        return True

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the joint, whatever s and phase."""
        still = np.zeros((*np.broadcast_shapes(np.shape(s), np.shape(phase)), 3))
        along = still.copy()
        along[..., 0] = 1.0
        return still, along, still
