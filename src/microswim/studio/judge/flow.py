"""The flow about a design on a slice, by boundary elements, as a series in the phase."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.series.fourier import MIRROR_Q, series_of
from microswim.studio.drawing import reach
from microswim.studio.spec_tables import swimmer_of
from microswim.swimmer.swimmer import Swimmer

Progress = Callable[[int, int], None]
FLOW_PHASES = 8


def flow(question: dict[str, Any], progress: Progress) -> dict[str, Any]:
    """Return the velocity of the fluid on the plane r = 0 of the body frame, a Fourier series in
    the phase.

    Rows along q, columns along s; components s, q, r; at the motor's own rate.
    """
    swimmer = swimmer_of(question["tables"])
    S, Q = _window(swimmer)
    points = np.stack([*np.meshgrid(S, Q), np.zeros((Q.size, S.size))], axis=-1)
    sample = _helix_flow if _rigid(swimmer) else _wave_flow
    velocities = sample(swimmer, points, progress)
    if swimmer.wall is not None:  # the image's flow behind the wall is none
        from_wall = swimmer.wall.plane(swimmer.body.centre)
        behind = (points - from_wall[:3]) @ from_wall[3:] <= 0
        velocities = [np.where(behind[..., None], 0.0, u) for u in velocities]
    series = series_of(np.array(velocities), harmonics=FLOW_PHASES // 2 - 1)
    return served(S, Q, series, velocities)


def served(s: Array, q: Array, series: Array, velocities: list[Array]) -> dict[str, Any]:
    """Return a slice for the page: its sides, a series of velocities (term, q, s, 3), their size.

    Rows along q, columns along s.
    """
    return {
        "s": [float(s[0]), float(s[-1])],
        "q": [float(q[0]), float(q[-1])],
        "shape": [q.size, s.size],
        "series": [[_short(v) for v in term.ravel()] for term in series],
        "scale": float(np.percentile(np.linalg.norm(velocities, axis=-1), 97)),
    }


def _short(value: float) -> float:
    return float(f"{value:.4g}") if math.isfinite(value) else 0.0


def _window(swimmer: Swimmer) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates of the slice: the swimmer and half its length around."""
    length = float(swimmer.tail.apparent_length)
    front = 2.0 * float(swimmer.body.semi_axes3[0])
    margin = 0.35 * (length + front)
    step = (length + front + 2 * margin) / 55
    half = max(
        margin,
        2.0 * reach(swimmer.settled.tail),
        float(swimmer.body.semi_axes3[1]) * 1.6,
    )
    count = 2 * int(half / step) + 1
    return np.linspace(-front - margin, length + margin, 56), np.linspace(-half, half, count)


def _rigid(swimmer: Swimmer) -> bool:
    from microswim.models.bem.gait import turns_as_a_whole

    return turns_as_a_whole(swimmer)


def _helix_flow(swimmer: Swimmer, points: np.ndarray, progress: Progress) -> list[np.ndarray]:
    """The flow turns with the tail: ``u(x; phi) = Q u(Q' x; 0)``."""
    from microswim.models.bem import solve

    solution = solve(swimmer, 0.0, level="coarse")
    progress(1, FLOW_PHASES + 1)
    made = []
    for n in range(FLOW_PHASES):
        angle = swimmer.tail.sign * 2.0 * np.pi * n / FLOW_PHASES
        c, s = np.cos(angle), np.sin(angle)
        turn = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
        made.append(solution.velocity(points @ turn) @ turn.T)
        progress(n + 2, FLOW_PHASES + 1)
    return made


def _wave_flow(swimmer: Swimmer, points: np.ndarray, progress: Progress) -> list[np.ndarray]:
    """Solved at each phase; half a period on, a plane wave's flow is its mirror image in q."""
    from microswim.models.bem import solve

    mirrored = swimmer.tail.is_planar and swimmer.wall is None
    wanted = FLOW_PHASES // 2 if mirrored else FLOW_PHASES
    made = []
    for n in range(wanted):
        phase = 2.0 * np.pi * n / FLOW_PHASES
        made.append(solve(swimmer, phase, level="coarse").velocity(points))
        progress(n + 1, wanted)
    return made + [u[::-1] * MIRROR_Q[:3] for u in made] if mirrored else made
