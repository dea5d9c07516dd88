"""Where a swimmer comes nearest to a round tube, compiled.

The tube's axis is told in the frame that turns with the tail, as a line: its direction t and the
vector b from it to the body's centre.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.poses.beside_wall import LEAST, SIGN, TAIL_RADIUS, as_moment
from microswim.gait.poses.rings import rings_in_tube
from microswim.numerics.compiling.compiled import FAST, compiled
from microswim.numerics.rigid_motion import to_lab

#: Directions in which the body's farthest point is looked for, steps of the search, of the other.
AROUND, STEPS = 16, 12
#: Of the smallest gap solved, over which what touches of a body with edges loses its weight.
SOFT = 0.5


@compiled(fastmath=FAST, error_model="numpy")
def axis_in_body(boundary: Any, turn: Any, x: Any, q: Any, line: Any) -> None:
    """Write direction t of the tube's axis and vector b from it to the body's centre, line (6,).

    In the frame turned about s by `turn` from the body's. `boundary`: a point of the axis, its
    direction, the radius (7,).
    """
    along = 0.0
    for i in range(3):
        along += (x[i] - boundary[i]) * boundary[3 + i]
    ct, st = np.cos(turn), np.sin(turn)
    t0, t1, t2 = to_lab(q, boundary[3], boundary[4], boundary[5], -1.0)
    b0, b1, b2 = to_lab(
        q, x[0] - boundary[0] - along * boundary[3], x[1] - boundary[1] - along * boundary[4],
        x[2] - boundary[2] - along * boundary[5], -1.0,
    )  # fmt: skip
    line[0], line[1], line[2] = t0, t1 * ct + t2 * st, t2 * ct - t1 * st
    line[3], line[4], line[5] = b0, b1 * ct + b2 * st, b2 * ct - b1 * st


@compiled(error_model="numpy")
def _support(body: Any, d0: Any, d1: Any, d2: Any) -> Any:
    """Return the point of a body of revolution that lies farthest in the direction d."""
    across = np.sqrt(d1 * d1 + d2 * d2)
    where = np.arctan2(across, d0) / np.pi * (body.shape[0] - 1)
    i = min(int(where), body.shape[0] - 2)
    part = where - i
    s = body[i, 0] + part * (body[i + 1, 0] - body[i, 0])
    rho = body[i, 1] + part * (body[i + 1, 1] - body[i, 1])
    ratio = rho / across if across > 1e-15 else 0.0
    return s, ratio * d1, ratio * d2


@compiled(error_model="numpy")
def _reach(line: Any, body: Any, e: Any, turn: Any, out: Any) -> Any:
    """Write the body's point farthest from the axis towards one side, (3,), and that side, (3,).

    Returns its distance that way and how this changes with the angle.
    """
    c, s = np.cos(turn), np.sin(turn)
    for i in range(3):
        out[3 + i] = c * e[i] + s * e[3 + i]
    out[0], out[1], out[2] = _support(body, out[3], out[4], out[5])
    far, change = 0.0, 0.0
    for i in range(3):
        far += out[3 + i] * (line[3 + i] + out[i])
        change += (c * e[3 + i] - s * e[i]) * (line[3 + i] + out[i])
    return far, change


@compiled(error_model="numpy")
def _top(line: Any, body: Any, e: Any, angle: Any, out: Any) -> Any:
    """Write what `_reach` does where the distance is largest about an angle, which is returned."""
    step = 2.0 * np.pi / AROUND
    at, low, high = angle, angle - step, angle + step
    _, f = _reach(line, body, e, low, out)
    _, g = _reach(line, body, e, high, out)
    far = 0.0
    for _ in range(STEPS):  # false position, Illinois
        at = high - g * (high - low) / (g - f) if g != f else 0.5 * (low + high)
        far, change = _reach(line, body, e, at, out)
        if change * g < 0.0:
            low, f = high, g
        else:
            f *= 0.5
        high, g = at, change
        if g == 0.0:
            break
    return far


@compiled(error_model="numpy")
def body_in_tube(line: Any, body: Any, radius: Any, out: Any, work: Any) -> None:
    """Write gap, nearest point and normal into the fluid, (7,), of a smooth body in a tube.

    The distance of a convex body's farthest point is the largest of ``d . b + h(d)`` over
    directions d across the axis, h its support function: the largest of its humps, each between
    two directions of several, by false position.
    """
    e, here = work[:6], work[6:12]
    k = 0  # a first direction across t
    for i in range(1, 3):
        k = i if abs(line[i]) < abs(line[k]) else k
    for i in range(3):
        e[i] = (1.0 if i == k else 0.0) - line[k] * line[i]
    size = np.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
    for i in range(3):
        e[i] /= size
    e[3] = line[1] * e[2] - line[2] * e[1]
    e[4] = line[2] * e[0] - line[0] * e[2]
    e[5] = line[0] * e[1] - line[1] * e[0]
    best, step = -np.inf, 2.0 * np.pi / AROUND
    last, _ = _reach(line, body, e, -step, here)
    this, _ = _reach(line, body, e, 0.0, here)
    for n in range(AROUND):
        following, _ = _reach(line, body, e, (n + 1) * step, here)
        if this >= last and this >= following:
            far = _top(line, body, e, n * step, here)
            if far > best:
                best = far
                out[0] = radius - far
                for i in range(3):
                    out[1 + i], out[4 + i] = here[i], -here[3 + i]
        last, this = this, following


@compiled(fastmath=FAST, error_model="numpy")
def _squared(line: Any, P: Any) -> Any:
    """Return the squared distance of a point, from the body's centre, from the axis."""
    square, along = 0.0, 0.0
    for c in range(3):
        y = line[3 + c] + P[c]
        square += y * y
        along += y * line[c]
    return square - along * along


@compiled(fastmath=FAST, error_model="numpy")
def tail_in_tube(line: Any, tail: Any, thick: Any, radius: Any, out: Any) -> None:
    """Write the same, (7,), of a tail: the farthest of its centreline's points and its radius."""
    most, k = -1.0, 0
    for i in range(tail.shape[0]):
        square = _squared(line, tail[i])
        if square > most:
            most, k = square, i
    k = min(max(k, 1), tail.shape[0] - 2)  # a parabola through the farthest point
    y0, y1, y2 = (
        _squared(line, tail[k - 1]), _squared(line, tail[k]), _squared(line, tail[k + 1])
    )  # fmt: skip
    bend = 2.0 * y1 - y0 - y2
    u = 0.5 * (y2 - y0) / bend if bend > 0.0 else (1.0 if y2 > y0 else -1.0)
    u = min(max(u, -1.0), 1.0)
    w0, w1, w2 = 0.5 * u * (u - 1.0), 1.0 - u * u, 0.5 * u * (u + 1.0)
    along, square = 0.0, 0.0
    for c in range(3):
        out[1 + c] = w0 * tail[k - 1, c] + w1 * tail[k, c] + w2 * tail[k + 1, c]
        along += (line[3 + c] + out[1 + c]) * line[c]
    for c in range(3):
        y = line[3 + c] + out[1 + c] - along * line[c]
        out[4 + c] = -y
        square += y * y
    far = np.sqrt(square) + 1e-300
    out[0] = radius - far - thick
    for c in range(3):
        out[4 + c] /= far
        out[1 + c] -= thick * out[4 + c]


@compiled(fastmath=FAST, error_model="numpy")
def touch_tube(
    boundary: Any, numbers: Any, body: Any, tail: Any, x: Any, q: Any, phase: Any, line: Any,
    touch: Any, work: Any,
) -> None:  # fmt: skip
    """Write line (6,) as `axis_in_body`, in the frame of the tail, and touch (14,): body, tail.

    What the swimmer does not have has an infinite gap.
    """
    axis_in_body(boundary, numbers[SIGN] * phase, x, q, line)
    of_line(line, body, tail, numbers, boundary[6], touch, work)


@compiled(error_model="numpy")
def of_line(
    line: Any, body: Any, tail: Any, numbers: Any, radius: Any, touch: Any, work: Any
) -> None:
    """Write gaps, moments and normals of body and tail where a line is the axis, touch (14,)."""
    for i in range(14):
        touch[i] = 0.0
    touch[0] = touch[7] = np.inf
    if body.shape[0] > 0 and body.shape[1] == 3:
        rings_in_tube(line, body, radius, SOFT * numbers[LEAST], touch[:7], work[:6])
    elif body.shape[0] > 0:
        body_in_tube(line, body, radius, touch[:7], work)
        as_moment(touch[:7])
    if tail.shape[0] > 0:
        tail_in_tube(line, tail, numbers[TAIL_RADIUS], radius, touch[7:])
        as_moment(touch[7:])


@compiled()
def nearer_first(touch: Any) -> None:
    """Put the tail first if it is nearer than the body."""
    if touch[7] < touch[0]:
        for i in range(7):
            touch[i], touch[7 + i] = touch[7 + i], touch[i]
