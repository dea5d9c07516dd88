"""Gait of a swimmer: how many phases must be solved, and what symmetry gives for free.

A helix on a body of revolution turns as a whole: one phase gives all. A plane wave mirrors
after half a period, P(phase + pi) = mirror_q P(phase); a helix on an ellipsoid turns by pi into
itself. Near a wall, and for other tails, the full period is sampled.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from microswim import checks
from microswim.gait.gait import Gait
from microswim.gait.poses.one_pose import remark
from microswim.models import rooting
from microswim.models.bem.levels import Level, coarser, named
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.solution import Solution
from microswim.models.bem.trust import doubts, trusted
from microswim.numerics.array import Array
from microswim.swimmer.swimmer import Swimmer

#: Phases at which two levels are compared; share of its largest value from which a mean is told.
PHASES, STEADY = 24, 0.1
#: Least error of a velocity with a head from a file: levels that share its thinned triangles do not
#: show what was thinned away; the largest measured on unseen heads was 0.0011.
OF_A_FILE = 1.2e-3


def turns_as_a_whole(swimmer: Swimmer) -> bool:
    """Return whether one phase holds the whole gait: helix, body of revolution, no wall; no tail.

    Phase turns the surface of a helix about s, whatever its sections, and the surface's velocity
    with it, whatever its motion.
    """
    if swimmer.tail.is_absent:
        return True
    whole = swimmer.tail.is_rigid and swimmer.body.is_axisymmetric
    return whole and _is_round(swimmer)


def _is_round(swimmer: Swimmer) -> bool:
    """Return whether what bounds the fluid is the same from every side of the s axis."""
    in_round = swimmer.channel is None or swimmer.channel.centred
    return swimmer.wall is None and in_round


def half_period_signs(swimmer: Swimmer) -> Array | None:
    """Return signs that carry phase to phase + pi, or None if nothing does."""
    alike = _is_round(swimmer) and swimmer.body.is_mirrored and swimmer.tail.is_on_axis
    return swimmer.tail.half_period_signs if alike else None


def _arrays(solution: Solution) -> dict[str, Any]:
    return {
        "R": solution.resistance,
        "F": solution.propulsion,
        "G": solution.activity,
        "body_R": solution.body_resistance,
        "body_F": solution.body_propulsion,
    }


def _carried(sample: dict[str, Any], signs: Array) -> dict[str, Any]:
    both = np.outer(signs, signs)
    return {
        "R": sample["R"] * both,
        "F": sample["F"] * signs,
        "G": sample["G"],
        "body_R": sample["body_R"] * both,
        "body_F": sample["body_F"] * signs,
    }


def _info(solutions: list[Solution], level: str) -> dict[str, Any]:
    seconds = {k: sum(s.seconds[k] for s in solutions) for k in ("geometry", "assembly", "solve")}
    first = solutions[0]
    wall, channel = first.swimmer.wall, first.swimmer.channel
    around = channel if wall is None else wall
    held = around is not None and not around.stays(first.free)
    boundary = "channel" if wall is None else "wall"
    return {
        "level": level,
        "order": first.surface.order,
        "unknowns": first.unknowns,
        "patches": first.surface.patches,
        "phases_solved": len(solutions),
        "seconds": seconds,
        "asymmetry": max(s.asymmetry for s in solutions),
        "reciprocity": max(s.reciprocity for s in solutions),
        "wall": wall,
        "channel": channel,
        "remarks": [*first.remarks, *([remark(boundary)] if held else []), *doubts(solutions)],
        **({"one_pose": boundary} if held else {}),
        **_in_poiseuille(solutions),
        "joint": "torque and lateral force on the body alone drift with the logarithm of the mesh "
        "size; R, F_p and velocities converge",
    }


def _in_poiseuille(solutions: list[Solution]) -> dict[str, Any]:
    """Return the wrench of Poiseuille's flow of unit speed on the held swimmer, at one phase."""
    held = solutions[0].in_poiseuille if len(solutions) == 1 else None
    return {} if held is None else {"in_poiseuille": held.tolist()}


@checks.given(
    swimmer=checks.swimmer,
    order=checks.at_least(1),
    estimate_error=checks.truth,
    progress=checks.function,
)
def gait(
    swimmer: Swimmer,
    *,
    level: str | Level = "standard",
    order: int | None = None,
    estimate_error: bool = False,
    progress: Callable[[int, int], None] | None = None,
) -> Gait:
    """Return the gait of a swimmer by boundary elements.

    Parameters
    ----------
    swimmer : Swimmer
        With its `wall`, if it has one: the gait holds at that pose.
    level : str or Level
        "coarse", "standard" (default) or "fine", or a `Level` of one's own.
    order : int, optional
        Order p of the density on the level's patches.
    estimate_error : bool
        Solve the next coarser level too, of a beat at every other phase, and put the differences
        into ``info["error"]``.
    progress : callable, optional
        Called with (phases done, phases in all).

    Returns
    -------
    Gait
        With ``info``: unknowns, seconds of geometry, assembly and solve, asymmetry of R, error.
    """
    chosen = level if isinstance(level, Level) else named(level, swimmer, order)
    quickest = max(abs(tail.beats) for tail in swimmer.tail.each)
    count = 1 if turns_as_a_whole(swimmer) else chosen.phases * quickest
    signs = half_period_signs(swimmer)
    wanted = count // 2 if count > 1 and signs is not None else count
    phases = 2 * np.pi * np.arange(wanted) / count
    _check_roots(swimmer, phases[1:], chosen)
    solutions = []
    for n, phase in enumerate(phases.tolist()):
        solutions.append(trusted(swimmer, phase, chosen))
        if progress is not None:
            progress(n + 1, wanted)
    info = _info(solutions, chosen.name)
    result = _assembled(swimmer, solutions, count, signs, info)
    if not estimate_error:
        return result
    below = coarser(chosen.name)
    info["error"] = None
    if below is not None:
        every = 2 if wanted >= 6 and wanted % 2 == 0 else 1
        phases_below = chosen.phases // every
        level_below = replace(named(below, swimmer, order), phases=phases_below, single=True)
        same = _assembled(swimmer, solutions[::every], count // every, signs, info)
        least = 0.0 if swimmer.body.triangles is None else OF_A_FILE
        info["error"] = _difference(same, gait(swimmer, level=level_below), below, least)
    return _assembled(swimmer, solutions, count, signs, info)


def _check_roots(swimmer: Swimmer, phases: Array, level: Level) -> None:
    """Refuse, before the first solve, tails that at a later phase have no room, or touch."""
    if swimmer.body.triangles is None and len(swimmer.tail.each) == 1:
        return
    for phase in phases.tolist():
        rooting.check_all(swimmer.body, swimmer.tail, phase)
        swimmer_surface(swimmer.body, swimmer.tail, phase, level.resolution)


def _assembled(
    swimmer: Swimmer,
    solutions: list[Solution],
    count: int,
    signs: Array | None,
    info: dict[str, Any],
) -> Gait:
    common = {"rate": solutions[0].rate, "free": solutions[0].free, "model": "bem", "info": info}
    common["units"] = swimmer.units
    samples = [_arrays(s) for s in solutions]
    if count == 1 and swimmer.tail.is_rigid:
        only = samples[0]
        made = Gait.from_rotation(
            only["R"], only["F"], only["G"], sign=swimmer.tail.sign,
            body_R=only["body_R"], body_F=only["body_F"], **common,
        )  # fmt: skip
        return _framed(swimmer, made)
    if signs is not None:
        samples += [_carried(s, signs) for s in samples]
    stack = {k: np.array([s[k] for s in samples]) for k in samples[0]}
    made = Gait.from_samples(
        stack["R"], stack["F"], stack["G"],
        body_R=stack["body_R"], body_F=stack["body_F"], **common,
    )  # fmt: skip
    return _framed(swimmer, made)


def _framed(swimmer: Swimmer, made: Gait) -> Gait:
    """Read the tail's rate in the lab frame where the swimmer asks for it."""
    if swimmer.motion.frequency_frame == "lab":
        return made.in_lab_frame(swimmer.tail.rate, swimmer.tail.sign)
    return made


def _of_velocities(fine: Gait, rough: Gait) -> Array:
    """Relative differences (6,): of a mean, or over the period where the mean is next to nothing.

    Components below a thousandth of the largest of their kind count as a thousandth of it.
    """
    phases = np.linspace(0.0, 2.0 * np.pi, PHASES, endpoint=False)
    at, other = (g.velocity(phases) for g in (fine, rough))
    size, change = np.abs(at).max(axis=0), np.abs(at - other).max(axis=0)
    mean = np.abs(fine.mean_velocity)
    off = np.abs(fine.mean_velocity - rough.mean_velocity)
    steady = mean > STEADY * size
    size, change = np.where(steady, mean, size), np.where(steady, off, change)
    least = 1e-3 * np.repeat(size.reshape(2, 3).max(axis=1), 3)
    return change / np.maximum(np.maximum(size, least), 1e-300)


def _difference(fine: Gait, rough: Gait, below: str, least: float) -> dict[str, Any]:
    """Differences from the coarser level: of mean velocity and of R and F_p, the latter
    relative; those of velocities at least a share of them.
    """
    scale = np.abs(fine.mean_velocity)
    change = np.maximum(np.abs(fine.mean_velocity - rough.mean_velocity), least * scale)
    R, S = fine.resistance_series[0], rough.resistance_series[0]
    F, H = fine.propulsion_series[0], rough.propulsion_series[0]
    return {
        "against": below,
        "mean_velocity": change,
        "velocities": np.maximum(_of_velocities(fine, rough), least),
        "relative_forward": float(change[0] / scale[0]) if scale[0] > 0 else float("nan"),
        "resistance": float(np.abs(R - S).max() / np.abs(R).max()),
        "propulsion": float(np.abs(F - H).max() / max(np.abs(F).max(), 1e-300)),
    }
