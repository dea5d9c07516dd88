"""An atlas made of solves: scales, Gaussian processes, and what each answer misses, left out."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np

from microswim import __version__
from microswim.calibration.atlas import alone, coordinates
from microswim.calibration.atlas.atlas import Atlas
from microswim.calibration.atlas.near import measured
from microswim.calibration.atlas.side_by_side import base, rebuilt
from microswim.calibration.region import kriging
from microswim.calibration.region.beats import HALF, SAMPLES
from microswim.calibration.region.fit import Solved, one_thread, targets
from microswim.calibration.region.fit import groups_of as of_region
from microswim.calibration.region.kriging import PHASORS
from microswim.calibration.region.positive_definite import REAL
from microswim.calibration.region.surfaces import Surfaces, interleaved
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.models.rft.gait import gait as surrogate
from microswim.numerics.series.extremes import half_range
from microswim.numerics.series.fourier import series_of
from microswim.swimmer.drag.coefficients import Cox, GrayHancock, Lighthill
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.swimmer import Swimmer

ENOUGH = 400  #: designs from which the kernels' lengths are found
#: Variances of the noise of all corrections over the signal's, and its deviation per asymmetry of
#: a design's R, of which the likelihood takes the best.
NOISES, PER_ASYMMETRY = (3e-7, 3e-6), (0.0, 10.0, 100.0, 300.0)
LAWS = (Lighthill, GrayHancock, Cox)
#: Corrections whose size follows powers of the numbers, each with those of its direction.
SCALED = ((2,), (8,), (9,), (11,), (12,), *((j, j + 1) for j in range(REAL + 3, REAL + 15, 2)))
#: The same of each kind of design; of a plane wave none.
POWERS: dict[str, tuple[tuple[int, ...], ...]] = {
    "helix": SCALED,
    "plane_wave": (),
    "helix_alone": tuple((j, j + 1) for j in range(alone.REAL, alone.COLUMNS, 2)),
    "plane_wave_alone": (),
}
PERIOD = np.pi * np.arange(SAMPLES) / HALF


def groups_of(kind: str) -> list[tuple[slice, bool, int]]:
    """Return columns that share a kernel: a region's, a helix' real ones all together.

    Over so wide a range the tip says nothing of the real ones. A kernel costs a third of an answer.
    """
    if kind == "helix_alone":
        return [(slice(alone.REAL), False, PHASORS), (slice(alone.REAL, None), True, PHASORS)]
    thrust, others, *lateral = of_region(kind == "helix")
    if kind == "helix":
        return [(slice(thrust[0].start, others[0].stop), False, 0), *lateral]
    return [(thrust[0], False, 0), (others[0], False, 0), *lateral]


def fit(solved: list[Solved], about: dict[str, Any], former: Atlas | None = None) -> Atlas:
    """Return the atlas of solved designs.

    former : an atlas whose kernels serve again; to find them takes minutes.
    """
    x = np.array([coordinates.numbers(s.swimmer) for s in solved]).T
    kind = coordinates.kind_of(solved[0].swimmer)
    raw = coordinates.features(x, kind).T
    centre, spread = raw.mean(axis=0), raw.std(axis=0)
    if former is not None:
        centre, spread = former.centre, former.spread
    Z, N = (raw - centre) / spread, x[2]
    Y = _alone(solved) if kind == "helix_alone" else targets(solved)
    exponents = scales(x, Y, POWERS[kind]) if former is None else former.exponents
    scale = np.exp(exponents @ coordinates.powers(x)).T
    off = np.array([float(s.gait.info.get("asymmetry") or 0.0) for s in solved])
    sorted_groups = sorted(groups_of(kind), key=lambda g: g[0].start or 0)
    with one_thread():
        groups = tuple(
            _group(Z, N, (Y / scale)[:, part], pairs, phasors, former and former.surfaces.groups[i],
                   off)
            for i, (part, pairs, phasors) in enumerate(sorted_groups)
        )  # fmt: skip
        left = [interleaved(g.left_out()[0]) for g in groups]
    guess = Y - np.concatenate(left, axis=1) * scale
    truth = np.array([_by_gait(s.swimmer, s.gait) for s in solved])
    own = [_by_corrections(s.swimmer, y) for s, y in zip(solved, guess)]
    plain = {law.law: measured(Z, _missed(_surrogate(solved, law), truth, solved)) for law in LAWS}
    misses = measured(Z, _missed(np.array(own), truth, solved))
    about = {"solves": len(solved), "version": __version__, **about}
    surfaces = Surfaces(groups)
    return Atlas(surfaces, centre, spread, exponents, misses, plain, about)


def _alone(solved: list[Solved]) -> np.ndarray:
    """Return the corrections of helices without a body."""
    return np.array(
        [
            alone.encode(
                np.real(s.gait.resistance(0.0)),
                base(s.swimmer, 0.0)[0].reshape(6, 6),
                s.swimmer.tail.apparent_length,
            )
            for s in solved
        ]
    )


def _group(
    Z: Any, N: Any, y: np.ndarray, pairs: bool, phasors: int, former: kriging.Kriging | None,
    off: np.ndarray,
) -> kriging.Kriging:  # fmt: skip
    """Return a group's process: kernel from some of the designs, noise and weights from all.

    Solves are noisier where their R lacks symmetry, by `off` (n,) of its size.
    """
    y = y[:, ::2] + 1j * y[:, 1::2] if pairs else y
    some = slice(0, ENOUGH)
    kernel = former or kriging.fit(Z[some], N[some], y[some], phasors)
    known = Z, N, y, kernel.lengths, kernel.phasors
    tried = [own + (each * off) ** 2 for own in NOISES for each in PER_ASYMMETRY]
    return kriging.conditioned(*known, max(tried, key=lambda n: kriging.likelihood(*known, n)))


def scales(x: np.ndarray, Y: np.ndarray, together: Any = SCALED) -> np.ndarray:
    """Return powers of the corrections' sizes (corrections, 6), by least absolute deviations."""
    P, out = coordinates.powers(x).T, np.zeros((Y.shape[1], 6))
    for columns in together:
        size = np.sqrt(np.sum(Y[:, columns] ** 2, axis=1))
        if not np.any(size):
            continue
        log = np.log(np.maximum(size, 1e-9 * np.mean(size)))
        power = np.linalg.lstsq(P, log, rcond=None)[0]
        for _ in range(30):
            weight = 1.0 / np.maximum(np.abs(log - P @ power), 0.05)
            normal = P.T * weight
            power = np.linalg.lstsq(normal @ P, normal @ log, rcond=None)[0]
        out[list(columns)] = power
    return out


def velocities(R: np.ndarray, F: np.ndarray) -> np.ndarray:
    """Return mean u_s, lateral |u|, Omega_s, lateral |Omega| at unit phase rate, free in all.

    From R (m, 6, 6) and F_p (m, 6): of a helix at phase 0, of which the lateral velocity turns
    with it, m = 1; of a plane wave over the period, of which u_q and Omega_r have an amplitude.
    """
    V = -np.linalg.solve(R, F[..., None])[..., 0]
    if len(V) == 1:
        return np.array([V[0, 0], np.hypot(*V[0, 1:3]), V[0, 3], np.hypot(*V[0, 4:])])
    across, turning = half_range(series_of(V)[:, [1, 5]])
    return np.array([V[:, 0].mean(), across, 0.0, turning])


def held(R: np.ndarray) -> np.ndarray:
    """Return the same of a helix without a body (6, 6) turned by its motor against the lab, the
    torque in place of Omega_s; free in all it would not move at all.
    """
    free = [0, 1, 2, 4, 5]
    V = -np.linalg.solve(R[np.ix_(free, free)], R[free, 3])
    return np.array([V[0], np.hypot(*V[1:3]), R[3, 3] + R[3, free] @ V, np.hypot(*V[3:])])


def _is_held(swimmer: Swimmer) -> bool:
    """Whether it can be judged only turned against the lab: a helix without a body."""
    return swimmer.body.is_absent and swimmer.tail.is_rigid


def _by_corrections(swimmer: Swimmer, y: np.ndarray) -> np.ndarray:
    """Return the same of a swimmer's corrections."""
    R, F = (x[0] for x in rebuilt(swimmer, y)[:2])
    return held(R[0]) if _is_held(swimmer) else velocities(R, F)


def _by_gait(swimmer: Swimmer, gait: Gait) -> np.ndarray:
    """Return `velocities` of a swimmer's gait, or `held`."""
    if _is_held(swimmer):
        return held(np.real(gait.resistance(0.0)))
    phases = PERIOD if swimmer.tail.is_planar else np.zeros(1)
    return velocities(gait.resistance(phases), gait.propulsion(phases))


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
            out[i] = _by_gait(s.swimmer, made)
    return out


def _missed(guess: np.ndarray, truth: np.ndarray, solved: list[Solved]) -> np.ndarray:
    """Return errors (n, 4), as `Misses` holds them, relative to the answer where it has a mean."""
    b = np.array([float(as_wave(s.swimmer.tail).amplitude) for s in solved])
    turn = np.where(np.any(guess[:, 2]), np.abs(guess[:, 2]), 1.0)  # a plane wave has none
    size = np.stack([np.abs(guess[:, 0]), b, turn, np.ones_like(b)], axis=1)
    return np.abs(guess - truth) / size
