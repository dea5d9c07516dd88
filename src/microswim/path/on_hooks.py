"""Tails on hooks: each stands on the body by a joint that bends, and its motor turns it.

With the tail's axis at rest d and now e (unit vectors of the body), S the smallest turn from d to
e, and the tail turned by its phase about d before that (the hook hands the motor's turning on, as a
bent shaft does), a tail turns relative to the body at

    e x e' - (d x e) . e' / (1 + d . e) e + w e

and the generalised velocities (V of the body, e' of each tail, rates w) follow from

    R V + F_i w_i = 0,    R_e e' + ... = - dU/de,    F_i . V + ... = tau_i(w_i),   U = K theta^2 / 2

with K = stiffness / length of the hook and theta its bend [Riley Das Lauga 2018]. Tails are rigid,
drag as if alone (resistive force theory), and pass through one another and the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.models.rft.gait import body_resistance, tail_series
from microswim.models.rft.placed import at_own_rates
from microswim.numerics.array import Array
from microswim.numerics.rigid_motion import skew
from microswim.numerics.series.fourier import evaluate
from microswim.path.torque_law import TorqueLaw
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.geometry.tails.placement import Placement
from microswim.swimmer.parts import replaced
from microswim.swimmer.swimmer import Swimmer

#: Cosine of the bend at which a hook is turned back on itself.
FOLDED = -0.98
#: By how much a rigid tail's thrust may differ from the drag of its turning.
RIGID = 1e-9


@dataclass(frozen=True, eq=False)
class OnHooks:
    """A swimmer of n rigid tails on hooks.

    Parameters
    ----------
    law
        The torques of the motors.
    body
        Resistance of the body (6, 6).
    roots
        Where the tails stand, from the body's centre (n, 3).
    rest
        Axes of each tail at rest, its own s first (n, 3, 3).
    own
        Resistance of each about its root in its own axes at phase zero (n, 6, 6).
    sense
        Which way a positive rate turns each about its axis (n,).
    turning_back
        Moment per angle of the hooks (n,).
    """

    law: TorqueLaw
    body: Array
    roots: Array
    rest: Array
    own: Array
    sense: Array
    turning_back: Array
    model: str = "rft"
    error: dict[str, Any] | None = None

    @property
    def axes(self) -> Array:
        """Axes of the tails at rest (n, 3)."""
        return self.rest[:, :, 0]

    def given(self, rate: Array) -> Array:
        """Return the torque of each motor at its rate, (n,)."""
        return self.law.given(rate)

    def turned(self, phases: Array, axes: Array) -> tuple[Array, Array]:
        """Return the axes of each tail (n, 3, 3): bent and without its phase, and with it."""
        bent = smallest_turns(self.axes, axes) @ self.rest
        c, s = np.cos(phases), self.sense * np.sin(phases)
        spin = np.zeros((len(phases), 3, 3))
        spin[:, 0, 0] = 1.0
        spin[:, 1, 1] = spin[:, 2, 2] = c
        spin[:, 1, 2], spin[:, 2, 1] = -s, s
        return bent, bent @ spin

    def moving(self, phases: Array, axes: Array) -> tuple[Array, Array, Array]:
        """Return twist V (6,), rates (n,) and how the axes (n, 3) move, of unit axes.

        Raises
        ------
        MicroswimError
            If a hook is bent back on itself, or as `TorqueLaw.turning`.
        """
        n = len(phases)
        cosine = np.sum(self.axes * axes, axis=1)
        if cosine.min() < FOLDED:
            k = int(np.argmin(cosine))
            raise MicroswimError(
                f"hook.stiffness: the hook of tail[{k}] is bent back on itself; take a stiffer one"
            )
        bent, now = self.turned(phases, axes)
        across = bent[:, :, 1:]  # two directions across each axis, in which it moves
        B = _both(now) @ self.own @ np.swapaxes(_both(now), 1, 2)
        with_body, by_itself = _at_root(self.roots), self._turns(axes, across, cosine)
        drag = B @ by_itself
        R = np.zeros((6 + 2 * n, 6 + 2 * n))
        R[:6, :6] = self.body + np.sum(np.swapaxes(with_body, 1, 2) @ B @ with_body, axis=0)
        coupling = np.swapaxes(with_body, 1, 2) @ drag  # (n, 6, 3)
        inner = np.swapaxes(by_itself, 1, 2) @ drag  # (n, 3, 3)
        F, k = np.zeros((6 + 2 * n, n)), np.arange(n)
        for a in range(2):
            R[:6, 6 + 2 * k + a] = coupling[:, :, a].T
            R[6 + 2 * k + a, :6] = coupling[:, :, a]
            for b in range(2):
                R[6 + 2 * k + a, 6 + 2 * k + b] = inner[:, a, b]
            F[6 + 2 * k + a, k] = inner[:, a, 2]
        F[:6] = coupling[:, :, 2].T
        push = np.zeros(6 + 2 * n)
        straightens = self.turning_back * _over_sine(cosine)
        push[6:] = (straightens[:, None] * np.einsum("ni,nij->nj", self.axes, across)).ravel()
        moves = np.concatenate([self.law.free, np.ones(2 * n, bool)])
        parts = R[np.ix_(moves, moves)], F[moves], np.diag(inner[:, 2, 2]), push[moves]
        found, rate = self.law.solved(*parts)
        whole = np.zeros(6 + 2 * n)
        whole[moves] = found
        return whole[:6], rate, np.einsum("nij,nj->ni", across, whole[6:].reshape(n, 2))

    def _turns(self, axes: Array, across: Array, cosine: Array) -> Array:
        """Return twists about the roots (n, 6, 3) per motion of each axis, and per rate."""
        out = np.zeros((len(axes), 6, 3))
        a, b = across[:, :, 0], across[:, :, 1]
        aside = np.cross(self.axes, axes) / (1.0 + cosine)[:, None]
        out[:, 3:, 0] = b - np.sum(aside * a, axis=1)[:, None] * axes
        out[:, 3:, 1] = -a - np.sum(aside * b, axis=1)[:, None] * axes
        out[:, 3:, 2] = self.sense[:, None] * axes
        return out

    def bend(self, axes: Array) -> Array:
        """Return the angle of each hook (..., n) at axes (..., n, 3)."""
        across = np.linalg.norm(np.cross(self.axes, axes), axis=-1)
        return np.arctan2(across, np.sum(self.axes * axes, axis=-1))

    def stored(self, axes: Array) -> Array:
        """Return the energy in all hooks (...,) at axes (..., n, 3)."""
        return 0.5 * np.sum(self.turning_back * self.bend(axes) ** 2, axis=-1)


def smallest_turns(start: Array, end: Array) -> Array:
    """Return the smallest rotations (n, 3, 3) from unit vectors (n, 3) to others, not opposite."""
    W = skew(np.cross(start, end))
    share = 1.0 / (1.0 + np.sum(start * end, axis=1))
    return np.eye(3) + W + share[:, None, None] * (W @ W)


def hooked(swimmer: Swimmer, law: TorqueLaw) -> OnHooks:
    """Return a swimmer with rigid tails on its `Hook`, by resistive force theory.

    Raises
    ------
    SpecError
        If a tail is not rigid.
    """
    assert swimmer.hook is not None
    tails = at_own_rates(swimmer.tail)
    centre = np.asarray(swimmer.body.centre, float)
    made = [_own(swimmer, n, tail) for n, tail in enumerate(tails)]
    return OnHooks(
        law=law,
        body=body_resistance(swimmer),
        roots=np.array([np.array(t.placement.root, float) - centre for t in tails]),
        rest=np.array([t.placement.rotation for t in tails], float),
        own=np.array([B for B, _ in made]),
        sense=np.array([sense for _, sense in made]),
        turning_back=swimmer.hook.of_each(len(tails)),
    )


def _own(swimmer: Swimmer, n: int, tail: Tail) -> tuple[Array, float]:
    """Return resistance about the root in a tail's own axes, and which way its motor turns it."""
    series = tail_series(replaced(swimmer, "tail", tail.own))
    R, F, _ = (evaluate(one, 0.0) for one in series)
    Ad = Placement().adjoint(np.asarray(swimmer.body.centre, float), np.zeros(3))
    B, thrust = Ad @ R @ Ad.T, Ad @ F
    sense = float(np.sign(thrust @ B[:, 3]))
    if np.linalg.norm(thrust - sense * B[:, 3]) > RIGID * np.linalg.norm(thrust):
        raise SpecError(f"tail[{n}].kind", tail.kind, "rigid on a [hook]", "as a helix is")
    return 0.5 * (B + B.T), sense


def _both(Q: Array) -> Array:
    """Return rotations (n, 6, 6) of forces and torques alike."""
    out = np.zeros((len(Q), 6, 6))
    out[:, :3, :3] = out[:, 3:, 3:] = Q
    return out


def _at_root(roots: Array) -> Array:
    """Return (n, 6, 6) that takes the body's twist to that of a point at each root."""
    out = np.tile(np.eye(6), (len(roots), 1, 1))
    out[:, :3, 3:] = -skew(roots)
    return out


def _over_sine(cosine: Array) -> Array:
    """Return an angle over its sine."""
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    return 1.0 / np.sinc(angle / np.pi)
