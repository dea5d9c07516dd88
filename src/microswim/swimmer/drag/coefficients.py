"""Local resistance of the filament: c_t, c_n per unit length and the spin resistance c_r.

Lighthill [Tabak Eqs. 7-9], Gray & Hancock, Cox, a constant pair (also from a held swimmer's thrust
and torque), and the closed form (20). All formulas accept arrays and complex numbers.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from microswim import checks
from microswim.errors import SpecError, warn
from microswim.swimmer.drag.lighthill import lighthill_integrals
from microswim.swimmer.geometry.tails.kinds import Tail, as_wave


class ValidityWarning(UserWarning):
    """A formula is used near or beyond the edge of the range it was derived for.

    Examples
    --------
    >>> import warnings, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix").with_(
    ...     {"tail.waves": 5, "tail.amplitude": 0.02}
    ... )
    >>> with warnings.catch_warnings(record=True) as seen:
    ...     warnings.simplefilter("always")
    ...     gait = swimmer.gait()
    >>> seen[0].category.__name__
    'ValidityWarning'
    """


@dataclass(frozen=True, kw_only=True)
class Coefficients(ABC):
    """A law of local resistance. Use `Lighthill`, `GrayHancock`, `Cox` or `Constant`.

    Parameters
    ----------
    spin
        Whether a section that spins about its own centreline feels the torque
        ``c_r = 4 pi mu r_t^2`` per unit length. False is the paper's model.
    tip
        Whether the free end feels half of Stokes' drag on a sphere of the filament's radius,
        ``3 pi mu r_t``. The paper's model has none; a wave of a whole number of turns cancels along
        its length, and its end then decides the force and torque across.
    """

    spin: bool = True
    tip: bool = False
    law: ClassVar[str]
    is_given: ClassVar[bool] = False  #: whether c_t and c_n are numbers that somebody chose
    thickest: ClassVar[float] = np.inf  #: epsilon = 5.2 r_t alpha / lambda up to which it holds

    def __post_init__(self) -> None:
        checks.truth("coefficients.spin", self.spin)
        checks.truth("coefficients.tip", self.tip)

    @property
    def is_usual(self) -> bool:
        """Whether it is what a swimmer has where nothing is said."""
        return False

    @abstractmethod
    def pair(self, tail: Tail, viscosity: Any) -> tuple[Any, Any]:
        """Return ``(c_t, c_n)``: force per length and velocity, along and across the filament."""

    def local(self, tail: Tail, viscosity: Any) -> tuple[Any, Any, Any]:
        """Return ``(c_t, c_n, c_r)`` per unit length: along, across, and of spin.

        ``c_r = 2 pi mu (a^2 + b^2)`` of an infinite cylinder; a ribbon's c_n is between its two.
        """
        if tail.is_absent:
            return 0.0, 0.0, 0.0
        a, b = tail.half_axes
        spin = 2.0 * np.pi * viscosity * (a * a + b * b) if self.spin else 0.0 * tail.radius
        return (*self.pair(tail, viscosity), spin)

    def end(self, tail: Tail, viscosity: Any) -> Any:
        """Return force and velocity of the tip, in all directions: half a sphere, half its drag."""
        return 3.0 * np.pi * viscosity * tail.radius if self.tip else 0.0 * tail.radius


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Lighthill(Coefficients):
    """Lighthill's slender-body coefficients of an infinite helix [Tabak Eqs. 7-9].

    Valid for filaments thin against the wavelength: beyond ``epsilon = 5.2 r_t alpha / lambda`` of
    about 0.5 the denominators approach zero and the coefficients lose their meaning; then a
    `ValidityWarning` is given, and an error once a coefficient is no longer positive.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> [round(float(c), 2) for c in ms.Lighthill().pair(tail, 100.0)]
    [537.58, 780.37]
    """

    law: ClassVar[str] = "lighthill"
    thickest: ClassVar[float] = 0.5

    @property
    def is_usual(self) -> bool:
        return self.spin and not self.tip

    def pair(self, tail: Tail, viscosity: Any) -> tuple[Any, Any]:
        """Return ``(c_t, c_n)``.

        ``c_n = 4 pi mu / (-ln eps + (2 alpha^2 - 1) A_1 + 2 (1 - alpha^2) A_2)``   [Tabak Eq. 7]
        ``c_t = 2 pi mu / (-ln eps - 1/2 + alpha^2 A_1 + (1 - alpha^2) A_2)``       [Tabak Eq. 8]
        """
        alpha, wavelength = _wave(tail, self.law)
        epsilon = 5.2 * tail.radius * alpha / wavelength  # Eq. (26)
        A1, A2 = lighthill_integrals(alpha, epsilon)
        a2, slender = alpha**2, -np.log(epsilon)
        normal = slender + (2.0 * a2 - 1.0) * A1 + 2.0 * (1.0 - a2) * A2
        tangential = slender - 0.5 + a2 * A1 + (1.0 - a2) * A2
        meaningless = (normal.real <= 0) | (tangential.real <= 0)
        beyond = (epsilon.real > self.thickest) | meaningless
        if beyond.any() if isinstance(beyond, np.ndarray) else beyond:
            _warn_lighthill(epsilon, meaningless)
            normal = np.where(meaningless, np.nan, normal)
        return 2.0 * np.pi * viscosity / tangential, 4.0 * np.pi * viscosity / normal


@checks.by_name
@dataclass(frozen=True, kw_only=True, eq=False)
class Unchosen(Lighthill):
    """Lighthill's law where nobody chose a law, or Cox's for a tail that names no wavelength.

    `auto` may then take a model that needs none.
    """

    def pair(self, tail: Tail, viscosity: Any) -> tuple[Any, Any]:
        """Return ``(c_t, c_n)`` by Lighthill's law, which needs a wave; without one by Cox's."""
        law = Cox() if tail.wavelength_along_s is None else super()
        return law.pair(tail, viscosity)


def _warn_lighthill(epsilon: Any, meaningless: Any) -> None:
    """Refuse a single design beyond the limit (in a design map it becomes NaN), else warn."""
    mend = 'use the law "gray_hancock" or "cox" there'
    if np.ndim(epsilon) == 0 and meaningless:
        raise SpecError(
            "coefficients.law",
            "lighthill",
            "used for epsilon = 5.2 r_t alpha / lambda well below 1 "
            f"(here {np.real(epsilon):.3g}): its coefficients turn negative",
            mend,
        )
    if np.any(np.real(epsilon) > 0.5):
        worst = float(np.max(np.real(epsilon)))
        warn(
            f"Lighthill's coefficients are beyond their range (epsilon = {worst:.2g} > 0.5): the "
            f"filament is thick for its wavelength; {mend}",
            ValidityWarning,
            stacklevel=4,
        )


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class GrayHancock(Coefficients):
    """Gray & Hancock (1955): ``c_t = 2 pi mu/(ln(2 lambda/a) - 1/2)``, ``c_n`` with ``+1/2``.

    Valid for ``lambda`` well above the filament radius ``a``.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> c_t, c_n = ms.GrayHancock().pair(tail, 1.0)
    >>> bool(1 < c_n / c_t < 2)
    True
    """

    law: ClassVar[str] = "gray_hancock"

    def pair(self, tail: Tail, viscosity: Any) -> tuple[Any, Any]:
        """Return ``c_t = 2 pi mu/(ln(2 lambda/a) - 1/2)``, ``c_n = 4 pi mu/(ln(2 lambda/a) +
        1/2)``.
        """
        _, wavelength = _wave(tail, self.law)
        return _logarithmic(viscosity, 2.0 * wavelength / tail.radius, 0.5, -0.5, "wavelength")


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Cox(Coefficients):
    """Cox (1970), a straight slender rod of the filament's arc length l and radius a.

    ``c_t = 2 pi mu/(ln(2 l/a) - 3/2)``, ``c_n = 4 pi mu/(ln(2 l/a) - 1/2)``
    (J. Fluid Mech. 44, 791).
    Valid for l well above a; it knows the tail's length and not its wave.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> c_t, c_n = ms.Cox().pair(tail, 1.0)
    >>> bool(1 < c_n / c_t < 2)
    True
    """

    law: ClassVar[str] = "cox"

    def pair(self, tail: Tail, viscosity: Any) -> tuple[Any, Any]:
        """Return ``c_t = 2 pi mu / (ln(2 l/a) - 3/2)``, ``c_n = 4 pi mu / (ln(2 l/a) - 1/2)``."""
        return _logarithmic(viscosity, 2.0 * tail.arc_length / tail.radius, -0.5, -1.5, "length")


def _logarithmic(mu: Any, ratio: Any, normal: float, tangential: float, what: str) -> Any:
    log = np.log(ratio)
    if np.any(np.real(log) + tangential <= 0):
        raise SpecError(
            "tail.radius", "too large", f"small against the {what} for this law of local resistance"
        )
    return 2.0 * np.pi * mu / (log + tangential), 4.0 * np.pi * mu / (log + normal)


def _wave(tail: Tail, law: str) -> tuple[Any, Any]:
    """``(alpha, lambda)`` of a tail that has a wave."""
    wavelength = tail.wavelength_along_s
    if wavelength is None:
        raise SpecError(
            "tail.wavelength", None, f'given for the law "{law}"', 'or use the law "cox"'
        )
    return tail.alpha, wavelength


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Constant(Coefficients):
    """A constant pair, in units of viscosity (force per length and velocity).

    Parameters
    ----------
    normal, tangential
        ``c_n`` and ``c_t``, positive.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Constant(normal=995.5, tangential=775.2, spin=False).normal
    995.5
    """

    normal: float
    tangential: float
    law: ClassVar[str] = "constant"
    is_given: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.positive("coefficients.normal", self.normal)
        checks.positive("coefficients.tangential", self.tangential)

    def pair(self, tail: Tail, viscosity: Any) -> tuple[Any, Any]:
        """Return the pair as given."""
        return self.tangential, self.normal

    @classmethod
    @checks.given(
        tail=partial(checks.instance, kind="Tail"),
        thrust=partial(checks.number, allowed="a finite force"),
        torque=partial(checks.number, allowed="a finite torque"),
    )
    def from_held_tail(cls, tail: Tail, thrust: float, torque: float, **options: Any) -> Constant:
        """Return the pair that gives a held swimmer's thrust and torque through Eq. (20).

        Parameters
        ----------
        tail
            A `HelicalTail`; it turns at its own rate.
        thrust, torque
            Axial force and torque by the fluid on the tail, ``F_t,s`` and ``T_t,s``, with their
            signs: for a left-handed tail both are negative.
        options
            ``spin``.

        Raises
        ------
        SpecError
            If the two imply a coefficient that is not positive.

        Examples
        --------
        >>> import microswim as ms
        >>> tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
        >>> F, T = ms.closed_form(tail, c_n=995.5, c_t=775.2)
        >>> round(ms.Constant.from_held_tail(tail, F, T).normal, 1)
        995.5
        """
        columns = [closed_form(tail, c_n=c, c_t=1.0 - c) for c in (1.0, 0.0)]
        c_n, c_t = np.linalg.solve(np.array(columns).T, [thrust, torque])
        return cls(normal=float(c_n), tangential=float(c_t), **options)


@checks.given(
    tail=partial(checks.instance, kind="Tail"),
    c_n=checks.reals,
    c_t=checks.reals,
    u_s=checks.reals,
)
def closed_form(tail: Tail, *, c_n: Any, c_t: Any, u_s: Any = 0.0) -> tuple[Any, Any]:
    """Return the axial force and torque by the fluid on a helical tail without ramp [Tabak Eq. 20].

    ``[F; T] = -(L/alpha) alpha^2 ([[b^2k^2, 1], [b^2k, -b^2k]] u_s
    + [[k, -k], [1, b^2k^2]] b^2 omega) [c_n; c_t]``, the paper's ``alpha L`` being the arc
    length's share alpha^2 of a length ``L/alpha``. Signs are those of a left-handed helix; a
    right-handed one turns the other way, which flips the torque and not the force.

    Parameters
    ----------
    tail
        A `HelicalTail`; it turns at its own rate about s.
    c_n, c_t
        Local resistances, per unit length.
    u_s
        Velocity along s.

    Returns
    -------
    tuple
        ``(F_t,s, T_t,s)``.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
    >>> [round(float(x)) for x in ms.closed_form(tail, c_n=995.5, c_t=775.2)]
    [-190, -154]
    """
    wave = as_wave(tail)
    b2, k, omega = wave.amplitude**2, wave.wavenumber, tail.rate
    share = tail.alpha * tail.apparent_length
    force = (b2 * k**2 * c_n + c_t) * u_s + k * (c_n - c_t) * b2 * omega
    torque = b2 * k * (c_n - c_t) * u_s + (c_n + b2 * k**2 * c_t) * b2 * omega
    return -share * force, -share * tail.sign * torque


LAWS: dict[str, type[Coefficients]] = {c.law: c for c in (Lighthill, GrayHancock, Cox, Constant)}
