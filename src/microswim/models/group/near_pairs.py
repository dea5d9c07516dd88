"""Pairs of swimmers that are near one another: few nodes of each stand for its whole answer.

What `estimate` leaves out, the flow that comes back, two swimmers' skeletons of some seventy nodes
hold to a few per cent (`skeleton`). They are solved for each near pair by itself and what they
change is added, as pairs' lubrication is in Stokesian dynamics [Durlofsky Brady Bossis 1987]:

    R = R_estimate + sum_pairs (R_pair - R_estimate of the pair)
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from microswim.models.group.alone import Alone, rotation_of_block
from microswim.models.group.quick import resistance_and_propulsion, twists_of, whole_of
from microswim.numerics.array import Array
from microswim.swimmer.group import Group

#: What comes back of a pair from which on it counts as near, and which share of it is left by the
#: skeletons at the gap d that they are made for, (d/gap)^2.5 times that nearer: of two helices .011
#: was measured at d, .045 at .42 d, .35 to .5 at a quarter of d.
NEAR, LEFT, NEARER = 0.03, 0.025, 2.5
#: Residual of the pair's flow.
TOLERANCE = 1e-4


def corrected(
    group: Group, alone: Sequence[Alone], R: Array, F: Array, returned: Array
) -> tuple[Array, Array, Array]:
    """Return R (n, 6, n, 6) and F (n, 6, n) with the near pairs solved, and what is left out.

    Parameters
    ----------
    group, alone
        The swimmers at their poses, and each by itself.
    R, F
        By point forces, swimmers' axes.
    returned
        Bounds (n, n) of what comes back, which point forces leave out.
    """
    whole, pushed, left = R.copy(), F.copy(), returned.copy()
    for j, i in zip(*np.nonzero(np.triu(returned > NEAR)), strict=True):
        pair = Group((group.members[i], group.members[j]))
        bones = [alone[k].light for k in (i, j)]
        known = [b for b in bones if b is not None]
        if len(known) < 2:
            continue
        both = whole_of(pair, known, TOLERANCE)
        R_pair, F_pair = resistance_and_propulsion(both, twists_of(pair, known))
        for a, p in enumerate((i, j)):
            for b, q in enumerate((i, j)):
                block, thrust = R_pair[6 * a : 6 * a + 6, 6 * b : 6 * b + 6], F_pair[6 * a :, b][:6]
                if p == q:
                    whole[p, :, p] += block - R[p, :, p]
                    pushed[p, :, p] += thrust - F[p, :, p]
                else:
                    whole[p, :, q], pushed[p, :, q] = block, thrust
        d = max(b.distance for b in known)
        gap = _gap(pair, [alone[i], alone[j]], d) / d
        left[j, i] *= LEFT * (gap**-NEARER if gap > 0.0 else np.inf)
    return whole, pushed, left


def _gap(pair: Group, alone: Sequence[Alone], most: float) -> float:
    """Return the smallest distance between points of two surfaces, `most` if there is none less."""
    (one, other), (A, B) = pair.members, (rotation_of_block(m) for m in pair.members)
    away = np.array(other.position) - np.array(one.position)
    there = (alone[1].around.data @ B.T + away) @ A
    found = alone[0].around.query(there, distance_upper_bound=most)[0]
    return min(most, float(found.min()))
