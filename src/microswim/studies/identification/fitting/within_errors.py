"""Designs that the error of the model does not tell apart: an interval may reach over all of them.

Around a fit the errors of the velocities move the values in proportion; large errors do more. Of a
planar beat the track shows u_s, u_q and w_r as far as its noise lets it, and the model foretells
those of every design of the grid as far as its errors *there* let it. With y and C the logarithms
of the first and their covariance, L and S those of the second,

    chi^2(design) = (y - L)' (C + S)^-1 (y - L)

and a value reaches over every design that, all else free, lies no more than ``t^2`` behind the
best: the deviations of the model are fitted as well, each at the cost that its error says. Small
errors leave those that hang together with the design of the fit: between others the shape of the
path decides. Large ones change that shape as well.
"""

from __future__ import annotations

import warnings
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.ndimage import label
from scipy.optimize import least_squares
from scipy.special import ndtri

from microswim.errors import MicroswimError
from microswim.gait.gait import Gait
from microswim.studies.identification.fitting.first_guesses import (
    AMPLITUDE,
    WAVES,
    Grid,
    minima,
    shown,
)
from microswim.studies.identification.fitting.honesty import model_errors
from microswim.studies.identification.fitting.problem import PathProblem
from microswim.swimmer.fields import lifted

LARGE = 0.2  #: error of a velocity from which on the shape of a path tells no design from others
SHOWN = (0, 1, 5)  #: us, uq and or
T = float(ndtri(0.975))
FINER = 4  #: designs between two of the grid
COARSER = (4, 5)  #: steps of the grid between designs whose errors are asked for
ALL = 1.22  #: times the error within which one lies in 19 of 20: so all three of them do
LEAST = 0.05  #: share of a velocity of the model that is left of it at the least
LATER = (1, 5)  #: uq and or, whose phases may be off too
AS_WELL = 25.0  #: chi-squared that a design may lie behind the best and be looked at
MOST = 12  #: designs that are looked at
APART = (0.1, 0.15)  #: logarithm of the amplitude and waves, within which two starts are one
LOOSE = 2.0  #: deviation of the logarithms and phases that are looked for
PHASES = 32


def reach(
    problem: PathProblem, grid: Grid | None, done: Any, spread: float, errors: np.ndarray
) -> dict[str, tuple[float, float]]:
    """Return how far down and up amplitude and number of waves reach, empty where it is not known.

    Parameters
    ----------
    problem
        Whose track it is: of a planar beat in the image.
    grid
        Of the designs; both amplitude and waves are unknown.
    done
        What least squares found.
    spread
        Size of the noise in units of the residuals.
    errors
        Relative errors to expect of the six velocities there.
    """
    if grid is None or not both(problem):
        return {}
    b, n, behind = _over(problem, grid, done, spread, errors)
    here = shape_of(problem, done)
    alike = behind <= T**2
    i, j = int(np.argmin(np.abs(np.log(b / here[0])))), int(np.argmin(np.abs(n - here[1])))
    alike[i, j] = True
    if errors[list(SHOWN)].max() < LARGE:
        islands: Any = label(alike, structure=np.ones((3, 3)))
        alike = islands[0] == islands[0][i, j]
    rows, columns = np.nonzero(alike)
    if rows.size == 1:  # that of the fit alone, and its own curvature knows better than a cell
        return {}
    return {AMPLITUDE: _ends(b, rows), WAVES: _ends(n, columns)}


def starts(
    problem: PathProblem, grid: Grid, done: Any, spread: float, errors: np.ndarray,
    tried: list[tuple[float, float]],
) -> list[Any]:  # fmt: skip
    """Return the designs that the errors of the model leave, the likeliest first: a fit starts at
    each lowest place of chi-squared, however far from the one that fits. What the track tells of
    the velocities is a straight line from there, so those a good deal behind are looked at too, but
    none where a fit was tried or ended: amplitudes and waves, which those looked at are added to.
    Where the errors are large the interval of one reaches over all of them, see `reach`.
    """
    if errors[list(SHOWN)].max() >= LARGE:
        return []
    b, n, behind = _over(problem, grid, done, spread, errors)
    own, found = {name: float(done.x[i]) for i, name in enumerate(problem.names)}, []
    for i, j in minima(behind):
        one = (float(b[i]), float(n[j]))
        if behind[i, j] > AS_WELL or len(found) == MOST:
            break
        if not any(_one(one, other) for other in tried):
            tried.append(one)
            found.append(own | dict(zip((AMPLITUDE, WAVES), one)))
    return found


def inside(grid: Grid, design: tuple[float, float]) -> bool:
    """Return whether amplitude and waves lie in the range of a grid: a fit may run out of it."""
    b, n = grid.amplitude, grid.waves
    return bool(b[0] <= design[0] <= b[-1] and n[0] <= design[1] <= n[-1])


def _one(design: tuple[float, float], other: tuple[float, float]) -> bool:
    """Whether two designs, amplitude and waves, lead least squares to one."""
    b = abs(float(np.log(max(design[0], 1e-300) / max(other[0], 1e-300))))
    return b < APART[0] and abs(design[1] - other[1]) < APART[1]


def both(problem: PathProblem) -> bool:
    """Return whether it is a planar beat in the image whose amplitude and waves are looked for."""
    return problem.planar and {AMPLITUDE, WAVES} <= set(problem.names)


def shape_of(problem: PathProblem, done: Any) -> tuple[float, float]:
    """Return amplitude and number of waves of a fit."""
    b, n = (float(done.x[problem.names.index(name)]) for name in (AMPLITUDE, WAVES))
    return b, n


def _over(
    problem: PathProblem, grid: Grid, done: Any, spread: float, errors: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Amplitudes, waves and chi-squared behind the best over the grid, finely; the errors are those
    at the fit where nobody knows them at the grid's designs, as of beats without their bend.
    """
    b, n, velocities, off = finely(grid)
    off = np.where(np.isfinite(off), off, errors[list(SHOWN), None, None])
    seen, precision = _seen(problem, done, spread)
    here = np.array(shape_of(problem, done))
    own = shown(grid.swimmer, {AMPLITUDE: here[:1], WAVES: here[1:]})
    wanted = np.log(np.abs([own[4][0], own[1][0], own[2][0]])) + seen
    miss = velocities - wanted[:, None, None]
    return b, n, _behind(miss, _deviations(miss, off), precision)


def _deviations(miss: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Deviations of the logarithms by relative errors: a truth ``1 - e`` of the model lies farther
    off than one of ``1 + e``.
    """
    less = -np.log(np.maximum(1.0 - off, LEAST))
    return ALL / T * np.where(miss > 0, less, np.log1p(off))


def _behind(miss: np.ndarray, off: np.ndarray, precision: np.ndarray) -> np.ndarray:
    """Chi-squared behind the best of designs that miss the velocities, (3, i, j), with deviations
    `off`; ``(C + S)^-1 = P (1 + S P)^-1`` with the precision ``P = C^-1``, which may be singular.
    """
    d, S = miss.reshape(3, -1).T, off.reshape(3, -1).T ** 2
    known = np.isfinite(d).all(axis=1)
    d, S = d[known], S[known]
    left = np.linalg.solve(np.eye(3) + S[:, :, None] * precision, d[:, :, None])[:, :, 0]
    found = np.full(known.size, np.inf)
    found[known] = np.einsum("ni,ij,nj->n", d, precision, left)
    return (found - found.min()).reshape(miss.shape[1:])


def _seen(problem: PathProblem, done: Any, spread: float) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of the track's velocities over those of a fit, and the precision of that.

    Least squares of the path with the velocities of the fit larger and, across, later by what fits;
    frequency, phase and pose beside them, amplitude and waves as they are.
    """
    names, n = problem.names, len(problem.names)
    beside = [i for i, name in enumerate(names) if name not in (AMPLITUDE, WAVES)]
    beside += range(n, len(done.x))
    gait, count = problem.gait(done.x[:n]), len(SHOWN) + len(LATER)
    size = np.maximum(np.linalg.norm(problem.jacobian(done.x)[:, beside], axis=0), 1e-12) / spread

    def residuals(a: np.ndarray) -> np.ndarray:
        z = done.x.copy()
        z[beside] += a[count:] / size
        moved = _moved(gait.at_rate(problem.gait(z[:n]).rate), a[:count])
        return np.concatenate([problem.residuals_of(moved, z) / spread, a[:count] / LOOSE])

    start = np.zeros(count + len(beside))
    found = least_squares(residuals, start, x_scale="jac", max_nfev=30, ftol=1e-6, xtol=1e-4)
    J, k = found.jac[: done.fun.size], len(SHOWN)
    Q = np.linalg.qr(J[:, k:])[0]
    D = J[:, :k] - Q @ (Q.T @ J[:, :k])
    return found.x[:k], D.T @ D


def _moved(gait: Gait, a: np.ndarray) -> Gait:
    """A gait whose velocities are larger, by logarithms, and later, by phases (rad); R is one."""
    turned = np.fft.rfft(gait.velocity(2.0 * np.pi * np.arange(PHASES) / PHASES), axis=0)
    h, k = np.arange(len(turned)), len(SHOWN)
    turned[:, list(SHOWN)] *= np.exp(a[:k])
    turned[:, list(LATER)] *= np.exp(-1j * h[:, None] * a[k:])
    V = np.fft.irfft(turned, PHASES, axis=0)
    free: dict[str, Any] = {"rate": gait.rate, "free": gait.free, "units": gait.units}
    whole = np.broadcast_to(np.eye(6), (PHASES, 6, 6))
    return Gait.from_samples(whole, -V / gait.rate, np.ones(PHASES), model=gait.model, **free)


@lru_cache(maxsize=4)
def finely(grid: Grid) -> tuple[np.ndarray, ...]:
    """Return a grid with designs between its own: amplitudes, waves, logarithms of the velocities
    and the relative errors to expect of the model, each (3, amplitudes, waves).
    """
    x, n = np.log(grid.amplitude), grid.waves
    own = np.array([grid.axial, grid.wobble, grid.turn]).reshape(3, x.size, n.size)
    with np.errstate(divide="ignore", invalid="ignore"):
        own = np.log(np.abs(own))
    own[~np.isfinite(own)] = np.nan
    rows, columns = (np.unique([*range(0, v.size, k), v.size - 1]) for v, k in zip((x, n), COARSER))
    off = np.array([[_expected(grid, float(x[i]), float(n[j])) for j in columns] for i in rows])
    most = np.max(off, axis=(0, 1), initial=0.0, where=np.isfinite(off))
    if np.isfinite(off).any():
        off = np.where(np.isfinite(off), off, most)
    fine = [np.interp(np.arange(FINER * (v.size - 1) + 1) / FINER, np.arange(v.size), v)
            for v in (x, n)]  # fmt: skip
    places = np.stack(np.meshgrid(*fine, indexing="ij"), axis=-1)
    velocities = RegularGridInterpolator((x, n), np.moveaxis(own, 0, -1))(places)
    errors = np.expm1(RegularGridInterpolator((x[rows], n[columns]), np.log1p(off))(places))
    return np.exp(fine[0]), fine[1], *(np.moveaxis(v, -1, 0) for v in (velocities, errors))


def _expected(grid: Grid, log_amplitude: float, waves: float) -> np.ndarray:
    """Errors to expect of u_s, u_q and w_r at a design, NaN where they are not known."""
    one = lifted(grid.swimmer, {AMPLITUDE: float(np.exp(log_amplitude)), WAVES: float(waves)})
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of laws beyond their range: that is in the errors
            found = model_errors(one.with_({}).gait("auto"))
    except (MicroswimError, np.linalg.LinAlgError, ValueError):
        found = None
    return np.full(3, np.nan) if found is None else found[list(SHOWN)]


def _ends(values: np.ndarray, of: np.ndarray) -> tuple[float, float]:
    """Values of the grid just beyond those that are alike."""
    low, high = max(int(of.min()) - 1, 0), min(int(of.max()) + 1, values.size - 1)
    return float(values[low]), float(values[high])
