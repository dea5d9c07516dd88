"""The wave laid on the straight mesh, and the blended rigid motion of the whole swimmer.

With sigma = s clamped to the tail, e = X - sigma e_s, rho = |e| (distance from the straight axis),

    x = X + w1(rho) (P(s) - s e_s) + w2(rho) min(1, r_t/rho) (Q(sigma) - 1) e.

The first term carries the section to the centreline (s clamped to the tail, with sheared sections
to tail and cap), the second turns it: Q takes e_s to the tangent (perpendicular sections) or is
the identity (sheared sections). w1, w2 fall from 1 on the tail to 0, so the far mesh never moves.
Close to the joint perpendicular sections would leave the body's surface; there Q - 1 gives way to
the stretch in planes of constant s that a straight oblique tube has, and the body's surface slides
over itself. The mesh stays valid while |P - sigma e_s| max|w1'| < 1.

Nothing here knows a mesh: positions are NumPy arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from microswim.errors import SpecError, measured
from microswim.models import swimmer_surface as geometry
from microswim.models.fem.mesh import Outline
from microswim.swimmer.swimmer import Swimmer


def fade(t: np.ndarray) -> np.ndarray:
    """Return 1 for t <= 0, 0 for t >= 1, 1 - 3t^2 + 2t^3 between; steepest slope 3/2."""
    t = np.clip(t, 0.0, 1.0)
    return 1.0 - t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True)
class Wave:
    """The displacement that turns the straight tail of an outline into the swimmer's.

    Parameters
    ----------
    swimmer
        Body and tail, in its own units.
    outline
        Its outline; lengths here are divided by `outline.unit`.
    room
        Distance from the axis within which the mesh may move, in the outline's unit (the nearest
        wall).
    """

    swimmer: Swimmer
    outline: Outline
    room: float

    @property
    def reach(self) -> float:
        """Largest distance of the centreline from the axis."""
        s = np.linspace(0.0, self.outline.length, 401) * self.outline.unit
        phases = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
        far = [np.hypot(*self._curve(s, phase).P[:, 1:].T).max() for phase in phases]
        return float(max(far)) / self.outline.unit

    @property
    def scale(self) -> float:
        """Length over which the centreline bends, reach over steepest slope (1/k of a wave)."""
        s = np.linspace(0.0, self.outline.length, 401) * self.outline.unit
        slope = np.hypot(*self._curve(s, 0.0).P_s[:, 1:].T).max()
        return self.reach / max(float(slope), 1e-12)

    @property
    def width(self) -> float:
        """Distance over which w1 fades: three times the reach, within the room there is."""
        wanted = max(3.2 * self.reach, 3.0 * self.outline.radius)
        return min(wanted, 0.9 * (self.room - self.outline.radius))

    def check(self) -> None:
        """Refuse a wave too high for the fading zone around it."""
        if 1.5 * self.reach >= 0.9 * self.width:
            most = 0.6 * self.width * self.outline.unit
            raise SpecError(
                "tail.amplitude",
                self.reach * self.outline.unit,
                f"below {measured(most, 'tail.amplitude')}, or the mesh would fold",
                "lower the wave or give it more room to the wall",
            )

    def _curve(self, s: np.ndarray, phase: float) -> geometry.Curve:
        return geometry.smooth_centreline(self.swimmer.tail, s, phase)

    def _sigma(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Foot on the straight axis, offset e from it, and its length rho."""
        sigma = np.clip(X[:, 0], self.outline.joint, self.outline.length)
        offset = X.copy()
        offset[:, 0] -= sigma
        return sigma, offset, np.linalg.norm(offset, axis=1)

    def _along(self, X: np.ndarray) -> np.ndarray:
        """s of the centreline that a point follows.

        Sheared: its own plane's, the cap's sections included (the centreline continued by r_t);
        perpendicular: the foot's, so that the cap is a hemisphere about P(L).
        """
        sheared = self.swimmer.tail.sections == "sheared"
        start = self.outline.joint if self.outline.has_body or not sheared else -self.outline.radius
        end = self.outline.length + (self.outline.radius if sheared else 0.0)
        return np.clip(X[:, 0], start, end)

    def displacement(self, X: np.ndarray, phase: float) -> np.ndarray:
        """Return x - X at the points X (n, 3) of the straight mesh."""
        r_t, unit = self.outline.radius, self.outline.unit
        moved = np.zeros_like(X)
        sigma, offset, rho = self._sigma(X)
        near = rho < r_t + self.width
        sigma, offset, rho = sigma[near], offset[near], rho[near]
        curve = self._curve(sigma * unit, phase)
        along = self._along(X[near])
        shift = self._curve(along * unit, phase).P / unit
        shift[:, 0] -= along
        step = fade((rho - r_t) / self.width)[:, None] * shift
        if self.swimmer.tail.sections == "perpendicular":
            scale = np.minimum(1.0, r_t / np.maximum(rho, 1e-30)) * fade((rho - r_t) / self.turn)
            step += scale[:, None] * self._turned(sigma, offset, curve)
        if self.outline.has_body:
            step = self._beside_body(X[near])[:, None] * step
            step[:, 0] += self._slide(X[near], step)
        moved[near] = step
        return moved

    def _beside_body(self, X: np.ndarray) -> np.ndarray:
        """Factor that ends the displacement before the body's widest outline.

        1 near the axis and behind the body; 0 where the body's surface turns away from the tail.
        """
        _, b, c = self.outline.semi_axes
        outward = fade((((X[:, 1] / b) ** 2 + (X[:, 2] / c) ** 2) - 0.25) / 0.5)
        upstream = fade((X[:, 0] - self.outline.joint) / (0.5 * self.width))
        return 1.0 - (1.0 - outward) * upstream

    @property
    def turn(self) -> float:
        """Distance over which w2 fades."""
        return min(self.width, 4.0 * self.outline.radius)

    def _turned(self, sigma: np.ndarray, offset: np.ndarray, curve: geometry.Curve) -> np.ndarray:
        """(Q - 1) e, blended near the joint into the stretch of an oblique tube's section."""
        n1, n2 = geometry.section_axes(self.swimmer.tail, curve)
        T = curve.tangent
        turned = offset[:, :1] * T + offset[:, 1:2] * n1 + offset[:, 2:] * n2 - offset
        if not self.outline.has_body:
            return turned
        at_joint = fade((sigma - self.outline.joint) / (3.0 * self.outline.radius))[:, None]
        slope = np.hypot(T[:, 1], T[:, 2])
        way = np.zeros_like(T)
        way[:, 1:] = T[:, 1:] / np.maximum(slope, 1e-30)[:, None]
        along = np.sum(way * offset, axis=1, keepdims=True) * way
        stretched = (1.0 / T[:, :1] - 1.0) * along
        return (1.0 - at_joint) * turned + at_joint * stretched

    def _slide(self, X: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Change of s that keeps points of the body's rear surface on it, fading away from it."""
        rear = self.outline.rear
        before, after = rear(X[:, 1], X[:, 2]), rear(X[:, 1] + step[:, 1], X[:, 2] + step[:, 2])
        away = np.abs(X[:, 0] - before) / (0.5 * self.outline.semi_axes[0])
        behind = X[:, 0] > -self.outline.semi_axes[0]
        return np.where(behind, fade(away) * (after - before - step[:, 0]), 0.0)

    def surface_velocity(self, X: np.ndarray, x: np.ndarray, phase: float) -> np.ndarray:
        """Return the velocity per unit phase rate of the tail's surface at x, the image of X."""
        sigma, unit = self._along(X), self.outline.unit
        velocity = geometry.surface_velocity(self.swimmer.tail, x * unit, sigma * unit, phase)
        return velocity / unit

    def outward(self, X: np.ndarray, x: np.ndarray, phase: float) -> np.ndarray:
        """Return offset of the tail's surface from the centreline, close to its outward normal."""
        sigma, unit = self._along(X), self.outline.unit
        return x - self._curve(sigma * unit, phase).P / unit


@dataclass(frozen=True)
class Carrier:
    """Rigid motion of the swimmer blended into the resting walls.

    x = c + T(w theta) (Y - c) + w xi,  w = fade((d - inner) / (outer - inner)),

    d the distance from the swimmer's straight axis. A turn about that axis keeps the volume.

    Parameters
    ----------
    centre
        Point c about which the body turns (its centre).
    nose, tip
        Ends of the axis on s.
    inner, outer
        Distances at which w leaves 1 and reaches 0.
    """

    centre: np.ndarray
    nose: float
    tip: float
    inner: float
    outer: float

    def place(self, X: np.ndarray, Y: np.ndarray, xi: np.ndarray, turn: np.ndarray) -> np.ndarray:
        """Return positions of mesh points X whose wave-displaced places are Y.

        Parameters
        ----------
        X, Y : ndarray of shape (n, 3)
        xi : ndarray of shape (3,)
            Displacement of the centre.
        turn : ndarray of shape (3,)
            Rotation vector of the body.
        """
        foot = np.zeros_like(X)
        foot[:, 0] = np.clip(X[:, 0], self.nose, self.tip)
        distance = np.linalg.norm(X - foot, axis=1)
        w = fade((distance - self.inner) / (self.outer - self.inner))[:, None]
        about = Rotation.from_rotvec(w * turn).apply(Y - self.centre)
        return np.where(w > 0, self.centre + about + w * xi, Y)
