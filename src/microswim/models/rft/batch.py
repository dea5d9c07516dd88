"""Many designs at once: the surrogate over arrays of numbers of the spec, on all cores.

A rigid helix on a body of revolution looks the same at each phase but for a rotation, so one phase
tells all; a plane wave is sampled over half a period, the other half being its mirror image.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import MicroswimError, SpecError
from microswim.gait import quantities
from microswim.models.rft.batch_numbers import (
    OUTPUTS,
    blank,
    of_helices,
    share_of,
)
from microswim.models.rft.batch_of_waves import (
    MARGIN,
    loops_for,
    of_waves,
    shapes,
    solved_waves,
    wave_nodes,
)
from microswim.models.rft.gait import parameters
from microswim.models.rft.helix import FEWEST_WAVES, MOST_ON_RAMP, ramp_nodes
from microswim.models.rft.segment import (
    AMPLITUDE,
    C_N,
    C_T,
    HELIX,
    LENGTH,
    MOST_NODES,
    PARAMETERS,
    RAMP,
    STEEPEST,
    WAVENUMBER,
    node_numbers,
    wave_tail,
)
from microswim.numerics.compiling.compiled import pays, settled
from microswim.numerics.quadrature import panels
from microswim.numerics.solve6 import solve
from microswim.swimmer.fields import in_terms_of, lifted
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.swimmer import Swimmer

CHUNK = 8192
ONE_GAIT = 3e-3  #: seconds of a gait and its numbers as Python
SECONDS = {
    "helix": 3e-5,
    "plane_wave": 2e-4,
    "custom": 2e-2,
    "elastic": 3e-2,
}  #: of a design as Python


@checks.given(swimmer=checks.swimmer, values=checks.mapping)
def evaluate(swimmer: Swimmer, values: dict[str, Any], tolerance: float = 1e-8) -> dict[str, Any]:
    """Return the surrogate results for n designs that differ in some numbers of the spec.

    Parameters
    ----------
    swimmer
        What the designs have in common.
    values
        Dotted names of numbers of the spec to arrays of shape (n,).
    tolerance
        Relative accuracy of the quadrature, 1e-12 to 1e-3.

    Returns
    -------
    dict
        ``mean_velocity`` (n, 6), ``velocity_amplitude`` (n, 6), ``swimming_speed``,
        ``mean_power``, ``mean_torque``, ``efficiency`` (n,), as `summary` has them, to the
        tolerance; NaN where a design is out of range, touches itself, is beyond the law of its
        coefficients or too steep to be resolved.

    Raises
    ------
    SpecError
        If the tolerance is out of range, or a name is no number of the swimmer.

    Notes
    -----
    Some thousands of designs run compiled, fewer as Python; `microswim.warm_up` chooses compiled
    code for both. Threads of Python take turns. A process that is forked after a batch has run on
    all cores works on one core, with the same numbers.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> result = ms.evaluate(swimmer, {"tail.amplitude": np.linspace(0.05, 0.15, 5)})
    >>> result["mean_velocity"].shape
    (5, 6)
    """
    checks.number("tolerance", tolerance, "from 1e-12 to 1e-3", least=1e-12, most=1e-3)
    arrays = {k: checks.reals(k, v).reshape(-1) for k, v in values.items()}
    n = max((a.size for a in arrays.values()), default=1)
    for name, array in arrays.items():
        if not array.size:
            raise SpecError(f"values {name}", "no values", "one value or more")
        if array.size not in (1, n):
            raise SpecError(
                f"values {name}", f"{array.size} values", f"one value, or {n} as others"
            )
    if swimmer.region is not None:
        _check_heeded(arrays)
    swimmer = in_terms_of(swimmer, arrays)
    seconds = as_python(swimmer, n)
    out = blank(n)
    for i in range(0, n, CHUNK):
        some = {k: v[i : i + CHUNK] for k, v in arrays.items()}
        there = {name: values[i : i + CHUNK] for name, values in out.items()}
        _fill(there, swimmer, some, tolerance, seconds)
    return out


def _check_heeded(names: Any) -> None:
    for name in names:
        if name.startswith(("interaction.", "coefficients.")):
            raise SpecError(
                f"{name}: corrections over a region do not heed it; leave out [region], or this"
            )


def as_python(swimmer: Swimmer, designs: int) -> float:
    """Return how many seconds so many designs take as Python, side by side."""
    return designs * SECONDS[swimmer.tail.kind if swimmer.tail.in_batches else "custom"]


def expected_errors(swimmer: Swimmer, values: dict[str, Any]) -> np.ndarray:
    """Return expected relative error of the mean forward velocity (n,) of a calibrated surrogate.

    NaN outside its region. It costs more than the evaluation itself, so searches do without.
    """
    assert swimmer.region is not None
    arrays = {k: np.asarray(v, dtype=float).reshape(-1) for k, v in values.items()}
    many = lifted(in_terms_of(swimmer, arrays), arrays)
    return swimmer.region.expected_of_many(many, max(a.size for a in arrays.values()))


def _fill(
    out: dict[str, Any],
    swimmer: Swimmer,
    arrays: dict[str, Any],
    tolerance: float,
    seconds: float,
) -> None:
    """Fill in the results of a chunk of designs."""
    n = max((a.size for a in arrays.values()), default=1)
    if not is_regular(swimmer, arrays):
        _one_by_one(out, swimmer, arrays)
        return
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        many = lifted(swimmer, arrays)
        own = parameters if swimmer.region is None else swimmer.region.parameters
        with settled(swimmer.region is None and pays(seconds)):
            p = np.ascontiguousarray(np.broadcast_to(own(many), (n, PARAMETERS)))
        isolated = many.body.diagonal(many.fluid.viscosity)
        drag = np.stack(np.broadcast_arrays(*many.interaction.scaled(isolated)), axis=-1)
        drag = np.ascontiguousarray(np.broadcast_to(drag, (n, 6)))
        good = _buildable(many, p) & np.isfinite(drag @ np.ones(6))
        rate = np.broadcast_to(many.tail.rate, (n,))
    if swimmer.region is not None:
        good &= wave_nodes(p).sum(axis=1) <= MOST_NODES
        _calibrated(out, swimmer, arrays, p, good, rate, seconds)
        return
    if swimmer.tail.is_planar:
        good &= (shapes(p)[1] <= STEEPEST) & (wave_nodes(p).sum(axis=1) <= MOST_NODES)
    if swimmer.tail.is_rigid:
        good &= np.sum(node_numbers.written(HELIX, *shapes(p)), axis=0) <= MOST_NODES
        how = tolerance, loops_for(seconds)
        twists = _solved_helices(swimmer, p, drag, good, *how)
        of_helices(out, swimmer, *twists, drag, rate)
        return

    def solved(rows: np.ndarray, phase: np.ndarray) -> tuple[Any, Any]:
        return solved_waves(swimmer, p[rows], drag[rows], phase, tolerance, seconds)

    of_waves(out, solved, shapes(p)[1], good, drag, rate, seconds)


def _solved_helices(
    swimmer: Swimmer, p: Any, drag: Any, good: Any, tolerance: float, loops: Any
) -> tuple[Any, Any]:
    """Twists (n, 1, 6) and tail powers (n, 1) of helices at phase 0."""
    arc, free = swimmer.motion.line_element == "arc", np.array(swimmer.motion.mask)
    waves, bk, ramp = shapes(p)
    counts = _ramp_counts(waves, bk, ramp, min(12.0, MARGIN - np.log10(tolerance)), good)
    V, power = loops.solve_helices(arc, p, drag, free, counts)
    for i in np.flatnonzero(good & (counts < 0)):
        rules = node_numbers(HELIX, waves[i], bk[i], ramp[i])
        R, F, G = wave_tail(HELIX, arc, p[i], 0.0, *map(panels, rules))
        V[i] = -F
        solve(R + np.diag(drag[i]), V[i], free)
        power[i] = G + F @ V[i]
    return V[:, None], power[:, None]


def _ramp_counts(waves: Any, bk: Any, ramp: Any, digits: float, good: Any) -> np.ndarray:
    """Nodes on the ramp; negative for designs that are not good or not for closed integrals."""
    needed = ramp_nodes.written(waves * ramp, bk, digits)
    good = good & (waves >= FEWEST_WAVES) & (needed <= MOST_ON_RAMP)
    return np.where(good, needed, -1).astype(np.int64)


def _calibrated(
    out: dict[str, Any],
    swimmer: Swimmer,
    arrays: dict,
    p: Any,
    good: np.ndarray,
    rate: Any,
    seconds: float,
) -> None:
    """Fill in the results of a surrogate that carries a region calibration."""
    region, free, n = swimmer.region, np.array(swimmer.motion.mask), len(good)
    assert region is not None

    def solved(rows: np.ndarray, phase: np.ndarray) -> Any:
        picked = {k: v[rows] if v.size > 1 else v for k, v in arrays.items()}
        first = 1 if phase[0] > 0.0 else 0  # those in between stand at odd places
        every = region.solve(lifted(swimmer, picked), free, phase.size << first)
        return [x[:, first :: 1 + first] for x in every]

    if not swimmer.tail.is_rigid:
        of_waves(out, solved, shapes(p)[1], good, None, rate, seconds)
        return
    V, power, work = np.full((n, 1, 6), np.nan), *np.full((2, n, 1), np.nan)
    if good.any():
        V[good], power[good], work[good] = solved(np.flatnonzero(good), np.zeros(1))
    of_helices(out, swimmer, V, power, np.zeros((n, 6)), rate)
    out["efficiency"][:] = share_of(work[:, 0], power[:, 0])


def is_regular(swimmer: Swimmer, arrays: dict[str, Any]) -> bool:
    """Return whether the symmetries hold on which the batched evaluation rests."""
    if not swimmer.tail.in_batches or swimmer.interaction.is_coupled:
        return False
    if not swimmer.body.is_balanced:
        return False
    if any("coupling" in name for name in arrays) or _may_gain(swimmer, arrays):
        return False
    if swimmer.tail.is_planar:
        return True
    gamma, free = swimmer.interaction, swimmer.motion.mask
    varied = any("[1]" in k or "[2]" in k for k in arrays)
    round_body = swimmer.body.is_axisymmetric and (swimmer.body.of_revolution or not varied)
    alike = gamma.translation[1] == gamma.translation[2] and gamma.rotation[1] == gamma.rotation[2]
    sided = any(k.startswith("interaction.") and varied for k in arrays)
    return round_body and alike and not sided and free[1] == free[2] and free[4] == free[5]


def _may_gain(swimmer: Swimmer, arrays: dict[str, Any]) -> bool:
    """Whether a rotation coefficient below zero may make a swimmer that gains power."""
    own = list(swimmer.interaction.rotation)
    own += [v for k, v in arrays.items() if k.startswith("interaction.rotation")]
    return any(np.min(np.real(v)) < 0.0 for v in own)


def _buildable(many: Swimmer, p: np.ndarray) -> np.ndarray:
    """Designs that make sense; the others stay NaN."""
    tail, numbers = as_wave(many.tail), many.numbers
    good = np.isfinite(p @ np.ones(PARAMETERS)) & (p[:, AMPLITUDE] >= 0)
    for i in (LENGTH, WAVENUMBER, C_T, C_N):
        good &= p[:, i] > 0
    good &= (np.asarray(tail.radius) > 0) & (tail.radius < tail.room())
    good &= (p[:, RAMP] >= 0) & (p[:, RAMP] <= 1) & (np.asarray(many.fluid.viscosity) > 0)
    for name, value in numbers.items():
        if name.startswith(("body.", "interaction.tail")):
            good &= np.asarray(value) > 0
        elif name.startswith("interaction.translation"):
            good &= np.asarray(value) >= 0
    return good


def _one_by_one(out: dict[str, Any], swimmer: Swimmer, arrays: dict[str, Any]) -> None:
    """Fill in designs without the symmetries: each by its own gait."""
    n = len(out["efficiency"])
    with settled(pays(n * ONE_GAIT)), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for i in range(n):
            values = {k: float(v[i if v.size > 1 else 0]) for k, v in arrays.items()}
            try:
                made = quantities.numbers(swimmer.with_(values).gait(), names=OUTPUTS)
            except MicroswimError:
                continue
            for name in OUTPUTS:
                out[name][i] = made[name]
