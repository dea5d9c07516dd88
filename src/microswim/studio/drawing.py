"""What the scene draws of a swimmer: the surface of its body, the line of its tail over a period.

A wave is drawn by its own formula; any other tail by the Fourier series, in the phase, of points on
its centreline. An ellipsoid is drawn from its semi-axes; any other body by quadrilaterals.
"""

from __future__ import annotations

from typing import Any, TypeGuard

import numpy as np

from microswim.numerics.array import Array
from microswim.numerics.series.fourier import series_of, trimmed
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.tails.kinds import Tail, WaveTail
from microswim.swimmer.swimmer import Swimmer

FINENESS = (1.0, 0.5, 0.34)  #: of a body's surface: the first with few faces enough, or the last
ENOUGH = 2500
MOST_FACES = 12_000  #: a surface from a file that has more is drawn in patches
ALONG, PHASES = 61, 24
SEEN = 1e-4  #: of the tail's length: less an eye does not see


def shape(swimmer: Swimmer) -> dict[str, Any]:
    """Return the form of a swimmer, lengths in its own units, ready for JSON."""
    tail, body = swimmer.settled.tail, swimmer.body
    tails = [] if tail.is_absent else list(tail.each)
    return {
        "semi_axes": [float(a) for a in body.semi_axes3],
        "body": body.shape,
        "mesh": None if body.is_ellipsoid or body.is_absent else mesh(body),
        "kind": swimmer.tail.kind,
        "rigid": bool(tail.is_rigid),
        "length": float(tail.apparent_length),
        "reach": max(map(reach, tails), default=0.0),
        "ramp": min((float(getattr(t.own, "ramp", 0.0)) for t in tails), default=0.0),
        "radius": float(tail.radius),
        "sign": float(tail.sign),
        "tails": [filament(t) for t in tails],
    }


def filament(tail: Tail) -> dict[str, Any]:
    """Return one tail in its own axes, and where those stand: root from the joint, and rotation."""
    own = tail.own
    wave = own if _is_plain_wave(own) else None
    return {
        "kind": own.kind,
        "rigid": bool(own.is_rigid),
        "ahead": float(tail.ahead),
        "root": [float(x) for x in tail.placement.root],
        "rotation": np.asarray(tail.placement.rotation, float).ravel().tolist(),
        "length": float(own.apparent_length),
        "amplitude": 0.0 if wave is None else float(wave.amplitude),
        "amplitude_end": 0.0 if wave is None else _end(wave),
        "wavenumber": 0.0 if wave is None else float(wave.wavenumber),
        "ramp": 0.0 if wave is None else float(wave.ramp),
        "radius": float(own.radius),
        "narrowing": float(np.asarray(own.narrowing(own.apparent_length))),
        "section": None if own.section is None else [float(a) for a in own.section],
        "sign": float(own.sign),
        "sheared": own.sections == "sheared",
        "line": line(own) if wave is None else None,
    }


def _is_plain_wave(tail: Tail) -> TypeGuard[WaveTail]:
    """Whether the page draws it by the formula of a wave: its axis is straight."""
    return isinstance(tail, WaveTail) and tail.is_along_s


def _end(tail: WaveTail) -> float:
    return float(tail.amplitude if tail.amplitude_end is None else tail.amplitude_end)


def reach(tail: Tail) -> float:
    """Return the largest distance of the centreline from the axis s."""
    if _is_plain_wave(tail):
        return max(float(tail.amplitude), _end(tail))
    return max(float(np.linalg.norm(_positions(t)[..., 1:], axis=-1).max()) for t in tail.each)


def line(tail: Tail) -> list[list[float]]:
    """Return the centreline as rows of a Fourier series in the phase: mean, cosine, sine, ...

    Each row has s, q, r of `ALONG` points from the joint to the tip.
    """
    length = float(tail.apparent_length)
    series = trimmed(series_of(_positions(tail).reshape(PHASES, -1)), SEEN)
    return (np.round(series / length, 6) * length).tolist()


def _positions(tail: Tail) -> Array:
    phase = 2.0 * np.pi * np.arange(PHASES) / PHASES
    s = np.linspace(0.0, float(tail.apparent_length), ALONG)
    return tail.centreline(s, phase[:, None])[0]


def mesh(body: Body) -> dict[str, Any]:
    """Return corners about the body's centre, one after the other, and faces of four of them."""
    points, faces = body.drawing(FINENESS[0])
    for finer in FINENESS[1:]:
        if len(faces) > ENOUGH and body.triangles is None:
            points, faces = body.drawing(finer)
    if len(faces) > MOST_FACES:
        points, faces = Body.drawing(body, FINENESS[-1])
    size = float(max(body.semi_axes3))
    points, same = np.unique(np.round(points / size, 5), axis=0, return_inverse=True)
    return {"points": (points * size).ravel().tolist(), "faces": same[faces].ravel().tolist()}
