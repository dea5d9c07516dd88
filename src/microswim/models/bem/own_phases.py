"""Tails at phases of their own, each with its motor: R, the n propulsions, and what motors take.

    R V + F w = W,    F' V + G w = tau                  R (6, 6), F (6, n), G (n, n), w (n,)

F_j is the wrench on the fluid and G_ij what motor i must give at unit rate of motor j, all else
held: one flow has both the body and all tails, so that tails feel one another directly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from microswim.models.bem.levels import Level
from microswim.models.bem.trust import misfit, trusted
from microswim.numerics.array import Array
from microswim.swimmer.geometry.tails.several_tails import SeveralTails
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True, eq=False)
class OwnPhases:
    """A swimmer at a phase of each tail.

    Parameters
    ----------
    resistance : (6, 6)
    propulsion : (6, n)
    activity : (n, n)
    misfit : float
        By how much symmetry and reciprocity are missed.
    """

    resistance: Array
    propulsion: Array
    activity: Array
    misfit: float


def with_phases(swimmer: Swimmer, phases: Array) -> Swimmer:
    """Return the swimmer whose tails are at these phases (n,), all motors at one rate."""
    tails = tuple(
        replace(t, phase=float(np.mod(p, 2.0 * np.pi)), frequency=1.0)  # type: ignore[call-arg]
        for t, p in zip(swimmer.tail.each, phases, strict=True)
    )
    return replace(swimmer, tail=tails[0] if len(tails) == 1 else SeveralTails(tails=tails))


def at_own_phases(swimmer: Swimmer, phases: Array, level: Level) -> OwnPhases:
    """Solve for a swimmer with each tail at its phase (n,).

    Raises
    ------
    SpecError
        If tails touch there, or the flow is not resolved.
    """
    found = trusted(with_phases(swimmer, phases), 0.0, level, keep=True)
    assert found.factors is not None
    s, n = found.surface, len(phases)
    own = (s.of_tail == np.arange(1, n + 1)[:, None])[..., None, None]  # (n, e, 1, 1)
    density = found.factors.solve((own * s.node_motion).reshape(n, -1).T)
    weight = (own * s.moments[3]).reshape(n, -1)
    G = weight @ density
    return OwnPhases(
        resistance=found.resistance,
        propulsion=(weight @ found.density[:, :6]).T,
        activity=0.5 * (G + G.T),
        misfit=misfit(found),
    )
