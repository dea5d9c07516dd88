"""Shapes of an elastic filament at rest under steady loads, its base held."""

from __future__ import annotations

import numpy as np

from microswim.errors import MicroswimError
from microswim.models.elastic.plane import Base, Drag, Loads, balance
from microswim.models.elastic.rod import Rod, rod

HELD = np.zeros(1)


def static_shape(
    loads: Loads,
    *,
    drag: tuple[float, float] = (0.0, 0.0),
    angle: float = 0.0,
    turning: float | None = None,
    modes: int = 24,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the angle of the tangent and the place along a filament at rest.

    Parameters
    ----------
    loads
        In units of ``B / L^2``, as `Loads` has them.
    drag
        ``(c_t, c_n)`` for a flow, in units in which ``c U`` is a force per length ``B / L^3``.
    angle
        Of the base.
    turning
        Stiffness of the base's turning (``B / L``), 0 of a hinge; None of a clamp.
    modes
        Legendre polynomials of the curvature.

    Returns
    -------
    tuple
        Angles (m,) at the nodes, the last at the free end, and places (m, 2) over L.

    Raises
    ------
    MicroswimError
        If none is found.

    Examples
    --------
    >>> from microswim.models.elastic.plane import Loads
    >>> from microswim.models.elastic.statics import static_shape
    >>> _, place = static_shape(Loads(weight=(0.0, -1e-3)))
    >>> round(float(-place[-1, 1] / 1e-3), 6)
    0.125
    """
    shapes = rod(modes, turning)
    resists = Drag(drag[0], drag[1], 0.0, np.zeros((3, 3)), 0.0, ())
    base = Base(HELD, HELD + angle, HELD, HELD)
    q, w = np.zeros((1, shapes.count)), np.zeros((1, shapes.count))
    done, step = 0.0, 1.0
    while done < 1.0:
        share = min(1.0, done + step)
        found = _newton(shapes, resists, base, q, w, _scaled(loads, share))
        if found is None:
            step /= 2.0
            if step < 1e-3:
                raise MicroswimError(f"no shape at rest was found beyond {done:.0%} of the loads")
            continue
        done, q = share, found
    theta = angle + q[0] @ shapes.shapes.T
    return theta, np.stack([shapes.along @ np.cos(theta), shapes.along @ np.sin(theta)], axis=-1)


def _newton(
    shapes: Rod, resists: Drag, base: Base, q: np.ndarray, w: np.ndarray, loads: Loads
) -> np.ndarray | None:
    for _ in range(30):
        at = balance(shapes, resists, base, q, w, loads, 0.0 * q)
        change = -np.linalg.solve(at.stiffness[0], at.residual[0])
        if not np.abs(change).max() < 4.0:
            return None
        q = q + change
        if np.abs(change).max() < 1e-11 * max(1.0, np.abs(q).max()):
            return q
    return None


def _scaled(loads: Loads, share: float) -> Loads:
    def part(pair: tuple[float, float]) -> tuple[float, float]:
        return share * pair[0], share * pair[1]

    return Loads(
        weight=part(loads.weight), end=part(loads.end), flow=part(loads.flow),
        tip=share * loads.tip, along=share * loads.along,
    )  # fmt: skip
