"""What pulls at body and filament: weight, magnetic field, wall, and the fluid's own flow.

    filament, per length   (rho - rho_f) pi r^2 g,   m_l x B and J' m_l,   push exp(-gap / reach) n
                           with m_l = m_0 + c B, c of what the field magnetises
    body                   (rho_b - rho_f) V_b g,    m x B and J' m,       the same push

The repulsion of a wall is short-ranged and has no lubrication in it: it lets nothing through.
Lengths are in L, forces in ``B / L^2``, time over the unit of rate; the field keeps its own unit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from microswim.models.elastic.filament import Filament
from microswim.models.elastic.space import Pose, cross
from microswim.swimmer.surroundings.flow import Flow


@dataclass(frozen=True, eq=False)
class Wall:
    """The plane z = 0: push per length, range, half thickness of filament and body (s, q, r)."""

    push: float
    reach: float
    radius: float
    girth: np.ndarray

    def on(self, gap: Any) -> tuple[Any, Any]:
        """Return the force away from the wall at a gap, and how it falls with it."""
        force = self.push * np.exp(-np.minimum(gap, 40.0 * self.reach) / self.reach)
        return force, force / self.reach


@dataclass(frozen=True, eq=False)
class Loads:
    """Loads on an elastic swimmer, without units.

    Parameters
    ----------
    weight, body_weight
        Of the filament per length and of the body, lab frame, (3,).
    arm
        From the body's centre to where its weight acts, body frame, (3,).
    force, torque
        Further ones on the body about its centre, lab frame, (3,).
    magnetic
        Torque per field of the body's magnet: m_0, then C row by row, body frame, (12,).
    moments, soft
        Moment of each node and what a field adds to it, moment per field, by the node's own axes
        ``t, d_1, d_2``, (m, 3) each; None: not magnetic.
    field, gradient
        B (3,) at a time, and ``dB_i/dx_j`` (3, 3), lab frame, at a place; None: no field.
    flow
        Velocity (..., 3) at places (..., 3), lab frame; None: at rest.
    spin
        Half the curl of the flow, lab frame, (3,).
    wall
        Beside the swimmer, or None.
    slope
        Gradient of the flow, ``du_i/dx_j``, lab frame, (3, 3); None: no flow.
    """

    weight: np.ndarray
    body_weight: np.ndarray
    arm: np.ndarray
    force: np.ndarray
    torque: np.ndarray
    magnetic: np.ndarray | None
    moments: np.ndarray | None
    soft: np.ndarray | None
    field: Callable[[float, np.ndarray], tuple[np.ndarray, np.ndarray]] | None
    flow: Callable[[np.ndarray], np.ndarray] | None
    spin: np.ndarray
    wall: Wall | None
    slope: np.ndarray | None = None

    @property
    def push(self) -> float:
        """Push of the wall per length; 0 without one."""
        return 0.0 if self.wall is None else self.wall.push + 0.0 * self.wall.radius

    def still(self, held: bool) -> Loads:
        """Return what acts on a swimmer in one place: no field, and nothing on one that is free."""
        if held:
            return replace(self, field=None)
        none = dict.fromkeys(("field", "flow", "slope", "wall"))
        return replace(
            self, **none, **dict.fromkeys(("weight", "body_weight", "spin"), np.zeros(3))
        )

    def share(self, part: float) -> Loads:
        """Return a part of weight and flow."""
        flow = self.flow
        less = None if flow is None else (lambda x: part * flow(x))
        slope = None if self.slope is None else part * self.slope
        weight = {"weight": part * self.weight, "body_weight": part * self.body_weight}
        return replace(self, flow=less, slope=slope, spin=part * self.spin, **weight)


@dataclass(frozen=True, eq=False)
class Pull:
    """What the loads do at a moment, body frame, and how it changes as things move.

    Parameters
    ----------
    force, torque
        On each node, (..., m, 3).
    wrench
        On the body about its centre, (..., 6).
    shifting, turning
        Fall of force with the node's place, and of torque with its rotation, (..., m, 3, 3).
    body
        The same of the wrench, (..., 6, 6).
    """

    force: np.ndarray
    torque: np.ndarray
    wrench: np.ndarray
    shifting: np.ndarray
    turning: np.ndarray
    body: np.ndarray


def pull(
    loads: Loads, rod: Filament, at: Pose, X: np.ndarray, time: float, x: np.ndarray, Q: np.ndarray
) -> Pull:
    """Return what pulls at the nodes, places X (..., m, 3) from the body's centre at x (lab).

    Q is the rotation matrix from the body to the lab. In a field it is a single pose.
    """
    given = (loads.body_weight, loads.arm, loads.force, loads.torque, loads.push)
    kind = np.result_type(X, x, Q, loads.weight, *given)
    force = (rod.weight[:, None] * (loads.weight @ Q)[..., None, :]).astype(kind) + 0.0 * X
    torque, wrench = np.zeros(X.shape, kind), np.zeros((*X.shape[:-2], 6), kind)
    shifting, turning = np.zeros((2, *X.shape, 3), kind)
    body = np.zeros((*X.shape[:-2], 6, 6), kind)
    heavy = loads.body_weight @ Q
    wrench[..., :3] = (loads.force @ Q) + heavy
    wrench[..., 3:] = (loads.torque @ Q) + cross(loads.arm, heavy)
    if loads.field is not None:
        B, J = loads.field(time, x)
        B, J = B @ Q, Q.T @ J @ Q
        if loads.magnetic is not None:
            moment = loads.magnetic[:3] + loads.magnetic[3:].reshape(3, 3) @ B
            wrench[:3] += J.T @ moment
            wrench[3:] += cross(moment, B)
            body[3:, 3:] += _turned(moment, B)
        if loads.moments is not None:
            axes = at.directors[:, [2, 0, 1]]
            here = B + X @ J.T
            moment = np.einsum("mi,mij->mj", loads.moments, axes)
            if loads.soft is not None:
                own = loads.soft * np.einsum("mij,mj->mi", axes, here)
                moment = moment + np.einsum("mi,mij->mj", own, axes)
                turning += _as_soft_turns(loads.soft, axes, here)
            torque += cross(moment, here)
            force += moment @ J
            turning += _turned(moment, here)
    if loads.wall is not None:
        _push(loads.wall, rod, X, x, Q, force, wrench, shifting, body)
    return Pull(force, torque, wrench, shifting, turning, body)


def _turned(moment: np.ndarray, B: np.ndarray) -> np.ndarray:
    """How ``m x B`` falls as m turns: ``(m . B) I - m B'``."""
    size = (moment * B).sum(axis=-1)[..., None, None] * np.eye(3)
    return size - moment[..., :, None] * B[..., None, :]


def _as_soft_turns(soft: np.ndarray, axes: np.ndarray, B: np.ndarray) -> np.ndarray:
    """How ``(C B) x B`` falls beside that as the axes of C turn: ``[B] C [B]``."""
    across = cross(axes, B[:, None])  # rows e_i x B
    return -np.einsum("mi,mij,mik->mjk", soft, across, across)


def _push(
    wall: Wall, rod: Filament, X: np.ndarray, x: np.ndarray, Q: np.ndarray,
    force: np.ndarray, wrench: np.ndarray, shifting: np.ndarray, body: np.ndarray,
) -> None:  # fmt: skip
    up = Q[..., 2, :]  # z by the body's axes
    on, fall = wall.on(x[..., 2, None] + (X @ up[..., None])[..., 0] - wall.radius)
    both = up[..., :, None] * up[..., None, :]
    force += (rod.weight * on)[..., None] * up[..., None, :]
    shifting += (rod.weight * fall)[..., None, None] * both[..., None, :, :]
    own, own_fall = wall.on(x[..., 2] - np.sqrt(((wall.girth * up) ** 2).sum(axis=-1)))
    wrench[..., :3] += own[..., None] * up
    body[..., :3, :3] += own_fall[..., None, None] * both


def half_curl(flow: Flow) -> np.ndarray:
    """Return half the curl (3,) of a flow whose gradient is the same everywhere."""
    A = flow.gradient
    return np.array([A[2, 1] - A[1, 2], A[0, 2] - A[2, 0], A[1, 0] - A[0, 1]]) / 2.0
