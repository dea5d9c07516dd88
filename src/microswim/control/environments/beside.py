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
from microswim.control.environments.bench import under_all
from microswim.control.environments.camera import MM, SPREAD, attitude
from microswim.control.environments.jostle import displace, tumble
from microswim.control.environments.random_streams import normals
from microswim.control.posed_stepper import PosedStepper
from microswim.control.stepper import Stepper
from microswim.errors import SpecError
from microswim.gait.poses.table import WORK as POSE_WORK
from microswim.gait.poses.table import near, resist
from microswim.numerics.compiling.compiled import njit
from microswim.path.brownian import WORK as NOISE_WORK
from microswim.path.brownian import add_divergence, kicked
from microswim.swimmer.geometry.surroundings import Channel, Wall
from microswim.swimmer.surroundings import clearance
from microswim.swimmer.swimmer import Swimmer

#: Parts that a step may take beyond those in free fluid; what is left of it then is not moved.
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
    poses, progress
        The gait at every pose, as `Stepper.of` takes it; solved by boundary elements if not given.

    Raises
    ------
    SpecError
        If both are given or none, the robot does not fit, or the poses are of another boundary.
    """

    def __init__(self, robot: Swimmer, wall: Any, channel: Any, poses: Any, progress: Any) -> None:
        if (wall is None) == (channel is None):
            raise SpecError("wall, channel", (wall, channel), "one of the two, in mm")
        name, value = ("wall", wall) if channel is None else ("channel", channel)
        checks.number(name, value, "a length from 0.001 to 1000 (mm)", least=1e-3, most=1e3)
        self.size = float(value) * MM
        around: dict[str, Any] = {"wall": Wall(self.size)}
        if channel is not None:
            around = {"channel": Channel(diameter=self.size, length=LONG * self.size)}
        self.swimmer = replace(robot, **around)
        self.options = {"poses": poses, "progress": progress}
        clearance.check(self.swimmer)
        self.around: posed.Around | None = None

    @property
    def depth(self) -> float:
        """Distance of the wall from the plane z = 0, 0 in a tube."""
        return self.size if self.swimmer.wall is not None else 0.0

    @property
    def ways(self) -> int:
        """How many axes a task spans: along the wall, along the tube."""
        return 2 if self.swimmer.wall is not None else 1

    def hold(self, free: Stepper) -> None:
        """Hold the gait at every pose, for a robot as in free fluid."""
        made: Any = Stepper.of(self.swimmer, moment=free.moment, locked=free.locked, **self.options)
        assert isinstance(made, PosedStepper)
        table = made.around.table
        if self.depth:
            table = table._replace(boundary=np.array([0.0, 0.0, -self.depth, 0.0, 0.0, 1.0]))
        self.around = made.around._replace(table=table)
        self.magnetic, self.limits, self.work = made.magnetic, made.limits, posed.rows_of_work(8)

    def flowing(self, U: np.ndarray) -> None:
        """Set the flow of inputs (n, 37), that in free fluid, to rest at the boundary."""
        U[:, motion.FLOW + 2] = 0.0
        if self.depth:
            U[:, [motion.G + 2, motion.G + 5]] = U[:, [motion.FLOW, motion.FLOW + 1]] / self.depth
        else:
            U[:, motion.FLOW + 1] = 0.0

    def move(
        self, Y: np.ndarray, slopes: np.ndarray, U: np.ndarray, n: int, dt: float, made: np.ndarray
    ) -> None:
        """Move states (m, 8) by a time in n parts or more, under inputs that `flowing` has seen.

        `slopes` (m, 9) of the field; `made` (m, 48) as of `bench.Bench.write`, or none.
        """
        if not len(made):
            self._advance(Y, U, dt, n)
            return
        V = U.copy()
        for k in range(n):
            under_all(made, slopes, Y, U, k * dt / n, dt / n, V)
            self._advance(Y, V, dt / n, 1)

    def _advance(self, Y: np.ndarray, U: np.ndarray, dt: float, n: int) -> None:
        assert self.around is not None
        status, out = np.zeros(len(Y), np.int64), np.empty((len(Y), 19))
        run = posed.advance_all.over(len(Y))
        run(*self.around, self.magnetic, self.limits, Y, U, dt, n, MOST, status, out, self.work)

    def shake(self, mem: np.ndarray, s: Any, keys: np.ndarray, rows: np.ndarray) -> None:
        """Add thermal noise and tumbles of a step to the robots of these rows."""
        if s.energy > 0.0 or s.run_time > 0.0:
            shake_all(self.around, mem, s.energy, s.dt, s.run_time, s.tumble, keys, rows)

    def check(self, path: np.ndarray) -> None:
        """Refuse a path (m) that leaves the fluid, or begins where the robot is not clear of it."""
        if self.depth:
            clear = path[:, 2].min() + self.depth
            allowed = f"above the wall, z > {-self.depth / MM:g} mm"
        else:
            clear = 0.5 * self.size - np.hypot(path[:, 1], path[:, 2]).max()
            allowed = f"within the tube, {0.5 * self.size / MM:g} mm about the x axis"
        if clear <= 0:
            raise SpecError("path", f"up to {-clear / MM:.3g} mm beyond the boundary", allowed)
        gap = self._least_gap(path[0], path[1] - path[0])
        if gap <= 0:
            found = f"begun where the robot would reach {-gap / MM:.3g} mm into the boundary"
            raise SpecError("path", found, "begun further from it, or more along it")

    def _least_gap(self, place: np.ndarray, way: np.ndarray) -> float:
        """Return the smallest gap of the headings and rolls with which an episode begins."""
        assert self.around is not None
        y, touch, work = np.zeros(8), np.empty(14), np.empty(POSE_WORK)
        least, way = np.inf, way / np.linalg.norm(way)
        for turn in 2.0 * np.pi * np.arange(8) / 8:
            aside = np.array([np.cos(turn), np.sin(turn) if self.ways > 1 else 0.0, 0.0])
            heading = way + SPREAD * aside
            for phase in 2.0 * np.pi * np.arange(8) / 8:
                attitude(y, heading / np.linalg.norm(heading), phase)
                gap = near(self.around.table, place, y[3:7], phase, touch, work)
                least = min(least, gap)
        return float(least)


@compiled
def shake_all(
    around: Any, mem: Any, energy: float, dt: float, run_time: float, angle: float, keys: Any,
    rows: Any,
) -> None:  # fmt: skip
    """Add thermal noise and tumbles; what would reach through the boundary is not taken."""
    before, work = np.empty(8), np.empty(NOISE_WORK)
    for i in rows:
        if energy > 0.0:
            before[:] = mem[i, :8]
            jostled(around, mem[i], energy, dt, keys, i, work)
            _back(around.table, mem[i], before, work)
        if run_time > 0.0:
            before[:] = mem[i, :8]
            tumble(mem[i], dt / run_time, angle, keys, i)
            _back(around.table, mem[i], before, work)


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
