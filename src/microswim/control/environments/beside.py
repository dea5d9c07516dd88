"""A wall or a tube around the robots: R and F_p of each pose, contact, and a flow at rest there.

The wall is the plane ``z = -depth``, the axis of the tube, of radius a, is the x axis. What carries
the robots, f in free fluid, is there

    u = (f_x, f_y, 0) (z + depth) / depth        u = (f_x, 0, 0) (1 - (y^2 + z^2) / a^2)
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from microswim import checks
from microswim.control import motion, posed
from microswim.control.environments.camera import MM
from microswim.control.environments.jostle import displace, jostle, tumble
from microswim.control.environments.random_streams import normals
from microswim.control.motion import FIELD_BENDS, FLOW_BENDS, substep
from microswim.control.posed_stepper import PosedStepper
from microswim.control.stepper import Stepper
from microswim.errors import SpecError
from microswim.gait.poses.table import TUBE, near, resist
from microswim.numerics.compiling.compiled import njit
from microswim.path.brownian import WORK as NOISE_WORK
from microswim.path.brownian import add_divergence, kicked
from microswim.swimmer.geometry.surroundings import Channel, Wall
from microswim.swimmer.surroundings import clearance
from microswim.swimmer.swimmer import Swimmer

#: Parts that a step may take beyond those in free fluid; after as many the robot stays.
MOST = 2000
#: Length of the tube that a spec wants, in diameters; it is taken as endless.
LONG = 100.0

compiled = njit(cache=True, error_model="numpy")


class Boundary:
    """What bounds the fluid of all environments.

    Parameters
    ----------
    robot
        In free fluid.
    wall
        Distance (mm) of a wall below the plane z = 0, or None.
    channel
        Diameter (mm) of a tube about the x axis, or None.
    poses
        The gait at every pose, as `Stepper.of` takes it; solved by boundary elements if not given.

    Raises
    ------
    SpecError
        If both are given, or the robot does not fit.
    """

    def __init__(self, robot: Swimmer, wall: Any, channel: Any, poses: Any) -> None:
        if (wall is None) == (channel is None):
            raise SpecError("wall, channel", (wall, channel), "one of the two, in mm")
        name, value = ("wall", wall) if channel is None else ("channel", channel)
        checks.number(name, value, "a length from 0.001 to 1000 (mm)", least=1e-3, most=1e3)
        self.size = float(value) * MM
        around: dict[str, Any] = {"wall": Wall(self.size)}
        if channel is not None:
            around = {"channel": Channel(diameter=self.size, length=LONG * self.size)}
        self.swimmer, self.poses = replace(robot, **around), poses
        clearance.check(self.swimmer)

    @property
    def depth(self) -> float:
        """Distance of the wall from the plane z = 0, 0 in a tube."""
        return self.size if self.swimmer.wall is not None else 0.0

    @property
    def ways(self) -> int:
        """How many axes a task spans: along the wall, along the tube."""
        return 2 if self.swimmer.wall is not None else 1

    def model(self, free: Stepper, strength: float) -> tuple[posed.Around, np.ndarray]:
        """Return what the compiled step asks, for a robot as in free fluid.

        The repulsion is as large as what the magnet in a field of that strength may press with.
        """
        made: Any = Stepper.of(
            self.swimmer, poses=self.poses, moment=free.moment, locked=free.locked
        )
        assert isinstance(made, PosedStepper)
        table = made.around.table
        if self.depth:
            table = table._replace(boundary=np.array([0.0, 0.0, -self.depth, 0.0, 0.0, 1.0]))
        lever = float(self.swimmer.tail.apparent_length)
        push = max(made.around.contact[0], np.linalg.norm(free.magnetic[:3]) * strength / lever)
        contact = np.array([push, made.around.contact[1]])
        return made.around._replace(table=table, contact=contact), np.array(made.limits)

    def check(self, path: np.ndarray) -> None:
        """Refuse a path (m) that leaves the fluid."""
        if self.depth:
            clear = path[:, 2].min() + self.depth
            allowed = f"above the wall, z > {-self.depth / MM:g} mm"
        else:
            clear = 0.5 * self.size - np.hypot(path[:, 1], path[:, 2]).max()
            allowed = f"within the tube, {0.5 * self.size / MM:g} mm about the x axis"
        if clear <= 0:
            raise SpecError("path", f"up to {-clear / MM:.3g} mm beyond the boundary", allowed)


@compiled
def flowing(around: Any, depth: float, u: Any) -> None:
    """Bring the flow of the inputs, that in free fluid, to rest at the boundary."""
    u[motion.FLOW + 2] = 0.0
    if around.table.kind == TUBE:
        u[motion.FLOW + 1] = 0.0
        return
    u[motion.G + 2], u[motion.G + 5] = u[motion.FLOW] / depth, u[motion.FLOW + 1] / depth


@compiled
def part(model: Any, bounded: Any, mem: Any, u: Any, h: float, work: Any) -> None:
    """Step one robot by a time h, beside a boundary if there is one."""
    if bounded is None:
        substep(model[0], model[1], model[2], mem, u, 0.0, h, FIELD_BENDS, work)
    else:
        posed.advance(bounded[0], model[2], bounded[1], mem, u, h, 1, MOST, work)


@compiled
def parts(model: Any, bounded: Any, mem: Any, u: Any, n: int, h: float, work: Any) -> None:
    """Step one robot n times by h, the field turning, beside a boundary if there is one."""
    if bounded is None:
        bends = motion.graded(u) & ~FLOW_BENDS
        for k in range(n):
            substep(model[0], model[1], model[2], mem, u, k * h, h, bends, work)
    else:
        posed.advance(bounded[0], model[2], bounded[1], mem, u, n * h, n, MOST, work)


@compiled
def shaken(model: Any, bounded: Any, mem: Any, s: Any, keys: Any, i: int) -> None:
    """Add thermal noise and tumbles of a step; what would reach through a boundary is not taken."""
    if bounded is None:
        if s.energy > 0.0:
            jostle(model[0], mem, np.sqrt(2.0 * s.energy * s.dt), keys, i)
        if s.run_time > 0.0:
            tumble(mem, s.dt / s.run_time, s.tumble, keys, i)
    elif s.energy > 0.0 or s.run_time > 0.0:
        before, work = mem[:8].copy(), np.empty(NOISE_WORK)
        if s.energy > 0.0:
            jostled(bounded[0], mem, s.energy, s.dt, keys, i, work)
            _back(bounded[0].table, mem, before, work)
        if s.run_time > 0.0:
            before[:] = mem[:8]
            tumble(mem, s.dt / s.run_time, s.tumble, keys, i)
            _back(bounded[0].table, mem, before, work)


@compiled
def _back(table: Any, mem: Any, before: Any, work: Any) -> None:
    """Put a robot that reaches into the boundary back to where it was."""
    if not near(table, mem[:3], mem[3:7], mem[7], work[:14], work[14:]) > 0.0:
        mem[:8] = before


@compiled
def jostled(around: Any, mem: Any, energy: float, dt: float, keys: Any, i: int, work: Any) -> None:
    """Move a robot by a twist of covariance ``2 k_B T M dt`` and mean ``k_B T div M dt``."""
    n, kick = np.empty(12), np.zeros(6)
    for k in range(6):
        n[2 * k], n[2 * k + 1] = normals(keys, i)
    R, F, touch = work[:36].reshape((6, 6)), work[36:42], work[96:110]
    x, q, phase = mem[:3], mem[3:7], mem[7]
    resist(around.table, x, q, phase, R, F, touch, work[110:])
    length = np.sqrt((R[3, 3] + R[4, 4] + R[5, 5]) / (R[0, 0] + R[1, 1] + R[2, 2]))
    kicked(R, around.free, np.sqrt(2.0 * energy / dt), n[:6], kick)
    add_divergence(around.table, around, x, q, phase, energy, length, n[6:], kick, work)
    for k in range(6):
        kick[k] *= dt
    displace(mem, kick)
