"""A robot led along a path by a follower, from its start to the end of the path or of the time.

Between two commands the robot takes a step as `microswim.control.stepper` does, under the field
that the command makes, its weight, a flow and thermal noise; walls do not act.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from microswim.control.follower import PathFollower
from microswim.control.state import State
from microswim.control.stepper import Stepper
from microswim.errors import SpecError
from microswim.gait.readable import quantity
from microswim.gait.units import unit
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.swimmer.surroundings import weight
from microswim.swimmer.swimmer import Swimmer

A_TURN = 32  #: commands in a turn of the field
SLACK = 4.0  #: times that the way would take at full speed, after which a robot has not arrived
MOST = 1_000_000  #: commands


@dataclass(frozen=True, eq=False)
class Led:
    """What came of it, at the times of the commands.

    Parameters
    ----------
    time, position, quaternion
        Times (n,), places of the body's centre (n, 3) and attitudes (n, 4), lab frame.
    field, off
        B that was sent (n, 3) and distance from the path (n,).
    currents
        Of the coils (n, k); None without coils.
    arrived
        Whether the end of the path was reached.
    """

    time: Array
    position: Array
    quaternion: Array
    field: Array
    off: Array
    currents: Array | None
    arrived: bool


def led(
    follower: PathFollower,
    *,
    dt: float | None = None,
    time: float | None = None,
    seed: int = 0,
    progress: Callable[[int, int], None] | None = None,
) -> Led:
    """Take a robot along the path of its follower.

    Parameters
    ----------
    follower
        Whose swimmer it is; it starts at the path's first corner, its body first.
    dt
        Time between commands; by default a 32nd of a turn of the field.
    time
        After which it has not arrived; by default four times what the way takes at its speed.
    seed
        Of the noise.
    progress
        Called with the parts of the path done and of all.

    Raises
    ------
    SpecError
        If there would be too many commands, or the swimmer's surroundings are not known here.
    """
    swimmer = follower.swimmer
    check(swimmer)
    dt = 1.0 / (A_TURN * float(follower.frequency or 1.0)) if dt is None else dt
    way = float(np.linalg.norm(np.diff(follower.path, axis=0), axis=1).sum())
    time = SLACK * way / follower.speed if time is None else time
    count = int(np.ceil(time / dt))
    if not count <= MOST:
        of = unit(swimmer.units, "time")
        raise SpecError(
            "time", time, f"at most {MOST} commands of {quantity(dt, of, 3)}",
            "give a shorter path or time",
        )  # fmt: skip
    stepper = Stepper(follower.gait, swimmer, locked=True)  # type: ignore[arg-type]
    random = np.random.default_rng(seed) if swimmer.noise is not None else None
    state, rows, arrived = begun(follower), [], False
    follower.restart()
    for k in range(count + 1):
        command = follower(state, dt=dt)
        currents = () if command.currents is None else command.currents
        rows.append([k * dt, *state.values, *command.field, command.off, *currents])
        arrived = command.done
        if arrived or k == count:
            break
        loads = carried(swimmer, state.quaternion)
        state = stepper.step(state, dt=dt, **command.inputs, **loads)
        if random is not None:
            state = stepper.scattered(state, dt=dt, random=random)
        if progress is not None and k % 64 == 0:
            progress(int(1000 * follower.share), 1000)
    table = np.array(rows)
    return Led(
        time=table[:, 0],
        position=table[:, 1:4],
        quaternion=table[:, 4:8],
        field=table[:, 9:12],
        off=table[:, 12],
        currents=table[:, 13:] if table.shape[1] > 13 else None,
        arrived=arrived,
    )


def begun(follower: PathFollower) -> State:
    """Return the state at the path's first corner, the body ahead along it."""
    from scipy.spatial.transform import Rotation  # nobody waits for it without a path

    first, second = follower.path[:2]
    ahead = -(second - first) / np.linalg.norm(second - first)
    turn = Rotation.align_vectors(ahead[None], np.array([[1.0, 0.0, 0.0]]))[0]
    return State.at(position=first, quaternion=turn.as_quat(scalar_first=True))


def check(swimmer: Swimmer) -> None:
    """Refuse surroundings that a step does not know."""
    for name in ("wall", "channel"):
        if getattr(swimmer, name) is not None:
            raise SpecError(f"{name}: a led robot swims in free fluid; leave [{name}] out")
    if swimmer.flow is not None and swimmer.flow.bends:
        raise SpecError("flow.kind", swimmer.flow.kind, '"uniform" or "shear" here')


def carried(swimmer: Swimmer, quaternion: Array) -> dict[str, Array]:
    """Return weight and flow as inputs of a step."""
    inputs: dict[str, Array] = {}
    if swimmer.flow is not None:
        inputs |= {"flow": swimmer.flow.at_origin, "gradient": swimmer.flow.gradient}
    if swimmer.gravity is not None:
        down = np.asarray(swimmer.gravity.vector, float)
        Q = rotation_matrix(np.asarray(quaternion, float))
        lever = weight.arm(swimmer, np.zeros(1))[0]
        inputs |= {"force": weight.pull(swimmer), "torque": np.cross(Q @ lever, down)}
    return inputs
