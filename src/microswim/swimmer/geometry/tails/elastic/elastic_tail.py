"""A tail that bends: a filament of some stiffness, driven at its base.

Its shape is not given: drag, bending and drive decide it, and `microswim.models.elastic` finds
what it settles to. Here stands what is known beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.tails.elastic import magnetic_pieces
from microswim.swimmer.geometry.tails.elastic.rest_shape import (
    RestShape,
    drawn_at_rest,
    helix_at_rest,
)
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion, Tail

Drive = Literal["heave", "pivot", "rotate", "moment", "none"]
Hold = Literal["clamped", "hinged"]
#: What sets the size of each drive, in the spec and here.
SIZE = {"heave": "amplitude", "pivot": "angle", "rotate": "angle", "moment": "moment"}
FEWEST, MOST = 4, 2000  #: points of a shape at rest
STEEPEST = 1.5  #: angle of the base, rad
TWIST = 2.0 / 3.0  #: twisting over bending stiffness of a round rod of constant volume


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class ElasticTail(Tail):
    """Elastic filament that cannot stretch, driven at its base or from within.

    Parameters
    ----------
    length
        Length along the filament.
    radius
        Radius of the filament (length).
    bending
        Bending stiffness ``B = E I`` (force x length^2).
    frequency
        Cycles of the drive per time.
    base
        ``"clamped"``: the base keeps the direction that the drive gives it. ``"hinged"``: it
        turns freely.
    drive
        ``"heave"``: the base moves across s, ``q = amplitude cos(phase)``. ``"pivot"``: it turns
        about r, by ``angle cos(phase)``. ``"rotate"``: tilted from s by `angle` it turns about
        s with the phase, and the tail bends in space (one that is bent at rest needs no angle).
        ``"moment"``: inner moments bend it about r, a wave ``moment cos(phase - 2 pi s /
        wavelength)`` as a sperm's axoneme makes it.
        ``"none"``: it stands still.
    amplitude
        Of the heave (length).
    angle
        Of the pivot, or the tilt of the base that rotates (rad), up to 1.5.
    twisting
        Twisting stiffness (force x length^2), for a base that rotates; two thirds of `bending`
        by default, that of a round rod of constant volume.
    moment
        Size of the wave of inner moment (force x length).
    rest_radius, rest_pitch
        Of the helix about s that it is at rest (length); a negative pitch is left-handed, and
        without pitch it is an arc of a circle in the plane s-q. It begins at ``q = rest_radius``,
        the arc at the joint. Straight by default.
    rest
        Points ``(s, q, r)`` along the filament at rest, from the joint on, in place of the helix;
        the curve through them is drawn to the length. For any drive but one that rotates, in the
        plane s-q.
    magnet
        Magnetic moment of the filament, spread evenly along `magnet_span`: along its tangent and
        across it, ``(s, q, r)`` where it is straight (A m^2, or torque per field). Or a list of
        them, one for each piece.
    magnet_susceptibility
        Along and across the filament, of magnetic pieces that a field magnetises, such as a chain
        of beads: apparent susceptibility of the filament's own volume there. For swimmers in SI.
    magnet_span
        Where the filament is magnetic, from and to which part of its length; a list of such pairs
        for links, or a head and links.
    wavelength
        Of the inner moments, along the filament. Else for laws of local resistance that need
        one (by default the pitch at rest); Cox's law, which needs none, where the swimmer
        chooses no law and there is none.
    sections, surface_motion
        As for `WaveTail`, for the reference solvers.

    Raises
    ------
    SpecError
        If a field is out of range, or the drive lacks its size or has another's.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.ElasticTail(
    ...     length=1.0, radius=0.01, bending=0.02, base="hinged", drive="heave", amplitude=0.1
    ... )
    >>> tail.arc_length
    1.0
    """

    length: float
    radius: float
    bending: float
    frequency: float = 1.0
    base: Hold = "clamped"
    drive: Drive = "heave"
    amplitude: float | None = None
    angle: float | None = None
    twisting: float | None = None
    moment: float | None = None
    rest_radius: float | None = None
    rest_pitch: float | None = None
    rest: Any = None
    magnet: tuple[Any, ...] | None = None
    magnet_susceptibility: tuple[float, float] | None = None
    magnet_span: tuple[Any, ...] = (0.0, 1.0)
    wavelength: float | None = None
    sections: Sections = "perpendicular"
    surface_motion: SurfaceMotion = "bending"
    kind: ClassVar[str] = "elastic"
    settles: ClassVar[bool] = True

    def __post_init__(self) -> None:
        checks.positive("tail.length", self.length, "length")
        checks.positive("tail.bending", self.bending, "stiffness")
        self._check_filament()
        if self.surface_motion == "rigid":
            raise SpecError("tail.surface_motion", "rigid", "translating or bending", "it bends")
        if self.wavelength is not None:
            checks.positive("tail.wavelength", self.wavelength, "length")
        checks.choice("tail.base", self.base, get_args(Hold))
        checks.choice("tail.drive", self.drive, get_args(Drive))
        self._check_rest()
        self._check_drive()
        self._check_magnet()

    def _check_drive(self) -> None:
        needed = SIZE.get(self.drive)
        for name in ("amplitude", "angle", "moment"):
            if getattr(self, name) is not None and name != needed:
                raise SpecError(
                    f"tail.{name}", getattr(self, name), f'left out with drive = "{self.drive}"'
                )
        optional = self.turns and self.is_bent
        if needed is not None and getattr(self, needed) is None and not optional:
            raise SpecError(f"tail.{needed}: missing; the drive {self.drive} needs it")
        if self.moment is not None:
            checks.number("tail.moment", self.moment, "a torque of zero or more", least=0.0)
            if self.wavelength is None:
                raise SpecError("tail.wavelength: missing; the drive moment needs it")
        if self.amplitude is not None:
            checks.number("tail.amplitude", self.amplitude, "a length of zero or more", least=0.0)
        if self.angle is not None:
            checks.number("tail.angle", self.angle, f"an angle of 0 to {STEEPEST} rad",
                          least=0.0, most=STEEPEST)  # fmt: skip
        if needed == "angle" and self.base == "hinged":
            raise SpecError(
                "tail.base",
                "hinged",
                '"clamped" where the base turns',
                "a hinge hands on no turning",
            )
        if self.twisting is not None:
            checks.positive("tail.twisting", self.twisting, "stiffness")

    def _check_rest(self) -> None:
        if self.rest_radius is not None:
            checks.positive("tail.rest_radius", self.rest_radius, "length")
        if self.rest_pitch is not None:
            checks.number("tail.rest_pitch", self.rest_pitch, "a length, negative for a left hand")
            if self.rest_radius is None:
                raise SpecError("tail.rest_radius: missing; a rest_pitch needs it")
        if self.rest is None:
            return
        if self.rest_radius is not None:
            raise SpecError("tail.rest, tail.rest_radius: give one of the two")
        allowed = f"points [s, q, r] along the filament, {FEWEST} to {MOST}, none twice in a row"
        try:
            points = np.array(self.rest, float)
        except (TypeError, ValueError):
            raise SpecError("tail.rest", self.rest, allowed) from None
        whole = points.ndim == 2 and points.shape[1] == 3 and FEWEST <= len(points) <= MOST
        if not whole or not (np.abs(points) <= checks.LARGEST).all():
            raise SpecError("tail.rest", f"an array of shape {points.shape}", allowed)
        if not np.linalg.norm(np.diff(points, axis=0), axis=1).all():
            raise SpecError("tail.rest", "two points in the same place", allowed)
        object.__setattr__(self, "rest", tuple(map(tuple, points.tolist())))

    def _check_magnet(self) -> None:
        own = {"magnet_span": magnetic_pieces.spans(self.magnet_span)}
        if self.magnet is not None:
            count = len(own["magnet_span"]) if np.ndim(self.magnet_span) == 2 else 1
            own["magnet"] = magnetic_pieces.moments(self.magnet, count)
        soft = self.magnet_susceptibility
        if soft is not None:
            checks.numbers("tail.magnet_susceptibility", soft, 2,
                           "two numbers above -1: along and across", least=-1.0)  # fmt: skip
            own["magnet_susceptibility"] = tuple(map(float, soft))
        for name, value in own.items():
            object.__setattr__(self, name, value)

    @property
    def is_magnetic(self) -> bool:
        """Whether a field pulls at the filament."""
        return self.magnet is not None or self.magnet_susceptibility is not None

    @property
    def pieces(self) -> list[magnetic_pieces.Piece]:
        """Where it is magnetic, and the moment of each piece."""
        return magnetic_pieces.pieces(self.magnet, self.magnet_span)

    @property
    def is_bent(self) -> bool:
        """Whether it is bent at rest."""
        return self.rest is not None or self.rest_radius is not None

    @property
    def rest_shape(self) -> RestShape | None:
        """Shape at rest; None where that is straight."""
        if self.rest is not None:
            return drawn_at_rest(self.rest)
        if self.rest_radius is None:
            return None
        return helix_at_rest(self.rest_radius / self.length, (self.rest_pitch or 0.0) / self.length)

    @property
    def sign(self) -> float:
        return 1.0

    @property
    def apparent_length(self) -> Any:
        return self.length

    @property
    def arc_length(self) -> Any:
        return self.length

    @property
    def alpha(self) -> Any:
        if not self.rest_pitch:
            return 1.0
        pitch, radius = self._pitch, self.rest_radius or 0.0
        return pitch / np.sqrt((2.0 * np.pi * radius) ** 2 + pitch**2)

    @property
    def _pitch(self) -> Any:
        return np.sign(np.real(self.rest_pitch)) * self.rest_pitch  # type: ignore[operator]

    @property
    def number_of_waves(self) -> Any:
        """Number of waves of the given wavelength; a straight rod has none."""
        return 0.0 if self.wavelength is None else self.length / self.wavelength

    @property
    def wavelength_along_s(self) -> Any:
        """Wavelength for laws of local resistance: as given, or the pitch at rest; None: none."""
        if self.wavelength is not None or not self.rest_pitch:
            return self.wavelength
        return self._pitch

    @property
    def edges(self) -> np.ndarray:
        return np.array([0.0, 1.0])

    @property
    def is_planar(self) -> bool:
        return not self.turns

    @property
    def turns(self) -> bool:
        """Whether its base turns about s, and the tail with it."""
        return self.drive == "rotate"

    @property
    def spin(self) -> float:
        return self.sign if self.turns else 0.0

    @property
    def twist_ratio(self) -> Any:
        """Twisting over bending stiffness."""
        return TWIST if self.twisting is None else self.twisting / self.bending

    @property
    def starts_on_axis(self) -> bool:
        return not (self.amplitude or self.rest_pitch or np.any((self.rest or [0.0])[0]))

    def base_motion(self, phase: Any) -> tuple[Any, Any]:
        """Return the place across s and angle about r of the base that the drive holds."""
        c = np.cos(phase)
        return (self.amplitude or 0.0) * c, (self.angle or 0.0) * c

    def curve(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Refuse to give one: the shape is not known before it is solved for.

        Raises
        ------
        SpecError
            Always; `Swimmer.settled` has the tail that it settles to.
        """
        raise SpecError(
            "tail.kind", "elastic", "one whose shape is given here",
            "swimmer.settled has the tail that an elastic one settles to",
        )  # fmt: skip

    def continued(self, s: Any, phase: Any) -> np.ndarray:
        """Return the position at s of a tail that does not bend, behind the joint straight on."""
        return self.stiff(s, phase)[0]

    def stiff(self, s: Any, phase: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return centreline, slope and velocity per unit phase rate of a tail too stiff to bend."""
        s, phase = np.broadcast_arrays(s, phase)
        none, tilt = 0.0 * s * phase, self.angle or 0.0
        if self.turns:
            c, d, out = np.cos(tilt), np.sin(tilt) * np.cos(phase), np.sin(tilt) * np.sin(phase)
            slope = np.stack([c + none, d + none, out + none], axis=-1)
            turned = np.stack([none, -s * out, s * d], axis=-1)
            return s[..., None] * slope, slope, turned
        place, angle = self.base_motion(phase)
        place_rate, angle_rate = (-(x or 0.0) * np.sin(phase) for x in (self.amplitude, tilt))
        c, d = np.cos(angle), np.sin(angle)
        P = np.stack([s * c, place + s * d, none], axis=-1)
        P_s = np.stack([c + none, d + none, none], axis=-1)
        turning = s * angle_rate
        P_phase = np.stack([-turning * d, place_rate + turning * c, none], axis=-1)
        return P, P_s, P_phase
