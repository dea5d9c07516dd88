"""Quasi-steady Stokes gait in a channel: all motions from one factorisation a phase.

With u_j the flow of the rigid mode w_j (j = 1..6), u_t that of the tail's motion per unit rate,

    R_ij = w_i' K u_j,   F_i = w_i' K u_t,   G = u_t' K u_t      [Tabak Eq. 17, by linearity]

Inside, lengths are in units of the body's diameter and viscosity is one; the gait is returned in
the swimmer's units.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.gait.gait import Gait
from microswim.gait.poses.one_pose import remark
from microswim.models.fem.displacement import Wave
from microswim.models.fem.mesh import (
    Level,
    Outline,
    Zone,
    check_in_channel,
    ellipsoid_axes,
    level_named,
    straight_mesh,
)
from microswim.models.fem.remesh import Laid, filled
from microswim.models.fem.stokes import FOLDED, Stokes
from microswim.numerics.series.fourier import MIRROR_Q
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.surroundings import Channel
from microswim.swimmer.swimmer import Swimmer

#: What level coarse is off, measured (docs/accuracy-fem.md and random designs in tubes).
LOOKING = (
    "level coarse is for looking: about 3 % off in u_s in a wide channel, 3 to 10 % in a tube; "
    "level standard is 0.3 % off"
)


@dataclass(frozen=True)
class Snapshot:
    """Resistance and propulsion at one phase in the swimmer's units; `body_*`: body alone."""

    resistance: np.ndarray
    propulsion: np.ndarray
    activity: float
    body_resistance: np.ndarray
    body_propulsion: np.ndarray


def room_around(outline: Outline, channel: Channel) -> float:
    """Return distance from the tail's straight axis to the nearest wall, in the outline's unit."""
    s = np.linspace(0.0, outline.length, 41)
    axis = np.stack([s, 0 * s, 0 * s], axis=-1) - outline.middle_of(channel)
    return float(np.min(channel.clearance(outline.unit * axis @ channel.axes))) / outline.unit


def wave_in(channel: Channel, swimmer: Swimmer) -> Wave:
    """Return the wave of a swimmer in a channel, refused where it makes no sense."""
    outline = Outline.of(swimmer)
    wave = Wave(swimmer, outline, max(room_around(outline, channel), 0.0))
    check_in_channel(outline, channel, wave.reach + outline.radius)
    wave.check()
    return wave


def problem(swimmer: Swimmer, channel: Channel, level: Level) -> tuple[Wave, Stokes]:
    """Return wave, and one straight mesh with spaces that carries it through the whole period."""
    wave, zone = wave_in(channel, swimmer), None
    outline = wave.outline
    for attempt in range(6):
        flow = Stokes(straight_mesh(outline, channel, level, zone), level.order)
        if (smallest := smallest_jacobian(wave, flow)) > 2 * FOLDED:
            return wave, flow
        level = replace(level, curvature=1.1 * level.curvature)
        zone = Zone(outline.radius + 0.7 * wave.width, wave.scale * 1.2 * 0.93**attempt)
    raise MicroswimError(
        f"no one mesh carries this wave through a period without folding (smallest Jacobian "
        f"{smallest:.2g}), as a run in time needs; lower the wave or use fewer waves, or take the "
        "quasi-steady gait, which makes a mesh for each phase"
    )


def meshes(wave: Wave, channel: Channel, level: Level) -> tuple[bool, Callable[[float], Laid]]:
    """Return whether meshes are filled in anew, and the mesh with the wave on it by phase.

    One straight mesh displaced, as long as that does not fold; else one filled in for each phase.
    """
    flow = Stokes(straight_mesh(wave.outline, channel, level), level.order)
    if smallest_jacobian(wave, flow) > 2 * FOLDED:
        return False, lambda phase: displaced(wave, flow, phase)
    return True, lambda phase: filled(wave, channel, level, phase)


def displaced(wave: Wave, flow: Stokes, phase: float) -> Laid:
    """Return the wave laid on the nodes of a straight mesh."""
    X = flow.nodes.points
    return Laid(flow, X, X + wave.displacement(X, phase))


def smallest_jacobian(wave: Wave, flow: Stokes, phases: int = 8) -> float:
    """Return the smallest Jacobian of the wave's displacement over the period."""
    X, angles = flow.nodes.points, np.arange(phases) * 2.0 * np.pi / phases
    return min(flow.smallest_jacobian(X + wave.displacement(X, float(a))) for a in angles)


def tail_data(
    wave: Wave, flow: Stokes, phase: float, straight: np.ndarray | None = None
) -> np.ndarray:
    """Return the boundary data of the tail's motion per unit phase rate, without net flux.

    `straight`: where the nodes lie on the straight outline, by default where the mesh has them.
    """
    X = flow.nodes.points if straight is None else straight
    x, on = flow.places, flow.on["tail"]
    velocity, normal = np.zeros_like(x), np.zeros_like(x)
    velocity[on] = wave.surface_velocity(X[on], x[on], phase)
    normal[on] = wave.outward(X[on], x[on], phase)
    return flow.without_flux(flow.given(velocity, on), flow.given(normal, on))


def snapshot(
    wave: Wave,
    flow: Stokes,
    phase: float,
    viscosity: float,
    tell: Callable[[], None] = lambda: None,
) -> Snapshot:
    """Solve the seven flows at one phase on a straight mesh; `solved` says more."""
    return solved(wave, displaced(wave, flow, phase), phase, viscosity, tell)


def solved(
    wave: Wave,
    laid: Laid,
    phase: float,
    viscosity: float,
    tell: Callable[[], None] = lambda: None,
) -> Snapshot:
    """Solve the seven flows at one phase; `tell` is called after the factorisation and each."""
    flow = laid.flow
    flow.move(laid.places)
    flow.factorise(1.0)
    tell()
    modes = flow.rigid_modes(wave.outline.centre)
    data = [*modes, tail_data(wave, flow, phase, laid.straight)]
    total, body = np.zeros((6, 7)), np.zeros((6, 7))
    for j, motion in enumerate(data):
        reaction = flow.apply(flow.solve(motion))
        body[:, j] = flow.forces(reaction, modes, "body")
        total[:, j] = body[:, j] + flow.forces(reaction, modes, "tail")
        tell()
    activity = data[6] @ reaction
    return _in_units(total, body, float(activity), wave.outline.unit, viscosity)


def body_resistance(
    body: Body, *, channel: Channel, level: str | Level = "standard", viscosity: float = 1.0
) -> np.ndarray:
    """Return 6x6 resistance of a body without a tail, held in a channel, about its own centre.

    Parameters
    ----------
    body
        `Sphere`, `Spheroid` or `Ellipsoid`.
    channel
        The vessel; `channel.position` is that of the body's centre.
    level
        ``"coarse"``, ``"standard"``, ``"fine"``, ``"paper"`` or a `Level`.
    viscosity
        Of the fluid.
    """
    r_s, r_q, r_r = axes = ellipsoid_axes(body)
    unit = 2.0 * max(axes)
    outline = Outline((r_s / unit, r_q / unit, r_r / unit), 0.0, 0.0, unit)
    check_in_channel(outline, channel, 0.0)
    level = level_named(level)
    flow = Stokes(straight_mesh(outline, channel, level), level.order)
    flow.factorise(1.0)
    modes = flow.rigid_modes(outline.centre)
    pulls = [flow.forces(flow.apply(flow.solve(mode)), modes, "body") for mode in modes]
    total = np.column_stack([*pulls, np.zeros(6)])
    return _in_units(total, total, 0.0, unit, viscosity).resistance


def _in_units(
    total: np.ndarray, body: np.ndarray, activity: float, unit: float, viscosity: float
) -> Snapshot:
    """Back to the swimmer's units: F ~ mu l U, T ~ mu l^2 U, U ~ l rate."""
    row = np.repeat([1.0, unit], 3)
    scale = viscosity * unit * np.outer(row, np.append(row, unit))
    total, body = total * scale, body * scale
    symmetric = 0.5 * (total[:, :6] + total[:, :6].T)
    power = activity * viscosity * unit**3
    return Snapshot(symmetric, total[:, 6], power, body[:, :6], body[:, 6])


@checks.given(
    swimmer=checks.swimmer,
    channel=partial(checks.instance, kind="Channel"),
    phases=checks.at_least(1),
    progress=checks.function,
)
def gait(
    swimmer: Swimmer,
    *,
    channel: Channel | None = None,
    level: str | Level = "standard",
    phases: int = 8,
    progress: Callable[[int, int], None] | None = None,
) -> Gait:
    """Return the gait of a swimmer at rest in the middle of a channel (or elsewhere in it), Stokes
    flow.

    Parameters
    ----------
    swimmer
        The swimmer.
    channel
        The vessel; by default the swimmer's own, or `Channel.around` (ten body diameters).
    level
        ``"coarse"``, ``"standard"``, ``"fine"``, ``"paper"`` or a `Level`.
    phases
        Phases over the period. On the axis of a cylinder a rigid helix needs one only, a plane
        wave is solved at half of them: the others are its mirror images.
    progress
        Called as ``progress(done, of)`` after the mesh, and in each phase after the factorisation
        and each of the seven flows.
    """
    start = time.perf_counter()
    channel = vessel(swimmer, channel)
    turning = turns_rigidly(swimmer, channel)
    mirrored = phases % 2 == 0 and mirrors_itself(swimmer, channel)
    wanted = 1 if turning else phases // 2 if mirrored else phases
    angles = np.arange(wanted) * 2.0 * np.pi / phases
    done, of = count(1), 1 + 8 * len(angles)

    def tell() -> None:
        if progress:
            progress(next(done), of)

    wave = wave_in(channel, swimmer)
    anew, mesh_at = meshes(wave, channel, level_named(level))
    tell()
    shots, mesh_info = [], {}
    for angle in map(float, angles):
        laid = mesh_at(angle)
        shots.append(solved(wave, laid, angle, float(swimmer.fluid.viscosity), tell))
        mesh_info = _of_mesh(laid.flow)
        del laid  # a filled mesh gives its memory back before the next
    if mirrored:
        shots += [mirror_image(shot) for shot in shots]
    held = not channel.stays(swimmer.motion.mask)
    info = {
        "level": level if isinstance(level, str) else asdict(level),
        "mesh": "filled in anew at each phase" if anew else "displaced",
        **mesh_info,
        "remarks": [
            *([LOOKING] if level == "coarse" else []),
            *([remark("channel")] if held else []),
        ],
        **({"one_pose": "channel"} if held else {}),
        "channel": asdict(channel),
        "wall_seconds": time.perf_counter() - start,
    }
    return _assembled(swimmer, shots, turning, info)


def _of_mesh(flow: Stokes) -> dict[str, Any]:
    """What a gait says of the mesh it was found on."""
    size = {"unknowns": int(flow.unknowns), "elements": int(flow.mesh.ne)}
    return {**size, "seconds": dict(flow.seconds)}


def vessel(swimmer: Swimmer, channel: Channel | None) -> Channel:
    """Return the channel asked for, the swimmer's own, or ten body diameters."""
    if swimmer.wall is not None:
        raise SpecError('wall: model = "fem" knows a [channel], not a [wall]; take "bem"')
    return channel or swimmer.channel or Channel.around(swimmer)


def is_round(swimmer: Swimmer) -> bool:
    """Return whether turning the tail's phase is turning the swimmer: a helix on an axisymmetric
    body.
    """
    return swimmer.tail.is_rigid and swimmer.body.is_axisymmetric


def turns_rigidly(swimmer: Swimmer, channel: Channel) -> bool:
    """Return whether one phase tells all: a round swimmer on the axis of a cylinder."""
    return channel.centred and is_round(swimmer)


def mirrors_itself(swimmer: Swimmer, channel: Channel) -> bool:
    """Return whether half a period later is the mirror image: a plane wave on the axis of a
    cylinder.
    """
    return channel.centred and swimmer.tail.is_planar


def mirror_image(shot: Snapshot) -> Snapshot:
    """Return the same swimmer seen in the plane q = 0: R -> M R M, F -> M F; torques are axial."""
    M = np.diag(MIRROR_Q)
    R, body_R = M @ shot.resistance @ M, M @ shot.body_resistance @ M
    return Snapshot(R, M @ shot.propulsion, shot.activity, body_R, M @ shot.body_propulsion)


def _assembled(swimmer: Swimmer, shots: list[Snapshot], turning: bool, info: dict) -> Gait:
    names = ("resistance", "propulsion", "activity", "body_resistance", "body_propulsion")
    R, F, G, body_R, body_F = (np.array([getattr(shot, n) for shot in shots]) for n in names)
    common = {
        "rate": float(swimmer.tail.rate),
        "free": swimmer.motion.mask,
        "units": swimmer.units,
        "model": "fem",
        "info": info,
    }
    if not turning:
        return Gait.from_samples(R, F, G, body_R=body_R, body_F=body_F, **common)
    sign = float(swimmer.tail.sign)
    parts = {"body_R": body_R[0], "body_F": body_F[0]}
    return Gait.from_rotation(R[0], F[0], G[0], sign=sign, **parts, **common)
