"""Velocities of several swimmers at their poses, for a path: by elements, by points, from afar."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.models.group.blocks import prepare
from microswim.models.group.estimate import GroupEstimate
from microswim.models.group.estimate import estimate as by_points
from microswim.models.group.quick import QuickSolution, solve_quickly
from microswim.models.group.solution import GroupSolution
from microswim.models.group.swarm import swarm
from microswim.numerics.array import Array
from microswim.swimmer.group import Group
from microswim.swimmer.magnetism.between import are_magnetic, largest_torques
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

    def at(self, pose: Pose, time: float) -> tuple[Array, float, float]:
        """Return velocities (n, 6) in the swimmers' axes, their error, the longest time step."""
        ...


class PhaseByPhase:
    """Each swimmer at its phase, by boundary elements (``"bem"``) or points (``"estimate"``)."""

    def __init__(self, group: Group, model: str, level: str) -> None:
        self.group, self.model = group, model
        self.blocks = prepare(group, level)
        self.rates = np.array([self.blocks.of(m).rate for m in group.members])
        self.of_field = 0.0 if group.field is None else float(group.field.rate)

    def begun(self, pose: Pose) -> Pose:
        """Return the pose as it is."""
        return pose

    def at(self, pose: Pose, time: float) -> tuple[Array, float, float]:
        """Return velocities, their error, a step of 1/16 of a period (of the field too), of 0.35
        rad and of what a magnet takes to turn into the field.
        """
        x, Q, phase = pose
        directions, rolls = zip(*(direction_and_roll(q) for q in Q), strict=True)
        here = self.group.moved(x, directions, rolls, phase, time)
        found = self._solved(here)
        turning = float(np.linalg.norm(found.velocity[:, 3:], axis=1).max())
        fastest = max(np.abs(self.rates).max(), self.of_field) * STEPS / (2.0 * np.pi)
        error = float(getattr(found, "expected_error", np.nan))
        return found.velocity, error, _over(max(fastest, turning / TURN, _into_field(found)))

    def _solved(self, here: Group) -> QuickSolution | GroupSolution | GroupEstimate:
        if self.model == "bem":
            return solve_quickly(here, self.blocks)
        found = by_points(here, blocks=self.blocks)
        _require("estimate", found.expected_error)
        return found


class OnAverage:
    """All swimmers seen from afar, averaged over their periods (``"far"``)."""

    def __init__(self, group: Group, level: str) -> None:
        if are_magnetic(group.members):
            raise SpecError(
                'model = "far": knows no magnets; take model = "estimate", or leave [magnet] out '
                "of the specs"
            )
        self.swarm = swarm(group, level)
        self.rates = self.swarm.rates

    def begun(self, pose: Pose) -> Pose:
        """Return the pose with s along the mean path in place of about it."""
        x, Q, phase = pose
        return x, self.swarm.along_paths(Q, phase), phase

    def at(self, pose: Pose, time: float) -> tuple[Array, float, float]:
        """Return velocities, their error, a step by how they turn and come nearer, at any time."""
        V, errors, nearest = self.swarm.velocity(*pose[:2])
        half, most = np.quantile(errors, [0.5, HELD], method="higher")
        _require("far", float(half))
        speed, turning = (float(np.linalg.norm(v, axis=1).max()) for v in (V[:, :3], V[:, 3:]))
        apart = max(nearest, self.swarm.size)
        return V, float(most), _over(max(turning / TURN, 2.0 * speed / (NEARER * apart)))


def _over(rate: float) -> float:
    return 1.0 / rate if rate > 0.0 else np.inf


def _into_field(found: QuickSolution | GroupSolution | GroupEstimate) -> float:
    """Return the fastest rate at which a magnet turns into the field: ``m B`` times a mobility."""
    group = found.group
    if not are_magnetic(group.members):
        return 0.0
    torque = largest_torques(group.members, group.field, group.time)
    own = found.resistance.reshape(len(torque), 6, -1, 6)
    drag = [np.linalg.eigvalsh(own[i, 3:, i, 3:])[0] for i in range(len(torque))]
    return float((torque / drag).max())


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
