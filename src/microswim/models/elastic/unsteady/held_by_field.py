"""An elastic robot as a field that turns holds it: at rest in axes that turn with the field.

With the balance of work of `swimmer_in_time`, ``M w + work = 0``, the velocities are those of axes
that turn at the field's ``Omega``,

    w = (v, Q' Omega + sigma e_s, sigma (k_2, -k_1, 0)),

v of the body and Q its rotation to those axes. A robot that looks the same from all sides of its
own line, magnet and all, gets no torque about it: it spins about that line at sigma, such that
none is needed, and its shape stays. For any other robot sigma is zero. Implicit steps in time,
each longer than the last, lead there as the robot itself would go, and end as Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.elastic.problem import elastic_tail
from microswim.models.elastic.space import AXIS
from microswim.models.elastic.unsteady.numbers import in_time, units_of
from microswim.models.elastic.unsteady.swimmer_in_time import InTime
from microswim.models.elastic.whirl import slowed
from microswim.numerics.rigid_motion import multiply, quaternion_of
from microswim.swimmer.swimmer import Swimmer

FIRST, MOST, SHARP = 8, 32, 1e-4  #: polynomials a strain, and largest share of the last two
SLOWEST, LEAST_FASTER = 1e-3, 1.05
STEPS, SHORTEST, FARTHEST, LONG = 24, 1e-2, 0.5, 1e3
SETTLED = 1e-5  #: of the last change; Newton's method leaves its square
SMALL = 1e-7  #: step of a difference
GROWS = 1e-4  #: of the field's rate, from which on a disturbance grows
PUSHED, FOLLOWED, SLOW = 0.1, 150, 1e-2  #: first disturbance, steps after it, and the last of them


@dataclass(frozen=True, eq=False)
class Held:
    """A robot in axes that turn with the field.

    Parameters
    ----------
    of
        The swimmer without units.
    turning
        The field's angular velocity, (3,), in its units.
    quaternion, strains
        Body to these axes, ``wxyz``; two curvatures and the twist, (3, n).
    velocity, twirl
        Of the body, body frame, (3,); rate at which it spins about its own line, 0 where it
        may not.
    twirls
        Whether it may.
    """

    of: InTime
    turning: np.ndarray
    quaternion: np.ndarray
    strains: np.ndarray
    velocity: np.ndarray
    twirl: float
    twirls: bool

    @property
    def along(self) -> float:
        """Velocity along the field's axis."""
        y = self.state
        _, _, Q, _ = self.of.seen(0.0, y)
        axis = self.turning / np.linalg.norm(self.turning)
        return float(axis @ (Q @ self.velocity))

    @property
    def angle(self) -> float:
        """Angle between the body's axis s and the field's, up to a right one."""
        _, _, Q, _ = self.of.seen(0.0, self.state)
        axis = self.turning / np.linalg.norm(self.turning)
        return float(np.arccos(min(1.0, abs(axis @ Q @ AXIS))))

    @property
    def state(self) -> np.ndarray:
        """Pose and strains, as `InTime` takes them."""
        return np.concatenate([np.zeros(3), self.quaternion, self.strains.ravel(), np.zeros(2)])

    def balance(self) -> tuple[np.ndarray, np.ndarray]:
        """Return M, and the work of each velocity, (6 + 3 n,)."""
        y = self.state
        now = self.of.moment(0.0, y)
        M, work = now.balance(0.0, y)
        spin = now.Q.T @ self.turning + self.twirl * AXIS
        k1, k2, k3 = self.strains
        turned = self.twirl * np.concatenate([k2, -k1, 0.0 * k3])
        return M, M @ np.concatenate([self.velocity, spin, turned]) + work

    def moved(self, change: np.ndarray) -> Held:
        """Return it after a change of velocity (3,), attitude (3,), strains and twirl."""
        half = np.append(1.0, change[3:6] / 2.0)
        turned = multiply(self.quaternion, half / np.linalg.norm(half))
        return replace(
            self,
            velocity=self.velocity + change[:3],
            quaternion=turned,
            strains=self.strains + change[6:-1].reshape(3, -1),
            twirl=self.twirl + change[-1],
        )

    def slopes(self, work: np.ndarray) -> np.ndarray:
        """Return the derivative of the work by each part of a change, (6 + 3 n, 7 + 3 n)."""
        each = SMALL * np.eye(7 + self.strains.size)
        return np.stack([(self.moved(e).balance()[1] - work) / SMALL for e in each], axis=1)

    @property
    def disturbances(self) -> tuple[np.ndarray, np.ndarray]:
        """Rates at which disturbances of attitude and strains grow, and these in columns."""
        M, work = self.balance()
        A = np.linalg.solve(M, self.slopes(work)[:, 3:-1])[3:]
        return np.linalg.eig(-A)

    @property
    def growth(self) -> float:
        """Rate at which the fastest disturbance grows."""
        return float(np.real(self.disturbances[0]).max())


def held_by_field(swimmer: Swimmer, near: Held | None = None) -> Held | None:
    """Return how the field of a swimmer holds it, with as many strains as it takes; None: it slips.

    Parameters
    ----------
    swimmer
        With an `ElasticTail` and a field that turns; wall, weight and flow are left out.
    near
        As it is held at another rate of the field; else it begins along the field, at rest.

    Raises
    ------
    SpecError
        As `in_time`.
    MicroswimError
        If the filament bends too sharply.
    """
    alone = replace(swimmer, gravity=None, flow=None, wall=None, channel=None, noise=None)
    rest = elastic_tail(alone).rest_shape
    n = FIRST if near is None else near.strains.shape[1] - near.of.rod.hooks
    n = max(n, 0 if rest is None else rest.modes() + 2)
    while n <= MOST:
        at = _begun(alone, n, near)
        found = (near and lasting(held(at, LONG))) or sped_up(at)
        if found is None:
            return None
        bends = np.abs(found.strains - found.of.rod.rest)
        if bends[:, -2:].max() / n**2 <= SHARP * max(bends.max(), 1e-6):  # in the tail's place
            return found
        near, n = found, n + max(4, n // 3)
    raise MicroswimError(
        "the elastic tail bends too sharply to be resolved: stiffen it, or turn it slower"
    )


def _begun(swimmer: Swimmer, modes: int, near: Held | None) -> Held:
    """A guess: as it is near, or straight with its moment along the field."""
    of, units = in_time(swimmer, modes), units_of(swimmer)
    turning = swimmer.field.angular_velocity * units.time  # type: ignore[union-attr]
    if near is not None:
        more = ((0, 0), (0, of.rod.count - near.strains.shape[1]))
        q = of.rod.rest + np.pad(near.strains - near.of.rod.rest, more)
        sense = float(np.sign(turning @ near.turning))
        return replace(near, of=of, turning=turning, strains=q, velocity=sense * near.velocity)
    own = _moment(of)
    twirls = not elastic_tail(swimmer).is_bent and not np.abs(own[1:]).any() and _alike(of)
    q = quaternion_of(_attitude(of, turning, own if own.any() else AXIS))
    return Held(of, turning, q, of.rod.rest.copy(), np.zeros(3), 0.0, twirls)


def _attitude(of: InTime, turning: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Return the rotation (3, 3), body to lab, in which a slow field holds a stiff robot.

    Its moment along B leaves a turn about it, by which no torque of drag is about it:
    ``m . D w(psi) = 0`` where that falls, w the field's axis as the robot sees it.
    """
    B, _ = of.loads.field(0.0, np.zeros(3))  # type: ignore[misc]
    m, b, n = (x / np.linalg.norm(x) for x in (own, B, turning))
    at_rest = Held(of, turning, np.array([1.0, 0, 0, 0]), of.rod.rest, np.zeros(3), 0.0, False)
    R = at_rest.balance()[0][:6, :6]
    D = R[3:, 3:] - R[3:, :3] @ np.linalg.solve(R[:3, :3], R[:3, 3:])
    first = np.cross(m, np.eye(3)[np.argmin(np.abs(m))])
    first /= np.linalg.norm(first)
    second, lean = np.cross(m, first), n @ b
    across = np.sqrt(max(1.0 - lean**2, 0.0))
    A, C, S = m @ D @ (lean * m), across * (m @ D @ first), across * (m @ D @ second)
    # A + C cos psi + S sin psi = 0, of its two roots that where it falls
    size = np.hypot(C, S)
    psi = (
        np.arctan2(S, C) + np.arccos(np.clip(-A / size, -1.0, 1.0))
        if size > SMALL * D[1, 1]
        else 0.0
    )
    w = lean * m + across * (np.cos(psi) * first + np.sin(psi) * second)
    seen, there = (np.stack([x, y, np.cross(x, y)], axis=1) for x, y in (
        (m, (w - lean * m) / across), (b, (n - lean * b) / across)))  # fmt: skip
    return there @ seen.T


def _moment(of: InTime) -> np.ndarray:
    """Moment of the robot where its filament is straight, body frame, (3,)."""
    loads = of.loads
    own = np.zeros(3) if loads.magnetic is None else loads.magnetic[:3]
    return own if loads.moments is None else own + loads.moments.sum(axis=0)


def _alike(of: InTime) -> bool:
    """Whether body and magnets look the same after a quarter of a turn about s."""
    turn, signs = [0, 2, 1, 3, 5, 4], np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])
    quarter = of.drag.body[np.ix_(turn, turn)] * np.outer(signs, signs)
    loads, same = of.loads, np.allclose(quarter, of.drag.body)
    if loads.magnetic is not None:
        C = loads.magnetic[3:].reshape(3, 3)
        same = same and np.allclose(C, np.diag([C[0, 0], C[1, 1], C[1, 1]]))
    if loads.moments is not None:
        same = same and not loads.moments[:, 1:].any()
    return bool(same)


def sped_up(at: Held) -> Held | None:
    """Return how a field that has sped up to its rate holds a robot; None where it slips."""
    drag, share, faster, done = at.of.drag, 1.0, 5.0, 0.0
    while done < 1.0:
        found = lasting(held(replace(at, of=replace(at.of, drag=slowed(drag, share)))))
        if found is not None:
            at, done = found, share
        elif done:
            faster **= 0.5
            if faster < LEAST_FASTER:
                return None
        elif share < SLOWEST:
            return None
        share = min(1.0, faster * done) if done else share / faster
    return at


def held(at: Held, step: float = 1.0) -> Held | None:
    """Return where a robot comes to rest in the field's axes, steps of that length first; None if
    nowhere.
    """
    for _ in range(STEPS):
        change = _change(at, step)
        size = np.abs(change[3:-1]).max()
        if not size <= FARTHEST:
            step /= 4.0
            if step < SHORTEST:
                return None
            continue
        at, step = at.moved(change), 16.0 * step
        if step > LONG and size <= SETTLED * max(1.0, np.abs(at.strains).max()):
            return at
    return None


def lasting(at: Held | None) -> Held | None:
    """Return a state that lasts: this one, or where a disturbance leads from it."""
    return at if at is None or at.growth <= GROWS else released(at)


def released(at: Held) -> Held | None:
    """Return where a robot goes from a state that a disturbance leaves, which steps too long for
    its growth would not see; None if it comes to rest nowhere.
    """
    rates, ways = at.disturbances
    worst = np.real(rates).argmax()
    step, way = 0.5 / np.real(rates)[worst], np.real(ways[:, worst])
    way = PUSHED / np.abs(way).max() * way
    for sense in (1.0, -1.0):
        gone = _followed(at.moved(np.concatenate([np.zeros(3), sense * way, [0.0]])), step)
        found = gone and held(gone, LONG)
        if found is not None and found.growth <= GROWS:
            return found
    return None


def _followed(at: Held, step: float) -> Held | None:
    """Steps of one length, until they have become small."""
    for _ in range(FOLLOWED):
        change = _change(at, step)
        size = np.abs(change[3:-1]).max()
        if not size <= FARTHEST:
            step /= 2.0
            continue
        at = at.moved(change)
        if size <= SLOW:
            return at
    return None


def _change(at: Held, step: float) -> np.ndarray:
    """An implicit step in time."""
    M, work, J = _linear(at)
    free = np.ones(J.shape[1], bool)
    free[3 if at.twirls else -1] = False  # its attitude about its own line, or no twirl
    J[:, 3:-1] += M[:, 3:] / step
    change = np.zeros(J.shape[1])
    change[free] = np.linalg.solve(J[:, free], -work)
    return change


def _linear(at: Held) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    M, work = at.balance()
    return M, work, at.slopes(work)
