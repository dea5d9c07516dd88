"""Steer: a magnetised helical robot follows a path in 3-D; thousands of them, compiled.

Each step of 20 ms: the coils turn the field about the wanted direction at the wanted frequency, the
robot follows as `motion` has it (beyond step-out it does not), a flow that nobody measures carries
it, and a camera sees it seldom, late and with noise. Millimetres in observations and paths, SI
inside.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

import numpy as np

from microswim.control import motion
from microswim.control.environments import uneven
from microswim.control.environments.camera import (
    MM,
    SPREAD,
    attitude,
    conditions,
    expose,
    fill,
    seen,
)
from microswim.control.environments.moving import move
from microswim.control.environments.paths import POINTS, locate, point, resampled, wander
from microswim.control.environments.random_streams import (
    direction,
    direction_within,
    normals,
    uniform,
)
from microswim.control.environments.world import World, robot
from microswim.control.motion import INPUT, field_at
from microswim.control.stepper import Stepper
from microswim.numerics.compiling.compiled import FAST, njit, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.rigid_motion import to_lab

MOMENT = 2e-5  # A m^2, across the helix: a head of NdFeB of half a millimetre holds five times that
OBSERVED, ACTIONS = 17, 4
#: Per environment: state (8), field direction (3), direction driven (3), frequency, flow (3), mean
#: flow (3), progress, gradient of the field (9).
Y, B, D, F, FLOW, MEAN, PROGRESS, SLOPE, MEMORY = 0, 8, 11, 14, 15, 18, 21, 22, 31
STEP, SEGMENT, SEEN, DONE, COUNTS = 0, 1, 2, 3, 4
LIMIT = 20.0  # of observations
TURN = 0.64  # rad of the field per internal step

Settings = namedtuple(
    "Settings",
    "dt field top gust calm noise angle_noise energy run_time tumble slope ways interval "
    "latency steps length bend lost ahead",
)


def settings(*, max_steps: int = 1500, **options: Any) -> Settings:
    """Return settings of the task; `options` as `camera.conditions` takes them."""
    return Settings(
        dt=0.02, field=4e-3, top=10.0, calm=2.0, length=10.0 * MM, bend=0.8 / MM, lost=3.0 * MM,
        ahead=1.0 * MM, **conditions(max_steps=max_steps, **options),
    )  # fmt: skip


compiled = njit(cache=True, fastmath=FAST, error_model="numpy")


@compiled
def start(
    mem: Any, count: Any, ring: Any, path: Any, keys: Any, i: int, s: Any, draw: bool
) -> None:
    """Begin an episode: a path (unless given), a pose near its beginning, a mean flow."""
    if draw:
        wander(path, s.length, s.bend, s.ways, keys, i)
    h0, h1, h2 = path[1, 0] - path[0, 0], path[1, 1] - path[0, 1], path[1, 2] - path[0, 2]
    h = np.empty(3)
    e0, e1, e2 = direction_within(s.ways, keys, i)
    size = np.sqrt(h0 * h0 + h1 * h1 + h2 * h2)
    h[0], h[1], h[2] = h0 / size + SPREAD * e0, h1 / size + SPREAD * e1, h2 / size + SPREAD * e2
    h /= np.sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2])
    mem[:] = 0.0
    e0, e1, e2 = direction_within(s.ways, keys, i)
    mem[0] = path[0, 0] + 0.2 * MM * e0
    mem[1] = path[0, 1] + 0.2 * MM * e1
    mem[2] = path[0, 2] + 0.2 * MM * e2
    attitude(mem, h, 2.0 * np.pi * uniform(keys, i))
    q = (mem[3], mem[4], mem[5], mem[6])
    mem[B], mem[B + 1], mem[B + 2] = to_lab(q, 0.0, 1.0, 0.0, 1.0)
    mem[D], mem[D + 1], mem[D + 2] = h[0], h[1], h[2]
    f0, f1, f2 = direction(keys, i)
    mem[MEAN], mem[MEAN + 1], mem[MEAN + 2] = s.gust * f0, s.gust * f1, s.gust * f2
    count[:] = 0
    fill(ring, mem, s.noise, s.angle_noise, keys, i)
    segment, f = locate(path, 0, mem[0], mem[1], mem[2])
    count[SEGMENT], mem[PROGRESS] = segment, segment + f
    if s.slope > 0.0:
        uneven.draw(mem[SLOPE:], s.slope, keys, i)


@compiled
def command(mem: Any, action: Any, s: Any) -> None:
    """Set direction and frequency wanted; the field keeps as near to what it was as it can."""
    a0, a1, a2 = action[0], action[1], action[2]
    size = np.sqrt(a0 * a0 + a1 * a1 + a2 * a2)
    if size > 1e-3:
        mem[D], mem[D + 1], mem[D + 2] = a0 / size, a1 / size, a2 / size
    mem[F] = s.top * min(max(action[3], -1.0), 1.0)
    d0, d1, d2 = mem[D], mem[D + 1], mem[D + 2]
    along = mem[B] * d0 + mem[B + 1] * d1 + mem[B + 2] * d2
    b0, b1, b2 = mem[B] - along * d0, mem[B + 1] - along * d1, mem[B + 2] - along * d2
    size = np.sqrt(b0 * b0 + b1 * b1 + b2 * b2)
    if size < 1e-6:  # the field was along the new direction: any across it
        x, y = (1.0, 0.0) if abs(d0) < 0.5 else (0.0, 1.0)
        b0, b1, b2 = -d2 * y, d2 * x, d0 * y - d1 * x
        size = np.sqrt(b0 * b0 + b1 * b1 + b2 * b2)
    mem[B], mem[B + 1], mem[B + 2] = b0 / size, b1 / size, b2 / size


@compiled
def order(mem: Any, action: Any, u: Any, s: Any, keys: Any, i: int) -> int:
    """Write the inputs of a step: field and flow; return its parts."""
    command(mem, action, s)
    fade = np.exp(-s.dt / s.calm)
    push = s.gust * np.sqrt(1.0 - fade * fade)
    n0, n1 = normals(keys, i)
    n2, _ = normals(keys, i)
    mem[FLOW] = fade * mem[FLOW] + push * n0
    mem[FLOW + 1] = fade * mem[FLOW + 1] + push * n1
    mem[FLOW + 2] = fade * mem[FLOW + 2] + push * n2
    w = -2.0 * np.pi * mem[F]  # a left-handed helix advances against the sense of its rotation
    for k in range(3):
        u[motion.FIELD + k] = s.field * mem[B + k]
        u[motion.TURNS + k] = w * mem[D + k]
        u[motion.FLOW + k] = mem[FLOW + k] + mem[MEAN + k]
    for k in range(9):
        u[motion.J + k] = mem[SLOPE + k]
    return max(1, int(np.ceil(abs(w) * s.dt / TURN)))


@compiled
def carry_on(mem: Any, u: Any, s: Any) -> None:
    """Leave the field where it turned to."""
    b0, b1, b2 = field_at(u, s.dt)
    mem[B], mem[B + 1], mem[B + 2] = b0 / s.field, b1 / s.field, b2 / s.field


@compiled
def watch(mem: Any, count: Any, ring: Any, path: Any, s: Any, out: Any) -> None:
    """Write the observation: what the camera told, and the command."""
    frame = ring[seen(ring, count[STEP], s.interval, s.latency)]
    x0, x1, x2 = frame[0], frame[1], frame[2]
    segment, f = locate(path, count[SEEN], x0, x1, x2)
    count[SEEN] = segment
    step = s.length / (path.shape[0] - 1)
    p0, p1, p2 = point(path, segment + f)
    g0, g1, g2 = point(path, segment + f + s.ahead / step)
    a, b = path[segment], path[segment + 1]
    t0, t1, t2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    size = np.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
    out[0], out[1], out[2] = (p0 - x0) / MM, (p1 - x1) / MM, (p2 - x2) / MM
    out[3], out[4], out[5] = t0 / size, t1 / size, t2 / size
    out[6], out[7], out[8] = (g0 - x0) / MM, (g1 - x1) / MM, (g2 - x2) / MM
    for k in range(3):
        out[9 + k], out[12 + k] = frame[3 + k], mem[D + k]
    out[15] = mem[F] / s.top
    out[16] = 1.0 - (segment + f) / (path.shape[0] - 1)
    for k in range(OBSERVED):
        out[k] = min(max(out[k], -LIMIT), LIMIT)


@compiled
def judge(mem: Any, count: Any, path: Any, s: Any) -> tuple[float, bool, float]:
    """Return the reward, whether the task is over, distance from the path.

    Reward: millimetres of progress along the path, less 0.01 a step for each millimetre off it; 5
    for the end of the path, -5 for getting lost.
    """
    segment, f = locate(path, count[SEGMENT], mem[0], mem[1], mem[2])
    p0, p1, p2 = point(path, segment + f)
    off = np.sqrt((mem[0] - p0) ** 2 + (mem[1] - p1) ** 2 + (mem[2] - p2) ** 2)
    scale = s.length / (path.shape[0] - 1) / MM
    reward = (segment + f - mem[PROGRESS]) * scale - 0.01 * off / MM
    count[SEGMENT], mem[PROGRESS] = segment, segment + f
    if segment + f >= path.shape[0] - 1.0 - 0.1 / scale:
        return reward + 5.0, True, off
    if off > s.lost:
        return reward - 5.0, True, off
    return reward, False, off


@compiled
def finish(
    mem: Any, count: Any, ring: Any, path: Any, keys: Any, i: int, u: Any, s: Any, obs: Any,
    ends: Any, draw: bool,
) -> float:  # fmt: skip
    """Return the reward of a step that was moved; where the episode had ended, begin anew."""
    if count[DONE]:
        start(mem, count, ring, path, keys, i, s, draw)
        watch(mem, count, ring, path, s, obs)
        ends[0], ends[1] = False, False
        return 0.0
    carry_on(mem, u, s)
    count[STEP] += 1
    if count[STEP] % s.interval == 0:
        row = (count[STEP] // s.interval) % ring.shape[0]
        expose(ring[row], mem, s.noise, s.angle_noise, keys, i)
    watch(mem, count, ring, path, s, obs)
    reward, over, _ = judge(mem, count, path, s)
    ends[0], ends[1] = over, not over and count[STEP] >= s.steps
    count[DONE] = ends[0] or ends[1]
    return reward


@loop(fastmath=FAST, error_model="numpy")
def step_all(
    mem: Any, count: Any, ring: Any, path: Any, keys: Any, actions: Any, scratch: Any, model: Any,
    s: Any, obs: Any, ends: Any, rewards: Any, draw: bool,
) -> None:  # fmt: skip
    """Step all environments."""
    blocks, n = scratch.shape[0], mem.shape[0]
    for b in prange(blocks):
        u, work = scratch[b, :INPUT], scratch[b, INPUT:]
        for i in range(b * n // blocks, (b + 1) * n // blocks):
            if not count[i, DONE]:
                parts = order(mem[i], actions[i], u, s, keys, i)
                move(model, mem[i], mem[i, SLOPE:], u, parts, s, keys, i, work)
            rewards[i] = finish(
                mem[i], count[i], ring[i], path[i], keys, i, u, s, obs[i], ends[i], draw
            )


@compiled
def order_all(mem: Any, count: Any, keys: Any, actions: Any, s: Any, U: Any, parts: Any) -> None:
    """Write the inputs and parts of a step of all environments whose episodes go on."""
    for i in range(mem.shape[0]):
        parts[i] = 0 if count[i, DONE] else order(mem[i], actions[i], U[i], s, keys, i)


@compiled
def finish_all(
    mem: Any, count: Any, ring: Any, path: Any, keys: Any, U: Any, s: Any, obs: Any, ends: Any,
    rewards: Any, draw: bool,
) -> None:  # fmt: skip
    """Write what comes of a step that was moved."""
    for i in range(mem.shape[0]):
        rewards[i] = finish(
            mem[i], count[i], ring[i], path[i], keys, i, U[i], s, obs[i], ends[i], draw
        )


@compiled
def begin_all(
    mem: Any, count: Any, ring: Any, path: Any, keys: Any, s: Any, obs: Any, draw: bool
) -> None:
    """Begin an episode in all environments."""
    for i in range(mem.shape[0]):
        start(mem[i], count[i], ring[i], path[i], keys, i, s, draw)
        watch(mem[i], count[i], ring[i], path[i], s, obs[i])


class SteerWorld(World):
    """So many robots and their paths; options as `settings` takes them."""

    observed, actions, memory_size, counts, robot = OBSERVED, ACTIONS, MEMORY, COUNTS, "steer"
    slope = SLOPE
    conditions = staticmethod(settings)

    def __init__(self, n: int, **options: Any) -> None:
        super().__init__(n, **options)
        self.own_length, self.draw = self.settings.length, True
        self.path = np.zeros((n, POINTS, 3))

    @staticmethod
    def stepper() -> Stepper:
        """Return the robot: rigid, its magnet across the helix."""
        return Stepper(robot("steer").gait(), moment=(0.0, MOMENT, 0.0), locked=True)

    def take(self, path: Any) -> None:
        """Take a path in mm; None: each episode draws its own."""
        length = self.own_length
        if path is not None:
            self.path[:] = given = resampled(path) * MM
            length = float(np.linalg.norm(np.diff(given, axis=0), axis=1).sum())
        if path is not None and self.boundary is not None:
            self.boundary.check(self.path[0])
        self.draw, self.settings = path is None, self.settings._replace(length=length)

    def begin(self, obs: np.ndarray) -> None:
        """Begin in all environments."""
        begin_all(
            self.memory, self.count, self.ring, self.path, self.keys, self.settings, obs, self.draw
        )

    def advance(
        self, actions: np.ndarray, obs: np.ndarray, ends: np.ndarray, rewards: np.ndarray
    ) -> None:
        """Step all environments."""
        step_all.over(len(obs))(
            self.memory, self.count, self.ring, self.path, self.keys, actions, self.scratch,
            self.model, self.settings, obs, ends, rewards, self.draw,
        )  # fmt: skip

    def order(self, actions: np.ndarray, U: np.ndarray) -> np.ndarray:
        """Write the inputs (n, 37) of a step; return its parts (n,), 0 where an episode ended."""
        parts = np.zeros(len(U), np.int64)
        order_all(self.memory, self.count, self.keys, actions, self.settings, U, parts)
        return parts

    def finish(
        self, actions: np.ndarray, U: np.ndarray, obs: np.ndarray, ends: np.ndarray,
        rewards: np.ndarray,
    ) -> None:  # fmt: skip
        """Write what comes of a step that was moved."""
        finish_all(
            self.memory, self.count, self.ring, self.path, self.keys, U, self.settings, obs, ends,
            rewards, self.draw,
        )  # fmt: skip

    @property
    def about(self) -> dict[str, np.ndarray]:
        """What the camera does not tell: distance from the path (mm) and progress (0 to 1)."""
        x, where = self.memory[:, :3], self.memory[:, PROGRESS]
        near = np.array([point(p, w) for p, w in zip(self.path, where)])
        off = np.linalg.norm(x - near, axis=1) / MM
        return {"off_path": off, "progress": where / (POINTS - 1)}
