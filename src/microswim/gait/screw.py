"""The rigid motion of a steadily driven swimmer over one period: a screw."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.gait.gait import Gait
from microswim.gait.stepping import WORK, integrate, pack, step
from microswim.numerics.compiling.compiled import pays
from microswim.numerics.rigid_motion import ScrewMotion, along_twist, multiply, rotation_matrix

#: Seconds of a step as Python, side by side with the others.
ONE_STEP = 1e-5
AVERAGED = 256  #: steps of a period over which a path is averaged
ASIDE = 1e-3  #: share of a displacement along s from which on one end leads


@checks.given(gait=checks.gait, steps=checks.at_least(1))
def screw(gait: Gait, steps: int | None = None) -> ScrewMotion:
    """Return the rigid motion of a free swimmer over one period, by steps of order 4.

    Parameters
    ----------
    gait
        Any gait; its series may be complex (complex-step derivatives).
    steps
        Steps per period; by default none for a rigid helix on a round body, whose motion has a
        closed form, else 256, or four for each term of the gait's series if that is more: good to
        about 1e-9 of the displacement.

    Returns
    -------
    ScrewMotion
        From it swimming speed, pitch and path radius; NaN for a gait that holds at one pose,
        beside a wall (`Gait.one_pose`).

    Examples
    --------
    >>> import microswim as ms
    >>> ms.screw(ms.Swimmer.preset("tabak/helix").gait()).quaternion.shape
    (4,)
    """
    if gait.one_pose:
        return ScrewMotion(np.full(3, np.nan), np.full(4, np.nan), gait.period)
    forward = 1.0 if np.real(gait.rate) >= 0 else -1.0
    if gait.turned and steps is None:
        return ScrewMotion(*_of_one_phase(gait, forward), gait.period)
    packed, free = pack(gait), np.array(gait.free)
    steps = steps or max(256, 4 * len(packed))
    kind = packed.dtype
    rates, loads = np.array([forward], dtype=kind), np.zeros((1, 5, 3), dtype=kind)
    if pays(steps * ONE_STEP):
        x, q, phase = (np.array(v, dtype=kind) for v in ([0, 0, 0], [1, 0, 0, 0], 0))
        times, counts = np.array([0.0, 2.0 * np.pi]), np.array([0, steps])
        X, Q, _ = integrate(packed, free, x, q, phase[()], times, counts, rates, loads)
        return ScrewMotion(X[-1], Q[-1], gait.period)
    return ScrewMotion(*_joined(*_side_by_side(gait, steps)), gait.period)


def average_radius(gait: Gait, whole: ScrewMotion) -> Any:
    """Return the radius of the circle or helix of the path without its wobble.

    Mean over the period of where the body's centre stands about the screw axis, the turn of the
    screw up to then taken back: it does not depend on the phase at which a period begins.

    Parameters
    ----------
    gait
        Of a free swimmer.
    whole
        Its screw motion.
    """
    if gait.turned or gait.one_pose or not whole.turns:
        return whole.radius
    x = _one_after_another(*_side_by_side(gait, AVERAGED))[0]
    share = (np.arange(AVERAGED) + 1.0) / AVERAGED
    off = x + whole.arm - (share * whole.advance)[:, None] * whole.axis
    back = (-0.5 * whole.angle) * share
    about = np.concatenate([np.cos(back)[:, None], np.sin(back)[:, None] * whole.axis], axis=1)
    centre = np.mean(np.einsum("nij,nj->ni", rotation_matrix(about), off), axis=0)
    centre = centre - whole.axis * np.sum(whole.axis * centre)
    return np.sqrt(np.sum(centre * centre))


def _side_by_side(gait: Gait, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and turn (n, 3), (n, 4) of each step of a period, as Python, all at once:
    without loads a step does not depend on the pose.
    """
    packed, forward = pack(gait), 1.0 if np.real(gait.rate) >= 0 else -1.0
    kind = packed.dtype
    rates, loads = np.array([forward], dtype=kind), np.zeros((1, 5, 3), dtype=kind)
    x, q, work = (np.zeros((n, steps), dtype=kind) for n in (3, 4, WORK))
    q[0], h = 1.0, 2.0 * np.pi / steps
    phases = (forward * h * np.arange(steps)).astype(kind)
    step.written(packed, np.array(gait.free), x, q, phases, h, rates, loads, work)
    return x.T, q.T


def leading_end(gait: Gait, front: str = "body") -> str:
    """Return which end goes first over a period, ``"body"`` or ``"tail"``; empty if neither does.

    The mean of u_s does not tell: it is taken in axes that sway, and a swimmer that is thrown to
    and fro across its axis as it yaws may go the other way. `front` is the other end's name where
    there is no body.
    """
    way = np.real(screw(gait).displacement)
    size = float(np.sqrt(np.sum(way**2)))
    if not np.isfinite(size) or abs(way[0]) <= ASIDE * size:
        return ""
    return front if way[0] < 0.0 else "tail"


def is_misled(u_s: float, leads: str) -> bool:
    """Return whether the sign of a mean u_s says another end than that which leads."""
    return leads != "" and (u_s < 0.0) == (leads == "tail")


def way_of(numbers: dict[str, Any]) -> str:
    """Return in words what the sign of u_s says; where it misleads, which end goes first."""
    leads = numbers.get("leading_end", "")
    if is_misled(numbers["mean_velocity"][0], leads):
        return f"in the swaying frame of the body; it goes {leads} first"
    return (
        "positive: the tail leads" if leads == "tail" else f"negative: the {leads or 'body'} leads"
    )


def _of_one_phase(gait: Gait, forward: float) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and quaternion of a gait that phase 0 tells.

    Seen from axes that turn with the tail the twist is constant, ``[U, w + sign e_s]`` per unit of
    phase; after a period these axes are the body's again, one turn ahead.
    """
    twist = 2.0 * np.pi * gait.velocity(0.0, forward)
    twist[3] += 2.0 * np.pi * forward * gait.turned
    x, q = along_twist(twist)
    return x, -q


def _one_after_another(x: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pose after each of n motions one after the other, by doubling."""
    ahead = 1
    while ahead < len(q):
        moved = np.einsum("nij,nj->ni", rotation_matrix(q[:-ahead]), x[ahead:])
        x = np.concatenate([x[:ahead], x[:-ahead] + moved])
        q = np.concatenate([q[:ahead], multiply(q[:-ahead], q[ahead:])])
        ahead *= 2
    return x, q


def _joined(x: np.ndarray, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacement and quaternion of motions x (n, 3), q (n, 4) one after the other."""
    while len(q) > 1:
        even = len(q) // 2 * 2
        a, b = q[0:even:2], q[1:even:2]
        moved = np.einsum("nij,nj->ni", rotation_matrix(a), x[1:even:2])
        x = np.concatenate([x[0:even:2] + moved, x[even:]])
        q = np.concatenate([multiply(a, b), q[even:]])
    return x[0], q[0]
