"""Another body or another tail in place of a design's own, of about the same size."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from microswim import checks
from microswim.errors import SpecError
from microswim.studio.spec_tables import canonical, swimmer_of
from microswim.swimmer.geometry.bodies import (
    Box,
    Capsule,
    Cylinder,
    Ellipsoid,
    NoBody,
    Revolution,
    Sphere,
    Spheroid,
)
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.tails.kinds import (
    ElasticTail,
    HelicalTail,
    NoTail,
    PlaneWaveTail,
    Tail,
    WaveTail,
)
from microswim.swimmer.swimmer import Swimmer

#: Profile of an egg: share of the length from the joint, share of the half width.
EGG = ((0.0, 0.0), (0.06, 0.45), (0.3, 0.92), (0.55, 1.0), (0.85, 0.66), (0.97, 0.26), (1.0, 0.0))
SLENDER, HEAVE, WAVES = 40.0, 0.05, 3.0  #: of a tail where there was none
STIFF = 0.05  #: bending stiffness over viscosity, rate and length^4: the tail bends as it beats


def exchanged(tables: Any, field: Any, word: Any) -> dict[str, Any]:
    """Return the tables with another shape of body or kind of tail, all other tables as they are.

    Raises
    ------
    SpecError
        If the field is neither, or the page has no such body or tail to give.
    """
    swimmer = swimmer_of(tables)
    if field == "body.shape":
        made = replace(swimmer, body=_chosen(field, word, BODIES)(*_half_lengths(swimmer)))
    elif field == "tail.kind":
        made = replace(swimmer, tail=_chosen(field, word, TAILS)(swimmer))
    else:
        raise SpecError("exchange", field, "body.shape or tail.kind")
    part = field.partition(".")[0]
    return {**tables, part: canonical(made)[part]}


def _chosen(field: str, word: Any, known: dict[str, Any]) -> Any:
    checks.choice(field, word, known)
    return known[word]


def _half_lengths(swimmer: Swimmer) -> tuple[float, float, float]:
    a, b, c = (float(x) for x in swimmer.body.semi_axes3)
    if a > 0:
        return _round(a), _round(b), _round(c)
    fallback = _round(float(swimmer.tail.apparent_length) / 8.0)
    return fallback, fallback, fallback


def _round(value: float) -> float:
    """A number of four digits: sizes are for people."""
    return float(f"{value:.4g}")


def _revolution(a: float, b: float, c: float) -> Revolution:
    return Revolution(profile=tuple((_round(2.0 * a * s), _round(b * rho)) for s, rho in EGG))


BODIES: dict[str, Callable[[float, float, float], Body]] = {
    "sphere": lambda a, b, c: Sphere(radius=_round(math.cbrt(a * b * c))),
    "spheroid": lambda a, b, c: Spheroid(semi_axes=(1.5 * a if a == b else a, b)),
    "ellipsoid": lambda a, b, c: Ellipsoid(semi_axes=(a, b, 0.8 * c if b == c else c)),
    "capsule": lambda a, b, c: Capsule(length=max(2.0 * a, 3.0 * b), radius=b),
    "cylinder": lambda a, b, c: Cylinder(length=2.0 * a, radius=b),
    "box": lambda a, b, c: Box(size=(_round(1.6 * a), _round(1.6 * b), _round(1.6 * c))),
    "revolution": _revolution,
    "none": lambda a, b, c: NoBody(),
}


def _filament(swimmer: Swimmer) -> dict[str, Any]:
    """Length, radius and frequency of the tail; of the body's size where there is none."""
    tail = swimmer.tail
    length = float(tail.apparent_length) or 4.0 * max(map(float, swimmer.body.semi_axes3))
    usual = 10.0 if swimmer.units == "SI" else 1.0
    return {
        "length": _round(length),
        "radius": _round(float(tail.radius) or length / SLENDER),
        "frequency": _round(float(tail.frequency) or usual),
    }


def _wave(kind: type[WaveTail]) -> Callable[[Swimmer], Tail]:
    def of(swimmer: Swimmer) -> Tail:
        own, like = _filament(swimmer), swimmer.tail
        if isinstance(like, WaveTail):
            amplitude, waves = float(like.amplitude), float(like.number_of_waves)
        else:
            amplitude, waves = HEAVE * own["length"], WAVES
        return kind(**own, amplitude=_round(amplitude), waves=_round(waves))

    return of


def _elastic(swimmer: Swimmer) -> ElasticTail:
    own = _filament(swimmer)
    drag = float(swimmer.fluid.viscosity) * 2.0 * math.pi * own["frequency"] * own["length"] ** 4
    wave = _round(float(swimmer.tail.wavelength_along_s or own["length"]))  # some laws ask for it
    how: dict[str, Any] = {"bending": _round(STIFF * abs(drag)), "wavelength": wave}
    return ElasticTail(**own, **how, drive="heave", amplitude=_round(HEAVE * own["length"]))


TAILS: dict[str, Callable[[Swimmer], Tail]] = {
    "helix": _wave(HelicalTail),
    "plane_wave": _wave(PlaneWaveTail),
    "elastic": _elastic,
    "none": lambda swimmer: NoTail(),
}
