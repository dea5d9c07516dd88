"""What the boundary elements measure of their own error, acted on.

R of a passive body is symmetric and positive definite, and thrust and drag are reciprocal
(Lorentz): ``F_p`` from the tail's own flow and from those of the rigid motions agree. How far a
solution is from both measures its error, whatever the geometry.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from microswim.errors import SpecError
from microswim.gait.readable import percent
from microswim.models.bem.levels import Level
from microswim.models.bem.solution import Solution, solve
from microswim.swimmer.swimmer import Swimmer

#: Misfit of reciprocity from which on smaller panels at the joint are tried, and from which on a
#: solution is refused.
DOUBTFUL, USELESS = 1e-2, 0.1


#: What to say where patches overlap; of five helices u_s was 1 to 17 % off that of level fine.
OPEN = (
    "the tail leans so much that its root comes out of the far side of the body's end, and u_s may "
    "be off by 17 %: a thinner filament, a longer ramp or a blunter body has no such root"
)


def misfit(solution: Solution) -> float:
    """Return the larger of asymmetry and misfit of reciprocity, infinite where R is indefinite."""
    if not np.linalg.eigvalsh(solution.resistance).min() > 0.0:
        return float("inf")
    worst = max(solution.asymmetry, solution.reciprocity)
    return worst if np.isfinite(worst) else float("inf")


def trusted(swimmer: Swimmer, phase: float, level: Level, keep: bool = False) -> Solution:
    """Solve at one phase; where reciprocity is missed, again with more panels at the joint.

    `keep` keeps the factorised system.

    Raises
    ------
    SpecError
        If R is not positive definite, or reciprocity is missed by a tenth, on both meshes.
    """
    best = solve(swimmer, phase, level=level, keep=keep)
    if misfit(best) > DOUBTFUL:
        mesh = level.resolution
        finer = replace(mesh, root=0.5 * mesh.root, around=mesh.around + 1, body=mesh.body + 1)
        again = solve(swimmer, phase, level=replace(level, resolution=finer), keep=keep)
        best = min(best, again, key=misfit)
    if misfit(best) > USELESS:
        raise _beyond(swimmer, best, level)
    return best


def doubts(solutions: list[Solution]) -> list[str]:
    """Return what is to be said of solutions that miss reciprocity or whose root is open."""
    worst = max(map(misfit, solutions))
    found = [OPEN] if any(s.layer.surface.is_open for s in solutions) else []
    if worst <= DOUBTFUL:
        return found
    return found + [
        f"thrust and drag are reciprocal only to {percent(worst)}, symmetry likewise: expect "
        "errors of that size in forces and power; level fine tells more"
    ]


def _beyond(swimmer: Swimmer, solution: Solution, level: Level) -> SpecError:
    """What to say of a flow that this mesh does not resolve."""
    what = f"resolved: at level {level.name} the resistance is not that of a passive body"
    mend = "use level fine, or a gap, a root or a bend that is less narrow"
    if swimmer.wall is not None:
        return SpecError("wall.distance", swimmer.wall.distance, f"far enough to be {what}", mend)
    return SpecError("tail.radius", swimmer.tail.radius, f"thick enough to be {what}", mend)
