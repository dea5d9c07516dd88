"""A tail that may stand anywhere on its body: its root, its axis and its phase."""

from __future__ import annotations

from abc import ABC
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim.swimmer.geometry.tails.placement import ALONG_S, AT_JOINT, Placement, check
from microswim.swimmer.geometry.tails.tail import Tail
from microswim.swimmer.parts import replaced


@dataclass(frozen=True, kw_only=True)
class PlacedTail(Tail, ABC):
    """A tail with a place: the fields that say where it stands and how far ahead it beats.

    Parameters
    ----------
    position
        Root, from the joint (length); the joint by default.
    direction
        Axis of the tail, about which its motor turns, away from the root; along s by default. The
        shortest turn from s to it carries the tail's own q and r along.
    phase
        How far ahead of the swimmer's phase it beats (rad).
    """

    position: tuple[float, float, float] | None = None
    direction: tuple[float, float, float] | None = None
    phase: float | None = None

    def _check_place(self) -> None:
        check(self.position, self.direction, self.phase)
        for name in ("position", "direction"):
            if (value := getattr(self, name)) is not None:
                object.__setattr__(self, name, tuple(value))

    @property
    def placement(self) -> Placement:
        return Placement(self.position or AT_JOINT, self.direction or ALONG_S)

    @property
    def ahead(self) -> Any:
        return 0.0 if self.phase is None else self.phase

    @property
    def is_placed(self) -> bool:
        if self.position is None and self.direction is None and self.phase is None:
            return self.pace != 1  # nearly always, and then quickly
        if self.pace != 1:
            return True
        across = (self.direction or ALONG_S)[1:]
        moved = (*(self.position or AT_JOINT), *across, self.ahead)
        return any(bool(x) for x in moved) or self._points_back

    @property
    def _points_back(self) -> bool:
        return self.direction is not None and bool(np.real(self.direction[0]) <= 0.0)

    @property
    def is_on_axis(self) -> bool:
        aside = *(self.position or AT_JOINT)[1:], *(self.direction or ALONG_S)[1:]
        return not any(bool(x) for x in aside) and not self._points_back

    @property
    def own(self) -> Tail:
        return self._alone if self.is_placed else self

    @cached_property
    def _alone(self) -> Tail:
        own: Tail = self
        for name in ("position", "direction", "phase"):
            own = replaced(own, name, None)
        return own
