"""Velocities of several swimmers at their poses, for a path: by elements, by points, from afar."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.group.blocks import prepare
from microswim.models.group.estimate import GroupEstimate
from microswim.models.group.estimate import estimate as by_points
from microswim.models.group.quick import QuickSolution, solve_quickly
from microswim.models.group.solution import GroupSolution
from microswim.models.group.swarm import swarm
from microswim.numerics.array import Array
from microswim.swimmer.group import Group
from microswim.swimmer.member import direction_and_roll

#: Steps in a period of the fastest motor, and the largest turn in a step (rad).
STEPS, TURN = 16, 0.35
#: Share of the smallest distance, or of a swimmer's size if that is larger, by which two swimmers
#: may come nearer in a step.
NEARER = 0.1
#: Share of many swimmers within the stated error.
HELD = 0.95
#: Largest error of an estimate that a path is followed with.
WORST = 0.25

Pose = tuple[Array, Array, Array]  # positions (n, 3), rotations (n, 3, 3), phases (n,)


class OfAll(Protocol):
    """What a path of several swimmers asks of a model."""

    @property
    def rates(self) -> Array:
        """Phase rates of the motors (n,)."""
        ...

    def begun(self, pose: Pose) -> Pose:
        """Return the pose with which a path begins at a pose of the group."""
        ...

    def at(self, pose: Pose) -> tuple[Array, float, float]:
        """Return velocities (n, 6) in the swimmers' axes, their error, the longest time step."""
        ...


class PhaseByPhase:
    """Each swimmer at its phase, by boundary elements (``"bem"``) or points (``"estimate"``)."""

    def __init__(self, group: Group, model: str, level: str) -> None:
        self.group, self.model = group, model
        self.blocks = prepare(group, level)
        self.rates = np.array([self.blocks.of(m).rate for m in group.members])

    def begun(self, pose: Pose) -> Pose:
        """Return the pose as it is."""
        return pose

    def at(self, pose: Pose) -> tuple[Array, float, float]:
        """Return velocities, their error, a step of 1/16 of a period and 0.35 rad."""
        found = self._solved(pose)
        turning = float(np.linalg.norm(found.velocity[:, 3:], axis=1).max())
        fastest = float(np.abs(self.rates).max()) * STEPS / (2.0 * np.pi)
        error = float(getattr(found, "expected_error", np.nan))
        return found.velocity, error, _over(max(fastest, turning / TURN))

    def _solved(self, pose: Pose) -> QuickSolution | GroupSolution | GroupEstimate:
        x, Q, phase = pose
        directions, rolls = zip(*(direction_and_roll(q) for q in Q), strict=True)
        here = self.group.moved(positions=x, directions=directions, rolls=rolls, phases=phase)
        if self.model == "bem":
            return solve_quickly(here, self.blocks)
        found = by_points(here, blocks=self.blocks)
        _require("estimate", found.expected_error)
        return found


class OnAverage:
    """All swimmers seen from afar, averaged over their periods (``"far"``)."""

    def __init__(self, group: Group, level: str) -> None:
        self.swarm = swarm(group, level)
        self.rates = self.swarm.rates

    def begun(self, pose: Pose) -> Pose:
        """Return the pose with s along the mean path in place of about it."""
        x, Q, phase = pose
        return x, self.swarm.along_paths(Q, phase), phase

    def at(self, pose: Pose) -> tuple[Array, float, float]:
        """Return velocities, their error, a step by how they turn and come nearer."""
        V, errors, nearest = self.swarm.velocity(*pose[:2])
        half, most = np.quantile(errors, [0.5, HELD], method="higher")
        _require("far", float(half))
        speed, turning = (float(np.linalg.norm(v, axis=1).max()) for v in (V[:, :3], V[:, 3:]))
        apart = max(nearest, self.swarm.size)
        return V, float(most), _over(max(turning / TURN, 2.0 * speed / (NEARER * apart)))


def _over(rate: float) -> float:
    return 1.0 / rate if rate > 0.0 else np.inf


def _require(model: str, error: float) -> None:
    """Stop where an estimate says little."""
    if not error <= WORST:
        raise MicroswimError(
            f'model = "{model}": two swimmers are so near that velocities may be off by '
            f'{100.0 * error:.0f} %; take model = "bem"'
        )


def model_of(group: Group, model: str, level: str) -> OfAll:
    """Return what answers for a group by a model."""
    return OnAverage(group, level) if model == "far" else PhaseByPhase(group, model, level)
