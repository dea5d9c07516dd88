"""The inverse problem: interaction coefficients from velocities [Tabak Eqs. 18-22, Section 3.2.1].

Weighted least squares with bounds, ``min_x sum ((y_i - f_i(x)) / sigma_i)^2``, with the Jacobian by
the complex step ``Im f(x + ih)/h`` through the surrogate's kernels, so it is exact to rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from scipy.optimize import least_squares

from microswim import checks
from microswim.calibration import observations as observe
from microswim.calibration import record
from microswim.calibration.coefficients import CoefficientCalibration, sigmas_of, values_of
from microswim.calibration.identifiability import determined, is_definite, physical_warnings
from microswim.calibration.observations import Observation
from microswim.calibration.unknowns import Unknown, for_loads, resolve
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.models.rft.gait import gait as checked_surrogate
from microswim.models.rft.gait import unchecked as surrogate
from microswim.numerics.compiling.compiled import pays, settled
from microswim.numerics.complex_step import STEP, derivative_from
from microswim.numerics.gauss_newton import gauss_newton
from microswim.numerics.series.extremes import half_range
from microswim.numerics.series.fourier import series_of
from microswim.swimmer import physical_sense
from microswim.swimmer.fields import lifted
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.swimmer import Swimmer

ONE_STEP = 0.02  #: seconds of all gaits for one observation and one unknown as Python


@checks.given(
    swimmer=checks.swimmer,
    unknowns=checks.words,
    quantities=checks.words,
    bounds=checks.mapping,
    start=checks.mapping,
    positive=checks.truth,
    method=checks.one_of("least squares", "ratios"),
)
def calibrate(
    swimmer: Swimmer,
    data: Gait | dict[str, Any] | Sequence[Observation],
    unknowns: Iterable[str] = (),
    *,
    quantities: Iterable[str] = (),
    bounds: dict[str, tuple[float, float]] | None = None,
    start: dict[str, float] | None = None,
    positive: bool = False,
    method: Literal["least squares", "ratios"] = "least squares",
) -> CoefficientCalibration:
    """Find interaction coefficients that make the surrogate agree with data.

    Parameters
    ----------
    swimmer
        The swimmer to calibrate; what is not unknown stays as it is.
    data
        A reference gait, measured quantities of this swimmer, value and uncertainty (such as
        ``{"swimming_speed": (30e-6, 1e-6)}``), or a list of
        `Observation` of one or several swimmers.
    unknowns
        Names: ``translation.s`` (also q, r, qr), ``rotation.s`` (q, r, qr), ``coupling.qr``,
        ``tail.t`` (n, r), or any dotted number; by default those of the paper for this tail, and
        on a reference gait the factors of the filament too.
    quantities
        What to take from a reference gait; by default forward speed, lateral amplitude and rate,
        the response to a force along and across (``mobility.us.us``, ``mobility.uq.uq``) and, of
        a helix, the motor's power. Where that would make the resistance lose its positive
        definiteness, the coefficients are kept positive, and agree less well.
    bounds
        Name to (least, most).
    start
        Name to first guess; by default the swimmer's own values.
    positive
        Keep the body's resistance positive definite, as it must be: positive drags, and a coupling
        that stays below the geometric mean of the two drags it joins.
    method
        ``"least squares"``, or ``"ratios"``: the paper's direct ratios of force to velocity of the
        body (from a reference gait).

    Returns
    -------
    CoefficientCalibration
        Its swimmer says in ``calibration`` by what, where and when it was made, what agrees and
        what does not.

    Raises
    ------
    SpecError
        If a name is unknown, data are missing or a bound excludes the start.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> truth = swimmer.with_({"interaction.translation": (2.24, 1.25, 1.25)})
    >>> fit = ms.calibrate(swimmer, truth.gait(), ["translation.s", "translation.qr"])
    >>> [round(float(v), 6) for v in fit.values], fit.swimmer.calibration.reference
    ([2.24, 1.25], 'rft')
    """
    if swimmer.region is not None:
        raise SpecError(
            "region: a swimmer with corrections over a region heeds no interaction coefficients; "
            "leave out [region] to fit some, or calibrate over a region again"
        )
    if method == "ratios":
        return record.kept(_ratios(swimmer, data), data)
    unknowns, quantities = tuple(unknowns), tuple(quantities)
    if isinstance(data, Gait):
        physical_sense.require_tail(swimmer, "a calibration on a gait")
    usual = isinstance(data, Gait) and not unknowns and not quantities
    if usual and len(swimmer.tail.each) > 1:
        raise SpecError(
            "calibrate: which coefficients several tails ask for is not known: those of one tail "
            "come out negative, as the tails' flows meet; name the unknowns, such as tail.n, and "
            "the quantities, or compute with model bem"
        )
    if usual:
        unknowns, quantities = for_loads(swimmer), observe.with_loads(swimmer)
    observations = _observations(swimmer, data, quantities)
    chosen = resolve(swimmer, unknowns)
    problem = _Problem(swimmer, observations, chosen, positive)
    with settled(pays(ONE_STEP * len(observations) * (1 + len(chosen)))):
        fit = problem.outcome(problem.solve(start or {}, bounds or {}))
        why = refusal(fit.swimmer)
        if why or (usual and not is_definite(fit.swimmer)):
            fit = _kept_positive(problem, fit, start or {}, bounds or {}, why)
    return record.kept(fit, data)


def refusal(swimmer: Swimmer) -> str:
    """Return why the surrogate refuses a swimmer with these coefficients, or nothing."""
    try:
        checked_surrogate(swimmer)
    except SpecError as error:
        return str(error)
    return ""


def _kept_positive(
    problem: _Problem, fit: CoefficientCalibration, start: dict, bounds: dict, why: str
) -> CoefficientCalibration:
    """Fit again among coefficients that some fluid has, and say so; refuse what has none there.

    Raises
    ------
    SpecError
        If there is none that the surrogate takes.
    """
    interaction = all(u.paths[0][0].startswith("interaction.") for u in problem.unknowns)
    if interaction and not bounds:
        again = replace(problem, positive=True)
        found = again.outcome(again.solve(start, {}))
    else:
        least = {u.name: (0.0, u.bounds[1]) for u in problem.unknowns if u.is_translation}
        found = problem.outcome(problem.solve(start, least | bounds))
    still = refusal(found.swimmer)
    if still:
        raise SpecError(
            f"no model takes the coefficients that fit these data: {still}; ask for fewer unknowns"
        )
    if not why:
        return found
    said = f"kept positive: what fits best is refused, {why}"
    return replace(found, warnings=(*found.warnings, said))


def _observations(swimmer: Swimmer, data: Any, quantities: Iterable[str]) -> tuple:
    if isinstance(data, Gait):
        return tuple(observe.from_reference(swimmer, data, quantities))
    if isinstance(data, dict):
        checks.mapping("data", data, "quantities to values, {...}")
        data = observe.from_dict(swimmer, data)
    if not isinstance(data, (list, tuple)):
        raise SpecError("data", data, "a gait, measured quantities {...} or a list of Observation")
    if not data:
        raise SpecError("data: nothing was observed; give a gait or measured quantities")
    for i, observation in enumerate(data):
        checks.instance(f"data[{i}]", observation, "Observation")
    return tuple(data)


@dataclass(frozen=True)
class _Problem:
    """Residuals and their Jacobian in the unknowns' free coordinates."""

    swimmer: Swimmer
    observations: tuple[Observation, ...]
    unknowns: tuple[Unknown, ...]
    positive: bool

    def predict(self, values: Iterable[Any]) -> np.ndarray:
        """Return all observed quantities for the unknowns' values (numbers, real or complex)."""
        made: dict[int, tuple[Gait, Any, Any]] = {}
        out = []
        for o in self.observations:
            if id(o.swimmer) not in made:
                one = lift(o.swimmer, self.unknowns, values)
                made[id(o.swimmer)] = surrogate(one), one.body_length, drive_of(one)
            gait, length, drive = made[id(o.swimmer)]
            value = observe.observed(gait, o.quantity, o.phase, body_length=length, drive=drive)
            out.append(np.atleast_1d(value))
        return np.concatenate(out)

    def jacobian(self, values: np.ndarray) -> np.ndarray:
        """Return d predict / d values by the complex step."""
        columns = []
        for j in range(len(values)):
            stepped = [complex(v, STEP * (i == j)) for i, v in enumerate(values)]
            columns.append(derivative_from(self.predict(stepped)))
        return np.stack(columns, axis=-1)

    def solve(self, start: dict, bounds: dict) -> np.ndarray:
        """Return values at the minimum."""
        own, names = self.swimmer.numbers, [u.name for u in self.unknowns]
        for what, given in (("start", start), ("bounds", bounds)):
            for name in given:
                checks.choice(f"name in {what}", name, names)
        for name, value in start.items():
            checks.number(f"start of {name}", value, "a finite number")
        first = np.array([start.get(u.name, u.value(own)) for u in self.unknowns], dtype=float)
        for name, pair in bounds.items():
            checks.numbers(f"bound {name}", pair, 2, "a lower and an upper number, LOW:HIGH")
        low, high = np.array([bounds.get(u.name, u.bounds) for u in self.unknowns], float).T
        for u, x, a, b in zip(self.unknowns, first, low, high):
            if not a < x < b:
                raise SpecError(f"start of {u.name}", float(x), f"between {a:g} and {b:g}")
        y, sigma = values_of(self.observations), sigmas_of(self.observations)
        to, back, slope = self._coordinates()
        limits = (np.full(len(first), -40.0), np.full(len(first), 40.0))
        limits = limits if self.positive else (low, high)

        def residuals(z: np.ndarray) -> np.ndarray:
            return (np.real(self.predict(back(z))) - y) / sigma

        def jacobian(z: np.ndarray) -> np.ndarray:
            return self.jacobian(back(z)) @ slope(z) / sigma[:, None]

        z = gauss_newton(residuals, jacobian, to(first))
        if np.any(z <= limits[0]) or np.any(z >= limits[1]):
            how: dict[str, Any] = {"jac": jacobian, "bounds": limits, "xtol": 1e-12}
            z = least_squares(residuals, to(first), ftol=1e-12, gtol=1e-12, **how).x
        return back(z)

    def _coordinates(self) -> tuple[Any, Any, Any]:
        """Maps values -> free coordinates, back, and d values / d coordinates.

        With `positive` a drag is ``exp z``, a coupling ``tanh z`` of the geometric mean of the two
        drags that it joins (those of the unknowns, else those of the swimmer).
        """
        if not self.positive:
            return np.asarray, np.asarray, lambda z: np.eye(len(z))
        couplings = [u.pair is not None for u in self.unknowns]

        def limit(values: Any, pair: tuple[int, int]) -> Any:
            whole = lift(self.swimmer, self.unknowns, values).interaction
            drags = (*whole.translation, *whole.rotation)
            return np.sqrt(drags[pair[0]] * drags[3 + pair[1]] + 0j)

        def back(z: Any) -> np.ndarray:
            z = np.asarray(z)
            values = np.where(couplings, 0.0 * z, np.exp(np.where(couplings, 0.0, z)))
            full = values.astype(complex)
            for i, u in enumerate(self.unknowns):
                if u.pair is not None:
                    full[i] = np.tanh(z[i]) * limit(values, u.pair)
            return full if np.iscomplexobj(z) else np.real(full)

        def to(values: Any) -> np.ndarray:
            values = np.asarray(values, dtype=float)
            out = np.log(np.where(couplings, 1.0, np.maximum(values, 1e-12)))
            for i, u in enumerate(self.unknowns):
                if u.pair is not None:
                    share = values[i] / limit(values, u.pair).real
                    out[i] = np.arctanh(np.clip(share, -0.999, 0.999))
            return out

        def slope(z: Any) -> np.ndarray:
            eye = np.eye(len(z)) * 1j * STEP
            return np.stack([derivative_from(back(z + e)) for e in eye], axis=-1)

        return to, back, slope

    def outcome(self, values: np.ndarray) -> CoefficientCalibration:
        """Return everything there is to say about the solution."""
        sigma = sigmas_of(self.observations)
        J = self.jacobian(values) / sigma[:, None]
        directions, covariance = determined(J, values, [u.name for u in self.unknowns])
        fitted = fitted_swimmer(self.swimmer, self.unknowns, values)
        return CoefficientCalibration(
            swimmer=fitted,
            names=tuple(u.name for u in self.unknowns),
            values=values,
            covariance=covariance,
            observations=self.observations,
            predicted=np.real(self.predict(values)),
            directions=directions,
            warnings=physical_warnings(fitted, directions),
        )


def lift(swimmer: Swimmer, unknowns: Iterable[Unknown], values: Iterable[Any]) -> Swimmer:
    """Return the swimmer whose unknown numbers are replaced, unchecked."""
    changes = {p: f * v for u, v in zip(unknowns, values) for p, f in u.paths}
    return lifted(swimmer, changes)


def fitted_swimmer(swimmer: Swimmer, unknowns: Iterable[Unknown], values: Any) -> Swimmer:
    """Return the swimmer with the fitted numbers, checked."""
    return lift(swimmer, unknowns, [float(v) for v in values]).with_({})


def _ratios(swimmer: Swimmer, reference: Any) -> CoefficientCalibration:
    """Direct ratios of the body's force to its velocity [Tabak Section 3.2.1].

    ``gamma_i = |F_b,i| / (|V_i| D_i)``: means along and about s (for a helix), amplitudes for the
    directions whose mean is zero.
    """
    if not isinstance(reference, Gait):
        raise SpecError("method", "ratios", "used with a reference gait, which holds the forces")
    unknowns = resolve(swimmer, ())
    wrench = series_of(reference.body_wrench(2.0 * np.pi * np.arange(64) / 64))
    drag = swimmer.body.diagonal(swimmer.fluid.viscosity)
    values = []
    for u in unknowns:
        i = u.direction
        whole = i == 0 or (i == 3 and swimmer.tail.is_rigid)
        force = -wrench[0, i] if whole else half_range(wrench[:, i])
        velocity = (reference.mean_velocity if whole else reference.velocity_amplitude)[i]
        values.append(force / velocity / drag[i])
    problem = _Problem(swimmer, _observations(swimmer, reference, ()), unknowns, False)
    found = replace(problem.outcome(np.array(values)), method="ratios")
    why = refusal(found.swimmer)
    if why:
        raise SpecError(f'method = "ratios": no model takes its coefficients: {why}; fit them')
    return found
