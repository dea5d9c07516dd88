"""What no swimmer in a real fluid would be like: refused where it cannot be, else said in words.

Drag takes power from every motion [Kim and Karrila 1991, Section 5.2], so the
resistance of a body, and of a whole swimmer, is positive definite. Interaction coefficients below
zero are not resistances; the paper's plane wave has one about r (its Table 3), which makes up for a
coupling that the model lacks, and only then, with the whole still definite, such a swimmer passes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.gait.readable import significant
from microswim.swimmer.geometry import attachment
from microswim.swimmer.geometry.tails.wave_tail import WaveTail

if TYPE_CHECKING:
    from microswim.swimmer.swimmer import Swimmer

PHASES = 16  #: at which the whole resistance is looked at
ROOT_PHASES = tuple(0.25 * np.pi * i for i in range(8))  #: at which a moving root is looked at
WIDE = 0.5  #: amplitude over length from which on no local law of resistance was made for it
INERTIA = 0.5  #: Reynolds number from which on a Stokes flow is doubtful
ABOUT_S = (False, False, False, True, False, False)  #: free to turn about s alone
_ONES = (1.0, 1.0, 1.0)


def said_with(swimmer: Swimmer, gait: Gait) -> Gait:
    """Return the gait with the `remarks` on its swimmer before its own."""
    said = swimmer.remarks
    if not said:
        return gait
    whole = [*said, *(r for r in gait.info.get("remarks", ()) if r not in said)]
    return replace(gait, info={**gait.info, "remarks": whole})


def remarks(swimmer: Swimmer) -> tuple[str, ...]:
    """Return a sentence on each thing that can be computed and hardly be meant.

    A swimmer keeps them as ``swimmer.remarks``.

    Parameters
    ----------
    swimmer
        Any swimmer; of complex numbers the real parts count.
    """
    return (*_of_shape(swimmer), *_of_motion(swimmer), *of_motors(swimmer))


def remarks_on_drag(swimmer: Swimmer) -> tuple[str, ...]:
    """Return what is odd about the local law and the interaction coefficients of a surrogate."""
    out = []
    c_t, c_n = _local(swimmer)
    if c_t > c_n:
        out.append(
            f"c_t = {c_t:.4g} is larger than c_n = {c_n:.4g}: no filament slides less easily along "
            "itself than across, and such a tail swims backwards"
        )
    negative = [f"interaction.rotation[{i}]" for i in _negative(swimmer.interaction.rotation)]
    if negative:
        out.append(
            f"{', '.join(negative)} below zero: this body would be turned by its own drag; the "
            "coefficient makes up for what the model lacks, and holds at its own design alone"
        )
    return tuple(out)


def require_drag(swimmer: Swimmer) -> None:
    """Refuse interaction coefficients of a body that no fluid resists.

    Raises
    ------
    SpecError
        If a translation is negative or the coupling larger than the drags that it joins.
    """
    x = swimmer.interaction
    if x.resists:
        return
    for i in _negative(x.translation):
        value = float(np.real(x.translation[i]))
        raise SpecError(
            f"interaction.translation[{i}]", value, "zero or more",
            "a body of negative drag would be driven by its own motion",
        )  # fmt: skip
    if not x.is_coupled:
        return
    own = [i for i in range(6) if i < 3 or np.real(x.rotation[i - 3]) >= 0.0]
    block = np.real(x.body_resistance(swimmer.body.diagonal(swimmer.fluid.viscosity)))
    if not _dissipates(block[np.ix_(own, own)]):
        raise SpecError(
            "interaction.coupling", np.real(x.coupling).tolist(),
            "small against the drags that it joins",
            "this body would draw power from the fluid in some motion",
        )  # fmt: skip


def require_tail(swimmer: Swimmer, what: str) -> None:
    """Refuse a body alone where its propulsion is the matter.

    Raises
    ------
    SpecError
        With what was asked for.
    """
    if swimmer.tail.is_absent:
        raise SpecError(
            "tail.kind", "none", f"a tail that propels, for {what}",
            "without one nothing moves by itself; microswim mobility tells how a body resists",
        )  # fmt: skip


def require_dissipation(swimmer: Swimmer, gait: Gait) -> None:
    """Refuse a whole swimmer that would gain power from the fluid in some free motion.

    Raises
    ------
    SpecError
        If its resistance is not positive definite at some phase.
    """
    x = swimmer.interaction
    if x.resists or not any(gait.free):
        return
    negative = _negative(x.rotation)
    if not (negative or x.is_coupled):
        return
    free = np.flatnonzero(gait.free)
    phases = np.linspace(0.0, 2.0 * np.pi, PHASES, endpoint=False)
    for R in np.real(gait.resistance(phases))[:, free[:, None], free]:
        if not _dissipates(R):
            name = f"interaction.rotation[{negative[0]}]" if negative else "interaction.coupling"
            value = np.array(np.real(x.rotation[negative[0]] if negative else x.coupling)).tolist()
            raise SpecError(
                name, value, "such that every motion of the whole swimmer costs power",
                "as it is, some motion would gain it, and velocities mean nothing",
            )  # fmt: skip


def stands_still(swimmer: Swimmer) -> bool:
    """Return whether the tail stands still in the lab while the motor turns the body that is not
    there.

    A rigid tail alone, free to turn about s, meets no force and no torque where it turns backwards
    as fast as the motor turns it: ``R V + F_p rate = 0`` at ``V = -sign rate e_s`` about the axis.
    """
    alone = swimmer.body.is_absent and swimmer.motion.mask[3]
    return alone and swimmer.tail.is_rigid and swimmer.tail.surface_motion == "rigid"


def turning(swimmer: Swimmer) -> str:
    """Return what bounds the fluid and would turn with it along a path: ``"wall"``, ``"channel"``.

    Nothing where there is no boundary, or one that stays where it is, seen from the swimmer.
    """
    around, free = {"wall": swimmer.wall, "channel": swimmer.channel}, swimmer.motion.mask
    return next((k for k, v in around.items() if v is not None and not v.stays(free)), "")


def reynolds(swimmer: Swimmer) -> float:
    """Return the scaling Reynolds number, ``rho f D^2 / mu`` with D the body's greatest width.

    Without a body D is the tail's length.
    """
    tail, fluid = swimmer.tail, swimmer.fluid
    D = 2.0 * max(_size(a) for a in swimmer.body.semi_axes3) or _size(tail.apparent_length)
    return _size(fluid.density) * _size(tail.frequency) * D**2 / _size(fluid.viscosity)


def turning_reynolds(swimmer: Swimmer) -> float:
    """Return ``rho w a^2 / mu`` of a magnet's swimmer that turns with its field about its own axis.

    w: rate of the field, a: half width of body and tail; zero where no field turns it.
    """
    field, fluid = swimmer.field, swimmer.fluid
    if swimmer.magnet is None or field is None or not np.any(np.real(field.angular_velocity)):
        return 0.0
    own = max(_size(a) for a in swimmer.body.semi_axes3[1:])
    tail = _size(getattr(swimmer.tail, "amplitude", None) or 0.0) + _size(swimmer.tail.radius)
    rate = _size(field.rate)
    return _size(fluid.density) * rate * max(own, tail) ** 2 / _size(fluid.viscosity)


def _of_motion(swimmer: Swimmer) -> list[str]:
    Re, out = reynolds(swimmer), []
    if Re > INERTIA:
        out.append(
            f"the Reynolds number (frequency x body length squared) is {significant(Re, 2)}: "
            "inertia, which is left out, is felt; swim keeps that of the fluid"
        )
    Re = turning_reynolds(swimmer)
    if Re > INERTIA:
        out.append(
            f"in step with its field the robot turns at a Reynolds number of {significant(Re, 2)}: "
            "inertia, which is left out, is felt"
        )
    if not stands_still(swimmer):
        return out
    return [
        *out,
        "without a body nothing takes up the motor's torque: the tail stands still in the lab and "
        "u_s is zero by a law, not by this shape; give it a body, or hold os",
    ]


def of_motors(swimmer: Swimmer) -> list[str]:
    """Return what is to be said of motors of given torque, and of hooks of rigid tails."""
    out = []
    if swimmer.motor is not None:
        out.append(
            "[motor] gives a torque: microswim path follows how fast it turns the tails; run and "
            "all else take tail.frequency"
        )
    if swimmer.hook is not None and not swimmer.tail.settles:
        out.append(
            "[hook] bends: microswim path follows how rigid tails tilt on it; in run and all else "
            "they stand as at rest"
        )
    return out


def _of_shape(swimmer: Swimmer) -> list[str]:
    tail, body, out = swimmer.tail, swimmer.body, []
    half_width = min(_size(a) for a in body.semi_axes3[1:])
    if not body.is_absent and _size(tail.radius) >= half_width:
        out.append("the filament is as thick as the body or thicker")
    if any(isinstance(t, WaveTail) and _is_wide(t) for t in tail.each):
        out.append(
            "the amplitude is half of the tail's length or more: laws of local resistance were not "
            "made for such a wave"
        )
    phases = ROOT_PHASES[:1] if tail.is_rigid else ROOT_PHASES
    lost = [t for t in tail.each if any(attachment.misses(body, t, phase) for phase in phases)]
    if any(t.is_placed for t in lost):
        out.append(
            "a tail does not touch the body from where it stands: move tail.position towards the "
            "body; bem refuses it as it is"
        )
    elif lost and not attachment.amplitude_of(lost[0]):
        out.append(
            "the tail begins beside the body and does not touch it: "
            f"{attachment.BESIDE}; bem and fem refuse it as it is"
        )
    elif lost:
        out.append(
            "the tail does not touch the body: its amplitude is beyond the body's half width; "
            f"{attachment.MEND}; bem and fem refuse it as it is"
        )
    return out


def _is_wide(tail: WaveTail) -> bool:
    return _size(tail.amplitude) >= WIDE * _size(tail.apparent_length)


def _local(swimmer: Swimmer) -> tuple[float, float]:
    """``(c_t, c_n)`` where the user chose them or their factors, else a pair that is in order."""
    factors = tuple(float(np.real(f)) for f in swimmer.interaction.tail)
    if not swimmer.coefficients.is_given and factors == _ONES:
        return 0.0, 1.0
    law, mu = swimmer.coefficients, swimmer.fluid.viscosity
    pairs = [[float(np.real(c)) for c in law.pair(t, mu)] for t in swimmer.tail.each]
    c_t, c_n = max(pairs, key=lambda pair: pair[0] / pair[1])
    return factors[0] * c_t, factors[1] * c_n


def _negative(values: Any) -> list[int]:
    return [i for i, value in enumerate(values) if np.real(value) < 0.0]


def _dissipates(R: np.ndarray) -> bool:
    """Whether a symmetric matrix, in units of its diagonal, is positive semidefinite."""
    diagonal = np.diag(R)
    if (diagonal < 0.0).any():
        return False
    scale = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    return bool(np.linalg.eigvalsh(R / np.outer(scale, scale))[0] > -1e-9)


def _size(value: Any) -> float:
    if isinstance(value, (int, float, complex)):  # one swimmer, and not many: quickly
        return abs(value.real)
    return float(np.max(np.abs(np.real(value))))
