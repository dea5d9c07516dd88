"""Gymnasium environments ``microswim/Steer-v0`` and ``microswim/Reach-v0`` (extra ``control``).

One class for one robot, one for thousands; the worlds in steer and reach do the work. Gymnasium 1
looks for no plug-ins: importing this module registers both, also by name, as in
``gymnasium.make("microswim.control.environments:microswim/Steer-v0")``.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from microswim.control.environments.reach import ReachWorld
from microswim.control.environments.steer import LIMIT, SteerWorld
from microswim.errors import SpecError

World = SteerWorld | ReachWorld
KEYS = 2**63


def _spaces(world: type[World]) -> tuple[gym.spaces.Box, gym.spaces.Box]:
    seen = gym.spaces.Box(-LIMIT, LIMIT, (world.observed,), np.float32)
    return seen, gym.spaces.Box(-1.0, 1.0, (world.actions,), np.float32)


def _keys(seeds: list[int]) -> np.ndarray:
    """Key of each seed: that of a single environment with this seed."""
    return np.array([gym.utils.seeding.np_random(s)[0].integers(KEYS) for s in seeds], np.uint64)


def _path(options: dict[str, Any] | None) -> Any:
    unknown = set(options or {}) - {"path"}
    if unknown:
        raise SpecError("options", sorted(unknown)[0], '"path"')
    return (options or {}).get("path")


class _Single(gym.Env):
    world: type[World]
    metadata = {"render_modes": []}  # noqa: RUF012  (Gymnasium's own form)

    def __init__(self, render_mode: str | None = None, **options: Any) -> None:
        self.observation_space, self.action_space = _spaces(self.world)
        self.render_mode = render_mode
        self.all = self.world(1, **options)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        key = np.array([self.np_random.integers(KEYS)], dtype=np.uint64)
        return self.all.reset(key, _path(options))[0], self._info()

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        given = np.asarray(action, dtype=np.float64).reshape(1, -1)
        if given.shape[1] != self.all.actions or not np.isfinite(given).all():
            raise SpecError("action", action, f"{self.all.actions} finite numbers in [-1, 1]")
        if self.all.count[0, -1]:
            raise gym.error.ResetNeeded("this episode has ended; call reset")
        obs, reward, ends = self.all.step(given)
        return obs[0], float(reward[0]), bool(ends[0, 0]), bool(ends[0, 1]), self._info()

    def _info(self) -> dict[str, Any]:
        return {k: float(v[0]) for k, v in self.all.about.items()}


class _Vector(VectorEnv):
    world: type[World]
    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(self, num_envs: int = 1, **options: Any) -> None:
        self.num_envs, self.render_mode = int(num_envs), options.pop("render_mode", None)
        self.single_observation_space, self.single_action_space = _spaces(self.world)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.all = self.world(self.num_envs, **options)

    def reset(
        self, *, seed: int | list[int] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin anew; environment i of seed n is the single environment of seed n + i."""
        if isinstance(seed, (list, tuple)):
            if len(seed) != self.num_envs:
                raise SpecError("seed", f"{len(seed)} seeds", f"{self.num_envs} seeds or one")
            keys = _keys(list(seed))
        elif seed is not None:
            super().reset(seed=seed)
            keys = _keys([seed + i for i in range(self.num_envs)])
        else:
            keys = self.np_random.integers(KEYS, size=self.num_envs).astype(np.uint64)
        return self.all.reset(keys, _path(options)), {}

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict]:
        """One step of all; where an episode ended the step before, a new one begins instead."""
        given = np.ascontiguousarray(actions, dtype=np.float64)
        if given.shape != (self.num_envs, self.all.actions) or not np.isfinite(given).all():
            shape = (self.num_envs, self.all.actions)
            raise SpecError("actions", f"of shape {given.shape}", f"finite, of shape {shape}")
        obs, rewards, ends = self.all.step(given)
        return obs, rewards, ends[:, 0].copy(), ends[:, 1].copy(), {}


class SteerEnv(_Single):
    """A magnetised helical robot follows a path in 3-D.

    Action (4): direction to swim in (normalised), frequency of the rotating field over 10 Hz
    (negative: backwards). Observation (17): from the camera the vectors to the nearest point of the
    path and to the point 1 mm ahead of it (mm), the path's direction, the robot's heading; the
    direction and frequency commanded last; what remains of the path, 0 to 1. Options of `reset`:
    ``path``, points (k, 3) in mm.

    Examples
    --------
    >>> import gymnasium, microswim.control.environments
    >>> env = gymnasium.make("microswim/Steer-v0")
    >>> env.reset(seed=0)[0].shape
    (17,)
    """

    world = SteerWorld


class ReachEnv(_Single):
    """A motor-driven swimmer brings its centre to a target, with two controls.

    Action (2): motor rate over 8 Hz, rate of turn of the guiding field over 2 rad per time.
    Observation (9), in the frame of the guiding field: vector to the target (mm), heading (2),
    distance (mm), direction to the target (2), motor rate.

    Examples
    --------
    >>> import gymnasium, microswim.control.environments
    >>> env = gymnasium.make("microswim/Reach-v0")
    >>> env.reset(seed=0)[0].shape
    (9,)
    """

    world = ReachWorld


class SteerVectorEnv(_Vector):
    """Many `SteerEnv` at once, stepped by compiled code on all cores."""

    world = SteerWorld


class ReachVectorEnv(_Vector):
    """Many `ReachEnv` at once, stepped by compiled code on all cores."""

    world = ReachWorld


for _name in ("Steer", "Reach"):
    gym.register(
        id=f"microswim/{_name}-v0",
        entry_point=f"{__name__}:{_name}Env",
        vector_entry_point=f"{__name__}:{_name}VectorEnv",
    )
