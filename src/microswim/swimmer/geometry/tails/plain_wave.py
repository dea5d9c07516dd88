"""The wave that closed forms, batches and finite elements know: of one amplitude, round, at the
joint.
"""

from __future__ import annotations

from microswim.errors import SpecError
from microswim.swimmer.geometry.tails.tail import Tail
from microswim.swimmer.geometry.tails.wave_tail import WaveTail


def as_wave(tail: Tail) -> WaveTail:
    """Return the tail if it is a helix or a plane wave of one amplitude, its filament round.

    Raises
    ------
    SpecError
        If it has no amplitude and no wavenumber, is conical, not round or not at the joint.
    """
    if len(tail.each) > 1:
        raise SpecError("tail: a single tail is wanted here; take model rft or bem for several")
    if not isinstance(tail, WaveTail):
        raise SpecError("tail.kind", tail.kind, "one with a wave here", "take a helix")
    if not tail.is_plain:
        names = (
            *("amplitude_end", "section", "radius_end", "position", "direction", "phase"),
            "mean_curvature",
        )
        name = next(name for name in names if getattr(tail, name, None) is not None)
        raise SpecError(
            f"tail.{name}: a round filament of one amplitude, at the joint, is wanted here; "
            "leave it out, or take model rft or bem"
        )
    return tail
