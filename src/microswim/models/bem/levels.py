"""Levels of resolution: coarse, standard, fine."""

from __future__ import annotations

from dataclasses import dataclass, replace

from microswim.errors import SpecError
from microswim.models.bem.patches.resolution import Resolution
from microswim.models.bem.system import Quadrature

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


def coarser(name: str) -> str | None:
    """Return the name of the next coarser level, None below coarse and for levels of one's own."""
    return {"standard": "coarse", "fine": "standard"}.get(name)
