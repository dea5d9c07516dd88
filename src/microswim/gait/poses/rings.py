"""Where a body with edges comes nearest to a round tube, compiled.

The body is the hull of circles about s: the rims of a cylinder, the middles of a capsule's ends.
Such a body may touch with several points at once, along both of its ends or at two places of one
rim that is flat on the wall. Were what holds it off to act at the nearest alone, it would jump from
one to another with every small turn. So it acts at all of them, each with the weight

    exp(-(g_k - g) / soft),   g = min_k g_k  the gap,

by their mean normal and moment, which are continuous in the pose; the gap itself is exact.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.compiling.compiled import compiled

#: Points of a circle; Newton's steps from the one that is farthest out; exponent of no weight.
AROUND, STEPS, NOTHING = 64, 6, 40.0
#: Columns of rings: s and radius of the circle, how far out of it the body reaches.
S, RADIUS, THICK = 0, 1, 2


@compiled(error_model="numpy")
def _square(c: Any, s: Any, of: Any) -> Any:
    """Return the squared distance from the axis at cos and sin of the angle about s."""
    across = c * c * of[3] + 2.0 * c * s * of[4] + s * s * of[5]
    return of[0] + 2.0 * (c * of[1] + s * of[2]) + across


@compiled(error_model="numpy")
def _squares(line: Any, ring: Any, of: Any) -> None:
    """Write the products (6,) of which a circle's squared distances from the axis are made."""
    rho, t0, t1, t2 = ring[RADIUS], line[0], line[1], line[2]
    a0, a1, a2 = line[3] + ring[S], line[4], line[5]
    along = a0 * t0 + a1 * t1 + a2 * t2
    of[0] = a0 * a0 + a1 * a1 + a2 * a2 - along * along
    of[1], of[2] = rho * (a1 - along * t1), rho * (a2 - along * t2)
    of[3], of[4] = rho * rho * (1.0 - t1 * t1), -rho * rho * t1 * t2
    of[5] = rho * rho * (1.0 - t2 * t2)


@compiled(error_model="numpy")
def _farthest(of: Any) -> Any:
    """Return the largest distance of a circle's points from the axis."""
    step = 2.0 * np.pi / AROUND
    most = 0.0
    last, here = _square(np.cos(-step), np.sin(-step), of), _square(1.0, 0.0, of)
    for k in range(AROUND):
        angle = k * step
        following = _square(np.cos(angle + step), np.sin(angle + step), of)
        most = max(most, here)
        if here >= last and here >= following:  # the top of a hump lies within a step
            at = angle
            for _ in range(STEPS):
                c, s = np.cos(at), np.sin(at)
                change = c * of[2] - s * of[1] + c * s * (of[5] - of[3]) + (c * c - s * s) * of[4]
                bend = (c * c - s * s) * (of[5] - of[3]) - c * of[1] - s * of[2]
                bend -= 4.0 * c * s * of[4]
                if not bend < 0.0:
                    break
                at = min(max(at - change / bend, angle - step), angle + step)
            most = max(most, _square(np.cos(at), np.sin(at), of))
        last, here = here, following
    return np.sqrt(max(most, 0.0))


@compiled(error_model="numpy")
def rings_in_tube(line: Any, rings: Any, radius: Any, soft: Any, out: Any, of: Any) -> None:
    """Write gap, mean moment of the normals about the body's centre and mean normal, (7,).

    Parameters
    ----------
    line
        The tube's axis, as `tube_contact.axis_in_body` has it (6,).
    rings
        Circles whose hull is the body (n, 3): s, radius and thickness.
    radius, soft
        Of the tube; gap beyond the smallest over which what touches loses its weight.
    out
        Written.
    of
        Scratch of 6 numbers.
    """
    gap = np.inf
    for m in range(rings.shape[0]):
        _squares(line, rings[m], of)
        far = _farthest(of) if rings[m, RADIUS] > 0.0 else np.sqrt(max(of[0], 0.0))
        gap = min(gap, radius - far - rings[m, THICK])
    out[0] = gap
    for i in range(6):
        out[1 + i] = 0.0
    whole = 0.0
    for m in range(rings.shape[0]):
        count = AROUND if rings[m, RADIUS] > 0.0 else 1
        for k in range(count):
            angle = 2.0 * np.pi * k / count
            whole += _weighed(line, rings[m], angle, radius, (gap, soft), out)
    for i in range(6):
        out[1 + i] /= whole


@compiled(error_model="numpy")
def _weighed(line: Any, ring: Any, angle: Any, radius: Any, least: Any, out: Any) -> Any:
    """Add the moment and the normal of a circle's point by its weight, which is returned."""
    p0, p1, p2 = ring[S], ring[RADIUS] * np.cos(angle), ring[RADIUS] * np.sin(angle)
    y0, y1, y2 = line[3] + p0, line[4] + p1, line[5] + p2
    along = y0 * line[0] + y1 * line[1] + y2 * line[2]
    y0, y1, y2 = y0 - along * line[0], y1 - along * line[1], y2 - along * line[2]
    far = np.sqrt(y0 * y0 + y1 * y1 + y2 * y2) + 1e-300
    beyond = (radius - far - ring[THICK] - least[0]) / least[1]
    if beyond > NOTHING:
        return 0.0
    weight = np.exp(-beyond)
    n0, n1, n2 = -y0 / far * weight, -y1 / far * weight, -y2 / far * weight
    out[1] += p1 * n2 - p2 * n1
    out[2] += p2 * n0 - p0 * n2
    out[3] += p0 * n1 - p1 * n0
    out[4] += n0
    out[5] += n1
    out[6] += n2
    return weight
