"""The straight mesh: body, straight capsule for the tail, channel; curved tetrahedra.

Meshed once per outline; the wave is laid on it by an analytic displacement (`displacement`), or,
where that folds it, on its surface alone (`remesh`).
Lengths are in units of `Outline.unit`.
"""

# Netgen has no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import ngsolve as ngs
import numpy as np
from netgen import occ
from netgen.meshing import MeshingParameters, MeshingStep

from microswim.errors import MicroswimError, SpecError
from microswim.swimmer import physical_sense
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.surroundings import Channel
from microswim.swimmer.geometry.tails.kinds import WaveTail, as_wave
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True)
class Level:
    """How fine a mesh is.

    Parameters
    ----------
    order
        Polynomial order of velocity and geometry; the pressure's is one less (Taylor-Hood).
    tail, body
        Mesh size on the tail in its radii, on the body in its smallest semi-axis.
    far
        Mesh size at the walls in channel diameters.
    grading
        Growth of the mesh size away from small features (Netgen's number).
    curvature
        Elements per radius of curvature; on the tail this decides (below 1.5 curved elements fold).
    """

    order: int
    tail: float
    body: float
    far: float
    grading: float
    curvature: float = 1.5


LEVELS = {
    "coarse": Level(order=2, tail=1.6, body=0.35, far=0.3, grading=0.7, curvature=1.5),
    "standard": Level(order=3, tail=1.6, body=0.35, far=0.3, grading=0.7, curvature=1.5),
    "fine": Level(order=3, tail=1.2, body=0.25, far=0.25, grading=0.5, curvature=2.0),
    "paper": Level(order=2, tail=0.6, body=0.12, far=0.14, grading=0.25, curvature=3.5),
}


def level_named(level: str | Level) -> Level:
    """Return the level of that name; a `Level` of one's own passes through."""
    if isinstance(level, Level):
        return level
    if not isinstance(level, str) or level not in LEVELS:
        raise SpecError("level", level, "one of " + ", ".join(f'"{name}"' for name in LEVELS))
    return LEVELS[level]


@dataclass(frozen=True)
class Outline:
    """Body and straight tail, lengths divided by `unit`.

    `semi_axes` are zero without a body; `length` and `radius` of the tail are zero without a tail.
    """

    semi_axes: tuple[float, float, float]
    length: float
    radius: float
    unit: float = 1.0

    @classmethod
    def of(cls, swimmer: Swimmer) -> Outline:
        """Return outline of a swimmer, scaled by its body's largest diameter (or half the tail)."""
        body, tail = swimmer.body, swimmer.tail
        physical_sense.require_tail(swimmer, "the finite elements")
        if tail.is_placed:
            raise SpecError(
                'tail: model "fem" takes one tail at the joint, along s, without a phase of its '
                'own; take "rft" or "bem"'
            )
        if isinstance(tail, WaveTail):
            as_wave(tail)
        r_s, r_q, r_r = axes = ellipsoid_axes(body)
        unit = 2.0 * max(axes) or 0.5 * float(tail.apparent_length)
        scaled = (r_s / unit, r_q / unit, r_r / unit)
        return cls(scaled, float(tail.apparent_length) / unit, float(tail.radius) / unit, unit)

    @property
    def has_body(self) -> bool:
        return self.semi_axes[0] > 0

    @property
    def nose(self) -> float:
        """s of the foremost point."""
        return -2.0 * self.semi_axes[0] if self.has_body else -self.radius

    @property
    def tip(self) -> float:
        """s of the hindmost point."""
        return self.length + self.radius

    @property
    def centre(self) -> np.ndarray:
        return np.array([-self.semi_axes[0], 0.0, 0.0])

    @property
    def joint(self) -> float:
        """s at which the straight tube leaves the body (0 without a body)."""
        return float(self.rear(self.radius, 0.0)) if self.has_body else 0.0

    def rear(self, q: np.ndarray | float, r: np.ndarray | float) -> np.ndarray:
        """Return s of the body's rear surface over the point (q, r); its equator beyond the
        outline.
        """
        a, b, c = self.semi_axes
        return -a + a * np.sqrt(np.clip(1.0 - (q / b) ** 2 - (r / c) ** 2, 0.0, None))

    def in_body(self, point: tuple[float, float, float]) -> bool:
        """Return whether a point lies in the body."""
        if not self.has_body:
            return False
        scaled = (np.asarray(point) - self.centre) / np.asarray(self.semi_axes)
        return bool(scaled @ scaled < 1.0)

    def middle_of(self, channel: Channel) -> np.ndarray:
        """Return the position of the channel's middle in the swimmer's frame."""
        own = np.array([0.5 * (self.nose + self.tip), 0.0, 0.0])
        return own - channel.axes @ np.asarray(channel.position) / self.unit


def ellipsoid_axes(body: Body) -> list[float]:
    """Return semi-axes of an ellipsoid, zeros without a body.

    Raises
    ------
    SpecError
        If the body is of another shape.
    """
    if not (body.is_ellipsoid or body.is_absent):
        raise SpecError("body.shape", body.shape, "an ellipsoid for the finite elements",
                        "take model bem")  # fmt: skip
    return [float(a) for a in body.semi_axes3]


def _body_solid(outline: Outline) -> Any:
    a, b, c = outline.semi_axes
    centre = occ.Pnt(-a, 0, 0)
    if a == b == c:
        return occ.Sphere(centre, a)
    return occ.Ellipsoid(occ.Axes(centre, n=occ.X, h=occ.Y), a, b, c)


def _tail_solid(outline: Outline) -> Any:
    start = -0.5 * outline.semi_axes[0]
    tube = occ.Cylinder(occ.Pnt(start, 0, 0), occ.X, r=outline.radius, h=outline.length - start)
    solid = tube + occ.Sphere(occ.Pnt(outline.length, 0, 0), outline.radius)
    return solid if outline.has_body else solid + occ.Sphere(occ.Pnt(0, 0, 0), outline.radius)


def _name(solid: Any, name: str, size: float) -> None:
    solid.faces.name = name
    for face in solid.faces:
        face.maxh = size


def _swimmer_solid(outline: Outline, level: Level) -> Any:
    parts = []
    if outline.has_body:
        body = _body_solid(outline)
        _name(body, "body", level.body * min(outline.semi_axes))
        parts.append(body)
    if outline.length > 0:
        tail = _tail_solid(outline)
        _name(tail, "tail", level.tail * outline.radius)
        parts.append(tail)
    return parts[0] if len(parts) == 1 else parts[0] + parts[1]


def _channel_solid(outline: Outline, channel: Channel) -> Any:
    """Cylinder or box about the swimmer; faces "wall", or "end" where it is open."""
    diameter, length = channel.diameter / outline.unit, channel.length / outline.unit
    if channel.is_cylinder:
        solid = occ.Cylinder(occ.Pnt(-length / 2, 0, 0), occ.X, r=diameter / 2, h=length)
    else:
        half = diameter / 2
        solid = occ.Box(occ.Pnt(-length / 2, -half, -half), occ.Pnt(length / 2, half, half))
    solid.faces.name = "wall"
    if channel.ends == "open":
        solid.faces.Min(occ.X).name = "end"
        solid.faces.Max(occ.X).name = "end"
    turned = solid.Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.Z), -np.degrees(channel.tilt))
    turned = turned.Rotate(occ.Axis(occ.Pnt(0, 0, 0), occ.X), np.degrees(channel.azimuth))
    return turned.Move(occ.Vec(*outline.middle_of(channel)))


def check_in_channel(outline: Outline, channel: Channel, reach: float) -> None:
    """Refuse a swimmer whose body, or tail with lateral reach `reach`, touches a wall."""
    s = np.linspace(outline.nose, outline.tip, 81)
    a, b, c = outline.semi_axes
    inside = np.clip(1.0 - ((s + a) / a) ** 2, 0.0, None) if outline.has_body else 0.0 * s
    radii = np.where(s < 0, max(b, c) * np.sqrt(inside), reach)
    on_axis = np.stack([s, 0 * s, 0 * s], axis=-1) - outline.middle_of(channel)
    channel.check_fits(outline.unit * on_axis @ channel.axes, outline.unit * radii)


@dataclass(frozen=True)
class Zone:
    """Mesh size `size` up to the distance `radius` from the tail's axis."""

    radius: float
    size: float


def straight_mesh(
    outline: Outline, channel: Channel, level: Level, zone: Zone | None = None
) -> ngs.Mesh:
    """Return the curved tetrahedra around body and straight tail; boundaries body, tail, wall (and
    end).
    """
    mesh = ngs.Mesh(_tetrahedra(outline, channel, level, zone))
    mesh.Curve(level.order)
    return mesh


@lru_cache(maxsize=4)
def _tetrahedra(outline: Outline, channel: Channel, level: Level, zone: Zone | None) -> Any:
    """Netgen's mesh; the last few are kept, designs with the same outline share it."""
    return _fluid(outline, channel, level).GenerateMesh(sizes(outline, channel, level, zone))


def surface_mesh(outline: Outline, channel: Channel, level: Level) -> Any:
    """Return Netgen's triangles on body, straight tail and channel alone."""
    only = sizes(outline, channel, level, perfstepsend=MeshingStep.MESHSURFACE)
    return _fluid(outline, channel, level).GenerateMesh(only)


def _fluid(outline: Outline, channel: Channel, level: Level) -> occ.OCCGeometry:
    fluid = _channel_solid(outline, channel) - _swimmer_solid(outline, level)
    if len(fluid.solids) != 1:
        raise MicroswimError("the fluid is not one piece: the swimmer cuts through the channel")
    return occ.OCCGeometry(fluid)


def sizes(
    outline: Outline, channel: Channel, level: Level, zone: Zone | None = None, **more: Any
) -> MeshingParameters:
    """Return Netgen's parameters for a level in a channel."""
    found = MeshingParameters(
        maxh=level.far * channel.diameter / outline.unit,
        grading=level.grading,
        curvaturesafety=level.curvature,
        optsteps3d=6,
        **more,
    )
    if zone:
        for at in _zone_points(outline, zone):
            found.RestrictH(*at)
    return found


def _zone_points(outline: Outline, zone: Zone) -> list[tuple[float, float, float, float]]:
    """Points a mesh size apart in the cylinder around the tail; closer by half about its tip."""
    near = max(3.0 * outline.radius, zone.size)
    whole = _lattice(0.0, outline.length + near, outline.radius, zone.radius, zone.size)
    low, high = outline.length - near, outline.length + near
    tip = _lattice(low, high, outline.radius, outline.radius + near, 0.5 * zone.size)
    return [p for p in [*whole, *tip] if not outline.in_body(p[:3])]


def _lattice(
    low: float, high: float, inner: float, outer: float, size: float
) -> list[tuple[float, float, float, float]]:
    """Points (s, q, r) between two cylinders, each with the mesh size wanted there."""
    points = []
    for i, s in enumerate(np.arange(low, high, size)):
        for rho in np.arange(inner + 0.5 * size, outer, size):
            n = max(6, int(np.ceil(2.0 * np.pi * rho / size)))
            angles = (np.arange(n) + 0.5 * (i % 2)) * 2.0 * np.pi / n
            points += [(s, rho * np.cos(a), rho * np.sin(a), size) for a in angles]
    return [(float(s), float(q), float(r), float(h)) for s, q, r, h in points]
