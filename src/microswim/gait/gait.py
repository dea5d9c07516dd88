"""Gait: all that a hydrodynamic model says about a swimmer, as Fourier series in the phase.

``R(phi) V + F_p(phi) rate = W_external``: 6x6 resistance R, propulsive wrench F_p per unit phase
rate. The force and torque by the fluid on the swimmer is ``-(R V + F_p rate)``. Six-vectors are
``[linear; angular]`` in the body frame about the body's centre. Holds Eqs. (15) and (24). A gait
does not know which model made it. A *series* is one of `microswim.numerics.series.fourier`.
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError
from microswim.gait import doors, portrait
from microswim.gait.poses.one_pose import refusal
from microswim.gait.turned import sense
from microswim.numerics.array import kept, read_only
from microswim.numerics.series.extremes import half_range
from microswim.numerics.series.fourier import evaluate, rotate, series_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Degrees of freedom, in the order of all six-vectors.
DEGREES_OF_FREEDOM = ("us", "uq", "ur", "os", "oq", "or")
ALL_FREE = (True,) * 6
#: Of a term of each series.
SHAPES = {"resistance_series": (6, 6), "propulsion_series": (6,), "activity_series": ()}


@checks.by_name
@dataclass(frozen=True, eq=False, repr=False)
@read_only
class Gait:
    """Resistance and propulsion of a swimmer over one period of its tail.

    Parameters
    ----------
    resistance_series
        R, shape (1 + 2 H, 6, 6).
    propulsion_series
        F_p per unit phase rate, shape (1 + 2 H', 6).
    activity_series
        G: power given to the fluid per squared unit rate while the body is held, (1 + 2 H'',).
    rate
        Phase rate (rad per time), the motor's: tail relative to the body.
    free
        Which of us, uq, ur, os, oq, or are free; the others are held at zero.
    body_resistance_series, body_propulsion_series
        The part of R and F_p that acts on the body alone; tail = total - body.
    model, units, info
        What made it, ``"dimensionless"`` or ``"SI"``, and whatever else the model says.

    Examples
    --------
    >>> import microswim as ms
    >>> gait = ms.Swimmer.preset("tabak/helix-constant").gait()
    >>> round(float(gait.mean_velocity[0]), 4)
    -0.037
    """

    resistance_series: np.ndarray
    propulsion_series: np.ndarray
    activity_series: np.ndarray
    _: KW_ONLY
    rate: Any
    free: tuple[bool, ...] = ALL_FREE
    body_resistance_series: np.ndarray | None = None
    body_propulsion_series: np.ndarray | None = None
    model: str = "rft"
    units: str = "dimensionless"
    info: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        own = self.__dict__
        for name, shape in SHAPES.items():
            series = own[name]
            if type(series) is not np.ndarray or series.shape[1:] != shape or not series.ndim:
                checks.shaped(name, series, ("n", *shape))
                own[name] = np.asarray(series)

    def __repr__(self) -> str:
        """Return about five lines with units; the numbers are in `microswim.summary`."""
        return portrait.as_text(*portrait.of_gait(self))

    def _repr_html_(self) -> str:
        return portrait.as_html(*portrait.of_gait(self))

    @checks.given()
    def plot(self) -> Figure:
        """Draw velocity, body rate and motor power over a period; call its ``savefig``.

        Examples
        --------
        >>> import microswim as ms
        >>> figure = ms.Swimmer.preset("tabak/plane_wave").gait().plot()
        >>> figure.axes[0].get_xlabel()
        'phase of the tail (periods)'
        """
        return doors.go(doors.PLOT_GAIT, self)

    @classmethod
    @checks.given(
        R=partial(checks.shaped, shape=("n", 6, 6)),
        F=partial(checks.shaped, shape=("n", 6)),
        G=partial(checks.shaped, shape=("n",)),
        body_R=partial(checks.shaped, shape=("n", 6, 6)),
        body_F=partial(checks.shaped, shape=("n", 6)),
        harmonics=checks.at_least(0),
    )
    def from_samples(
        cls,
        R: np.ndarray,
        F: np.ndarray,
        G: np.ndarray,
        *,
        body_R: np.ndarray | None = None,
        body_F: np.ndarray | None = None,
        harmonics: int | None = None,
        **fields: Any,
    ) -> Gait:
        """Return the gait through uniform samples over the full period, phases ``2 pi i / n``.

        R (n, 6, 6), F (n, 6), G (n,); `body_R`, `body_F` likewise. The other fields by name.
        """
        keep = {
            "body_resistance_series": body_R,
            "body_propulsion_series": body_F,
        }
        bodies: dict[str, Any] = {
            k: series_of(np.asarray(v), harmonics) for k, v in keep.items() if v is not None
        }
        series = [series_of(np.asarray(x), harmonics) for x in (R, F, G)]
        return cls(series[0], series[1], series[2], **bodies, **fields)

    @classmethod
    @checks.given(
        R=partial(checks.shaped, shape=(6, 6)),
        F=partial(checks.shaped, shape=(6,)),
        G=partial(checks.shaped, shape=()),
        sign=checks.sign,
        body_R=partial(checks.shaped, shape=(6, 6)),
        body_F=partial(checks.shaped, shape=(6,)),
    )
    def from_rotation(
        cls,
        R: np.ndarray,
        F: np.ndarray,
        G: Any,
        *,
        sign: float = 1.0,
        body_R: np.ndarray | None = None,
        body_F: np.ndarray | None = None,
        **fields: Any,
    ) -> Gait:
        """Return gait of a rigid rotating tail on an axisymmetric body, exact from phase 0 alone.

        ``R(phi) = Q R(0) Q'``, ``F_p(phi) = Q F_p(0)``, Q the rotation by ``sign * phi`` about s.
        """
        keep = {"body_resistance_series": body_R, "body_propulsion_series": body_F}
        bodies: dict[str, Any] = {
            k: rotate(np.asarray(v), sign) for k, v in keep.items() if v is not None
        }
        turned, pushed = (rotate(np.asarray(x), sign) for x in (R, F))
        return cls(turned, pushed, np.atleast_1d(G), **bodies, **fields)

    @checks.given(phase=checks.finite)
    def resistance(self, phase: Any) -> np.ndarray:
        """Return R at the phases (rad), shape phase.shape + (6, 6); symmetric positive definite."""
        return evaluate(self.resistance_series, phase)

    @checks.given(phase=checks.finite)
    def propulsion(self, phase: Any) -> np.ndarray:
        """Return F_p per unit phase rate, shape phase.shape + (6,)."""
        return evaluate(self.propulsion_series, phase)

    @checks.given(phase=checks.finite)
    def activity(self, phase: Any) -> np.ndarray:
        """Return power given to the fluid per squared unit rate with the body held, phase.shape."""
        return evaluate(self.activity_series, phase)

    @property
    def period(self) -> Any:
        """Time of one cycle of the tail; infinite if it stands still."""
        if np.ndim(self.rate) == 0 and self.rate == 0:
            return np.inf
        return 2.0 * np.pi / np.sqrt(self.rate**2)

    @checks.given(phase=checks.finite, rate=checks.finite, wrench=checks.six)
    def velocity(self, phase: Any, rate: Any = None, wrench: Any = None) -> np.ndarray:
        """Return the twist ``V = R^-1 (W - F_p rate)`` [Tabak Eq. 15], shape phase.shape + (6,).

        Parameters
        ----------
        phase
            Phases (rad).
        rate
            Phase rate; the gait's own by default.
        wrench
            External force and torque on the body, body frame, about its centre (6,).
        """
        return self._twist(phase, self.rate if rate is None else rate, wrench)

    def _twist(self, phase: Any, rate: Any, wrench: Any = None) -> np.ndarray:
        load = -evaluate(self.propulsion_series, phase) * rate
        if wrench is not None:
            load = load + wrench
        f = np.flatnonzero(self.free)
        R = evaluate(self.resistance_series, phase)
        out = np.zeros(load.shape, dtype=np.result_type(R, load))
        try:
            part = R[..., f[:, None], f]
            out[..., f] = np.linalg.solve(part, load[..., f, None])[..., 0]
        except np.linalg.LinAlgError:
            raise MicroswimError(
                "the resistance matrix is singular: a swimmer needs a body or a tail that "
                "resists every free motion"
            ) from None
        return out

    @property
    def one_pose(self) -> str:
        """What would turn with the swimmer along a path, ``"wall"`` or ``"channel"``; or nothing.

        A gait beside a wall is right at the pose where it was solved. Carried along a path it
        would carry the wall with it.
        """
        return str(self.info.get("one_pose", ""))

    def check_path(self) -> None:
        """Refuse what would follow a path if the gait holds at one pose.

        Raises
        ------
        SpecError
            One sentence.
        """
        if self.one_pose:
            raise refusal(self.one_pose)

    @property
    def samples(self) -> int:
        """Phases that resolve the velocity (a ratio of series) to rounding."""
        return max(64, 4 * (len(self.resistance_series) // 2 + 2))

    @cached_property
    def _phases(self) -> np.ndarray:
        """Uniform phases over the period, `samples` of them; one where all are alike."""
        n = 1 if self.turned else self.samples
        return 2.0 * np.pi * np.arange(n) / n

    @cached_property
    def turned(self) -> float:
        """Sign with which phase 0, turned about s with the phase, is every phase; 0.0 if none."""
        return sense(self)

    @cached_property
    def _velocities(self) -> np.ndarray:
        """Twist at the uniform phases, at the gait's own rate; means over the period rest on it."""
        return self._twist(self._phases, self.rate)

    @cached_property
    def velocity_series(self) -> np.ndarray:
        """Series of the velocity at the gait's own rate, shape (1 + 2 H, 6)."""
        V = self._velocities
        return kept(rotate(V[0], self.turned) if self.turned else series_of(V))

    @property
    def mean_velocity(self) -> np.ndarray:
        """Twist averaged over the period, body frame, about the body's centre, shape (6,)."""
        return self.velocity_series[0]

    @cached_property
    def velocity_amplitude(self) -> np.ndarray:
        """Half of peak to peak of each component of the velocity over the period, shape (6,)."""
        size = np.abs(self.velocity_series).reshape(-1, 2, 3).max(axis=2)
        felt = np.flatnonzero((size > 1e-12 * size.max(axis=0)).any(axis=1))
        series = self.velocity_series[: 1 + 2 * ((felt.max(initial=0) + 1) // 2)]
        return kept(half_range(series))

    @checks.given(phase=checks.finite)
    def power(self, phase: Any) -> np.ndarray:
        """Return power of the motor, ``rate (F_p . V + G rate)``: all that the fluid dissipates.

        For a helix this is the motor's torque times its rate, for a plane wave the lateral force
        times the lateral velocity along the tail, as in Eq. (24).
        """
        return self._power(phase, self._twist(phase, self.rate))

    def _power(self, phase: Any, V: np.ndarray) -> np.ndarray:
        work = np.sum(evaluate(self.propulsion_series, phase) * V, axis=-1)
        return self.rate * (work + evaluate(self.activity_series, phase) * self.rate)

    @cached_property
    def mean_power(self) -> Any:
        """Power of the motor averaged over the period."""
        return np.mean(self._power(self._phases, self._velocities))

    @property
    def mean_torque(self) -> Any:
        """Torque of the motor averaged over the period (for a helix; else power over rate)."""
        return self.mean_power / self.rate if np.real(self.rate) != 0 else 0.0 * self.mean_power

    @checks.given(phase=checks.finite)
    def body_wrench(self, phase: Any) -> np.ndarray:
        """Return the force and torque by the fluid on the body alone, shape phase.shape + (6,)."""
        return self._body_wrench(phase, self._twist(phase, self.rate))

    def _body_wrench(self, phase: Any, V: np.ndarray) -> np.ndarray:
        if self.body_resistance_series is None:
            raise MicroswimError(f"the {self.model} gait does not hold the body's own resistance")
        drag = np.einsum("...ij,...j->...i", evaluate(self.body_resistance_series, phase), V)
        if self.body_propulsion_series is not None:
            drag = drag + evaluate(self.body_propulsion_series, phase) * self.rate
        return -drag

    @cached_property
    def efficiency(self) -> Any:
        """Hydrodynamic efficiency ``eta = mean(F_s u_s) / mean(motor power)`` [Tabak Eq. 24].

        ``F_s`` is the drag on the body alone. Zero for a swimmer that stands still.
        """
        if np.real(self.mean_power) == 0:
            return 0.0
        V = self._velocities
        work = -self._body_wrench(self._phases, V)[..., 0] * V[..., 0]
        return np.mean(work) / self.mean_power

    @checks.given(rate=checks.finite)
    def at_rate(self, rate: Any) -> Gait:
        """Return the same gait driven at another phase rate."""
        return replace(self, rate=rate)

    @checks.given(rate=checks.finite, sign=checks.sign)
    def in_lab_frame(self, rate: Any, sign: float) -> Gait:
        """Return the same gait with `rate` read as the tail's rate in the lab frame.

        The motor then turns at ``rate / (1 + sign w_s)``, w_s the mean body rate about s per
        unit motor rate: the paper's reading in Section 3.1 and Fig. 6.
        """
        per_rate = self.at_rate(1.0).mean_velocity[3]
        return self.at_rate(rate / (1.0 + sign * per_rate))
