"""An atlas made of solves: scales, Gaussian processes, and what each answer misses, left out."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from microswim import __version__
from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.atlas import Atlas
from microswim.calibration.atlas.near import measured
from microswim.calibration.atlas.side_by_side import rebuilt
from microswim.calibration.region import kriging
from microswim.calibration.region.fit import Solved, one_thread, targets
from microswim.calibration.region.fit import groups_of as of_region
from microswim.calibration.region.positive_definite import REAL
from microswim.errors import SpecError
from microswim.models.rft.gait import gait as surrogate
from microswim.swimmer.drag.coefficients import Cox, GrayHancock, Lighthill
from microswim.swimmer.geometry.tails.kinds import as_wave

ENOUGH = 400  #: designs from which the kernels' lengths are found
LAWS = (Lighthill, GrayHancock, Cox)
TURNING = 4  #: torque, and the axial wrench that turns the body alone, come before it
#: Corrections whose size follows powers of the numbers, each with those of its direction.
SCALED = ((2,), (8,), (9,), (11,), (12,), *((j, j + 1) for j in range(REAL + 3, REAL + 15, 2)))


def groups_of(helix: bool) -> list[tuple[slice, bool, int]]:
    """Return columns that share a kernel: a region's, with what turns the body alone apart."""
    thrust, others, *lateral = of_region(helix)
    if not helix:
        return [thrust, others, *lateral]
    middle = slice(others[0].start, TURNING), slice(TURNING, others[0].stop)
    return [thrust, *((part, *others[1:]) for part in middle), *lateral]


def fit(solved: list[Solved], about: dict[str, Any], former: Atlas | None = None) -> Atlas:
    """Return the atlas of solved designs.

    former : an atlas whose kernels serve again; to find them takes minutes.
    """
    x = np.array([coordinates.numbers(s.swimmer) for s in solved]).T
    raw = coordinates.features(x).T
    centre, spread = raw.mean(axis=0), raw.std(axis=0)
    if former is not None:
        centre, spread = former.centre, former.spread
    Z, N, Y = (raw - centre) / spread, x[2], targets(solved)
    exponents = scales(x, Y) if former is None else former.exponents
    scale = np.exp(exponents @ coordinates.powers(x)).T
    sorted_groups = sorted(groups_of(solved[0].swimmer.tail.is_rigid), key=lambda g: g[0].start)
    with one_thread():
        groups = tuple(
            _group(Z, N, (Y / scale)[:, part], pairs, phasors, former and former.surfaces.groups[i])
            for i, (part, pairs, phasors) in enumerate(sorted_groups)
        )
        left = [kriging.interleaved(g.left_out()[0]) for g in groups]
    guess = Y - np.concatenate(left, axis=1) * scale
    truth = np.array([velocities(s.gait.resistance(0.0), s.gait.propulsion(0.0))
                      for s in solved])  # fmt: skip
    own = [velocities(*(x[0, 0] for x in rebuilt(s.swimmer, y)[:2])) for s, y in zip(solved, guess)]
    plain = {law.law: measured(Z, _missed(_surrogate(solved, law), truth, solved)) for law in LAWS}
    misses = measured(Z, _missed(np.array(own), truth, solved))
    about = {"solves": len(solved), "version": __version__, **about}
    surfaces = kriging.Surfaces(groups)
    return Atlas(surfaces, centre, spread, exponents, misses, plain, about)


def _group(
    Z: Any, N: Any, y: np.ndarray, pairs: bool, phasors: int, former: kriging.Kriging | None
) -> kriging.Kriging:
    """Return a group's process: kernel from some of the designs, weights from all."""
    y = y[:, ::2] + 1j * y[:, 1::2] if pairs else y
    some = slice(0, ENOUGH)
    kernel = former or kriging.fit(Z[some], N[some], y[some], phasors)
    return kriging.conditioned(Z, N, y, kernel.lengths, kernel.phasors, float(kernel.noise))


def scales(x: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Return powers of the corrections' sizes (corrections, 6), by least absolute deviations."""
    P, out = coordinates.powers(x).T, np.zeros((Y.shape[1], 6))
    for columns in SCALED:
        size = np.sqrt(np.sum(Y[:, columns] ** 2, axis=1))
        if not np.any(size):
            continue
        log = np.log(np.maximum(size, 1e-9 * np.mean(size)))
        power = np.linalg.lstsq(P, log, rcond=None)[0]
        for _ in range(30):
            weight = 1.0 / np.maximum(np.abs(log - P @ power), 0.05)
            power = np.linalg.solve((P.T * weight) @ P, (P.T * weight) @ log)
        out[list(columns)] = power
    return out


def velocities(R: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Return u_s, lateral |u|, Omega_s, lateral |Omega| at unit phase rate, free in all."""
    V = -np.linalg.solve(R, F)
    return np.array([V[0], np.hypot(V[1], V[2]), V[3], np.hypot(V[4], V[5])])


def _surrogate(solved: list[Solved], law: Any) -> np.ndarray:
    """Return velocities by plain resistive force theory with a law; NaN where it does not hold."""
    out = np.full((len(solved), 4), np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for i, s in enumerate(solved):
            try:
                made = surrogate(replace(s.swimmer, coefficients=law()))
            except SpecError:
                continue
            out[i] = velocities(made.resistance(0.0), made.propulsion(0.0))
    return out


def _missed(guess: np.ndarray, truth: np.ndarray, solved: list[Solved]) -> np.ndarray:
    """Return errors (n, 4), as `Misses` holds them, relative to the answer where it has a mean."""
    b = np.array([float(as_wave(s.swimmer.tail).amplitude) for s in solved])
    size = np.stack([np.abs(guess[:, 0]), b, np.abs(guess[:, 2]), np.ones_like(b)], axis=1)
    return np.abs(guess - truth) / size
