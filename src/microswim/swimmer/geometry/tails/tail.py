"""What every tail says of itself: its centreline, its lengths, its symmetries.

A tail is its centreline ``P(s, phase)`` in the frame ``sqr`` (origin at the joint, s away from the
body) with ``phase = omega t``; tangent and velocity follow from P. Whoever needs to know something
of a tail asks here; nobody asks of what kind it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from microswim import checks

Sections = Literal["perpendicular", "sheared"]
SurfaceMotion = Literal["rigid", "translating", "bending"]


class Tail(ABC):
    """A tail of any kind. Use `HelicalTail`, `PlaneWaveTail`, `CustomTail` or `NoTail`.

    Attributes
    ----------
    kind
        Word of the spec.
    rft_loop
        Loop of the surrogate that sums it: one of its own form, or ``"centreline"``, which takes
        any centreline node by node.
    is_absent
        Whether there is no tail, only a body.
    is_rigid
        Whether phase turns the shape as a whole about s, by ``sign`` x phase.
    is_planar
        Whether it stays in the plane s-q.
    half_period_signs
        Signs of ``[U; Omega]`` that carry phase to phase + pi, None if nothing does.
    yaw_axis
        Index of the body's rotation that the tail drives across s (4 about q, 5 about r).
    settles
        Whether its shape is not given but settles under drag; `Swimmer.settled` has it then.
    """

    kind: ClassVar[str]
    rft_loop: ClassVar[str] = "centreline"
    is_absent: ClassVar[bool] = False
    is_rigid: ClassVar[bool] = False
    is_planar: ClassVar[bool] = False
    half_period_signs: ClassVar[np.ndarray | None] = None
    yaw_axis: ClassVar[int] = 5
    settles: ClassVar[bool] = False

    section: tuple[float, float] | None = None
    radius: float
    frequency: float
    length: float
    sections: Sections
    surface_motion: SurfaceMotion

    @property
    @abstractmethod
    def sign(self) -> float:
        """Sense of rotation about s at positive frequency, +1 or -1."""

    @property
    @abstractmethod
    def apparent_length(self) -> Any:
        """Length L along s."""

    @property
    @abstractmethod
    def arc_length(self) -> Any:
        """Length along the filament."""

    @property
    @abstractmethod
    def alpha(self) -> Any:
        """Apparent over actual length, averaged where it varies."""

    @property
    @abstractmethod
    def number_of_waves(self) -> Any:
        """Number of waves on the tail."""

    @property
    @abstractmethod
    def wavelength_along_s(self) -> Any:
        """Wavelength along s, None for a tail that names none."""

    @property
    @abstractmethod
    def edges(self) -> np.ndarray:
        """Ends of the smooth panels, as fractions of the length."""

    @abstractmethod
    def centreline(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the position, derivative along s, derivative in phase; each broadcast(s, phase) +
        (3,).
        """

    def continued(self, s: Any, phase: Any) -> np.ndarray:
        """Return the position at s, behind the joint (s < 0) straight on; broadcast(s, phase) +
        (3,).
        """
        s, phase = np.broadcast_arrays(s, phase)
        P, slope, _ = self.centreline(np.maximum(s, 0.0), phase)
        return P + np.minimum(s, 0.0)[..., None] * slope

    @property
    def starts_on_axis(self) -> bool:
        """Whether the tail is known to pass through the joint at all phases."""
        return False

    @property
    def rate(self) -> Any:
        """Phase rate ``2 pi frequency`` (rad per time)."""
        return 2.0 * np.pi * self.frequency

    @property
    def spin(self) -> float:
        """Spin of each section about s per unit phase rate: the sign of a rigid tail, else 0."""
        return self.sign if self.surface_motion == "rigid" else 0.0

    @property
    def in_batches(self) -> bool:
        """Whether the surrogate evaluates many such tails at once."""
        return self.rft_loop != "centreline"

    @property
    def half_axes(self) -> tuple[Any, Any]:
        """Half axes of the cross-section along the normal and the binormal: the radius if round."""
        return (self.radius, self.radius) if self.section is None else self.section

    def _check_filament(self) -> None:
        checks.positive("tail.radius", self.radius, "length")
        checks.number("tail.frequency", self.frequency, "a finite number")
        if self.frequency:
            checks.positive("tail.frequency", abs(self.frequency), "or negative number, or zero")
        checks.choice("tail.sections", self.sections, get_args(Sections))
        checks.choice("tail.surface_motion", self.surface_motion, get_args(SurfaceMotion))
