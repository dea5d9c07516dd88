"""Whether a tail touches its body: one rule for every model.

The tail's centreline is continued behind the joint (helix and plane wave by their own formula, any
other tail straight) and must lie inside the body somewhere. Without a ramp a helix of an amplitude
beyond the body's half width winds around it and never does.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.tails.kinds import Tail

SAMPLES = 1001
#: A tail that stands elsewhere than at the joint is continued by so many radii.
RADII = 4.0
MEND = "a ramp, such as tail.ramp = 0.1, leads it there; or use a smaller amplitude"
#: The same of a tail that has no amplitude: its shape is given, or settles.
BESIDE = (
    "let its shape begin at the joint, or take a smaller radius at rest, less heave or a wider body"
)


def misses(body: Body, tail: Tail, phase: float = 0.0) -> bool:
    """Return whether the centreline passes the body by.

    Parameters
    ----------
    body, tail
        Of one swimmer; numbers may be complex, real parts count.
    phase
        Of the tail (rad).
    """
    if body.is_absent or (tail.starts_on_axis and not tail.is_placed):
        return False
    s = np.linspace(-continued(body, tail), float(np.real(tail.apparent_length)), SAMPLES)
    return not bool((body.level(np.real(tail.continued(s, phase))) < 0.0).any())


def continued(body: Body, tail: Tail) -> float:
    """Return the length behind its root over which a tail may be continued to leave its body."""
    if tail.is_placed:
        return RADII * float(np.real(max(tail.half_axes, key=np.real)))
    return float(np.real(body.behind))


def refusal(tail: Tail) -> SpecError:
    """Return the error of a model that needs the joint and finds none."""
    if tail.is_placed:
        return SpecError(
            "tail.position",
            tail.placement.root,
            "a root from which the tail, continued backwards, meets the body",
            "move it towards the body, or turn tail.direction away from it",
        )
    if not amplitude_of(tail):
        return SpecError(f"tail: it begins beside the body and does not touch it; {BESIDE}")
    return SpecError(
        "tail.amplitude",
        amplitude_of(tail),
        "less than the body's half width where no ramp leads the tail to the body",
        MEND,
    )


def amplitude_of(tail: Tail) -> Any:
    """Return the amplitude of a wave along the tail; None where the tail has none."""
    return getattr(tail, "amplitude", None) if not tail.settles else None
