"""What a swimmer asks of a region calibration that it carries; `calibration.region` makes them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from microswim.gait.gait import Gait

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer


class Region(Protocol):
    """A region calibration, as the swimmer that carries it sees it."""

    @property
    def low(self) -> dict[str, float]:
        """Lower bound of each number that varies over the region, `high` the upper one."""
        ...

    @property
    def high(self) -> dict[str, float]: ...

    @property
    def fixed(self) -> dict[str, float]:
        """Numbers of the spec that all its designs share."""
        ...

    def gait(self, swimmer: Swimmer) -> Gait:
        """Return the corrected gait of a design."""
        ...

    def parameters(self, swimmer: Swimmer) -> np.ndarray:
        """Return the kernel parameters of one or many designs."""
        ...

    def solve(self, many: Swimmer, free: np.ndarray, phases: int) -> tuple[np.ndarray, ...]:
        """Return twists, tail powers and drag times speed of many designs."""
        ...

    def expected_of_many(self, many: Swimmer, count: int) -> np.ndarray:
        """Return the expected relative error of many designs, NaN outside the region."""
        ...
