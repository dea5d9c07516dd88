"""Levels of resolution: coarse, standard, fine."""

from __future__ import annotations

from dataclasses import dataclass, replace

from microswim.errors import SpecError
from microswim.models.bem.patches.resolution import Resolution, Sides
from microswim.models.bem.system import Quadrature
from microswim.swimmer.swimmer import Swimmer

LEVELS = ("coarse", "standard", "fine")


@dataclass(frozen=True)
class Level:
    """Patches, quadrature and number of phases over a full period (where phases are sampled).

    `single`: factorised in single precision, to six digits; for estimates of an error.
    """

    name: str
    resolution: Resolution
    rule: Quadrature
    phases: int
    single: bool = False


_BY_NAME = {
    "coarse": Level(
        "coarse",
        Resolution(
            order=2,
            panel=4.0,
            stretch=6.0,
            bend=1.0,
            wave=1.4,
            root=1.0,
            growth=2.5,
            body=1,
            alone=1,
            file="coarse",
        ),
        Quadrature(points=4, near=2.0, far=8.0),
        12,
    ),
    "standard": Level(
        "standard",
        Resolution(
            order=3,
            panel=5.0,
            stretch=8.0,
            bend=1.6,
            wave=2.0,
            slender=1.0,
            around=3,
            root=1.5,
            growth=3.0,
            body=1,
            alone=2,
        ),
        Quadrature(points=5, near=2.0, far=6.0),
        12,
    ),
    "fine": Level(
        "fine",
        Resolution(
            order=3,
            panel=2.5,
            stretch=5.0,
            bend=0.5,
            wave=0.8,
            root=0.5,
            body=3,
            alone=3,
            file="fine",
        ),
        Quadrature(points=5, near=2.5, far=12.0, radial=8, angular=10),
        16,
    ),
}


def get_level(name: str, order: int | None = None) -> Level:
    """Return the level by name; `order` replaces p on the same patches.

    Raises
    ------
    SpecError
        If the name or the order is not known.
    """
    if not isinstance(name, str) or name not in _BY_NAME:
        raise SpecError("level", name, "coarse, standard or fine")
    level = _BY_NAME[name]
    if order is None:
        return level
    if not 1 <= order <= 6:
        raise SpecError("order", order, "from 1 to 6", "p = 2 or 3 serves nearly always")
    return replace(level, resolution=replace(level.resolution, order=order))


#: In a tube what is pushed ahead passes the swimmer again: with the plain rule from nearby on, or
#: densities of order 2, the tube leaks. A cylinder of three quarters of its width lost a third of
#: its drag at order 2; the plain rule from six half lengths on added 3 %.
FAR = 24.0

#: Few patches of order 3, for coarse in a tube.
IN_TUBE = replace(
    _BY_NAME["coarse"],
    resolution=replace(
        _BY_NAME["standard"].resolution,
        panel=7.0,
        stretch=12.0,
        bend=2.2,
        wave=2.6,
        file="coarse",
        vessel=Sides(around=18, along=1.2, change=3.0),
    ),
    rule=replace(_BY_NAME["coarse"].rule, far=FAR),
)


def named(name: str, swimmer: Swimmer, order: int | None = None) -> Level:
    """Return the level of a name for a swimmer, as `get_level`.

    In a tube it is a tighter one. Coarse takes the panels of several slender tails as long as
    standard does: four flagella have 8,208 unknowns in place of 20,880, u_s .3 % off.
    """
    level = get_level(name, order)
    if name == "coarse" and len(swimmer.tail.each) > 1:
        level = replace(level, resolution=replace(level.resolution, slender=1.0))
    if swimmer.channel is None:
        return level
    if name == "coarse" and order is None:
        return IN_TUBE
    return replace(level, rule=replace(level.rule, far=FAR))


def coarser(name: str) -> str | None:
    """Return the name of the next coarser level, None below coarse and for levels of one's own."""
    return {"standard": "coarse", "fine": "standard"}.get(name)
