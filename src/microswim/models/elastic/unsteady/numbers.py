"""An elastic swimmer and its loads without units, from its spec."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.quantities import magnitude
from microswim.models.elastic.problem import elastic_tail
from microswim.models.elastic.unsteady.loads import Loads, Wall, half_curl
from microswim.models.elastic.unsteady.swimmer_in_time import InTime
from microswim.models.elastic.whirl import filament_of, resistances
from microswim.swimmer.geometry.solids.volume import volume_and_middle
from microswim.swimmer.geometry.tails.elastic.elastic_tail import SIZE
from microswim.swimmer.magnetism.magnet import MU_0
from microswim.swimmer.swimmer import Swimmer

REACH, PUSH = 0.01, 20.0  #: of a wall: range over L, and push per length over ``B / L^3``


@dataclass(frozen=True)
class Units:
    """What a length, a time, a force and a torque of 1 are, in the units of the swimmer."""

    length: float
    time: float
    force: float

    @property
    def torque(self) -> float:
        """Force times length."""
        return self.force * self.length


def units_of(swimmer: Swimmer) -> Units:
    """Return the units of an elastic swimmer: L, time of drive or field, and ``B / L^2``."""
    tail, field = elastic_tail(swimmer), swimmer.field
    rates = [magnitude(tail.rate) if tail.drive != "none" else 0.0]
    rates.append(0.0 if field is None else abs(field.rate))
    slack = swimmer.coefficients.local(tail, swimmer.fluid.viscosity)[1]
    rate = max(rates, key=np.real) or tail.bending / (slack * tail.length**4)
    return Units(tail.length, 1.0 / rate, tail.bending / tail.length**2)


def in_time(swimmer: Swimmer, modes: int, phase: float = 0.0, **more: Any) -> InTime:
    """Return an elastic swimmer without units, with so many polynomials a strain.

    Parameters
    ----------
    swimmer
        With an `ElasticTail`.
    modes
        Legendre polynomials of each strain.
    phase
        Of the drive at the start.
    more
        ``force``, ``torque`` on the body, lab frame, (3,).

    Raises
    ------
    SpecError
        If it has what is not followed in time.
    """
    tail, units = elastic_tail(swimmer), units_of(swimmer)
    if swimmer.channel is not None:
        raise SpecError("channel: an elastic tail is not followed in a tube; remove it")
    if swimmer.noise is not None:
        raise SpecError("noise: an elastic tail is followed without it; remove [noise]")
    if tail.base == "hinged" and swimmer.body.is_absent and any(swimmer.motion.mask[3:]):
        raise SpecError("tail.base", "hinged", '"clamped" where there is no body',
                        "a hinge to nothing has no angle; or hold the rotations")  # fmt: skip
    rod = filament_of(swimmer, modes)
    size = getattr(tail, SIZE.get(tail.drive, ""), None) or 0.0
    if tail.drive == "heave":
        size /= units.length
    if tail.drive == "moment":
        size *= units.length / tail.bending
    return InTime(
        rod=rod,
        drag=resistances(swimmer, 1.0 / units.time),
        loads=_loads(swimmer, rod, units, **more),
        drive=tail.drive,
        size=size,
        waves=tail.number_of_waves,
        rate=tail.rate * units.time if tail.drive != "none" else 0.0,
        phase=phase,
    )


def _loads(swimmer: Swimmer, rod: Any, units: Units, force: Any = (0, 0, 0),
           torque: Any = (0, 0, 0)) -> Loads:  # fmt: skip
    weight, body_weight, arm = _weights(swimmer, units)
    pressing = weight, body_weight, np.asarray(force, float) / units.force
    magnetic, moments, soft = _magnets(swimmer, rod, units)
    flow = swimmer.flow
    return Loads(
        weight=weight,
        body_weight=body_weight,
        arm=arm,
        force=np.asarray(force, float) / units.force,
        torque=np.asarray(torque, float) / units.torque,
        magnetic=magnetic,
        moments=moments,
        soft=soft,
        field=_field(swimmer, units),
        flow=_flow(swimmer, units),
        spin=np.zeros(3) if flow is None else half_curl(flow) * units.time,
        wall=_wall(swimmer, units, pressing),
        slope=None if flow is None else flow.gradient * units.time,
    )


def _flow(swimmer: Swimmer, units: Units) -> Any:
    flow = swimmer.flow
    if flow is None:
        return None
    return lambda places: flow.at(places * units.length) * (units.time / units.length)


def _field(swimmer: Swimmer, units: Units) -> Any:
    field = swimmer.field
    if field is None:
        return None

    def at(time: float, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        when, place = time * units.time, x * units.length
        return field.at(when, place), field.gradient(when, place) * units.length

    return at


def _weights(swimmer: Swimmer, units: Units) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    if swimmer.gravity is None:
        return np.zeros(3), np.zeros(3), np.zeros(3)
    tail, rho, g = elastic_tail(swimmer), swimmer.fluid.density, swimmer.gravity.vector
    body_density, tail_density = swimmer.gravity.densities
    area = np.pi * tail.radius**2
    volume, middle = volume_and_middle(swimmer.body)
    mass = (body_density - rho) * volume
    first = mass * (middle - swimmer.body.centre) if volume else np.zeros(3)
    first = first + body_density * volume * np.array(swimmer.gravity.centre_of_mass)
    # the arm carries the weight's own torque: first moment x g, as arm x weight where there is any
    arm = first / mass / units.length if mass else np.zeros(3)
    on_tail = (tail_density - rho) * area * units.length / units.force * g
    return on_tail, mass / units.force * g, arm


def _magnets(swimmer: Swimmer, rod: Any, units: Units) -> tuple[Any, Any, Any]:
    tail = elastic_tail(swimmer)
    if swimmer.field is None:
        return None, None, None
    own = None if swimmer.magnet is None else swimmer.magnet.magnetic / units.torque
    if not tail.is_magnetic:
        return own, None, None
    pieces = tail.pieces
    over = np.array([rod.over(p.first, p.last) for p in pieces])  # (k, m)
    per_length = np.array([np.divide(p.moment, p.last - p.first) for p in pieces])
    moments = over.T @ per_length / units.torque
    if tail.magnet_susceptibility is None:
        return own, moments, None
    if swimmer.units != "SI":
        raise SpecError(
            "tail.magnet_susceptibility: for a swimmer in SI; without units give magnet"
        )
    along, across = tail.magnet_susceptibility
    per_length = np.array([along, across, across]) * np.pi * tail.radius**2 * tail.length / MU_0
    return own, moments, np.outer(over.sum(axis=0), per_length) / units.torque


def _wall(swimmer: Swimmer, units: Units, pressing: tuple[np.ndarray, ...]) -> Wall | None:
    """The wall, whose push outdoes drive, bending, weights and a stream towards it."""
    if swimmer.wall is None:
        return None
    girth, drag = (
        np.array(swimmer.body.semi_axes3) / units.length,
        resistances(swimmer, 1.0 / units.time),
    )
    stream = 0.0 if swimmer.flow is None else np.linalg.norm(swimmer.flow.at_origin)
    carried = drag.normal * (1.0 + stream * units.time / units.length)
    carried = carried + 2.0 * stream * units.time / units.length * np.abs(drag.body[:3, :3]).max()
    push = PUSH + carried + 2.0 * sum(np.abs(load).sum() for load in pressing)
    return Wall(push, REACH, swimmer.tail.radius / units.length, girth)
