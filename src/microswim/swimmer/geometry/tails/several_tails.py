"""Several tails on one body, each with its motor: the phase that they share.

Tails whose frequencies are whole multiples ``f_i = k_i f`` of a common one, reversed ones among
them (``k_i < 0``), beat in one period: tail i is at ``k_i phase + ahead_i`` and moves at
``k_i`` times the rate of the phase.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion, Tail
from microswim.swimmer.parts import replaced

#: Tails, and periods of one of them in that of the swimmer's phase.
MOST, MOST_BEATS = 100, 12


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class SeveralTails(Tail):
    """Tails of one swimmer, each with its own shape, hand, place, phase and frequency.

    ``Swimmer(tail=[first, second], ...)`` makes them; ``swimmer.tail.each`` is the single tails.
    The numbers of all of them that models scale by are the largest, the radius the smallest.

    Parameters
    ----------
    tails
        Single tails, 2 to 100; their frequencies are whole multiples of a common one.

    Raises
    ------
    SpecError
        If there are too few or too many, one is none or elastic, or their beats share no period.

    Examples
    --------
    >>> import microswim as ms
    >>> wave = dict(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> tails = [
    ...     ms.HelicalTail(**wave, position=(-0.4, 0.3, 0)),
    ...     ms.HelicalTail(**wave, position=(-0.4, -0.3, 0), handedness="right"),
    ... ]
    >>> swimmer = ms.Swimmer(
    ...     body=ms.Sphere(radius=0.5), tail=tails, fluid=ms.Fluid(viscosity=1.0)
    ... )
    >>> len(swimmer.tail.each), abs(float(swimmer.gait().mean_velocity[3])) < 1e-12
    (2, True)
    """

    tails: tuple[Tail, ...]
    kind: ClassVar[str] = "several"

    def __post_init__(self) -> None:
        allowed = f"two to {MOST} single tails"
        if not isinstance(self.tails, (tuple, list)) or not 2 <= len(self.tails) <= MOST:
            raise SpecError("tail", self.tails, allowed)
        object.__setattr__(self, "tails", tuple(self.tails))
        for n, tail in enumerate(self.tails):
            name = f"tail[{n}]"
            if not isinstance(tail, Tail) or isinstance(tail, SeveralTails):
                raise SpecError(name, type(tail).__name__, "a single tail")
            if tail.is_absent or tail.settles:
                mend = "leave the table out" if tail.is_absent else "an elastic tail is alone"
                raise SpecError(f"{name}.kind", tail.kind, "one that has a given shape", mend)
        _ = self._shared

    @cached_property
    def _shared(self) -> tuple[float, tuple[int, ...]]:
        """Frequency of the swimmer's phase, and how often each tail beats in its period."""
        rates = [float(np.real(t.frequency)) for t in self.tails]
        first = next((f for f in rates if f), 0.0)
        if not first:
            return 0.0, (1,) * len(rates)
        ratios = [Fraction(f / first).limit_denominator(MOST_BEATS) for f in rates]
        common = lcm(*(r.denominator for r in ratios))
        beats = [int(r * common) for r in ratios]
        shared = gcd(*beats)
        beats = [b // shared for b in beats]
        for n, (f, r) in enumerate(zip(rates, ratios)):
            if abs(f / first - r) > 1e-9 * abs(r) or abs(beats[n]) > MOST_BEATS:
                raise SpecError(
                    f"tail[{n}].frequency", f, "such that all frequencies are whole multiples, up "
                    f"to {MOST_BEATS}, of a common one", "else no period holds the beat of them all"
                )  # fmt: skip
        return first * shared / common, tuple(beats)

    @cached_property
    def each(self) -> tuple[Tail, ...]:
        """The single tails, in their order, each at its own pace."""
        frequency, beats = self._shared
        return tuple(_at_pace(t, frequency, b) for t, b in zip(self.tails, beats))

    @property
    def is_placed(self) -> bool:
        return True

    @property
    def is_on_axis(self) -> bool:
        return False

    @property
    def in_batches(self) -> bool:
        return False

    @property
    def frequency(self) -> Any:  # type: ignore[override]
        """Cycles per time of the phase that they share."""
        return self._shared[0]

    @property
    def radius(self) -> Any:  # type: ignore[override]
        """Smallest radius."""
        return min(float(np.real(t.radius)) for t in self.tails)

    @property
    def length(self) -> Any:  # type: ignore[override]
        """Largest length."""
        return self._largest("length")

    @property
    def apparent_length(self) -> Any:
        """Largest length along the axes."""
        return self._largest("apparent_length")

    @property
    def arc_length(self) -> Any:
        """Largest length along the filaments."""
        return self._largest("arc_length")

    @property
    def number_of_waves(self) -> Any:
        """Largest number of waves."""
        return self._largest("number_of_waves")

    @property
    def reach(self) -> float:
        return self._largest("reach")

    def _largest(self, name: str) -> float:
        return max(float(np.real(getattr(t, name))) for t in self.tails)

    @property
    def sections(self) -> Sections:  # type: ignore[override]
        """Sections of the first; each has its own."""
        return self.tails[0].sections

    @property
    def surface_motion(self) -> SurfaceMotion:  # type: ignore[override]
        """``"rigid"`` where all of them turn as they are."""
        every = all(t.surface_motion == "rigid" for t in self.tails)
        return "rigid" if every else "bending"

    @property
    def sign(self) -> float:
        return self.tails[0].sign

    @property
    def alpha(self) -> Any:
        """Mean of apparent over actual length."""
        return float(np.mean([np.real(t.alpha) for t in self.tails]))

    @property
    def wavelength_along_s(self) -> Any:
        return None

    @property
    def edges(self) -> np.ndarray:
        return np.array([0.0, 1.0])

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Refuse to give one for all: each of them has a centreline, see `each`.

        Raises
        ------
        SpecError
            Always.
        """
        raise SpecError("tail", "several", "a single tail here", "ask each of tail.each")


def _at_pace(tail: Tail, frequency: float, beats: int) -> Tail:
    """Return a tail that beats so many times in a period of the frequency.

    Its rate over that of the phase is the same number, but for the complex step of a derivative.
    """
    if beats == 1 and tail.frequency == frequency:
        return tail
    made = replaced(tail, "frequency", tail.frequency)
    stepped = isinstance(tail.frequency, complex)
    object.__setattr__(made, "pace", tail.frequency / frequency if stepped else beats)
    return made
