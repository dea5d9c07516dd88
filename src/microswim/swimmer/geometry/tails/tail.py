"""What every tail says of itself: its centreline, its lengths, its symmetries.

A tail is its centreline ``P(s, phase)`` in the frame ``sqr`` (origin at the joint, s away from the
body) with ``phase = omega t``; tangent and velocity follow from P. In its `own` frame it begins at
the origin and runs along s; its `placement` takes it from there to ``sqr``. Whoever needs to know
something of a tail asks here; nobody asks of what kind it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from microswim import checks
from microswim.swimmer.geometry.tails.placement import Placement

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
    turns_whole
        Whether phase turns the shape as a whole about the tail's own axis, by ``sign`` x phase.
    beats_in_plane
        Whether it stays in the plane s-q of its own frame.
    half_period_signs
        Signs of ``[U; Omega]`` that carry phase to phase + pi at the joint, None if nothing does.
    yaw_axis
        Index of the body's rotation that the tail drives across s (4 about q, 5 about r).
    pace
        Its rate over that of the swimmer's phase: a whole number, which one of several tails has.
    settles
        Whether its shape is not given but settles under drag; `Swimmer.settled` has it then.
    """

    kind: ClassVar[str]
    rft_loop: ClassVar[str] = "centreline"
    is_absent: ClassVar[bool] = False
    turns_whole: ClassVar[bool] = False
    beats_in_plane: ClassVar[bool] = False
    half_period_signs: ClassVar[np.ndarray | None] = None
    yaw_axis: ClassVar[int] = 5
    settles: ClassVar[bool] = False
    pace: Any = 1

    section: tuple[float, float] | None = None
    radius: float
    frequency: float
    length: float
    sections: Sections
    surface_motion: SurfaceMotion

    @property
    def each(self) -> tuple[Tail, ...]:
        """The single tails of which it consists: itself."""
        return (self,)

    @property
    def named(self) -> dict[str, Tail]:
        """The single tails by their names in a spec: ``tail``, or ``tail[0]``, ``tail[1]``, ..."""
        if len(self.each) == 1:
            return {"tail": self}
        return {f"tail[{n}]": tail for n, tail in enumerate(self.each)}

    @property
    def own(self) -> Tail:
        """The same tail in its own frame: at the joint, along s, its phase that of the motor."""
        return self

    @property
    def placement(self) -> Placement:
        """Where its own frame stands in ``sqr``."""
        return Placement()

    @property
    def ahead(self) -> Any:
        """Phase (rad) by which it is ahead of the swimmer's."""
        return 0.0

    @property
    def beats(self) -> int:
        """Number of its periods in one of the swimmer's; negative if it turns the other way."""
        return round(float(np.real(self.pace)))

    def own_phase(self, phase: Any) -> Any:
        """Return its own phase (rad) at a phase of the swimmer."""
        return self.beats * phase + self.ahead

    @property
    def is_placed(self) -> bool:
        """Whether it stands or beats in any other way than its `own`."""
        return False

    @property
    def is_on_axis(self) -> bool:
        """Whether its axis is the axis s of the body."""
        return True

    @property
    def is_rigid(self) -> bool:
        """Whether phase turns the shape as a whole about s, by ``sign`` x phase."""
        return self.turns_whole and self.is_on_axis

    @property
    def is_planar(self) -> bool:
        """Whether it stays in the plane s-q."""
        return self.beats_in_plane and self.is_on_axis

    @property
    @abstractmethod
    def sign(self) -> float:
        """Sense of rotation about its axis at positive frequency, +1 or -1."""

    @property
    @abstractmethod
    def apparent_length(self) -> Any:
        """Length L along s."""

    @property
    @abstractmethod
    def arc_length(self) -> Any:
        """Length along the filament."""

    @property
    def bend(self) -> Any:
        """Curvature of the filament, mean over its length and the beat; zero of a symmetric one."""
        return 0.0

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
    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return what `centreline` does, in the tail's own frame and at its own phase."""

    def centreline(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the position, derivative along s, derivative in phase; each broadcast(s, phase) +
        (3,), frame ``sqr``.

        Parameters
        ----------
        s
            Coordinate along the tail's axis, 0 to `apparent_length`.
        phase
            Phase (rad) of the swimmer, broadcast against `s`.
        """
        if not self.is_placed:
            return self.curve(s, phase)
        P, slope, velocity = self.curve(s, self.own_phase(phase))
        place = self.placement
        return place.placed(P), place.turned(slope), self.pace * place.turned(velocity)

    @property
    def reach(self) -> float:
        """Largest s of the straight axis of the tail, root to tip, its real part."""
        place, length = self.placement, float(np.real(self.apparent_length))
        return float(np.real(place.root[0])) + length * max(float(np.real(place.rotation[0, 0])), 0)

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

    def narrowing(self, s: Any) -> Any:
        """Return the half axes at s in terms of those at the root: 1 unless the tail is tapered."""
        return 1.0 + 0.0 * np.asarray(s)

    def _check_filament(self) -> None:
        checks.positive("tail.radius", self.radius, "length")
        checks.number("tail.frequency", self.frequency, "a finite number")
        if self.frequency:
            checks.positive("tail.frequency", abs(self.frequency), "or negative number, or zero")
        checks.choice("tail.sections", self.sections, get_args(Sections))
        checks.choice("tail.surface_motion", self.surface_motion, get_args(SurfaceMotion))
