"""The shape to which a tail settles whose tilted base turns about s: it turns as a whole.

In axes that turn with the motor the shape is at rest. From the straight filament on, steps of
growing length in time lead to it as the filament itself would go, and end as Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.gait.quantities import magnitude
from microswim.models.elastic.filament import Filament, filament
from microswim.models.elastic.problem import check_options, elastic_tail
from microswim.models.elastic.space import (
    BalanceInSpace,
    DragInSpace,
    Pose,
    balance_in_space,
    pose,
)
from microswim.models.rft.gait import body_resistance
from microswim.numerics.series.fourier import TURN_S
from microswim.swimmer.swimmer import Swimmer

FIRST, MOST, TOLERANCE = 10, 40, 1e-5
STEPS, SHORTEST = 40, 1e-4
LEAST_SPIN = 1e-8  #: of the normal resistance, where a filament is given none
FARTHEST = 0.7  #: largest change of a coordinate in a step


@dataclass(frozen=True, eq=False)
class Whirl:
    """A shape that turns as a whole about s.

    Parameters
    ----------
    drag, rod
        What was solved, with which strains.
    rate
        1 or -1, the sense of the motor.
    shape
        Coordinates of two curvatures and the twist, (3, n).
    velocity
        Velocities of the body in the turning axes (6,), in units of phase rate and L.
    steps
        In phase and of Newton's method.
    """

    drag: DragInSpace
    rod: Filament
    rate: float
    shape: np.ndarray
    velocity: np.ndarray
    steps: int

    @property
    def pose(self) -> Pose:
        """Directors and places at its nodes."""
        return pose(self.rod, self.shape)

    @property
    def balance(self) -> BalanceInSpace:
        """The balance of work."""
        q, V = self.shape, self.velocity
        return balance_in_space(self.rod, self.drag, self.pose, q, V, self.rate)

    @property
    def rates(self) -> np.ndarray:
        """Eigenvalues of small disturbances in the turning axes, per unit phase."""
        at, f = self.balance, len(self.drag.free)
        R, G = np.real(at.resistance), np.real(at.stiffness)
        return np.linalg.eigvals(-np.linalg.solve(R, G)[f:])

    @property
    def growth(self) -> float:
        """Factor by which the slowest disturbance changes in a period."""
        if not self.rate:
            return 0.0
        return float(np.exp(np.clip(2.0 * np.pi * np.real(self.rates).max(), -700.0, 700.0)))


def drag_in_space(swimmer: Swimmer) -> DragInSpace:
    """Return the resistances of an elastic swimmer whose base turns about s.

    Raises
    ------
    SpecError
        If the body has no symmetry about s, so that the tail would meet another body as it turns.
    """
    _check_symmetry(body_resistance(swimmer), swimmer.motion.mask)
    return resistances(swimmer, magnitude(elastic_tail(swimmer).rate))


def resistances(swimmer: Swimmer, rate: float) -> DragInSpace:
    """Return the resistances of an elastic swimmer, time over a unit of rate.

    Raises
    ------
    SpecError
        If the swimmer has readings or corrections that an elastic tail has not.
    """
    tail = elastic_tail(swimmer)
    check_options(swimmer)
    L, mu, law = tail.length, swimmer.fluid.viscosity, swimmer.coefficients
    per_force = rate * L**4 / tail.bending
    c = [x * c for x, c in zip(swimmer.interaction.tail, law.local(tail, mu))]
    lengths = np.array([1.0, 1.0, 1.0, L, L, L])
    return DragInSpace(
        tangential=per_force * c[0],
        normal=per_force * c[1],
        spin=max(per_force * c[2] / L**2, LEAST_SPIN * per_force * c[1], key=np.real),
        tip=per_force * law.end(tail, mu) / L,
        body=per_force * body_resistance(swimmer) / np.outer(lengths, lengths) / L,
        offset=swimmer.body.semi_axes3[0] / L,
        free=tuple(np.flatnonzero(swimmer.motion.mask).tolist()),
    )


def _check_symmetry(body: np.ndarray, mask: tuple[bool, ...]) -> None:
    """A quarter turn about s must change nothing."""
    turn = [0, 2, 1, 3, 5, 4]
    signs = np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0])
    quarter = body[np.ix_(turn, turn)] * np.outer(signs, signs)
    alike = np.allclose(quarter, body) and np.allclose(body * np.outer(TURN_S, TURN_S), body)
    if not alike or mask[1] != mask[2] or mask[4] != mask[5]:
        raise SpecError(
            "tail.drive", "rotate", "that of a tail on a body alike in all directions across s",
            "take a body of revolution, interaction and motion.free alike for q and r",
        )  # fmt: skip


def whirl(swimmer: Swimmer) -> Whirl:
    """Return the shape to which the tail settles, with as many strains as it takes.

    Raises
    ------
    SpecError
        As `drag_in_space`.
    MicroswimError
        If it settles to none, or to one that takes too many strains.
    """
    drag, tail = drag_in_space(swimmer), elastic_tail(swimmer)
    rate, rest = float(np.sign(np.real(tail.rate))), tail.rest_shape
    n = max(FIRST, 0 if rest is None else rest.modes() + 2)
    rod = filament_of(swimmer, n)
    at = Whirl(drag, rod, rate, rod.rest, np.zeros(6), 0)
    found = _sped_up(at) if rate else at
    while n <= MOST:
        bent = (found.shape - found.rod.rest)[:, -2:]
        if np.abs(bent).max() <= TOLERANCE * np.abs(found.shape).max():
            return found
        more = max(6, n // 3)
        n += more
        rod = filament_of(swimmer, n)
        at = replace(found, rod=rod, shape=np.pad(found.shape, ((0, 0), (0, more))))
        found = settled_at(at) or _sped_up(replace(at, shape=rod.rest))
    raise MicroswimError("the turning tail bends too sharply to be resolved; stiffen it")


def filament_of(swimmer: Swimmer, modes: int) -> Filament:
    """Return the filament of a swimmer with its hook, of so many polynomials a strain."""
    tail, hook = elastic_tail(swimmer), None
    if tail.base == "hinged":
        hook = 0.0
    elif swimmer.hook is not None:
        hook = swimmer.hook.turning * tail.length / tail.bending
    tilt = (tail.angle or 0.0) if tail.turns else 0.0
    return filament(modes, twisting=tail.twist_ratio, rest=tail.rest_shape, tilt=tilt, hook=hook)


def _sped_up(straight: Whirl) -> Whirl:
    """Turned slowly first, then faster and faster, as a motor that starts would turn it."""
    drag, at = straight.drag, straight
    share, faster, done = min(1.0, 1.0 / float(np.real(drag.normal))), 5.0, 0.0
    while done < 1.0:
        found = settled_at(replace(at, drag=slowed(drag, share)))
        if found is None:
            faster **= 0.5
            if faster < 1.02:
                raise MicroswimError(
                    f"beyond {done:.0%} of its rate the turning tail settles to no shape that "
                    "turns as a whole: turn it slower or stiffen it"
                )
        else:
            at, done = found, share
        share = min(1.0, faster * done) if done else share / faster
    return at


def slowed(drag: DragInSpace, share: float) -> DragInSpace:
    """Return the resistances where the motor turns at a share of its rate."""
    names = ("tangential", "normal", "spin", "tip", "body")
    return replace(drag, **{name: share * getattr(drag, name) for name in names})


def settled_at(at: Whirl) -> Whirl | None:
    """Return where implicit steps in phase, each longer than the last, end; None if nowhere."""
    step, last = 10.0, np.inf
    for _ in range(STEPS):
        change = _change(at, at.balance, step)
        size = np.abs(change[len(at.drag.free) :]).max()
        if not size <= FARTHEST:
            step /= 4.0
            if step < SHORTEST:
                return None
            continue
        at, step = _moved(at, change), 16.0 * step
        small = step > 1e3 and size <= 1e-9 * max(1.0, np.abs(at.shape).max())
        if small and (last <= 1e-7 or not np.iscomplexobj(change)):
            return at
        last = size
    return None


def _change(at: Whirl, balance: BalanceInSpace, step: float) -> np.ndarray:
    f = len(at.drag.free)
    A = np.concatenate([balance.resistance[:, :f], balance.stiffness], axis=1)
    A[:, f:] += balance.resistance[:, f:] / step
    return -np.linalg.solve(A, balance.residual)


def _moved(at: Whirl, change: np.ndarray) -> Whirl:
    f, V = len(at.drag.free), at.velocity + 0.0 * change[-1]
    V[list(at.drag.free)] += change[:f]
    q = at.shape + change[f:].reshape(3, -1)
    return replace(at, shape=q, velocity=V, steps=at.steps + 1)
