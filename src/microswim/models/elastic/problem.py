"""The numbers of an elastic swimmer, without units: lengths in L, forces in ``B / L^2``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.quantities import magnitude
from microswim.models.elastic.plane import Drag
from microswim.models.elastic.rod import Rod, bent, rod
from microswim.models.rft.gait import body_resistance
from microswim.swimmer.geometry.tails.elastic.elastic_tail import ElasticTail
from microswim.swimmer.geometry.tails.elastic.rest_shape import RestShape
from microswim.swimmer.swimmer import Swimmer

#: Degrees of freedom in the plane s-q, and those that would leave it.
PLANE, ACROSS = [0, 1, 5], [2, 3, 4]


@dataclass(frozen=True, eq=False)
class Problem:
    """What decides the beat of an elastic tail.

    Parameters
    ----------
    drag
        Resistances of rod and body.
    heave, pivot
        Sizes of the drive: length over L, and angle.
    turning
        Stiffness of the base's turning, 0 of a hinge, None of a clamp.
    moment, waves
        Of the wave of inner moment: its size times ``L / B``, and waves in L, positive towards
        the tip.
    rest
        Its shape at rest in the plane; None where that is straight.
    """

    drag: Drag
    heave: float
    pivot: float
    turning: float | None
    moment: float = 0.0
    waves: float = 0.0
    rest: RestShape | None = None

    @property
    def mirrors(self) -> bool:
        """Whether the tail half a period on is its mirror image: straight at rest, on a body whose
        drag along s does not push it aside.
        """
        return self.rest is None and not self.drag.body[0, 1:].any()

    def rod(self, modes: int) -> Rod:
        """Return its rod of so many curvatures."""
        straight = rod(modes, self.turning)
        return straight if self.rest is None else bent(straight, self.rest)

    @property
    def is_driven(self) -> bool:
        """Whether anything moves it."""
        return bool(self.heave or self.pivot or self.moment)

    def share(self, part: float) -> Problem:
        """Return the same with a part of its drive."""
        sizes = {n: part * getattr(self, n) for n in ("heave", "pivot", "moment")}
        return replace(self, **sizes)

    @property
    def sperm_number(self) -> float:
        """``Sp = L (w c_n / B)^(1/4)``."""
        return float(np.real(self.drag.normal) ** 0.25)


def elastic_tail(swimmer: Swimmer) -> ElasticTail:
    """Return the tail of a swimmer that has an elastic one.

    Raises
    ------
    SpecError
        If it has another.
    """
    tail: Any = swimmer.tail
    if not tail.settles:
        raise SpecError("tail.kind", tail.kind, '"elastic" for the model elastic')
    return tail


def problem(swimmer: Swimmer) -> Problem:
    """Return the numbers of an elastic swimmer.

    Raises
    ------
    SpecError
        If its tail is not elastic, or it would leave the plane in which it beats.
    """
    tail = elastic_tail(swimmer)
    check_options(swimmer)
    rest = tail.rest_shape
    if np.any(body_resistance(swimmer)[np.ix_(PLANE, ACROSS)]):
        raise SpecError("interaction.coupling", swimmer.interaction.coupling,
                        "one that keeps the swimmer in the plane s-q, in which its tail beats",
                        "leave only the entries of s, q with r")  # fmt: skip
    L, rate, mu = tail.length, magnitude(tail.rate), swimmer.fluid.viscosity
    per_force = rate * L**4 / tail.bending
    law = swimmer.coefficients
    c_t, c_n = (x * c for x, c in zip(swimmer.interaction.tail, law.local(tail, mu)[:2]))
    lengths = np.array([1.0, 1.0, L])
    body = body_resistance(swimmer)[np.ix_(PLANE, PLANE)] / np.outer(lengths, lengths) / L
    mask = np.array(swimmer.motion.mask)[PLANE]
    drag = Drag(
        tangential=per_force * c_t,
        normal=per_force * c_n,
        tip=per_force * law.end(tail, mu) / L,
        body=per_force * body,
        offset=swimmer.body.semi_axes3[0] / L,
        free=tuple(np.flatnonzero(mask).tolist()),
    )
    turning = 0.0 if tail.base == "hinged" else None
    if swimmer.hook is not None:
        turning = swimmer.hook.turning * L / tail.bending
    waves = tail.number_of_waves * float(np.sign(np.real(tail.rate)) or 1.0)
    moment = (tail.moment or 0.0) * L / tail.bending
    heave, pivot = (tail.amplitude or 0.0) / L, tail.angle or 0.0
    return Problem(drag, heave, pivot, turning, moment, waves, rest)


def check_options(swimmer: Swimmer) -> None:
    """Refuse readings and corrections that an elastic tail does not have.

    Raises
    ------
    SpecError
        If the swimmer has one.
    """
    if swimmer.motion.line_element != "arc":
        raise SpecError("motion.line_element", swimmer.motion.line_element,
                        '"arc" for an elastic tail')  # fmt: skip
    if swimmer.region is not None:
        raise SpecError("region", "given", "none for an elastic tail", "remove the table")
