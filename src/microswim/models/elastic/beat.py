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
from microswim.models.elastic.growing import grown, newton
from microswim.models.elastic.plane import Balance, Base, Loads, balance
from microswim.models.elastic.problem import Problem
from microswim.models.elastic.rod import Rod
from microswim.numerics.series.fourier import evaluate, series_of

#: Phases over half a period and curvatures of the rod, to begin with; their product, at most.
FIRST, MOST = (8, 12), 2500
#: Largest share that the last harmonics, and curvatures in the tail's place, may have.
TOLERANCE = 1e-5
CLOSE, NEAR = 1e-6, 1e-2  #: last step of Newton's method, whose square is left over; on the way


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
    def motion(self) -> np.ndarray:
        """Velocities, and coordinates about those at rest, (T, f + n)."""
        return np.concatenate([self.velocity, self.shape - self.rod.rest], axis=-1)

    def moved(self, dz: np.ndarray, steps: int = 0) -> Beat:
        """Return it with another motion after so many steps: as it is and so much more."""
        f = self.velocity.shape[1]
        velocity, shape = self.velocity + dz[:, :f], self.shape + dz[:, f:]
        return replace(self, velocity=velocity, shape=shape, steps=steps)

    @property
    def is_resolved(self) -> tuple[bool, bool]:
        """Whether harmonics and curvatures have decayed."""
        bends = np.abs(self.shape - self.rod.rest)
        if bends.max(initial=0.0) <= 1e-12 * np.abs(self.shape).max(initial=0.0):
            return True, True
        first, last, _ = self.harmonics
        sharp = bends[:, -2:].max() / self.rod.count**2  # the place is twice the integral
        return bool(last <= TOLERANCE * first), bool(sharp <= TOLERANCE * bends.max())

    @property
    def harmonics(self) -> tuple[float, float, int]:
        """The largest of its harmonics, the last ones above rounding, and how many it has."""
        sizes = np.abs(np.fft.fft(self.over_period(self.shape), axis=0)).max(axis=1)
        half = len(sizes) // 2
        last = sizes[half // 2 * 2 - 1 : half + 1].max() - 1e-12 * sizes.max()
        return sizes[1 : half + 1].max(), max(last, 0.0), half // 2 * 2

    @property
    def phases_wanted(self) -> int:
        """More phases than it has, enough for harmonics that go on falling as these do."""
        T, H = len(self.shape), harmonics_wanted(*self.harmonics, TOLERANCE)
        if self.problem.mirrors:
            return min(max(H + 1, T + 4), 2 * T)
        return min(max(2 * H + 1, T + 4), 2 * T - 1)  # odd

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
        beat = (beat and newton(_finer(beat, T, n), _correction, CLOSE)) or found(problem, T, n)
        in_time, along = beat.is_resolved
        if in_time and along:
            return beat
        T, n = (T if in_time else beat.phases_wanted), (n if along else n + max(6, n // 3))
    raise MicroswimError(
        f"the elastic tail bends too sharply to be resolved (sperm number "
        f"{problem.sperm_number:.3g}): stiffen it, drive it less, or slower"
    )


def harmonics_wanted(first: float, last: float, count: int, tolerance: float) -> int:
    """Return at which of harmonics that go on falling as from the first to the last of so many one
    is no larger than a part of the first.
    """
    fall = np.log(min(last / first, 0.9)) / (count - 1)
    return 1 + int(np.ceil(np.log(tolerance) / fall))


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
    shapes = problem.rod(n)
    still = np.tile(shapes.rest, (T, 1)), np.zeros((T, len(problem.drag.free)))

    def at(share: float) -> Beat:
        return Beat(problem.share(share), shapes, *still, 0)

    def solved(near: Beat, whole: bool) -> Beat | None:
        return newton(near, _correction, CLOSE if whole else NEAR)

    beat, done = grown(at, solved, _correction, 0.01)
    if done < 1.0:
        raise MicroswimError(
            f"no periodic beat of the elastic tail was found beyond {done:.0%} of its "
            "drive: drive it less or stiffen it"
        )
    return beat


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
