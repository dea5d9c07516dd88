"""Reach: a motor-driven swimmer brings its centre to a target; thousands of them, compiled.

Two controls: the motor's rate, and the rate at which a guiding field turns in the plane z = 0. The
robot's magnet lies along its axis, so the field turns the robot as it turns a magnetotactic cell,
with a lag; nothing else holds it in the plane. Millimetres in observations, SI inside.
"""

from __future__ import annotations

from collections import namedtuple
from typing import Any

import numpy as np

from microswim.control import motion
from microswim.control.environments import uneven
from microswim.control.environments.camera import (
    MM,
    attitude,
    conditions,
    expose,
    fill,
    seen,
)
from microswim.control.environments.moving import move
from microswim.control.environments.random_streams import direction, uniform
from microswim.control.environments.world import World, robot
from microswim.control.motion import INPUT
from microswim.control.stepper import Stepper
from microswim.errors import SpecError
from microswim.numerics.compiling.compiled import FAST, njit, prange
from microswim.numerics.compiling.cores import loop

MOMENT = 1e-4  # A m^2, along the body: the robot follows the field at 11 per second
OBSERVED, ACTIONS = 9, 2
#: Per environment: state (8), angle of the field, motor (-1 to 1), target (2), flow (3), distance,
#: gradient of the field (9).
ANGLE, MOTOR, TARGET, FLOW, DISTANCE, SLOPE, MEMORY = 8, 9, 10, 12, 15, 16, 25
STEP, DONE, COUNTS = 0, 1, 2
LIMIT = 20.0
TURN = 1.01  # rad of the tail per internal step

Settings = namedtuple(
    "Settings",
    "dt field top swing gust noise angle_noise energy run_time tumble slope ways interval "
    "latency steps near",
)


def settings(*, max_steps: int = 1000, **options: Any) -> Settings:
    """Return settings of the task; `options` as `camera.conditions` takes them."""
    return Settings(
        dt=0.02, field=4e-3, top=16.0 * np.pi, swing=2.0, near=0.2 * MM,
        **conditions(max_steps=max_steps, **options),
    )  # fmt: skip


compiled = njit(cache=True, fastmath=FAST, error_model="numpy")


@compiled
def far(mem: Any) -> float:
    """Return the distance of the body's centre from the target."""
    x, y, z = mem[TARGET] - mem[0], mem[TARGET + 1] - mem[1], mem[2]
    return np.sqrt(x * x + y * y + z * z)


@compiled
def bearing_of(ways: int, keys: Any, i: int) -> float:
    """Return a random direction in the plane z = 0; of one way, along the x axis."""
    turn = uniform(keys, i)
    return 2.0 * np.pi * turn if ways > 1 else np.pi * np.floor(2.0 * turn)


@compiled
def start(mem: Any, count: Any, ring: Any, keys: Any, i: int, s: Any) -> None:
    """Begin an episode: heading, target 2 to 6 mm away, flow."""
    mem[:] = 0.0
    count[:] = 0
    heading = bearing_of(s.ways, keys, i)
    h = np.array([np.cos(heading), np.sin(heading), 0.0])
    attitude(mem, h, 2.0 * np.pi * uniform(keys, i))
    mem[7] = 2.0 * np.pi * uniform(keys, i)
    mem[ANGLE] = heading
    away, bearing = (2.0 + 4.0 * uniform(keys, i)) * MM, bearing_of(s.ways, keys, i)
    mem[TARGET], mem[TARGET + 1] = away * np.cos(bearing), away * np.sin(bearing)
    f0, f1, f2 = direction(keys, i)
    mem[FLOW], mem[FLOW + 1], mem[FLOW + 2] = s.gust * f0, s.gust * f1, 0.1 * s.gust * f2
    mem[DISTANCE] = far(mem)
    fill(ring, mem, s.noise, s.angle_noise, keys, i)
    if s.slope > 0.0:
        uneven.draw(mem[SLOPE:], s.slope, keys, i)


@compiled
def order(mem: Any, action: Any, u: Any, s: Any) -> int:
    """Write the inputs of a step; return its parts. The field turns by ``swing dt`` at most."""
    mem[MOTOR] = min(max(action[0], -1.0), 1.0)
    turn = s.swing * min(max(action[1], -1.0), 1.0)
    u[motion.MOTOR], u[motion.TURNS + 2] = s.top * mem[MOTOR], turn
    u[motion.FIELD], u[motion.FIELD + 1] = (
        s.field * np.cos(mem[ANGLE]),
        s.field * np.sin(mem[ANGLE]),
    )
    for k in range(3):
        u[motion.FLOW + k] = mem[FLOW + k]
    for k in range(9):
        u[motion.J + k] = mem[SLOPE + k]
    return max(1, int(np.ceil(abs(u[motion.MOTOR]) * s.dt / TURN)))


@compiled
def watch(mem: Any, count: Any, ring: Any, s: Any, out: Any) -> None:
    """Write the observation, in the frame of the guiding field."""
    frame = ring[seen(ring, count[STEP], s.interval, s.latency)]
    c, d = np.cos(mem[ANGLE]), np.sin(mem[ANGLE])
    x, y = (mem[TARGET] - frame[0]) / MM, (mem[TARGET + 1] - frame[1]) / MM
    out[0], out[1], out[2] = c * x + d * y, c * y - d * x, -frame[2] / MM
    out[3], out[4] = c * frame[3] + d * frame[4], c * frame[4] - d * frame[3]
    away = np.sqrt(x * x + y * y) + 1e-9
    out[5], out[6], out[7] = away, out[0] / away, out[1] / away
    out[8] = mem[MOTOR]
    for k in range(OBSERVED):
        out[k] = min(max(out[k], -LIMIT), LIMIT)


@compiled
def finish(
    mem: Any, count: Any, ring: Any, keys: Any, i: int, action: Any, u: Any, s: Any, obs: Any,
    ends: Any,
) -> float:  # fmt: skip
    """Return the reward of a step that was moved; where the episode had ended, begin anew.

    Reward: millimetres nearer to the target, less 0.002 for full use of each control; 5 for the
    target, -5 for 12 mm away from it.
    """
    if count[DONE]:
        start(mem, count, ring, keys, i, s)
        watch(mem, count, ring, s, obs)
        ends[0], ends[1] = False, False
        return 0.0
    mem[7] = np.mod(mem[7], 2.0 * np.pi)
    mem[ANGLE] = np.mod(mem[ANGLE] + u[motion.TURNS + 2] * s.dt, 2.0 * np.pi)
    count[STEP] += 1
    if count[STEP] % s.interval == 0:
        row = (count[STEP] // s.interval) % ring.shape[0]
        expose(ring[row], mem, s.noise, s.angle_noise, keys, i)
    watch(mem, count, ring, s, obs)
    away = far(mem)
    effort = min(action[0] ** 2, 1.0) + min(action[1] ** 2, 1.0)
    reward = (mem[DISTANCE] - away) / MM - 0.001 * effort
    mem[DISTANCE] = away
    there, lost = away < s.near, away > 12.0 * MM
    ends[0] = there or lost
    ends[1] = not ends[0] and count[STEP] >= s.steps
    count[DONE] = ends[0] or ends[1]
    return reward + (5.0 if there else 0.0) - (5.0 if lost else 0.0)


@loop(fastmath=FAST, error_model="numpy")
def step_all(
    mem: Any, count: Any, ring: Any, keys: Any, actions: Any, scratch: Any, model: Any,
    s: Any, obs: Any, ends: Any, rewards: Any,
) -> None:  # fmt: skip
    """Step all environments."""
    blocks, n = scratch.shape[0], mem.shape[0]
    for b in prange(blocks):
        u, work = scratch[b, :INPUT], scratch[b, INPUT:]
        for i in range(b * n // blocks, (b + 1) * n // blocks):
            if not count[i, DONE]:
                parts = order(mem[i], actions[i], u, s)
                move(model, mem[i], mem[i, SLOPE:], u, parts, s, keys, i, work)
            rewards[i] = finish(
                mem[i], count[i], ring[i], keys, i, actions[i], u, s, obs[i], ends[i]
            )


@compiled
def order_all(mem: Any, count: Any, actions: Any, s: Any, U: Any, parts: Any) -> None:
    """Write the inputs and parts of a step of all environments whose episodes go on."""
    for i in range(mem.shape[0]):
        parts[i] = 0 if count[i, DONE] else order(mem[i], actions[i], U[i], s)


@compiled
def finish_all(
    mem: Any, count: Any, ring: Any, keys: Any, actions: Any, U: Any, s: Any, obs: Any, ends: Any,
    rewards: Any,
) -> None:  # fmt: skip
    """Write what comes of a step that was moved."""
    for i in range(mem.shape[0]):
        rewards[i] = finish(
            mem[i], count[i], ring[i], keys, i, actions[i], U[i], s, obs[i], ends[i]
        )


@compiled
def begin_all(mem: Any, count: Any, ring: Any, keys: Any, s: Any, obs: Any) -> None:
    """Begin an episode in all environments."""
    for i in range(mem.shape[0]):
        start(mem[i], count[i], ring[i], keys, i, s)
        watch(mem[i], count[i], ring[i], s, obs[i])


class ReachWorld(World):
    """So many robots and their targets; options as `settings` takes them."""

    observed, actions, memory_size, counts, robot = OBSERVED, ACTIONS, MEMORY, COUNTS, "reach"
    slope = SLOPE
    conditions = staticmethod(settings)

    @staticmethod
    def stepper() -> Stepper:
        """Return the robot with its magnet along the body."""
        return Stepper(robot("reach").gait(), moment=(-MOMENT, 0.0, 0.0))

    def take(self, path: Any) -> None:
        """Refuse a path."""
        if path is not None:
            raise SpecError("path", path, "left out", "microswim/Reach-v0 has a target, no path")

    def begin(self, obs: np.ndarray) -> None:
        """Begin in all environments."""
        begin_all(self.memory, self.count, self.ring, self.keys, self.settings, obs)

    def advance(
        self, actions: np.ndarray, obs: np.ndarray, ends: np.ndarray, rewards: np.ndarray
    ) -> None:
        """Step all environments."""
        step_all.over(len(obs))(
            self.memory, self.count, self.ring, self.keys, actions, self.scratch, self.model,
            self.settings, obs, ends, rewards,
        )  # fmt: skip

    def order(self, actions: np.ndarray, U: np.ndarray) -> np.ndarray:
        """Write the inputs (n, 37) of a step; return its parts (n,), 0 where an episode ended."""
        parts = np.zeros(len(U), np.int64)
        order_all(self.memory, self.count, actions, self.settings, U, parts)
        return parts

    def finish(
        self, actions: np.ndarray, U: np.ndarray, obs: np.ndarray, ends: np.ndarray,
        rewards: np.ndarray,
    ) -> None:  # fmt: skip
        """Write what comes of a step that was moved."""
        finish_all(
            self.memory, self.count, self.ring, self.keys, actions, U, self.settings, obs, ends,
            rewards,
        )  # fmt: skip

    @property
    def about(self) -> dict[str, np.ndarray]:
        """What the camera does not tell: true distance from the target (mm)."""
        return {"distance": self.memory[:, DISTANCE] / MM}
