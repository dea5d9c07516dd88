"""An elastic swimmer in time: how its pose and its shape change, by the balance of work.

The state is the body's centre x (lab), its quaternion, and the filament's strains q; w are the
body's free velocities and dq/dt. With the shifts ``X_i`` and turns ``phi_i`` of `space`,

    sum_j M_ij w_j = -[ X_i . f(v_d - u) + phi_i . m(w_d) + K_i (q_i - q_i^0) - loads_i ],

v_d by the drive and u the fluid's. Nothing stretches, so nothing is stiff but bending: its part of
the derivative, ``-M^-1 K``, and that of the loads is all that implicit steps need. Leading axes of
the arrays are times side by side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from microswim.models.elastic.filament import Filament
from microswim.models.elastic.space import (
    AXIS,
    DragInSpace,
    Pose,
    as_it_bends,
    cross,
    cross_columns,
    dots,
    flat,
    pose,
    rigid_motions,
    shapes_of,
    swap,
    worked,
)
from microswim.models.elastic.unsteady.loads import Loads, Pull, pull
from microswim.numerics.rigid_motion import multiply, rotation_matrix, skew
from microswim.swimmer.geometry.tails.elastic.elastic_tail import Drive

POSE = 7  #: numbers of the state before the strains


@dataclass(frozen=True, eq=False)
class Moved:
    """How the drive moves the base: place from the joint, directors, velocity, rate of turning."""

    place: np.ndarray
    directors: np.ndarray
    velocity: np.ndarray
    turning: np.ndarray


@dataclass(frozen=True, eq=False)
class InTime:
    """An elastic swimmer without units: lengths in L, forces in ``B / L^2``.

    Parameters
    ----------
    rod, drag, loads
        Filament, resistances and loads.
    drive, size
        What drives it, and the length, angle or moment of that.
    waves
        Of inner moment, in L.
    rate
        Of the phase, in units of time.
    phase
        At time 0.
    """

    rod: Filament
    drag: DragInSpace
    loads: Loads
    drive: Drive
    size: float
    waves: float
    rate: float
    phase: float

    def base(self, time: float | np.ndarray) -> Moved:
        """Return where the drive holds the base."""
        angle = np.asarray(self.phase + self.rate * time)[..., None]
        rest = np.zeros((*angle.shape[:-1], 3))
        c, s = np.cos(angle), np.sin(angle)
        D = self.rod.base
        if self.drive == "heave":
            across = self.size * np.array([0.0, 1.0, 0.0])
            return Moved(c * across, D, -self.rate * s * across, rest)
        if self.drive == "pivot":
            about_r = np.array([0.0, 0.0, 1.0])
            turned = D @ _turned(about_r, self.size * c)
            return Moved(rest, turned, rest, -self.rate * self.size * s * about_r)
        if self.drive == "rotate":
            return Moved(rest, D @ _turned(AXIS, angle), rest, rest + self.rate * AXIS)
        return Moved(rest, D, rest, rest)

    def active(self, time: float | np.ndarray) -> np.ndarray:
        """Return the bends (..., 3, n) that inner moments would make of a straight filament."""
        angle = np.asarray(self.phase + self.rate * time)[..., None]
        kind = np.result_type(self.size, self.waves, self.rod.rest)
        bends = np.zeros((*angle.shape[:-1], *self.rod.rest.shape), kind)
        if self.drive == "moment":
            wave = self.size * np.cos(angle - 2.0 * np.pi * self.waves * self.rod.s)
            bends[..., 1, :] = (wave * self.rod.weight) @ self.rod.curvatures
        return bends

    def seen(
        self, time: float | np.ndarray, y: np.ndarray
    ) -> tuple[Pose, np.ndarray, np.ndarray, Moved]:
        """Return the filament, its nodes from the body's centre (..., m, 3), and the body's
        rotation.
        """
        turn = y[..., 3:POSE]
        Q = rotation_matrix(turn / np.linalg.norm(turn, axis=-1, keepdims=True))
        q = y[..., POSE : POSE + self.rod.rest.size]
        moved = self.base(time)
        at = pose(self.rod, q.reshape(*q.shape[:-1], 3, -1), moved.directors)
        X = at.place + moved.place[..., None, :] + self.drag.offset * AXIS
        return at, X, Q, moved

    def moment(self, time: float | np.ndarray, y: np.ndarray) -> Moment:
        """Return the balance at times (...) and states (..., 7 + 3 n or more)."""
        at, X, Q, moved = self.seen(time, y)
        rod, drag, loads = self.rod, self.drag, self.loads
        phi, shifted = shapes_of(rod, at)
        rigid_phi, rigid_shift = rigid_motions(X, drag.free)
        turn = np.concatenate([rigid_phi, phi], -1)
        shift = np.concatenate([rigid_shift, shifted], -1)
        spin = loads.spin @ Q
        still = np.zeros((*X.shape[:-2], 6), np.result_type(loads.spin, X))
        v = moved.velocity[..., None, :] + cross(moved.turning[..., None, :], at.place)
        if loads.flow is not None:
            v = v - loads.flow(y[..., None, :3] + X @ swap(Q)) @ Q
            still[..., :3] = -(loads.flow(y[..., None, :3]) @ Q)[..., 0, :]
        still[..., 3:] = -spin
        acts = pull(loads, rod, at, X, time, y[..., :3], Q)  # type: ignore[arg-type]
        return Moment(self, at, moved, turn, shift, v, spin, still, acts, Q)


def _turned(axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Matrices that turn rows by angles (..., 1) about one of the axes."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    both = np.outer(axis, axis)
    return both + c * (np.eye(3) - both) - s * skew(axis)


@dataclass(frozen=True, eq=False)
class Moment:
    """The balance of work at one time: see `InTime`.

    Parameters
    ----------
    of
        Whose.
    at, moved
        The filament and its base.
    turn, shift
        Of each node by each velocity, (..., m, 3, f + 3 n).
    v, spin, still
        Velocity of the nodes and twist of the body, against the fluid, were all w zero; half the
        curl of the flow; body frame.
    acts
        The loads.
    Q
        Body to lab.
    """

    of: InTime
    at: Pose
    moved: Moved
    turn: np.ndarray
    shift: np.ndarray
    v: np.ndarray
    spin: np.ndarray
    still: np.ndarray
    acts: Pull
    Q: np.ndarray

    @property
    def tangent(self) -> np.ndarray:
        """Unit tangents, (..., m, 3)."""
        return self.at.directors[..., 2, :]

    @property
    def stream(self) -> np.ndarray:
        """Velocity of the nodes against the fluid, (..., m, 3), were neither base nor w moving."""
        moved = self.moved
        return (
            self.v
            - moved.velocity[..., None, :]
            - cross(moved.turning[..., None, :], self.at.place)
        )

    @property
    def turning(self) -> np.ndarray:
        """Rate (..., 1, 3) at which the sections turn against the fluid, were all w zero."""
        return (self.moved.turning - self.spin)[..., None, :]

    def drag(self, v: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return force and torque (..., m, 3) on the fluid by velocities and rates of turning."""
        rod, c, t = self.of.rod, self.of.drag, self.tangent
        W_t, W_n, W_r = c.along(rod)
        f = W_n[:, None] * v + ((W_t - W_n) * (t * v).sum(axis=-1))[..., None] * t
        return f, (W_r * (t * w).sum(axis=-1))[..., None] * t

    @cached_property
    def dragged(self) -> tuple[np.ndarray, np.ndarray]:
        """Force on the fluid at each node by each velocity, (..., m, 3, N), and rate at which it
        spins there, (..., m, N).
        """
        t = self.tangent
        W_t, W_n, _ = self.of.drag.along(self.of.rod)
        along = (W_t - W_n)[:, None] * dots(t, self.shift)
        force = W_n[:, None, None] * self.shift + t[..., None] * along[..., None, :]
        return force, dots(t, self.turn)

    def resistance(self) -> np.ndarray:
        """Return M, (..., f + 3 n, f + 3 n)."""
        c, (force, spun) = self.of.drag, self.dragged
        W_r, f = c.along(self.of.rod)[2], len(c.free)
        M = swap(flat(self.shift)) @ flat(force) + swap(spun) @ (W_r[:, None] * spun)
        M[..., :f, :f] += c.body[np.ix_(c.free, c.free)]
        return M

    def stiffness(self, w: np.ndarray) -> np.ndarray:
        """Return how the work of each velocity grows as things move that way, but for how drag
        changes with the velocities that this brings.
        """
        of, acts, turn, shift = self.of, self.acts, self.turn, self.shift
        c, free, N = of.drag, list(of.drag.free), shift.shape[-1]
        f, t = len(free), self.tangent
        v, spin = self.velocity(w)
        on, twist = self.drag(v, spin)
        W_t, W_n, W_r = c.along(of.rod)
        dt = cross_columns(turn[..., f:], t[..., None])
        along, turning = (t * v).sum(axis=-1), (t * spin).sum(axis=-1)
        df = ((W_t - W_n)[:, None] * dots(v, dt))[..., None, :] * t[..., None]
        df += ((W_t - W_n) * along)[..., None, None] * dt
        dm = (W_r[:, None] * dots(spin, dt))[..., None, :] * t[..., None]
        dm += (W_r * turning)[..., None, None] * dt
        df += acts.shifting @ shift[..., f:]
        dm += acts.turning @ turn[..., f:]
        G = np.zeros((*shift.shape[:-3], N, N), np.result_type(df, dm, of.rod.stiffness))
        G[..., f:] = swap(flat(shift)) @ flat(df) + swap(flat(turn)) @ flat(dm)
        loads = on - acts.force, twist - acts.torque
        G[..., f:] += as_it_bends(of.rod, self.at, (turn[..., f:], shift[..., f:]), loads, c.free)
        G[..., range(f, N), range(f, N)] += of.rod.stiffness.ravel()
        G[..., :f] = self._as_the_body_moves()[..., free]
        return G

    def velocity(self, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the velocities against the fluid of each node and its section, (..., m, 3)."""
        v, spin = (flat(x) @ w[..., None] for x in (self.shift, self.turn))
        return self.v + v.reshape(self.v.shape), self.turning + spin.reshape(self.v.shape)

    def _as_the_body_moves(self) -> np.ndarray:
        """The same as the body moves along and turns about its axes, (..., f + 3 n, 6)."""
        acts, free = self.acts, list(self.of.drag.free)
        f, N = len(free), self.shift.shape[-1]
        G = np.zeros((*self.shift.shape[:-3], N, 6), acts.force.dtype)
        shift, turn = swap(flat(self.shift)), swap(flat(self.turn))
        G[..., :3] = shift @ flat(acts.shifting)
        G[..., 3:] = shift @ flat(swap(skew(acts.force)))  # e x F, of the lab's loads
        G[..., 3:] += turn @ flat(swap(acts.turning))
        own = np.zeros((*self.shift.shape[:-3], 6, 6), acts.force.dtype)
        own[..., :3, :3] = acts.body[..., :3, :3]
        own[..., :3, 3:] = swap(skew(acts.wrench[..., :3]))
        own[..., 3:, 3:] = swap(acts.body[..., 3:, 3:])
        G[..., :f, :] += own[..., free, :]
        return G

    def velocities(self, time: float, y: np.ndarray) -> np.ndarray:
        """Return w, (f + 3 n,)."""
        M, work = self.balance(time, y)
        return -np.linalg.solve(M, work)

    def balance(self, time: float | np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return M, and the work of each velocity were all of them zero."""
        of, c = self.of, self.of.drag
        F, m = self.drag(self.v, self.turning)
        work = worked(self.shift, F - self.acts.force) + worked(self.turn, m - self.acts.torque)
        f, q = len(c.free), y[..., POSE : POSE + of.rod.rest.size]
        active = of.active(time)
        bent = q - of.rod.rest.ravel() - active.reshape(*active.shape[:-2], -1)
        work[..., f:] += of.rod.stiffness.ravel() * bent
        work[..., :f] += (self.still @ c.body.T - self.acts.wrench)[..., list(c.free)]
        return self.resistance(), work

    def powers(self, w: np.ndarray, time: float) -> tuple[float, float]:
        """Return what drive and inner moments give, and what the fluid takes."""
        of, c = self.of, self.of.drag
        f = len(c.free)
        driven = self.moved.velocity + cross(self.moved.turning, self.at.place)
        v, spin = self.velocity(w)
        F, m = self.drag(v, spin)
        given = ((F - self.acts.force) * driven).sum()
        given += ((m - self.acts.torque) @ self.moved.turning).sum()
        given += (of.rod.stiffness * of.active(time)).ravel() @ w[f:]
        V = self.still.copy()
        V[list(c.free)] += w[:f]
        return float(given), float((F * v).sum() + V @ c.body @ V + (m * spin).sum())

    def power_slopes(self, w: np.ndarray, time: float) -> np.ndarray:
        """Return the derivatives of the two powers by w, (2, f + 3 n)."""
        of, c = self.of, self.of.drag
        f, shift, turn = len(c.free), flat(self.shift), flat(self.turn)
        driven = self.moved.velocity + cross(self.moved.turning, self.at.place)
        F, m = self.drag(driven, np.broadcast_to(self.moved.turning, driven.shape))
        given = shift.T @ F.ravel() + turn.T @ m.ravel()
        given[f:] += (of.rod.stiffness * of.active(time)).ravel()
        F, m = self.drag(*self.velocity(w))
        took = 2.0 * (shift.T @ F.ravel() + turn.T @ m.ravel())
        V = self.still.copy()
        V[list(c.free)] += w[:f]
        took[:f] += 2.0 * (c.body @ V)[list(c.free)]
        return np.stack([given, took])


def rates(of: InTime, time: float, y: np.ndarray) -> np.ndarray:
    """Return dy/dt: pose, strains, then the work of the drive and what was dissipated."""
    now = of.moment(time, y)
    w, f = now.velocities(time, y), len(of.drag.free)
    V = np.zeros(6)
    V[list(of.drag.free)] = w[:f]
    q = y[3:POSE] / np.linalg.norm(y[3:POSE])
    turned = multiply(q, np.append(0.0, V[3:])) / 2.0
    return np.concatenate([now.Q @ V[:3], turned, w[f:], now.powers(w, time)])


def derivative(of: InTime, time: float, y: np.ndarray) -> np.ndarray:
    """Return the part of d(dy/dt)/dy that is stiff."""
    now = of.moment(time, y)
    size = of.rod.rest.size
    M, work = now.balance(time, y)
    w = -np.linalg.solve(M, work)
    A = -np.linalg.solve(M, now.stiffness(w))
    q = y[3:POSE] / np.linalg.norm(y[3:POSE])
    turns = np.stack([multiply(q, np.append(0.0, e)) for e in np.eye(3)], axis=1) / 2.0
    T = np.zeros((POSE + size, 6 + size))
    T[:3, :3], T[3:POSE, 3:6], T[POSE:, 6:] = now.Q, turns, np.eye(size)
    back = np.zeros((6 + size, POSE + size))
    back[:3, :3], back[3:6, 3:POSE], back[6:, POSE:] = now.Q.T, 4.0 * turns.T, np.eye(size)
    keep = [*of.drag.free, *range(6, 6 + size)]
    J = np.zeros((len(y), len(y)))
    A = A @ back[keep]
    J[: POSE + size, : POSE + size] = T[:, keep] @ A
    J[POSE + size :, : POSE + size] = now.power_slopes(w, time) @ A
    return J
