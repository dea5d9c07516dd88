"""Where a swimmer lies in the design space: dimensionless numbers, range, scales.

Stokes flow knows shapes, not sizes: six numbers hold a rigid helix or a plane wave on a spheroid,
``b k``, ``k r_t``, the number of waves N, ``k a`` with the body's mean radius ``a^3 = r_s r_q^2``,
its aspect ratio ``r_s/r_q``, and the ramp. Either hand of a helix is the mirror image of the other.
Without a body its two numbers are 0 and 1, and do not count.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.swimmer.geometry.tails.kinds import WaveTail, as_wave
from microswim.swimmer.swimmer import Swimmer

#: Numbers of a design and the range of the atlas, as (words, lowest, highest).
NUMBERS = (
    ("amplitude x wavenumber", 0.05, 2.5),
    ("filament radius x wavenumber", 0.02, 0.8),
    ("waves", 0.5, 8.0),
    ("body radius x wavenumber", 0.05, 7.0),
    ("aspect ratio of the body", 0.5, 5.0),
    ("ramp", 0.05, 0.5),
)
#: Further numbers that are bounded: ratios of those.
RATIOS = (
    ("body radius / filament radius", 2.0, 40.0),
    ("body radius / length of the tail", 0.0, 0.7),
    ("length along the filament / its radius", 0.0, 1300.0),
    ("body radius / amplitude", 0.15, 140.0),  # below, u_s is a small difference of large numbers
    ("amplitude / length of the ramp", 0.0, 2.0),  # above, the tail stands up beside the body
    ("room for the root in the body's end / its width", 1.0, 60.0),  # below, it comes out
)
#: In their place for a plane wave: boundary elements of longer filaments are dear, its speed is no
#: difference of two, it stays in a plane, and its root leans at two moments of the period alone.
WAVES = {
    bound[0]: bound
    for bound in (
        ("length along the filament / its radius", 0.0, 430.0),
        ("body radius / amplitude", 0.0, 140.0),
        ("amplitude / length of the ramp", 0.0, 16.0),
        ("room for the root in the body's end / its width", 0.0, 60.0),
    )
}

LEAST = 1e-300  #: beside which nothing counts, in place of a division by zero
#: Sections and motion of the surface in the solves, by the kind of tail.
SURFACES = {"helix": ("perpendicular", "rigid"), "plane_wave": ("sheared", "translating")}
#: Of a tail without a body, which may begin at its full amplitude.
ALONE = (*NUMBERS[:3], ("ramp", 0.0, 0.5), RATIOS[2])


def kind_of(swimmer: Swimmer) -> str:
    """Return the kind of design: ``"helix"``, ``"plane_wave"``, or one of these ``_alone``."""
    return swimmer.tail.kind + "_alone" * swimmer.body.is_absent


def bounds(kind: str) -> tuple[tuple[str, float, float], ...]:
    """Return the range of a kind of design, in the order of `values`."""
    every = ALONE if kind.endswith("_alone") else (*NUMBERS, *RATIOS)
    if kind.startswith("helix"):
        return every
    return tuple(WAVES.get(name, (name, low, high)) for name, low, high in every)


def values(x: Any, kind: str) -> tuple[Any, ...]:
    """Return what is bounded of designs x (6, ...)."""
    each = ratios(x, kind)
    return (*x[:3], x[5], each[2]) if kind.endswith("_alone") else (*x, *each)


def numbers(swimmer: Swimmer) -> np.ndarray:
    """Return the six dimensionless numbers of a design, shape (6, ...)."""
    tail, (r_s, r_q, _) = as_wave(swimmer.tail), swimmer.body.semi_axes3
    k = tail.wavenumber
    mean = 0.0 if swimmer.body.is_absent else (r_s * r_q * r_q) ** (1.0 / 3.0)
    aspect = 1.0 if swimmer.body.is_absent else r_s / r_q
    each = (
        *(tail.amplitude * k, k * tail.radius, tail.number_of_waves),
        *(k * mean, aspect, tail.ramp),
    )
    many = any(isinstance(value, np.ndarray) for value in each)
    return np.array(np.broadcast_arrays(*each) if many else each)


def ratios(x: Any, kind: str = "helix") -> tuple[Any, ...]:
    """Return the numbers of `RATIOS` of designs x (6, ...).

    A plane wave is as long as its mean square slope makes it, to the leading order. Room for the
    root: continued into a body of half axes R and a, a tail of slope m and radius r lies within it
    somewhere all around where ``sqrt(a^2 + m^2 R^2) - m R > r sqrt(1 + m^2)``.
    """
    bk, thick, waves, head, aspect, ramp = x  # numbers or arrays: nothing here is dear for either
    length, slope2 = 2.0 * np.pi * waves, bk * bk * (0.5 if kind.startswith("plane_wave") else 1.0)
    filament = length * (1.0 + slope2) ** 0.5 / thick
    broad = head / (bk + LEAST)
    rise = bk * ramp / (ramp * ramp * length + LEAST)  # without a ramp nothing rises
    half = half_width(head, aspect)
    far = rise * aspect * half
    room = ((half * half + far * far) ** 0.5 - far) / (thick * (1.0 + rise * rise) ** 0.5)
    return head / thick, head / length, filament, broad, rise, room


def half_width(head: Any, aspect: Any) -> Any:
    """Return the half axis across of a spheroid of a mean radius and an aspect ratio."""
    return head * aspect ** (-1.0 / 3.0)


def features(x: Any, kind: str = "helix") -> np.ndarray:
    """Return the coordinates in which the corrections vary smoothly, shape (10, ...); (5, ...)
    without a body.

    Ratios beside the six numbers let the distance between designs count directions that are not
    along one of them: of the body to the tail's length and amplitude, of its half width to the
    filament, and the steepness of the root, which decide how the tail leaves the body.
    """
    bk, thick, waves, head, aspect, ramp = x
    if kind.endswith("_alone"):
        steep = np.where(ramp == 0, 0.0, bk / np.where(ramp == 0, 1.0, ramp) / waves)
        return np.array([*map(np.log, (bk, thick, waves)), ramp, np.log(1.0 + steep)])
    width, root = half_width(head, aspect) / thick, bk / (ramp * waves)
    logs = (bk, thick, waves, head, aspect)
    ratios = (head / waves, head / bk, width, root)
    found = np.log(np.array([*logs, ramp, *ratios]))
    found[len(logs)] = ramp
    return found


def powers(x: Any) -> np.ndarray:
    """Return what the powers of a correction's scale multiply, shape (6, ...)."""
    head = x[3] + (x[3] == 0.0)  # without a body there is no such power
    return np.log(np.array([0.0 * x[0] + np.e, *x[:3], head, x[4]]))


def outside(swimmer: Swimmer) -> list[str]:
    """Return in words what puts a swimmer outside the atlas; empty inside."""
    return unlike(swimmer) or beyond(numbers(swimmer), kind_of(swimmer))


def beyond(x: np.ndarray, kind: str) -> list[str]:
    """Return in words which of its numbers x (6,) put a design outside the atlas."""
    return [
        f"{name} {value:.4g} is not in {low:g} to {high:g}"
        for (name, low, high), value in zip(bounds(kind), values(np.real(x).tolist(), kind))
        if not low * (1 - 1e-9) <= value <= high * (1 + 1e-9)
    ]


def edges(swimmer: Swimmer) -> list[str]:
    """Return in words the bounds of the atlas that a swimmer within lies at."""
    x, kind = np.real(numbers(swimmer)), kind_of(swimmer)
    return [
        f"{name} {bound:g}"
        for (name, *ends), value in zip(bounds(kind), values(x, kind))
        for bound in ends
        if abs(value - bound) <= 1e-3 * bound
    ]


def misses(x: np.ndarray, kind: str = "helix") -> np.ndarray:
    """Return how many of the bounds of the range designs x (6, ...) miss."""
    found: Any = 0
    for (_, low, high), value in zip(bounds(kind), values(x, kind)):
        found = found + ((value < low * (1 - 1e-9)) | ~(value <= high * (1 + 1e-9)))
    return np.asarray(found)


def inside(x: np.ndarray, kind: str = "helix") -> np.ndarray:
    """Return whether designs x (6, ...) lie in the range."""
    return misses(x, kind) == 0


def unlike(swimmer: Swimmer) -> list[str]:
    """Return in words what makes a swimmer another kind of thing than the atlas holds."""
    tail, body = swimmer.tail, swimmer.body
    if tail.is_placed:
        return ["it holds single tails at the joint, along s, without a phase of their own"]
    if not (isinstance(tail, WaveTail) and (tail.is_rigid or tail.is_planar)):
        return ["it holds helical tails and plane waves"]
    if not tail.is_plain:
        return ["it holds round filaments of one amplitude"]
    if not body.is_absent and not (
        body.is_ellipsoid and body.is_axisymmetric and np.all(np.real(body.semi_axes3[0]) > 0)
    ):
        return ["it holds bodies of revolution: a sphere or a spheroid"]
    sections, motion = SURFACES[tail.kind]
    if (tail.sections, tail.surface_motion) != (sections, motion):
        return [
            f'of a {tail.kind} it holds sections = "{sections}" with surface_motion = "{motion}"'
        ]
    around = [n for n in ("wall", "channel", "region") if getattr(swimmer, n) is not None]
    return [f"it knows no {name}" for name in around]
