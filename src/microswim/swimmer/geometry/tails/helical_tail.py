"""The rotating rigid helix [Tabak Eq. 12]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from microswim import checks
from microswim.numerics.series.fourier import TURN_S
from microswim.swimmer.geometry.self_contact import nearest_turn
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion
from microswim.swimmer.geometry.tails.wave_tail import WaveTail


@checks.by_name
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
    rft_loop: ClassVar[str] = "helix"
    turns_whole: ClassVar[bool] = True
    half_period_signs: ClassVar[np.ndarray | None] = TURN_S
    yaw_axis: ClassVar[int] = 4

    def __post_init__(self) -> None:
        checks.choice("tail.handedness", self.handedness, ("left", "right"))
        super().__post_init__()

    @property
    def sign(self) -> float:
        """Sense of rotation about s at positive frequency: +1 left-handed, -1 right-handed."""
        return 1.0 if self.handedness == "left" else -1.0

    @property
    def out_of_plane(self) -> float:
        return -self.sign

    def stretch(self, bk: Any) -> Any:
        return np.sqrt(1.0 + bk**2)

    def _apparent_from_arc(self, wound: Any) -> Any:
        return np.sqrt(self.length**2 - wound**2)

    def alpha_of(self, bk: Any) -> Any:
        """Return ``alpha = (1 + b^2 k^2)^-1/2``, apparent over actual length."""
        return 1.0 / self.stretch(bk)

    def wound_length(self) -> float:
        return 2.0 * np.pi * self.amplitude * self.number_of_waves

    def room(self, amplitude: Any = None) -> Any:
        """Return least of the radius of curvature and half the distance of neighbouring turns."""
        b, k = self.amplitude if amplitude is None else amplitude, self.wavenumber
        B2 = np.asarray((b * k) ** 2)
        with np.errstate(divide="ignore", over="ignore"):
            bend = (1.0 + B2) / np.asarray(b * k**2)
        near = np.asarray(nearest_turn(B2, self.number_of_waves))
        far = np.isinf(near)  # stays infinite: over a complex wavenumber it would not be a number
        return np.minimum(bend, np.where(far, np.inf, np.where(far, 1.0, near) / k / 2.0))
