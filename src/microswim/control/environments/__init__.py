"""Gymnasium environments ``microswim/Steer-v0`` and ``microswim/Reach-v0`` (extra ``control``).

One class for one robot, one for thousands; the worlds in steer and reach do the work. Gymnasium 1
looks for no plug-ins: importing this module registers both, also by name, as in
``gymnasium.make("microswim.control.environments:microswim/Steer-v0")``.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from microswim import checks
from microswim.control.environments.reach import ReachWorld
from microswim.control.environments.steer import LIMIT, SteerWorld
from microswim.control.environments.world import World
from microswim.errors import SpecError

__all__ = ["ReachEnv", "ReachVectorEnv", "SteerEnv", "SteerVectorEnv"]

KEYS = 2**63
MOST = 1_000_000  # environments in a vector: 1.5 GB of paths and frames
BEYOND = 1e9  # an action of this size is a mistake


def __dir__() -> list[str]:
    """Return what a user means to see, not what the module imports."""
    return __all__


def _spaces(world: type[World]) -> tuple[gym.spaces.Box, gym.spaces.Box]:
    seen = gym.spaces.Box(-LIMIT, LIMIT, (world.observed,), np.float32)
    return seen, gym.spaces.Box(-1.0, 1.0, (world.actions,), np.float32)


def _seed(seed: Any) -> int | None:
    """The seed, checked."""
    if seed is None:
        return None
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise SpecError("seed", seed, "a whole number from 0 on")
    return int(seed)


def _key(seed: int) -> np.uint64:
    """Key of the stream of a single environment with this seed."""
    return np.uint64(np_random(seed)[0].integers(KEYS))


def _path(options: Any) -> Any:
    """The path among the options of a reset, the only one there is."""
    if options is None:
        return None
    if not isinstance(options, dict):
        raise SpecError("options", options, 'a dictionary such as {"path": points}')
    for name in options:
        if name != "path":
            raise SpecError("options", name, '"path"')
    return options.get("path")


def _finite(name: str, given: Any, shape: tuple[int, ...]) -> np.ndarray:
    """The actions as an array of this shape, checked."""
    try:
        actions = np.ascontiguousarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise SpecError(name, given, "made of numbers") from None
    if actions.shape != shape:
        raise SpecError(name, f"of shape {actions.shape}", f"of shape {shape}")
    if not (np.abs(actions) <= BEYOND).all():
        raise SpecError(name, given, "made of finite numbers, in [-1, 1]")
    return actions


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
        """Begin anew; without a seed the stream of chance goes on, as in a vector."""
        seed, path = _seed(seed), _path(options)
        super().reset(seed=seed)
        first = seed is not None or not self.all.begun
        keys = np.array([self.np_random.integers(KEYS)], np.uint64) if first else self.all.keys
        return self.all.reset(keys, path)[0], self._info()

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Return one step; an error before the first reset and after the end."""
        given = _finite("action", action, (self.all.actions,))[None]
        if not self.all.begun:
            raise gym.error.ResetNeeded("no episode has begun; call reset")
        if self.all.count[0, -1]:
            raise gym.error.ResetNeeded("this episode has ended; call reset")
        obs, reward, ends = self.all.step(given)
        return obs[0], float(reward[0]), bool(ends[0, 0]), bool(ends[0, 1]), self._info()

    def _info(self) -> dict[str, Any]:
        return {k: float(v[0]) for k, v in self.all.about.items()}


class _Vector(VectorEnv):
    world: type[World]
    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(self, num_envs: int = 1, render_mode: str | None = None, **options: Any) -> None:
        allowed = f"a whole number from 1 to {MOST}"
        checks.number("num_envs", num_envs, allowed, least=1, most=MOST)
        if int(num_envs) != num_envs:
            raise SpecError("num_envs", num_envs, allowed)
        self.num_envs, self.render_mode = int(num_envs), render_mode
        self.single_observation_space, self.single_action_space = _spaces(self.world)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.all = self.world(self.num_envs, **options)

    def reset(
        self, *, seed: Any = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin anew; environment i of seed n is the single environment of seed n + i.

        A list gives each environment its own seed; where it has None, or without any seed, the
        streams of chance go on.
        """
        seeds, path = self._seeds(seed), _path(options)
        if seed is not None and seeds[0] is not None:
            super().reset(seed=seeds[0])
        if not self.all.begun:
            self.all.keys = self.np_random.integers(KEYS, size=self.num_envs).astype(np.uint64)
        keys = self.all.keys.copy()
        for i, own in enumerate(seeds):
            keys[i] = keys[i] if own is None else _key(own)
        return self.all.reset(keys, path), {}

    def _seeds(self, seed: Any) -> list[int | None]:
        """Seed of each environment."""
        if isinstance(seed, (list, tuple, np.ndarray)):
            if len(seed) != self.num_envs:
                raise SpecError("seed", f"{len(seed)} seeds", f"{self.num_envs} seeds, or one")
            return [_seed(s) for s in seed]
        first = _seed(seed)
        return [None if first is None else first + i for i in range(self.num_envs)]

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict]:
        """Step all; where an episode ended the step before, a new one begins instead."""
        given = _finite("actions", actions, (self.num_envs, self.all.actions))
        if not self.all.begun:
            raise gym.error.ResetNeeded("no episode has begun; call reset")
        obs, rewards, ends = self.all.step(given)
        return obs, rewards, ends[:, 0].copy(), ends[:, 1].copy(), {}


class SteerEnv(_Single):
    """A magnetised helical robot follows a path in 3-D.

    Options: numbers as `camera.conditions` has them, ``coils`` and ``stray`` fields; ``wall`` or
    ``channel`` (mm), what bounds the fluid, with ``poses`` and ``progress`` as `beside.Boundary`.

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
