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
from microswim.control.environments.beside import Boundary
from microswim.control.environments.camera import FRAME, conditions
from microswim.control.motion import INPUT, WORK
from microswim.control.stepper import Stepper
from microswim.errors import MicroswimError, SpecError
from microswim.swimmer.swimmer import Swimmer

BLOCKS = 4  # of robots that one core takes together
#: Options that are no numbers of the task.
AROUND = ("coils", "stray", "wall", "channel", "poses", "progress")


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
        As `camera.conditions` takes them; `coils` and `stray`, as `bench.Bench`, `wall`, `channel`,
        `poses` and `progress`, as `beside.Boundary` does.

    Raises
    ------
    SpecError
        If an option is unknown or out of range.
    """

    robot: str  #: its file in ``robots/``
    slope: int  #: where in the memory the gradient of the field begins
    observed: int
    actions: int
    memory_size: int
    counts: int

    def __init__(self, n: int, **options: Any) -> None:
        coils, stray, *bounds = (options.pop(name, None) for name in AROUND)
        self.bench = None if coils is None and stray is None else Bench(coils, stray)
        self.boundary: Boundary | None = None
        if any(x is not None for x in bounds):
            self.boundary = Boundary(robot(self.robot), *bounds)
        self.settings = s = self.conditions(**_known(options))
        stepper = self.stepper()
        if self.boundary is not None:
            self.settings = s = s._replace(ways=self.boundary.ways)
            self.boundary.hold(stepper)
        made = np.zeros((0 if self.bench is None else n, NUMBERS))
        table = stepper.response
        self.model = (table.twist, table.strain, stepper.magnetic, made)
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
        """Move every robot in free fluid by one step and write what comes of it."""

    @abstractmethod
    def order(self, actions: np.ndarray, U: np.ndarray) -> np.ndarray:
        """Write the inputs (n, 37) of a step; return its parts (n,), 0 where an episode ended."""

    @abstractmethod
    def finish(
        self, actions: np.ndarray, U: np.ndarray, obs: np.ndarray, ends: np.ndarray,
        rewards: np.ndarray,
    ) -> None:  # fmt: skip
        """Write what comes of a step that was moved."""

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
        if self.boundary is None:
            self.advance(actions, obs, ends, rewards)
        else:
            U = np.zeros((n, INPUT))
            parts = self.order(actions, U)
            self._move(self.boundary, U, parts)
            self.finish(actions, U, obs, ends, rewards)
        return obs, rewards, ends

    def _move(self, boundary: Boundary, U: np.ndarray, parts: np.ndarray) -> None:
        """Move the robots whose episodes go on, those of as many parts of a step together."""
        boundary.flowing(U)
        slopes, made = self.memory[:, self.slope : self.slope + 9], self.model[3]
        for n in np.unique(parts[parts > 0]):
            rows = np.flatnonzero(parts == n)
            Y, own = self.memory[rows, :8].copy(), made[rows] if len(made) else made
            boundary.move(Y, slopes[rows], U[rows], int(n), self.settings.dt, own)
            self.memory[rows, :8] = Y
        boundary.shake(self.memory, self.settings, self.keys, np.flatnonzero(parts))


def _known(options: dict[str, Any]) -> dict[str, Any]:
    names = tuple(inspect.signature(conditions).parameters)
    for name, value in options.items():
        if name not in names:
            raise SpecError(name, value, "one of the settings " + ", ".join((*names, *AROUND)))
    return options
