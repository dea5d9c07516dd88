"""Names of what a calibration looks for: ``translation.s``, ``coupling.qr``, ``tail.n``, ...

An unknown may stand for several numbers of the spec at once (lateral directions that are alike).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.swimmer.swimmer import Swimmer

_AXES = "sqr"
_LOCAL = "tnr"
_FREE = (-1e12, 1e12)
_POSITIVE = (1e-9, 1e9)


@dataclass(frozen=True)
class Unknown:
    """One unknown: the numbers it sets, each with a factor, and the bounds it starts with."""

    name: str
    paths: tuple[tuple[str, float], ...]
    bounds: tuple[float, float] = _FREE
    pair: tuple[int, int] | None = None

    def value(self, numbers: dict[str, float]) -> float:
        """Return the present value, from all numbers of a swimmer."""
        path, factor = self.paths[0]
        return numbers[path] / factor

    @property
    def is_translation(self) -> bool:
        """Whether it is a drag against translation, which is never negative."""
        return all(path.startswith("interaction.translation") for path, _ in self.paths)

    @property
    def direction(self) -> int:
        """Degree of freedom (0 to 5) of an interaction coefficient."""
        part, axes = self.name.split(".")
        return _AXES.index(axes[0]) + (3 if part == "rotation" else 0)


def resolve(swimmer: Swimmer, names: Iterable[str]) -> tuple[Unknown, ...]:
    """Return unknowns by name; those that the paper fits for this tail when none is named.

    Raises
    ------
    SpecError
        If a name is not known or two set the same number.
    """
    chosen = tuple(_one(swimmer, name) for name in (tuple(names) or usual(swimmer)))
    paths = [path for u in chosen for path, _ in u.paths]
    for path in paths:
        if paths.count(path) > 1:
            raise SpecError("unknowns", path, "set by one unknown only")
    return chosen


def usual(swimmer: Swimmer) -> tuple[str, ...]:
    """Return unknowns of Table 3: s, lateral, and the rotation that the tail drives."""
    free: dict[str, bool] = dict(zip(DEGREES_OF_FREEDOM, swimmer.motion.mask))
    if swimmer.tail.is_rigid:
        wanted = {"translation.s": "us", "translation.qr": "uq", "rotation.s": "os"}
    else:
        wanted = {"translation.s": "us", "translation.q": "uq", "rotation.r": "or"}
    return tuple(name for name, degree in wanted.items() if free[degree])


def for_loads(swimmer: Swimmer) -> tuple[str, ...]:
    """Return those, and factors of the filament: enough to match how the swimmer answers forces
    too.

    A helix's spin factor also takes the torque. Only what a free swimmer answers can be matched.
    """
    free: dict[str, bool] = dict(zip(DEGREES_OF_FREEDOM, swimmer.motion.mask))
    if not (free["us"] and free["uq"]):
        return usual(swimmer)
    spins = swimmer.tail.is_rigid and swimmer.coefficients.spin
    return (*usual(swimmer), "tail.t", "tail.n", *(("tail.r",) if spins else ()))


def _one(swimmer: Swimmer, name: str) -> Unknown:
    part, _, axes = name.partition(".")
    if part in ("translation", "rotation") and axes and set(axes) <= set(_AXES):
        return Unknown(name, tuple((f"interaction.{part}[{_AXES.index(a)}]", 1.0) for a in axes))
    if part == "coupling" and len(axes) == 2 and set(axes) <= set(_AXES):
        return _coupling(swimmer, name, *(_AXES.index(a) for a in axes))
    if part == "tail" and len(axes) == 1 and axes in _LOCAL:
        return Unknown(name, ((f"interaction.tail[{_LOCAL.index(axes)}]", 1.0),), _POSITIVE)
    if name in swimmer.numbers:
        return Unknown(name, ((name, 1.0),))
    raise SpecError(
        "unknown",
        name,
        "translation.s (or q, r, qr), rotation.s, coupling.qr, tail.t (or n, r), or a number of "
        "the spec such as coefficients.normal",
    )


def _coupling(swimmer: Swimmer, name: str, force: int, turn: int) -> Unknown:
    """Coupling of a force to a rotation; for a helix its mirror entry turns with it.

    On a body of revolution with a turning tail the mean over the period has ``E_rq = -E_qr``.
    """
    paths = [(f"interaction.coupling[{force}][{turn}]", 1.0)]
    if swimmer.tail.is_rigid and force != turn and 0 not in (force, turn):
        paths.append((f"interaction.coupling[{turn}][{force}]", -1.0))
    return Unknown(name, tuple(paths), _FREE, (force, turn))
