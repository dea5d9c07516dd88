"""Where a tail grows out of its body: the joint, or a refusal with the nearest ramp that would do.

Most blunt heads meet the helix of the designer's first guess where the tube lies along them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.distance import cdist

from microswim.errors import SpecError
from microswim.models import swimmer_surface as geometry
from microswim.models.joint import Joint, check_clear, trace_joint
from microswim.models.seen_body import SeenBody, seen_from
from microswim.numerics.array import Array
from microswim.swimmer.geometry import attachment
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.tails.kinds import Tail, WaveTail
from microswim.swimmer.parts import numbered

#: Ramps that are tried; a sweep meets many refusals, so they are few.
RAMPS = (0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0)


def check(body: Body, tail: Tail, phase: float) -> list[str]:
    """Return remarks on the shape of a swimmer, see `swimmer_surface.check`.

    Raises
    ------
    SpecError
        If it cannot be built; with the nearest ramp of a wave that can.
    """
    try:
        return geometry.check(body, tail, phase)
    except SpecError as error:
        raise _with_nearest(error, body, tail, phase) from None


def check_all(body: Body, tail: Tail, phase: float) -> list[str]:
    """Return remarks on the shape of a swimmer with one tail or several, none of which touch.

    Raises
    ------
    SpecError
        If it cannot be built.
    """
    said = [numbered(name, _check_one, body, t, phase) for name, t in tail.named.items()]
    lines = [_filament(t, phase) for t in tail.each]
    for j, (other, Q) in enumerate(zip(tail.each, lines)):
        for i, (one, P) in enumerate(zip(tail.each[:j], lines)):
            gap = float(cdist(P, Q).min()) - max(one.half_axes) - max(other.half_axes)
            if gap <= 0.0:
                raise SpecError(
                    f"tail[{j}].position",
                    other.placement.root,
                    f"clear of tail[{i}]: at phase {phase:.3g} they touch",
                    "move them apart, or turn their directions away from one another",
                )
    return list(dict.fromkeys(remark for remarks in said for remark in remarks))


def _check_one(body: Body, tail: Tail, phase: float) -> list[str]:
    if tail.is_placed and attachment.misses(body, tail, phase):
        raise attachment.refusal(tail)
    return check(seen_from(body, tail), tail.own, float(tail.own_phase(phase)))


def _filament(tail: Tail, phase: float) -> Array:
    """Return points of the centreline, two per radius or a few hundred."""
    count = int(np.clip(2.0 * float(tail.arc_length) / float(tail.radius), 200, 3000))
    s = np.linspace(0.0, float(tail.apparent_length), count)
    return tail.centreline(s, phase)[0]


def root(body: Body, tail: Tail, phase: float) -> Joint:
    """Return the joint of a tail that leaves its body once, in a smooth closed curve.

    Raises
    ------
    SpecError
        If it does not; with the nearest ramp of a wave that does.
    """
    try:
        return _joint(body, tail, phase)
    except SpecError as error:
        raise _with_nearest(error, body, tail, phase) from None


def _with_nearest(error: SpecError, body: Body, tail: Tail, phase: float) -> SpecError:
    nearest = _nearest_ramp(body, tail, phase)
    if nearest is None:
        return error
    return SpecError(f"{error}; nearest that works here: tail.ramp = {nearest:g}")


def _joint(body: Body, tail: Tail, phase: float) -> Joint:
    joint = trace_joint(body, tail, phase)
    check_clear(body, tail, joint, phase)
    around = np.linspace(0.0, 2.0 * np.pi, 64)
    joint.body.opening(joint.pole, joint.first, float(joint.angle(around).max()))
    return joint


def _nearest_ramp(body: Body, tail: Tail, phase: float) -> float | None:
    if not isinstance(tail, WaveTail) or isinstance(body, SeenBody):
        return None  # of a tail elsewhere than at the joint its place is what to mend
    for ramp in sorted(RAMPS, key=lambda x: abs(x - tail.ramp)):
        try:
            other = replace(tail, ramp=ramp)
            geometry.check(body, other, phase)
            if not body.is_absent:
                _joint(body, other, phase)
        except (SpecError, ValueError, FloatingPointError):
            continue
        if ramp != tail.ramp:
            return ramp
    return None
