"""A magnet fixed in the body: a permanent one, or a soft one that the field magnetises.

m = B_r V / mu_0      a uniformly magnetised piece of remanence B_r and volume V
m = chi V B / mu_0    a soft piece of apparent susceptibility chi, a symmetric tensor (3, 3)

chi is that of the piece as a whole, its own demagnetising field in it: ``chi_i / (1 + N chi_i)``
of a material chi_i in an ellipsoid of demagnetising factor N along an axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured

MU_0 = 1.25663706127e-6  #: N/A^2, vacuum permeability (CODATA 2022)
WAYS = ("moment", "remanence", "susceptibility")  #: in which a magnet is given, one of them
SIZES = {"block": 3, "cylinder": 2, "sphere": 1}  #: lengths that say a shape


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Magnet:
    """A magnet fixed in the body, permanent or soft.

    One of `moment`, `remanence` and `susceptibility`; the last two with `volume`, or with `shape`
    and `size`.

    Parameters
    ----------
    moment
        The vector (s, q, r), body frame, or its size, with `direction`; A m^2, or torque per field
        of a swimmer without units.
    remanence
        Remanence of the material (T); for swimmers in SI.
    susceptibility
        Of a soft magnet: apparent susceptibility along s, q and r, or the symmetric tensor (3, 3);
        above -1. Its moment is this times volume times B over mu_0. For swimmers in SI.
    volume
        Of the magnet (m^3).
    shape
        ``"block"``, ``"cylinder"`` or ``"sphere"``.
    size
        Edges of the block, diameter and height of the cylinder, diameter of the sphere (m).
    direction
        Of the moment: a vector (s, q, r) of any length, or its angle (rad) from the s axis,
        towards q.
    azimuth
        Angle (rad) about s by which the direction is turned from q towards r.

    Raises
    ------
    SpecError
        If there are two ways to the moment or none, or a number is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> block = ms.Magnet(remanence=1.2, size=(1e-3, 1e-3, 0.5e-3), direction=(0, 1, 0))
    >>> round(float(block.vector[1]), 6)  # A m^2
    0.000477
    """

    moment: float | tuple[float, ...] | None = None
    remanence: float | None = None
    susceptibility: tuple[Any, ...] | None = None
    volume: float | None = None
    shape: Literal["block", "cylinder", "sphere"] = "block"
    size: tuple[float, ...] | None = None
    direction: float | tuple[float, ...] | None = None
    azimuth: float = 0.0

    def __post_init__(self) -> None:
        checks.choice("magnet.shape", self.shape, tuple(SIZES))
        ways = [w for w in WAYS if getattr(self, w) is not None]
        if len(ways) != 1:
            raise SpecError(
                "magnet: give moment, or remanence or susceptibility with size or volume; one of "
                "the three"
            )
        if self.moment is None:
            self._check_piece(ways[0])
        else:
            self._check_moment()
        if self.susceptibility is not None:
            self._check_soft()
        elif np.ndim(self.moment or 0.0) == 0:
            self._check_direction()
        checks.number("magnet.azimuth", self.azimuth, "an angle (rad)", least=-7.0, most=7.0)

    def _check_moment(self) -> None:
        for name in ("volume", "size"):
            if getattr(self, name) is not None:
                raise SpecError(
                    f"magnet.{name}: belongs to a remanence or a susceptibility; remove it or the "
                    "moment"
                )
        if np.ndim(self.moment) == 0:  # type: ignore[arg-type]
            checks.positive("magnet.moment", self.moment)
            return
        checks.numbers("magnet.moment", self.moment, 3, "three numbers [s, q, r]")
        object.__setattr__(self, "moment", tuple(float(x) for x in self.moment))  # type: ignore[union-attr]
        if self.direction is not None:
            size = measured(np.linalg.norm(self.moment), "magnet.moment")  # type: ignore[arg-type]
            raise SpecError(
                "magnet.direction: the moment is a vector already; give its size alone, "
                f"moment = {size}, or leave direction out"
            )

    def _check_soft(self) -> None:
        allowed = "three numbers above -1, along s, q and r, or a symmetric tensor (3, 3)"
        try:
            given = np.array(self.susceptibility, dtype=float)
        except (TypeError, ValueError):
            raise SpecError("magnet.susceptibility", self.susceptibility, allowed) from None
        whole = np.diag(given) if given.shape == (3,) else given
        if whole.shape != (3, 3) or not (np.abs(whole) <= checks.LARGEST).all():
            raise SpecError("magnet.susceptibility", self.susceptibility, allowed)
        if not np.allclose(whole, whole.T, rtol=1e-9, atol=0.0):
            raise SpecError("magnet.susceptibility", self.susceptibility, allowed)
        if np.linalg.eigvalsh(whole).min() <= -1.0:
            raise SpecError("magnet.susceptibility", self.susceptibility, allowed)
        if self.direction is not None or self.azimuth:
            raise SpecError(
                "magnet.direction: a soft magnet has none, the field magnetises it; leave it out, "
                "or turn the tensor"
            )
        plain = tuple(map(tuple, given.tolist())) if given.ndim == 2 else tuple(given.tolist())
        object.__setattr__(self, "susceptibility", plain)

    def _check_piece(self, way: str) -> None:
        if way == "remanence":
            checks.positive("magnet.remanence", self.remanence)
        if (self.volume is None) == (self.size is None):
            raise SpecError(f"magnet.{way}: needs size or volume, one of the two")
        if self.volume is not None:
            checks.positive("magnet.volume", self.volume)
            return
        n = SIZES[self.shape]
        allowed = {3: "three lengths", 2: "diameter and height", 1: "a list of the diameter"}[n]
        checks.numbers("magnet.size", self.size, n, allowed, above=0.0)
        object.__setattr__(self, "size", tuple(float(x) for x in self.size))  # type: ignore[union-attr]

    def _check_direction(self) -> None:
        allowed = "a vector [s, q, r], or the angle from the s axis towards q"
        if self.direction is None:
            raise SpecError(f"magnet.direction: missing; add {allowed}")
        if np.ndim(self.direction) == 0:
            checks.number("magnet.direction", self.direction, allowed, least=-7.0, most=7.0)
            return
        checks.numbers("magnet.direction", self.direction, 3, allowed)
        vector = tuple(float(x) for x in self.direction)  # type: ignore[union-attr]
        if not any(vector):
            raise SpecError("magnet.direction", self.direction, "a vector other than zero")
        object.__setattr__(self, "direction", vector)

    @property
    def piece(self) -> Any:
        """Volume (m^3) of the magnet, NaN where its moment is given."""
        if self.volume is not None:
            return self.volume
        if self.size is None:
            return math.nan
        match self.shape, self.size:
            case "cylinder", (diameter, height):
                return np.pi / 4.0 * diameter**2 * height
            case "sphere", (diameter,):
                return np.pi / 6.0 * diameter**3
            case _, (a, b, c):
                return a * b * c
        raise AssertionError(self.shape)

    @property
    def strength(self) -> Any:
        """Size of the moment; zero of a soft magnet, which has none of its own."""
        if self.susceptibility is not None:
            return 0.0
        if self.moment is None:
            return self.remanence * self.piece / MU_0
        if np.ndim(self.moment) == 0 or not isinstance(self.moment, tuple):
            return self.moment
        return np.sqrt(sum(x**2 for x in self.moment))

    @property
    def vector(self) -> np.ndarray:
        """Moment (3,) in the body frame without a field: zero of a soft magnet."""
        if self.susceptibility is not None:
            return np.zeros(3)
        if isinstance(self.moment, tuple):
            s, q, r = self.moment
        else:
            s, q, r = (self.strength * x for x in self._unit())
        c, n = np.cos(self.azimuth), np.sin(self.azimuth)
        return np.stack(np.broadcast_arrays(s, c * q - n * r, n * q + c * r), axis=-1)

    @property
    def softness(self) -> np.ndarray:
        """Moment per field (3, 3), body frame; zero of a permanent magnet."""
        if self.susceptibility is None:
            return np.zeros((3, 3))
        chi = np.array(self.susceptibility)
        return (np.diag(chi) if chi.ndim == 1 else chi) * (self.piece / MU_0)

    @property
    def magnetic(self) -> np.ndarray:
        """Moment without a field, then moment per field row by row (12,), body frame."""
        return np.concatenate([np.real(self.vector), np.real(self.softness).ravel()])

    def _unit(self) -> tuple[Any, Any, Any]:
        if isinstance(self.direction, tuple):
            size = np.sqrt(sum(x**2 for x in self.direction))
            s, q, r = self.direction
            return s / size, q / size, r / size
        angle: Any = self.direction
        return np.cos(angle), np.sin(angle), 0.0 * np.sin(angle)


def magnetic_of(magnet: Any) -> np.ndarray:
    """Return moment and moment per field (12,) of a `Magnet`, of a vector (3,), or of None."""
    if isinstance(magnet, Magnet):
        return magnet.magnetic
    return np.concatenate([np.zeros(3) if magnet is None else magnet, np.zeros(9)])


def vector_of(magnet: Any) -> Any:
    """Return the moment (s, q, r) of a `Magnet`, zero of None; what is no magnet comes back."""
    if magnet is None:
        return (0.0, 0.0, 0.0)
    return tuple(map(float, magnet.vector)) if isinstance(magnet, Magnet) else magnet
