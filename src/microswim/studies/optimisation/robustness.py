"""What manufacture and ignorance do to a design: yield and Sobol indices.

Numbers of the spec are uncertain: each made robot differs a little, and viscosity or interaction
coefficients are not known better. Many samples on the batched kernel answer.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from scipy.stats import norm, qmc

from microswim import checks
from microswim.calibration.atlas.everywhere import holding
from microswim.errors import MicroswimError, SpecError
from microswim.numerics.array import sealed
from microswim.studies.optimisation.expressions import constraints, parse
from microswim.studies.optimisation.limits import in_si, with_units
from microswim.studies.optimisation.merits import MERITS, known, of_many
from microswim.swimmer.fields import both_of_the_wave
from microswim.swimmer.geometry.tails.kinds import WaveTail
from microswim.swimmer.swimmer import Swimmer
from microswim.swimmer.variants import check_names

if TYPE_CHECKING:
    import xarray as xr

SIGMAS = 3.0  # normal deviations are cut there


@dataclass(frozen=True)
class Uncertainty:
    """Spread of one number.

    Parameters
    ----------
    low, high
        For a uniform spread, the bounds; for a normal one the relative standard deviation twice.
    relative
        Whether it is normal and relative to the nominal value.
    """

    low: float
    high: float
    relative: bool

    def sample(self, u: np.ndarray, nominal: Any) -> Any:
        """Return values for u uniform in (0, 1)."""
        if not self.relative:
            return self.low + (self.high - self.low) * u
        tail = norm.cdf(-SIGMAS)
        return nominal * (1.0 + self.low * norm.ppf(tail + (1.0 - 2.0 * tail) * u))


def uncertainties(swimmer: Swimmer, uncertain: Mapping[str, Any]) -> dict[str, Uncertainty]:
    """Return the spread that a user means: ``0.05`` or ``"5%"`` (normal, relative), or ``(low,
    high)``.

    Raises
    ------
    SpecError
        If a name is no number of the swimmer or a spread makes no sense.
    """
    check_names(swimmer, uncertain)
    out = {}
    for name, spread in uncertain.items():
        if isinstance(spread, tuple) and len(spread) == 2 and spread[0] < spread[1]:
            out[name] = Uncertainty(float(spread[0]), float(spread[1]), False)
            continue
        try:
            text = str(spread).strip()
            part = float(text[:-1]) / 100.0 if text.endswith("%") else float(text)
        except ValueError:
            part = -1.0
        if not 0.0 < part < 1.0 / SIGMAS:
            allowed = 'a relative spread such as "5%" (below 33 %), or (low, high)'
            raise SpecError(f"uncertain {name}", spread, allowed)
        out[name] = Uncertainty(part, part, True)
    if not out:
        raise SpecError("uncertain", "{}", "at least one number with its spread")
    return out


def _spread(
    swimmer: Swimmer, spreads: Mapping[str, Uncertainty], u: np.ndarray
) -> dict[str, np.ndarray]:
    numbers = spec_numbers(swimmer)
    return {
        name: np.asarray(s.sample(u[:, i], numbers[name]), dtype=float)
        for i, (name, s) in enumerate(spreads.items())
    }


def spec_numbers(swimmer: Swimmer) -> dict[str, float]:
    """Return numbers of the spec, both of waves and wavelength."""
    both = both_of_the_wave(swimmer.tail) if isinstance(swimmer.tail, WaveTail) else {}
    return both | dict(swimmer.numbers)


@checks.given(
    swimmer=checks.swimmer,
    uncertain=checks.mapping,
    subject_to=checks.words,
    model=checks.one_of("auto", "rft", "atlas"),
    samples=checks.at_least(1),
    seed=checks.at_least(0),
)
def robustness(
    swimmer: Swimmer,
    uncertain: Mapping[str, Any],
    *,
    subject_to: Any = "",
    model: Literal["auto", "rft", "atlas"] = "auto",
    samples: int = 4096,
    seed: int = 0,
) -> xr.Dataset:
    """Return merits of robots that differ from the design by chance.

    Parameters
    ----------
    swimmer
        The design.
    uncertain
        Dotted name to relative standard deviation (``0.05``, ``"5%"``; normal, cut at three
        deviations) or to ``(low, high)`` (uniform).
    subject_to
        Constraints that a robot must meet to be good.
    model
        ``"auto"``: the atlas where it holds for all of them, else ``"rft"``.
    samples, seed
        Size and seed of the Sobol sample.

    Returns
    -------
    xarray.Dataset
        Every merit and every uncertain number over ``sample``, ``good``; attributes ``yield``
        (fraction of good robots), ``yield_error`` (its standard error), ``subject_to``.

    Raises
    ------
    SpecError
        If a name or an expression makes no sense.

    Examples
    --------
    >>> import microswim as ms
    >>> made = ms.robustness(
    ...     ms.Swimmer.preset("tabak/helix"),
    ...     {"tail.amplitude": "5%"},
    ...     subject_to="swimming_speed >= 0.03",
    ... )
    >>> 0.5 < made.attrs["yield"] <= 1.0
    True
    """
    import xarray as xr

    spreads = uncertainties(swimmer, uncertain)
    text = subject_to if isinstance(subject_to, str) else ", ".join(subject_to)
    limits = constraints(in_si(text, swimmer), known(swimmer))
    u = sobol_points(len(spreads), samples, seed)
    numbers = _spread(swimmer, spreads, u)
    merits = of_many(_by(model, swimmer, numbers), numbers)
    good = np.isfinite(merits["swimming_speed"])
    for limit in limits:
        good = good & (np.nan_to_num(limit.margin(merits), nan=-1.0) >= 0.0)
    share = float(good.mean())
    data = {name: ("sample", merits[name]) for name in MERITS if name in merits}
    data["good"] = ("sample", good)
    about = {
        "yield": share,
        "yield_error": float(np.sqrt(share * (1.0 - share) / len(good))),
        "subject_to": text,
    }
    varied = {name: ("sample", v) for name, v in numbers.items()}
    return sealed(with_units(xr.Dataset(data, varied, about), swimmer.units))


def _by(model: str, swimmer: Swimmer, numbers: Mapping[str, Any]) -> Swimmer:
    return swimmer if model == "rft" else holding(swimmer, numbers)


def sobol_points(d: int, samples: int, seed: int) -> np.ndarray:
    """Return at least `samples` points of a scrambled Sobol sequence in the open unit cube."""
    n = 1 << (max(2, int(samples)) - 1).bit_length()
    return np.clip(qmc.Sobol(d, rng=np.random.default_rng(seed)).random(n), 1e-12, 1 - 1e-12)


@checks.given(
    swimmer=checks.swimmer,
    uncertain=checks.mapping,
    merit=checks.text,
    model=checks.one_of("auto", "rft", "atlas"),
    samples=checks.at_least(1),
    seed=checks.at_least(0),
)
def sobol_indices(
    swimmer: Swimmer,
    uncertain: Mapping[str, Any],
    merit: str = "swimming_speed",
    *,
    model: Literal["auto", "rft", "atlas"] = "auto",
    samples: int = 1024,
    seed: int = 0,
) -> xr.Dataset:
    """Return which uncertain number is to blame for the spread of a merit, and by how much.

    Parameters
    ----------
    swimmer, uncertain, model
        As in `robustness`.
    merit
        A merit or an expression.
    samples, seed
        Of Saltelli's scheme: ``samples (d + 2)`` designs.

    Returns
    -------
    xarray.Dataset
        Over ``name``: ``first`` (share of the variance that this number alone makes), ``total``
        (with all its interactions), and their 95 % half-widths ``first_error``, ``total_error``.

    Raises
    ------
    SpecError
        If some samples are no swimmers: indices need them all.
    MicroswimError
        If SALib is not installed.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> spread = {"tail.amplitude": "5%", "tail.radius": "5%"}
    >>> blame = ms.sobol_indices(swimmer, spread, samples=64)
    >>> bool(blame.total.sel(name="tail.amplitude") > blame.total.sel(name="tail.radius"))
    True
    """
    import xarray as xr

    try:
        from SALib.analyze import sobol
        from SALib.sample import sobol as sampling
    except ModuleNotFoundError:
        raise MicroswimError(
            'SALib is not installed; install it with: pip install "microswim[design]"'
        ) from None
    spreads = uncertainties(swimmer, uncertain)
    expression = parse(merit, known(swimmer))
    space = {
        "num_vars": len(spreads),
        "names": list(spreads),
        "bounds": [[1e-9, 1.0 - 1e-9]] * len(spreads),
    }
    u = sampling.sample(space, samples, calc_second_order=False, seed=seed)
    numbers = _spread(swimmer, spreads, u)
    merits = of_many(_by(model, swimmer, numbers), numbers)
    values = np.asarray(expression(merits), dtype=float)
    if not np.all(np.isfinite(values)):
        raise SpecError("uncertain: some samples are no swimmers; tighten the spreads")
    found = sobol.analyze(space, values, calc_second_order=False, seed=seed)
    keys = {"first": "S1", "total": "ST", "first_error": "S1_conf", "total_error": "ST_conf"}
    return sealed(
        xr.Dataset(
            {name: ("name", np.asarray(found[key])) for name, key in keys.items()},
            {"name": list(spreads)},
            {"merit": merit, "variance": float(np.var(values)), "mean": float(np.mean(values))},
        )
    )
