"""A swimmer of a group: where it is, turned how, at which phase, under which load.

A scene's frame is fixed in the laboratory. A swimmer's frame has its body's centre at `position`
and its axis s, from the body along the tail, along `direction`: the smallest turn that takes e_s
there, after a `roll` about s. With direction (1, 0, 0) both frames have the same axes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.swimmer.surroundings import weight
from microswim.swimmer.swimmer import Swimmer

NOWHERE = (0.0, 0.0, 0.0)


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Member:
    """A swimmer of a group, at a pose and a phase, under a load.

    Parameters
    ----------
    swimmer
        The swimmer; its ``motion.free`` says what is free, its tail's frequency how it is driven
        (in the lab frame: as it turns alone), its `Gravity` what it weighs (lab: the scene's axes).
    position
        Of its body's centre, or of the joint without a body (length, scene's frame).
    direction
        Of its axis s, from the body along the tail; of any length. It swims the other way.
    roll
        Turn about s before that (rad).
    phase
        Of its tail (rad).
    force, torque
        External force, and torque about the body's centre, in the scene's axes.

    Raises
    ------
    SpecError
        If an entry is not finite, the direction has no length, or the swimmer stands in a wall,
        a channel or a field of its own.

    Examples
    --------
    >>> import microswim as ms
    >>> one = ms.Member(swimmer=ms.Swimmer.preset("tabak/helix"), direction=(0, 1, 0))
    >>> one.rotation[:, 0].round(12).tolist()
    [0.0, 1.0, 0.0]
    """

    swimmer: Swimmer
    position: tuple[float, float, float] = NOWHERE
    direction: tuple[float, float, float] = (1.0, 0.0, 0.0)
    roll: float = 0.0
    phase: float = 0.0
    force: tuple[float, float, float] = NOWHERE
    torque: tuple[float, float, float] = NOWHERE

    def __post_init__(self) -> None:
        checks.swimmer("swimmer", self.swimmer)
        for name in ("position", "direction", "force", "torque"):
            value = getattr(self, name)
            checks.numbers(name, value, 3, "three finite numbers")
            object.__setattr__(self, name, tuple(float(x) for x in value))
        for name in ("roll", "phase"):
            checks.number(name, getattr(self, name), "a finite angle (rad)")
        if not any(self.direction):
            raise SpecError("direction", self.direction, "a direction of some length")
        _check_alone(self.swimmer)

    @property
    def rotation(self) -> Array:
        """Rotation (3, 3) from the swimmer's axes to the scene's."""
        return towards(np.array(self.direction)) @ about_s(self.roll)

    @property
    def wrench(self) -> Array:
        """External force and torque (6,) in the swimmer's axes, its weight among them."""
        Q, own = self.rotation, self.swimmer
        load = np.concatenate([np.array(self.force) @ Q, np.array(self.torque) @ Q])
        if own.gravity is None:
            return load
        down = own.gravity.vector @ Q
        lever = weight.arm(own, np.array([self.phase]))[0]
        return load + np.concatenate([weight.pull(own) @ Q, np.cross(lever, down)])


def _check_alone(swimmer: Swimmer) -> None:
    """Refuse surroundings that a swimmer cannot bring into a group."""
    for name in ("wall", "channel", "field", "flow", "noise"):
        if getattr(swimmer, name) is not None:
            raise SpecError(
                f"{name}: a swimmer of a group stands in still, free fluid; remove [{name}] from "
                "its spec (a scene has force, torque, [wall] and [field], a spec [gravity])"
            )


def about_s(angle: float) -> Array:
    """Return the rotation (3, 3) about s."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def towards(direction: Array) -> Array:
    """Return the smallest rotation (3, 3) that takes e_s to a direction; straight back: about r.

    Q = I + [w] + [w]^2 / (1 + c),  w = e_s x d, c = d_s                        (Rodrigues)
    """
    d = direction / np.linalg.norm(direction)
    if 1.0 + d[0] < 1e-14:
        return np.diag([-1.0, -1.0, 1.0])
    w = np.array([0.0, -d[2], d[1]])
    W = np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])
    return np.eye(3) + W + W @ W / (1.0 + d[0])


def direction_and_roll(Q: Array) -> tuple[Array, float]:
    """Return direction and roll of a member whose rotation (3, 3) is Q."""
    rolled = towards(Q[:, 0]).T @ Q
    return Q[:, 0], float(np.arctan2(rolled[2, 1], rolled[1, 1]))
