"""How a swimmer is printed: one line for each part, with units."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.gait.portrait import Rows
from microswim.gait.readable import quantity, significant
from microswim.gait.units import unit
from microswim.swimmer.geometry.tails.kinds import Tail, WaveTail
from microswim.swimmer.geometry.tails.placement import ALONG_S
from microswim.swimmer.swimmer import Swimmer


def of_swimmer(swimmer: Swimmer) -> tuple[str, Rows]:
    """Return title and rows of a swimmer.

    Examples
    --------
    >>> import microswim as ms
    >>> title, rows = of_swimmer(ms.Swimmer.preset("tabak/helix"))
    >>> title, rows[0]
    ('Swimmer, dimensionless', ('body', 'sphere, 1 x 1 x 1'))
    """
    rows = [("body", _body(swimmer)), *_tails(swimmer), ("fluid", _fluid(swimmer))]
    rows += [("drag", _drag(swimmer)), ("motion", _motion(swimmer))]
    rows += [
        (name, f"{getattr(swimmer, name)}")
        for name in ("wall", "channel", "hook")
        if getattr(swimmer, name) is not None
    ]
    if swimmer.magnet is not None:
        rows.append(("magnet", _magnet(swimmer)))
    if swimmer.field is not None:
        rows.append(("field", _field(swimmer)))
    return f"Swimmer, {swimmer.units}", rows


def _q(swimmer: Swimmer, value: Any, kind: str) -> str:
    return _short(quantity(value, unit(swimmer.units, kind)))


def _short(text: str) -> str:
    """Return a number without the zeros at its end."""
    number, space, unit = text.partition(" ")
    if "." in number and "e" not in number:
        number = number.rstrip("0").rstrip(".")
    return f"{number}{space}{unit}"


def _body(swimmer: Swimmer) -> str:
    axes = [_q(swimmer, 2.0 * r, "length") for r in swimmer.body.semi_axes3]
    return f"{swimmer.body.shape}, {' x '.join(axes)}" if any(swimmer.body.semi_axes3) else "none"


def _tails(swimmer: Swimmer) -> Rows:
    return [(name, _tail(swimmer, tail)) for name, tail in swimmer.tail.named.items()]


def _tail(swimmer: Swimmer, tail: Tail) -> str:
    if tail.is_absent:
        return "none"
    hand = getattr(tail, "handedness", None)
    kind = tail.kind.replace("_", " ")
    words = [f"{hand}-handed {kind}" if hand else kind]
    words.append(f"length {_q(swimmer, tail.apparent_length, 'length')}")
    if isinstance(tail, WaveTail):
        words.append(f"amplitude {_q(swimmer, tail.amplitude, 'length')}")
    words.append(f"{_short(significant(float(tail.number_of_waves)))} waves")
    words.append(f"radius {_q(swimmer, tail.radius, 'length')}")
    words.append(f"frequency {_q(swimmer, tail.frequency, 'frequency')}")
    return ", ".join([*words, *_place(swimmer, tail)])


def _place(swimmer: Swimmer, tail: Tail) -> list[str]:
    """Return where a tail stands, in words; nothing of one at the joint."""
    place, words = tail.placement, []
    if any(place.root):
        words.append(f"root at {', '.join(_q(swimmer, x, 'length') for x in place.root)}")
    if tuple(place.axis) != ALONG_S:
        words.append(f"axis along {', '.join(f'{x:.3g}' for x in place.rotation[:, 0])}")
    if tail.ahead:
        words.append(f"{tail.ahead:.4g} rad ahead")
    return words


def _fluid(swimmer: Swimmer) -> str:
    fluid = swimmer.fluid
    density = f", density {_q(swimmer, fluid.density, 'density')}" if fluid.density else ""
    return f"viscosity {_q(swimmer, fluid.viscosity, 'viscosity')}{density}"


def _drag(swimmer: Swimmer) -> str:
    own = swimmer.interaction
    told = [
        f"{name} {', '.join(f'{x:.4g}' for x in values)}"
        for name, values in (
            ("translation", own.translation),
            ("rotation", own.rotation),
            ("tail", own.tail),
        )
        if tuple(values) != (1.0, 1.0, 1.0)
    ]
    if any(any(row) for row in own.coupling):
        told.append("coupling")
    law = f"law {swimmer.coefficients.law.replace('_', ' ')}"
    region = ", calibrated over a region" if swimmer.region is not None else ""
    return f"{law}, interaction {'; '.join(told) or 'none'}{region}"


def _magnet(swimmer: Swimmer) -> str:
    soft: Any = swimmer.magnet.susceptibility  # type: ignore[union-attr]
    if soft is not None:
        own = ", ".join(f"{x:.4g}" for x in np.ravel(soft))
        return f"soft, susceptibility {own}{' along s, q, r' if len(np.ravel(soft)) == 3 else ''}"
    moment = [_q(swimmer, float(x), "A m^2") for x in swimmer.magnet.vector]  # type: ignore[union-attr]
    return f"moment {', '.join(moment)} along s, q, r"


def _field(swimmer: Swimmer) -> str:
    field: Any = swimmer.field
    words = [field.kind]
    if hasattr(field, "strength"):
        words.append(_q(swimmer, float(field.strength), "T"))
    if getattr(field, "file", None):
        words.append(str(field.file))
    turns = getattr(field, "frequency", 0.0)
    if turns:
        words.append(_q(swimmer, abs(turns), "Hz"))
    return ", ".join(words)


def _motion(swimmer: Swimmer) -> str:
    motion = swimmer.motion
    free = "all velocities free" if all(motion.mask) else f"free: {' '.join(motion.free)}"
    frame = "" if motion.frequency_frame == "body" else ", the motor's rate is that in the lab"
    return free + frame
