"""The beat that an elastic tail settles to: its shape and the body's velocities, periodic in phase.

Straight at rest and driven by a cosine, the tail half a period on is its own mirror image,
``q(phi + pi) = -q(phi)``: half a period at T equal phases holds the beat, and its derivative by the
trigonometric polynomial through these and their images is exact up to harmonic T. A tail that is
bent at rest, or whose body drifts aside, has no such image: a whole period at an odd number of
phases holds its beat. Newton's method on all phases at once finds it however slowly a tail would
settle to it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.elastic.plane import Balance, Base, Loads, balance
from microswim.models.elastic.problem import Problem
from microswim.models.elastic.rod import Rod
from microswim.numerics.series.fourier import evaluate, series_of

#: Phases over half a period and curvatures of the rod, to begin with; their product, at most.
FIRST, MOST = (8, 12), 2500
#: Largest share that the last harmonics and curvatures may have.
TOLERANCE = 1e-5


@dataclass(frozen=True, eq=False)
class Beat:
    """A periodic motion of an elastic tail with its body.

    Parameters
    ----------
    problem, rod
        What was solved, and with which shapes.
    shape
        Coordinates of the rod at T phases, (T, n): over half a period, or all of it where half
        a period on the tail is not its mirror image.
    velocity
        Free velocities of the body at these phases, (T, f).
    steps
        Steps of Newton's method.
    """

    problem: Problem
    rod: Rod
    shape: np.ndarray
    velocity: np.ndarray
    steps: int

    @property
    def phases(self) -> np.ndarray:
        """Its phases, (T,)."""
        return phases_of(self.problem, len(self.shape))

    @property
    def velocities(self) -> np.ndarray:
        """All velocities ``w = (V, dq/dphi)``, (T, f + n)."""
        rates = derivative_of(self.problem, len(self.shape)) @ self.shape
        return np.concatenate([self.velocity, rates], axis=1)

    @property
    def balance(self) -> Balance:
        """The balance of work at its phases."""
        base, q, w = drive(self.problem, self.phases), self.shape, self.velocities
        rest = unstressed(self.problem, self.rod, self.phases)
        return balance(self.rod, self.problem.drag, base, q, w, Loads(), rest)

    @property
    def is_resolved(self) -> tuple[bool, bool]:
        """Whether harmonics and curvatures have decayed."""
        size = np.abs(self.shape).max(initial=0.0)
        if size == 0.0:
            return True, True
        harmonics = np.abs(np.fft.fft(self.over_period(self.shape), axis=0))
        half = len(harmonics) // 2
        last = harmonics[half // 2 * 2 - 1 : half + 1].max()
        curved = np.abs((self.shape - self.rod.rest)[:, -2:]).max()
        least = 1e-12 * harmonics.max()  # of a bent tail that hardly beats
        enough = last <= max(TOLERANCE * harmonics[1:].max(), least)
        return bool(enough), bool(curved <= TOLERANCE * size)

    def over_period(self, samples: np.ndarray, sense: Any = -1.0) -> np.ndarray:
        """Return samples at its phases over a whole period, of what gets `sense` half of it on."""
        if not self.problem.mirrors:
            return samples
        return np.concatenate([samples, sense * samples])


def drive(problem: Problem, phase: np.ndarray) -> Base:
    """Return where the drive holds the base."""
    c, s, y, a = np.cos(phase), np.sin(phase), problem.heave, problem.pivot
    return Base(place=y * c, angle=a * c, place_rate=-y * s, angle_rate=-a * s)


def unstressed(problem: Problem, rod: Rod, phase: np.ndarray) -> np.ndarray:
    """Return the coordinates (T, n) in which inner moments and bending balance.

    An inner moment ``M cos(phi - 2 pi s / lambda)`` bends the filament by ``M / B`` at rest.
    """
    k = 2.0 * np.pi * problem.waves
    wave = problem.moment * np.cos(phase[:, None] - k * rod.s)
    return rod.rest + (wave * rod.weight) @ rod.curvatures


def phases_of(problem: Problem, T: int) -> np.ndarray:
    """Return T equal phases over half a period, or all of it."""
    return (np.pi if problem.mirrors else 2.0 * np.pi) * np.arange(T) / T


def derivative_of(problem: Problem, T: int) -> np.ndarray:
    """Return the derivative of the coordinates at these phases, (T, T)."""
    return antiperiodic_derivative(T) if problem.mirrors else periodic_derivative(T)


@lru_cache(16)
def antiperiodic_derivative(T: int) -> np.ndarray:
    """Return the derivative at T phases over half a period of what changes sign after it, (T, T).

    Of the Fourier derivative on 2 T phases, ``(-1)^j cot(j h / 2) / 2``, the images are folded in.
    """
    j = np.arange(1, 2 * T)
    row = np.append(0.0, 0.5 * (-1.0) ** j / np.tan(j * np.pi / (2 * T)))
    i = np.arange(T)
    whole = row[(i[:, None] - np.arange(2 * T)) % (2 * T)]
    return whole[:, :T] - whole[:, T:]


@lru_cache(16)
def periodic_derivative(T: int) -> np.ndarray:
    """Return the Fourier derivative at an odd number of phases, ``(-1)^j / (2 sin(j h / 2))``."""
    j = np.arange(1, T)
    row = np.append(0.0, 0.5 * (-1.0) ** j / np.sin(j * np.pi / T))
    i = np.arange(T)
    return row[(i[:, None] - i) % T]


def settled(problem: Problem) -> Beat:
    """Return the beat, with as many phases and curvatures as it takes.

    Raises
    ------
    MicroswimError
        If none is found, or it takes too many.
    """
    if not np.real(problem.drag.normal) > 0.0 or not problem.is_driven:
        return _still(problem)
    T, n = FIRST
    T = T if problem.mirrors else 2 * T + 1
    n = max(n, int(6 + 2 * problem.sperm_number + 4 * abs(np.real(problem.waves))))
    n = max(n, 0 if problem.rest is None else problem.rest.modes() + 2)
    beat = None
    while T * n <= MOST:
        beat = (beat and _newton(_finer(beat, T, n))) or found(problem, T, n)
        in_time, along = beat.is_resolved
        if in_time and along:
            return beat
        more = 2 * T if problem.mirrors else 2 * T - 1  # odd again
        T, n = (T if in_time else more), (n if along else n + max(6, n // 3))
    raise MicroswimError(
        f"the elastic tail bends too sharply to be resolved (sperm number "
        f"{problem.sperm_number:.3g}): stiffen it, drive it less, or slower"
    )


def _finer(beat: Beat, T: int, n: int) -> Beat:
    """The same beat at more phases, of more curvatures."""
    shapes, phase = beat.problem.rod(n), phases_of(beat.problem, T)
    sense = np.array([1.0, -1.0, -1.0])[list(beat.problem.drag.free)]  # half a period on
    q, V = (
        evaluate(series_of(beat.over_period(x, sign)), phase)
        for x, sign in ((beat.shape, -1.0), (beat.velocity, sense))
    )
    more = shapes.count - beat.rod.count
    own = shapes.rest + np.pad(q - beat.rod.rest, ((0, 0), (0, more)))
    return replace(beat, rod=shapes, shape=own, velocity=V)


def _still(problem: Problem) -> Beat:
    rest, T = problem.rest, FIRST[0] if problem.mirrors else 2 * FIRST[0] + 1
    shapes = problem.rod(max(FIRST[1], 0 if rest is None else rest.modes() + 2))
    own = np.tile(shapes.rest, (T, 1))
    return Beat(problem, shapes, own, np.zeros((T, len(problem.drag.free))), 0)


def found(problem: Problem, T: int, n: int) -> Beat:
    """Return Newton's method, at a smaller drive first where the whole is too far from rest."""
    shapes, f = problem.rod(n), len(problem.drag.free)
    beat = Beat(problem, shapes, np.tile(shapes.rest, (T, 1)), np.zeros((T, f)), 0)
    done, step = 0.0, 1.0
    while done < 1.0:
        share = min(1.0, done + step)
        grown = share / done if done else 0.0
        near = shapes.rest + grown * (beat.shape - shapes.rest)
        start = replace(beat, problem=problem.share(share), shape=near)
        found = _newton(start)
        if found is None:
            step /= 2.0
            if step < 0.01:
                raise MicroswimError(
                    f"no periodic beat of the elastic tail was found beyond {done:.0%} of its "
                    "drive: drive it less or stiffen it"
                )
            continue
        done, beat = share, replace(found, steps=found.steps + beat.steps)
    return beat


def _newton(beat: Beat) -> Beat | None:
    """Return the beat with no work left over, or None where Newton's method does not get there."""
    last = np.inf
    for step in range(1, 16):
        dz = _correction(beat)
        size = np.abs(dz).max()
        f = beat.velocity.shape[1]
        beat = replace(
            beat, shape=beat.shape + dz[:, f:], velocity=beat.velocity + dz[:, :f], steps=step
        )
        if size <= 1e-10 * max(1.0, np.abs(beat.shape).max()):
            if last <= 1e-10 or not np.iscomplexobj(dz):
                return beat
            size = 0.0  # an imaginary part lags behind by a step
        if not size < 4.0 * max(last, 1e-10):
            return None
        last = size
    return None


def _correction(beat: Beat) -> np.ndarray:
    """Newton's step of all phases at once, (T, f + n): velocities, then coordinates."""
    at, T, f = beat.balance, len(beat.shape), beat.velocity.shape[1]
    N = at.residual.shape[1]
    A = np.zeros((T, N, T, N), dtype=at.residual.dtype)
    i = np.arange(T)
    A[i, :, i, :f] = at.resistance[:, :, :f]
    D = derivative_of(beat.problem, T)
    A[:, :, :, f:] = at.resistance[:, :, None, f:] * D[:, None, :, None]
    A[i, :, i, f:] += at.stiffness
    return np.linalg.solve(A.reshape(T * N, T * N), -at.residual.ravel()).reshape(T, N)
