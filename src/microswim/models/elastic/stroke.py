"""The beat in space that an elastic tail settles to: bent out of its plane at rest, or under loads.

As in `beat`, Newton's method on equal phases of a whole period at once, an odd number of them, with
two curvatures and the twist as coordinates. A body that is held has its weight, a stream and a wall
about it, which pull at the filament; one that is free swims in still fluid.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait import doors
from microswim.models.elastic.beat import harmonics_wanted, periodic_derivative
from microswim.models.elastic.growing import grown, newton
from microswim.models.elastic.growth import slowest
from microswim.models.elastic.problem import elastic_tail
from microswim.models.elastic.space import (
    cross_columns,
    crossed,
    dots,
    flat,
    heading,
    summed,
    swap,
)
from microswim.models.elastic.unsteady.march import LOOSEST, at_rest, marched
from microswim.models.elastic.unsteady.numbers import in_time, units_of
from microswim.models.elastic.unsteady.swimmer_in_time import InTime, Moment
from microswim.numerics.series.fourier import evaluate, series_of
from microswim.swimmer.swimmer import Swimmer

FIRST, MOST = (11, 12), 1300  #: phases and polynomials a strain; their product, at most
TOLERANCE = 1e-3  #: largest share that the last harmonics, and strains in the place, may have
SETTLING = 4  #: periods from rest on before a beat is sought in time
CLOSE, NEAR = 1e-4, 1e-2  #: last step of Newton's method, whose square is left over; on the way


@dataclass(frozen=True, eq=False)
class Stroke:
    """A periodic motion of an elastic tail with its body, in space.

    Parameters
    ----------
    of
        What was solved, with which strains; its time is in units of the drive's rate.
    pose
        Place and quaternion of the body, (7,).
    shape
        Strains (T, 3 n) at T equal times of a period.
    velocity
        Free velocities of the body at these times, (T, f).
    steps
        Steps of Newton's method.
    """

    of: InTime
    pose: np.ndarray
    shape: np.ndarray
    velocity: np.ndarray
    steps: int

    @property
    def times(self) -> np.ndarray:
        """Its times, (T,)."""
        return 2.0 * np.pi * np.arange(len(self.shape)) / len(self.shape)

    @property
    def rest(self) -> np.ndarray:
        """Strains at rest, (3 n,)."""
        return self.of.rod.rest.ravel()

    def at(self, time: float | np.ndarray, q: np.ndarray) -> Moment:
        """Return the balance of work at times (...) with these strains (..., 3 n)."""
        return self.of.moment(time, self.state(q))

    def state(self, q: np.ndarray) -> np.ndarray:
        """Return pose and strains."""
        pose = np.broadcast_to(self.pose, (*q.shape[:-1], len(self.pose)))
        return np.concatenate([pose, q], axis=-1)

    @property
    def multiplier(self) -> complex:
        """Factor by which the slowest disturbance changes in a period."""
        f = self.velocity.shape[1]
        _, M, G = self.balances()
        return slowest(-np.linalg.solve(np.real(M), np.real(G))[:, f:], 1)

    def balances(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the work left over (T, N), and its derivatives by velocities and strains."""
        rates = periodic_derivative(len(self.shape)) @ self.shape
        w = np.concatenate([self.velocity, rates], axis=-1)
        now = self.at(self.times, self.shape)
        M, work = now.balance(self.times, self.state(self.shape))
        return work + (M @ w[..., None])[..., 0], M, by_strains(now, w)

    @property
    def is_resolved(self) -> tuple[bool, bool]:
        """Whether harmonics and strains have decayed."""
        size = np.abs(self.shape - self.rest).max(initial=0.0)
        if size <= 1e-12 * np.abs(self.rest).max(initial=0.0):
            return True, True
        first, last = self.harmonics
        own = (self.shape - self.rest).reshape(len(self.shape), 3, -1)[..., -2:]
        sharp = np.abs(own).max() / self.of.rod.count**2  # the place is twice the integral
        return bool(last <= TOLERANCE * first), bool(sharp <= TOLERANCE * size)

    @property
    def harmonics(self) -> tuple[float, float]:
        """The largest of its harmonics, and the largest of its last two above rounding."""
        sizes = np.abs(np.fft.fft(self.shape, axis=0)).max(axis=1)[: len(self.shape) // 2 + 1]
        return sizes[1:].max(), max(sizes[-2:].max() - 1e-12 * sizes.max(), 0.0)

    @property
    def phases_wanted(self) -> int:
        """More phases than it has, enough for harmonics that go on falling as these do."""
        T = len(self.shape)
        H = harmonics_wanted(*self.harmonics, T // 2, TOLERANCE)
        return min(max(2 * H + 1, T + 4), 2 * T + 1)

    @property
    def motion(self) -> np.ndarray:
        """Velocities, and strains about those at rest, (T, f + 3 n)."""
        return np.concatenate([self.velocity, self.shape - self.rest], axis=-1)

    def moved(self, dz: np.ndarray, steps: int = 0) -> Stroke:
        """Return it with another motion after so many steps: as it is and so much more."""
        f = self.velocity.shape[1]
        velocity, shape = self.velocity + dz[:, :f], self.shape + dz[:, f:]
        return replace(self, velocity=velocity, shape=shape, steps=steps)


def by_strains(now: Moment, w: np.ndarray) -> np.ndarray:
    """Return the derivative of the work by the strains at fixed velocities, (..., f + 3 n, 3 n)."""
    rod, c, f = now.of.rod, now.of.drag, len(now.of.drag.free)
    phi, moved, t = now.turn[..., f:], now.shift[..., f:], now.tangent
    ahead, rates = heading(rod, now.at.directors), w[..., f:].reshape(*w.shape[:-1], 3, -1)
    speed = dots(rod.curvatures @ swap(rates), now.at.directors)
    spun = rod.turns @ speed  # of each section against the base
    d_spun = summed(rod.turns, cross_columns(phi, speed[..., None]))
    d_ahead = cross_columns(phi, ahead[..., None])
    d_speed = cross_columns(d_spun, ahead[..., None]) + crossed(spun, d_ahead)
    V = np.zeros((*w.shape[:-1], 6), dtype=w.dtype)
    V[..., list(c.free)] = w[..., :f]
    turning = (now.moved.turning + V[..., 3:])[..., None, :]
    dv = summed(rod.along, d_speed) + crossed(turning, moved)
    if now.of.loads.slope is not None:
        dv = dv - (swap(now.Q) @ now.of.loads.slope @ now.Q)[..., None, :, :] @ moved
    force, turned = now.dragged  # the drag of dv does the work that dv does against that of w
    W_r = c.along(rod)[2]
    G = now.stiffness(w)[..., f:] + swap(flat(force)) @ flat(dv)
    return G + swap(turned) @ (W_r[:, None] * dots(t, d_spun))


def stroke(swimmer: Swimmer) -> Stroke:
    """Return the beat, with as many phases and strains as it takes.

    Raises
    ------
    SpecError
        As `in_time`.
    MicroswimError
        If none is found, or it takes too many.
    """
    rest = elastic_tail(swimmer).rest_shape
    T, n = FIRST
    number = np.real(in_time(swimmer, 4).drag.normal) ** 0.25
    n = max(n, int(6 + number), 0 if rest is None else rest.modes() + 2)
    beat: Stroke | None = None
    while T * n <= MOST:
        start = _at_rest(swimmer, T, n)
        near = beat and _solved(_finer(beat, start))
        beat = near or _found(start) or _found_in_time(swimmer, start)
        in_phase, along = beat.is_resolved
        if in_phase and along:
            return beat
        T, n = (T if in_phase else beat.phases_wanted), (n if along else n + max(4, n // 3))
    raise MicroswimError(
        f"the elastic tail bends too sharply to be resolved (sperm number "
        f"{number:.3g}): stiffen it, drive it less, or slower"
    )


def _at_rest(swimmer: Swimmer, T: int, n: int) -> Stroke:
    of = in_time(swimmer, n)
    held, pose = not of.drag.free, np.append(np.zeros(3), [1.0, 0.0, 0.0, 0.0])
    if held and swimmer.wall is not None:
        place, turned = doors.go(doors.START_BESIDE_WALL, swimmer.wall)
        pose = np.append(place / np.real(swimmer.tail.length), turned)
    of = replace(of, loads=of.loads.still(held))
    shape, velocity = np.tile(of.rod.rest.ravel(), (T, 1)), np.zeros((T, len(of.drag.free)))
    return Stroke(of, pose, shape, velocity, 0)


def _finer(beat: Stroke, start: Stroke) -> Stroke:
    """The same beat at the phases and with the strains of another."""
    old, n = beat.of.rod.count, start.of.rod.count
    both = (beat.shape - beat.rest, beat.velocity)
    bends, V = (evaluate(series_of(x), start.times) for x in both)
    more = np.pad(bends.reshape(-1, 3, old), ((0, 0), (0, 0), (0, n - old)))
    return replace(start, shape=start.rest + more.reshape(len(V), -1), velocity=V)


def _found(start: Stroke) -> Stroke | None:
    """Newton's method, at a smaller drive and load first where the whole is too far from rest."""
    walled = start.of.loads.wall is not None

    def at(share: float) -> Stroke:
        of = replace(start.of, size=share * start.of.size, loads=start.of.loads.share(share))
        return replace(start, of=of)

    first, least = (None, 0.2) if walled else (_correction, 0.02)
    beat, done = grown(at, _solved, first, least)
    return beat if done == 1.0 else None


def _found_in_time(swimmer: Swimmer, start: Stroke) -> Stroke:
    """Newton's method from the fifth period after rest."""
    units, T = units_of(swimmer), len(start.shape)
    if np.iscomplexobj(start.balances()[0]):
        raise MicroswimError("of such a beat no derivatives are known: step finitely")
    begun = at_rest(swimmer, start.pose[:3] * units.length, start.pose[3:], 0.0)
    times = 2.0 * np.pi * units.time * np.append(0.0, SETTLING + np.arange(T) / T)
    shapes = marched(swimmer, begun, times, LOOSEST).shapes[1:]
    near = np.zeros((T, 3, start.of.rod.count))
    first, n = start.of.rod.hooks, min(shapes[0].strains.shape[1], near.shape[2])
    near[..., :first] = np.array([x.hook[:, None] for x in shapes])[..., :first]
    near[..., first : first + n] = np.array([x.strains[:, :n] for x in shapes])
    found = _solved(replace(start, shape=near.reshape(T, -1)))
    if found is None:
        raise MicroswimError(
            "no periodic beat of the elastic tail was found: drive it less, stiffen it, or follow "
            "it in time, microswim path with --from-rest"
        )
    return found


def _solved(near: Stroke, whole: bool = True) -> Stroke | None:
    return newton(near, _correction, CLOSE if whole else NEAR)


def _correction(beat: Stroke) -> np.ndarray:
    """Newton's step of all phases at once, (T, f + 3 n); velocities are eliminated at each."""
    residual, M, G = beat.balances()
    f, i, D = beat.velocity.shape[1], np.arange(len(M)), periodic_derivative(len(M))
    own = np.concatenate([residual[..., None], G, M[..., f:]], axis=-1)
    own_f = np.linalg.solve(M[:, :f, :f], own[:, :f])  # of the velocities
    own = own[:, f:] - M[:, f:, :f] @ own_f
    left, G_q, M_q = own[..., 0], own[..., 1 : 1 + G.shape[-1]], own[..., 1 + G.shape[-1] :]
    A = M_q[:, :, None] * D[:, None, :, None]
    A[i, :, i] += G_q
    dq = np.linalg.solve(A.reshape(left.size, left.size), -left.ravel()).reshape(left.shape)
    moved = np.concatenate([np.ones((len(dq), 1)), dq, D @ dq], axis=-1)
    return np.concatenate([-(own_f @ moved[..., None])[..., 0], dq], axis=-1)
