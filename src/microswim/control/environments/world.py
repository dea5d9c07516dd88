"""World: what the environments share, from settings to the step; one robot or thousands.

A task gives its kernels and its numbers; the state of all its robots lies in plain arrays, one row
each, which the kernels overwrite.
"""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from importlib.resources import as_file, files
from typing import Any

import numpy as np

from microswim.control.environments.bench import NUMBERS, Bench
from microswim.control.environments.camera import FRAME, conditions
from microswim.control.motion import INPUT, WORK
from microswim.control.stepper import Stepper
from microswim.errors import MicroswimError, SpecError
from microswim.swimmer.swimmer import Swimmer

BLOCKS = 4  # of robots that one core takes together


def robot(name: str) -> Swimmer:
    """Return the swimmer of an environment, by the name of its file in ``robots/``."""
    with as_file(files("microswim.control.environments") / "robots" / f"{name}.toml") as path:
        return Swimmer.from_toml(path)


class World(ABC):
    """So many robots at one task.

    Parameters
    ----------
    n
        Number of robots.
    options
        As `camera.conditions` takes them; and `coils` and `stray`, as `bench.Bench` does.

    Raises
    ------
    SpecError
        If an option is unknown or out of range.
    """

    observed: int
    actions: int
    memory_size: int
    counts: int

    def __init__(self, n: int, **options: Any) -> None:
        coils, stray = (options.pop(name, None) for name in ("coils", "stray"))
        self.bench = None if coils is None and stray is None else Bench(coils, stray)
        self.settings = s = self.conditions(**_known(options))
        stepper = self.stepper()
        made = np.zeros((0 if self.bench is None else n, NUMBERS))
        self.model = (stepper.response.twist, stepper.response.strain, stepper.magnetic, made)
        self.memory = np.zeros((n, self.memory_size))
        self.count = np.zeros((n, self.counts), dtype=np.int64)
        self.ring = np.zeros((n, s.latency // s.interval + 2, FRAME))
        self.keys = np.zeros(n, dtype=np.uint64)
        self.scratch = np.zeros((BLOCKS, INPUT + WORK))
        self.begun = False

    @staticmethod
    @abstractmethod
    def conditions(**options: Any) -> Any:
        """Return the settings of the task, a named tuple of numbers for the kernels."""

    @staticmethod
    @abstractmethod
    def stepper() -> Stepper:
        """Return the robot, with its magnet."""

    @abstractmethod
    def take(self, path: Any) -> None:
        """Take the path of the episodes to come; None: the task's own."""

    @abstractmethod
    def begin(self, obs: np.ndarray) -> None:
        """Begin an episode for every robot and write what is seen."""

    @abstractmethod
    def advance(
        self, actions: np.ndarray, obs: np.ndarray, ends: np.ndarray, rewards: np.ndarray
    ) -> None:
        """Move every robot by one step and write what comes of it."""

    @property
    @abstractmethod
    def about(self) -> dict[str, np.ndarray]:
        """What the camera does not tell."""

    def reset(self, keys: np.ndarray, path: Any = None) -> np.ndarray:
        """Return what is seen at the start of new episodes with these keys, along this path."""
        self.take(path)
        self.keys = np.array(keys, dtype=np.uint64)
        obs = np.empty((len(self.memory), self.observed), dtype=np.float32)
        self.begin(obs)
        self.begun = True
        return obs

    def step(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return observations, rewards, and (n, 2): terminated, truncated.

        Raises
        ------
        MicroswimError
            If there was no reset before.
        """
        if not self.begun:
            raise MicroswimError("the environment has not begun; call reset before step")
        n = len(self.memory)
        obs, rewards = np.empty((n, self.observed), dtype=np.float32), np.empty(n)
        ends = np.empty((n, 2), dtype=np.bool_)
        if self.bench is not None:  # the first count is that of the steps
            times = self.settings.dt * self.count[:, 0]
            self.bench.write(self.memory[:, :3], times, self.model[3])
        self.advance(actions, obs, ends, rewards)
        return obs, rewards, ends


def _known(options: dict[str, Any]) -> dict[str, Any]:
    names = tuple(inspect.signature(conditions).parameters)
    for name, value in options.items():
        if name not in names:
            raise SpecError(
                name, value, "one of the settings " + ", ".join((*names, "coils", "stray"))
            )
    return options
