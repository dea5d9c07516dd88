"""When a fit may give an interval: what must show in the track, and what must not be left over.

A wave shape is in a track only if its wobble stands above the noise and its beat below half the
frame rate. A fit holds only if what it leaves is noise: as large as the scatter from frame to
frame, and without a memory of its own. The error of the model itself moves every value as well.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.gait.readable import quantity
from microswim.gait.units import unit
from microswim.studies.identification.fitting.problem import PathProblem
from microswim.studies.identification.spectrum import line

PHASES = 32
SIDEWAYS = (1, 2, 4, 5)  #: velocities that make the path wobble: u_q, u_r, w_q, w_r
STILL = 1e-3  #: rad, of an attitude that no camera tells
FEW = 22.5  #: sum of squared deviations of six velocities, one chance in a thousand
CAUSES = (
    "likely causes: the other hand, a mirrored axis (y down in an image), the attitude the wrong "
    "way round, a beat with a mean curvature, a wall, a drift, or a model that is too far off"
)


def check_shown(problem: PathProblem, shape: tuple[str, ...]) -> None:
    """Refuse to look for a wave that the track does not show.

    Raises
    ------
    MicroswimError
        If the beat is above half the frame rate, no wobble stands above the noise, or the
        swimmer of the spec is held in all that would make one.
    """
    track, rate = problem.track, problem.swimmer.tail.frequency
    if not set(problem.names) & set(shape) or track.quaternion is not None:
        return
    highest = 0.5 / float(np.median(np.diff(track.time)))
    hint = "microswim identify without a SPEC says what it does hold"
    if abs(rate) > highest:
        per = unit(problem.swimmer.units, "frequency")
        raise MicroswimError(
            f"the beat of the spec, {quantity(rate, per)}, is above half the frame rate, "
            f"{quantity(highest, per)}: this track holds no wave shape and no rate; {hint}, and if "
            "it beats slower, --set tail.frequency says so"
        )
    seen = line(track.time, track.position)
    few = track.duration * highest < 3.0 * 10.0  # too few frames for a spectrum
    if not seen.stands_out and not few:
        raise MicroswimError(
            "no wobble stands above the noise: wave shape and rate are not in this track; " + hint
        )
    motion = problem.swimmer.motion
    if not any(motion.mask[k] for k in SIDEWAYS):
        free = motion.free if isinstance(motion.free, str) else ", ".join(motion.free)
        raise MicroswimError(
            f"motion.free is {free}: all is held that would make the spec's swimmer wobble, and "
            "the track wobbles; --set motion.free=all lets it go"
        )


def left_over(problem: PathProblem, residuals: np.ndarray) -> str:
    """Return what speaks against a fit, or nothing: its residuals are noise, of positions and of
    attitudes, where the track has them.
    """
    track, count = problem.track, problem.track.position.size
    off = problem.scale * residuals[:count].reshape(track.position.shape)
    wobble = float(np.std(track.position - track.smooth))
    own = unit(problem.swimmer.units, "length")
    said = _memory(track.time, off, 1e-4 * wobble, problem.sigma, own)
    if not said and problem.weighs:
        turned = problem.sigma_attitude * residuals[count:].reshape(-1, 3)
        said = _memory(track.time, turned, STILL, problem.sigma_attitude, "rad")
        said = said and f"of the attitude: {said}"
    return said and (
        f"what the fit leaves, {said}: the model does not hold for this track, and no interval is "
        f"given; {CAUSES}"
    )


def _memory(time: np.ndarray, off: np.ndarray, slight: float, sigma: float | None, of: str) -> str:
    """Say why residuals (n, d), in units `of`, are no noise, nothing if they are, or are slight."""
    size = float(np.sqrt(np.mean(off**2)))
    if size < slight or (sigma is not None and size < 0.5 * sigma):
        return ""
    n, d = off.shape
    memory = float(np.sum(off[1:] * off[:-1]) / np.sum(off**2))
    noise = line(time, off).noise
    if memory > max(4.0 / np.sqrt(n * d), 0.1) or size > 2.0 * noise:
        left, seen = quantity(size, of, 3), quantity(noise, of, 3)
        return f"{left}, is no noise (that is {seen} from frame to frame)"
    return ""


def model_errors(own: Gait) -> np.ndarray | None:
    """Return relative errors to expect of the six velocities, None where nobody measured them."""
    found = own.info.get("expected_error")
    if found is None:
        return None
    errors = [found[name] for name, free in zip(DEGREES_OF_FREEDOM, own.free) if free]
    if any(error is None for error in errors) or not np.isfinite(errors).all():
        return None
    return np.array([found[name] if free else 0.0 for name, free in
                     zip(DEGREES_OF_FREEDOM, own.free)])  # fmt: skip


def scaled(gait: Gait, k: int, share: float) -> Gait:
    """Return a gait with a larger velocity k: ``F_p' = F_p - R e_k share V_k / rate``."""
    phase = 2.0 * np.pi * np.arange(PHASES) / PHASES
    V = gait.velocity(phase)[:, k]
    R = gait.resistance(phase)
    F = gait.propulsion(phase) - share * R[:, :, k] * (V / gait.rate)[:, None]
    free: dict[str, Any] = {"rate": gait.rate, "free": gait.free, "units": gait.units}
    return Gait.from_samples(R, F, gait.activity(phase), model=gait.model, **free)


def moved_by_model(
    problem: PathProblem, z: np.ndarray, spread: float, errors: np.ndarray
) -> np.ndarray:
    """Return by how much each velocity, larger by one deviation of its error, moves the path.

    The errors are those of 19 of 20: two deviations. Shape (residuals, velocities), in the noise.
    """
    gait, here = problem.gait(z[: len(problem.unknowns)]), problem.residuals(z)
    moved = [np.zeros((here.size, 0))]
    for k in np.flatnonzero(errors > 0):
        share = min(float(errors[k]) / 2.0, 0.5)
        d = (problem.residuals_of(scaled(gait, int(k), share), z) - here) / spread
        moved.append(d[:, None])
    return np.concatenate(moved, axis=1)


def covariance_of_model(
    problem: PathProblem, z: np.ndarray, own: np.ndarray, nuisance: np.ndarray, spread: float,
    errors: np.ndarray,
) -> np.ndarray:  # fmt: skip
    """Return the covariance of the values by errors of the model's velocities, independent of each
    other.

    A velocity larger by a deviation moves the path by d; the values that make up for it move by
    ``-own^+ d``, pose and phase projected out.
    """
    d = moved_by_model(problem, z, spread, errors)
    size = np.maximum(np.linalg.norm(own, axis=0), 1e-300)  # in metres some slopes are 1e9 others
    moved = np.linalg.lstsq(own / size, d - nuisance @ (nuisance.T @ d), rcond=1e-6)[0]
    moved = moved / size[:, None]
    return moved @ moved.T


def unexplained(
    problem: PathProblem, done: Any, spread: float, errors: np.ndarray | None
) -> tuple[float, np.ndarray]:
    """Return chi-squared and residuals of a fit once its velocities may be off by the model's
    errors.

    With a deviations of each, ``min |r + J x + D a|^2 + |a|^2`` over all parameters x and a: the
    fit as it is where no error is known. Residuals are as they are if the deviations are too many.
    """
    r = done.fun / spread
    if errors is None:
        return float(r @ r), done.fun
    J, d = problem.jacobian(done.x), moved_by_model(problem, done.x, spread, errors)
    U, s, _ = np.linalg.svd(J / np.maximum(np.linalg.norm(J, axis=0), 1e-300), full_matrices=False)
    U = U[:, s > 1e-8 * s[0]]
    r, d = (v - U @ (U.T @ v) for v in (r, d))
    a = -np.linalg.solve(np.eye(d.shape[1]) + d.T @ d, d.T @ r)
    left = r + d @ a
    return float(left @ left + a @ a), spread * left if a @ a < FEW else done.fun
