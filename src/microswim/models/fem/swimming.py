"""Swimming in time from rest: inertia of the fluid, moving mesh, free of force and torque.

The swimmer has no inertia of its own: force and torque of the fluid on it vanish at every step, as
in the paper [Tabak Eq. 17]. The pose of the new step is extrapolated (Adams-Bashforth), the
velocity follows from fluid and constraint at once. Inside: body diameter, viscosity and phase rate
are one, the density is ``Re = rho |rate| l^2 / mu`` (2 pi times the paper's Reynolds number).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.spatial.transform import Rotation

from microswim import checks
from microswim.errors import SpecError
from microswim.models.fem.displacement import Carrier, Wave
from microswim.models.fem.former import Former
from microswim.models.fem.gait import is_round, problem, vessel
from microswim.models.fem.mesh import Level, Outline, level_named
from microswim.models.fem.navier_stokes import Past, Step
from microswim.models.fem.record import March, dataset, load_march, save_march
from microswim.models.fem.stokes import Stokes
from microswim.swimmer.geometry.surroundings import Channel
from microswim.swimmer.swimmer import Swimmer


class Swim:
    """A swimmer marching in time; `step` takes one march state to the next.

    Parameters
    ----------
    swimmer, channel, level
        As for `swim`.
    steps_per_period
        Time steps in one period of the tail.
    free
        Which of the six motions are free.
    """

    def __init__(
        self,
        swimmer: Swimmer,
        channel: Channel,
        level: Level,
        steps_per_period: int,
        free: tuple[bool, ...],
    ) -> None:
        self.swimmer, self.channel, self.free = swimmer, channel, free
        self.dt = 2.0 * np.pi / steps_per_period
        outline, rate = Outline.of(swimmer), float(swimmer.tail.rate)
        self.direction, self.rate = np.sign(rate), abs(rate)
        fluid = swimmer.fluid
        self.reynolds = float(fluid.density * self.rate * outline.unit**2 / fluid.viscosity)
        self.round = is_round(swimmer)
        self._check_step(outline)
        self.wave, self.flow = problem(swimmer, channel, level)
        self.carrier = carrier_of(self.wave, channel)
        self.former: Former | None = None

    def _check_step(self, outline: Outline) -> None:
        """The convective term is explicit: refuse steps beyond its limit."""
        fastest = Wave(self.swimmer, outline, np.inf).reach + outline.radius
        if (number := fastest**2 * self.reynolds * self.dt) > 0.5:
            raise SpecError(
                "steps_per_period",
                round(2 * np.pi / self.dt),
                f"at least {int(np.ceil(4 * np.pi * number / self.dt))} at this Reynolds number",
            )

    def start(self) -> March:
        """Return everything at rest, the tail at phase 0."""
        X = self.flow.nodes.points
        self.flow.move(X + self.wave.displacement(X, 0.0))
        still = np.zeros(self.flow.size)
        past = Past((still,), (self.flow.position.copy(),))
        return March.at_rest(past)

    def pose(self, march: March) -> tuple[np.ndarray, Rotation]:
        """Return the pose of the new step: displacement of the centre, and turn of the body."""
        twist = 1.5 * march.twist - 0.5 * march.twist_old if march.step > 1 else march.twist
        turn = Rotation.from_rotvec(self.dt * twist[3:]) * Rotation.from_quat(march.turn)
        return march.shift + self.dt * twist[:3], turn

    def shape(self, turn: Rotation, phase: float) -> tuple[float, Rotation]:
        """Return the phase of the mesh's wave and turn of the mesh.

        A helix on a round body takes the spin about s into its phase, so that the mesh need not
        follow it: Spin(psi) P(phase) = P(phase + sign psi).
        """
        if not self.round:
            return phase, turn
        x, _, _, w = turn.as_quat()
        spin = 2.0 * np.arctan2(x, w)
        swing = turn * Rotation.from_rotvec([-spin, 0.0, 0.0])
        return phase + float(self.swimmer.tail.sign) * spin, swing

    def step(self, march: March) -> March:
        """Return one time step: pose, mesh, flow and twist, wrenches."""
        now = (march.step + 1) * self.dt
        shift, turn = self.pose(march)
        wave_phase, swing = self.shape(turn, self.direction * now)
        X, flow = self.flow.nodes.points, self.flow
        Y = X + self.wave.displacement(X, wave_phase)
        flow.move(self.carrier.place(X, Y, shift, swing.as_rotvec()))
        system = Step(flow, march.past, self.dt, density=self.reynolds)
        axes = turn.as_matrix()
        modes = flow.rigid_modes(self.carrier.centre + shift, axes)
        data = self.direction * self._tail(X, Y, wave_phase, swing)
        solution, twist, wrench, self.former = system.swim(data, modes, self.free, self.former)
        lab = np.concatenate([axes @ twist[:3], axes @ twist[3:]])
        past = march.past.then(solution[: flow.size], flow.position.copy())
        self.solution = solution
        row = np.concatenate([twist, wrench["body"], wrench["tail"], shift, turn.as_quat()])
        return march.then(past, lab, shift, turn.as_quat(), row)

    def _tail(self, X: np.ndarray, Y: np.ndarray, phase: float, swing: Rotation) -> np.ndarray:
        """Boundary data of the tail's own motion per unit phase, in the lab's axes."""
        flow, on = self.flow, self.flow.on["tail"]
        velocity, normal = np.zeros_like(Y), np.zeros_like(Y)
        velocity[on] = swing.apply(self.wave.surface_velocity(X[on], Y[on], phase))
        normal[on] = swing.apply(self.wave.outward(X[on], Y[on], phase))
        return flow.without_flux(flow.given(velocity, on), flow.given(normal, on))


def carrier_of(wave: Wave, channel: Channel) -> Carrier:
    """Return the blending of the swimmer's rigid motion between the wave's zone and the walls."""
    outline = wave.outline
    ends = np.array([[outline.nose, 0, 0], [outline.tip, 0, 0]]) - outline.middle_of(channel)
    outer = float(np.min(channel.clearance(outline.unit * ends @ channel.axes))) / outline.unit
    widest = max(*outline.semi_axes[1:], wave.reach + outline.radius)
    inner = min(widest + 0.25 * (outer - widest), outline.radius + wave.width)
    return Carrier(outline.centre, outline.nose, outline.tip, max(inner, widest), outer)


def swim(
    swimmer: Swimmer,
    *,
    channel: Channel | None = None,
    periods: float = 2.0,
    steps_per_period: int = 64,
    level: str | Level = "coarse",
    free: tuple[bool, ...] | None = None,
    checkpoint: str | Path | None = None,
    checkpoint_every: int = 8,
    vtk: str | Path | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> xr.Dataset:
    """Swim from rest with the fluid's inertia (`fluid.density`); velocities and forces in time.

    Parameters
    ----------
    swimmer
        The swimmer; zero density is quasi-steady Stokes flow, its motion in the channel included.
    channel
        The vessel; by default the swimmer's own, or `Channel.around`.
    periods
        How many periods of the tail.
    steps_per_period
        Time steps a period; the error falls with their square.
    level
        ``"coarse"``, ``"standard"``, ``"fine"``, ``"paper"`` or a `Level`.
    free
        Which of us, uq, ur, os, oq, or are free; by default `swimmer.motion`. All false holds the
        swimmer: thrust and torque of a stationary swimmer.
    checkpoint
        File that keeps the run every `checkpoint_every` steps. If it exists the run goes on from
        there, to the same numbers.
    vtk
        Folder for the flow at every checkpoint, as ``.vtu``.
    progress
        Called as ``progress(done, of)`` after each step.

    Returns
    -------
    xarray.Dataset
        Over ``time``: ``velocity`` (body frame, about the body's centre), ``wrench_body``,
        ``wrench_tail`` (of the fluid, body frame), ``position``, ``quaternion`` (wxyz), ``phase``.
    """
    began = time.perf_counter()
    checks.number("periods", periods, f"one step or more, {1 / steps_per_period:g}",
                  least=0.5 / steps_per_period)  # fmt: skip
    channel = vessel(swimmer, channel)
    free = swimmer.motion.mask if free is None else free
    run = Swim(swimmer, channel, level_named(level), steps_per_period, free)
    total = round(periods * steps_per_period)
    march = load_march(checkpoint, run) or run.start()
    if vtk:
        forget_flows_after(march.step, Path(vtk))
    while march.step < total:
        march = run.step(march)
        kept = march.step % checkpoint_every == 0 or march.step == total
        if kept:  # so that a run that goes on from here has the same numbers
            run.former = None
        if vtk and kept:  # first, so that a checkpoint vouches for the flow files up to it
            write_vtk(run.flow, run.solution, Path(vtk) / f"flow-{march.step:05d}")
        if checkpoint and kept:
            save_march(checkpoint, march, run)
        if progress is not None:
            progress(march.step, total)
    info = {"level": str(level), "unknowns": run.flow.unknowns, "elements": run.flow.mesh.ne}
    return dataset(run, march, {**info, "wall_seconds": time.perf_counter() - began})


def forget_flows_after(step: int, folder: Path) -> None:
    """Remove the flow files of later steps: a kill may have left them half written."""
    for file in folder.glob("flow-*.vtu"):
        if int(file.name[5:].split(".")[0]) > step:
            file.unlink()


def write_vtk(flow: Stokes, solution: np.ndarray, path: Path) -> None:
    """Write velocity and pressure on the moved mesh (body diameters and phase rates) to
    ``path.vtu``.
    """
    from microswim.models.fem.picture import write

    write(flow, solution, path)
