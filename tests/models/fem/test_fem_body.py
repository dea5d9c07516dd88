"""A body alone in a channel: Bohlin's and Brenner's series, convergence, box, symmetry."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import i1, k1

import microswim as ms
from microswim.swimmer.geometry.surroundings import Channel

pytest.importorskip("ngsolve", reason="needs the extra fem")

from microswim.models.fem.gait import body_resistance
from microswim.models.fem.mesh import Level

pytestmark = pytest.mark.fem


def bohlin(x: float) -> float:
    """Drag of a sphere on the axis of a long cylinder over Stokes' (Bohlin 1960)."""
    return 1.0 / (
        1.0
        - 2.10443 * x
        + 2.08877 * x**3
        - 0.94813 * x**5
        - 1.372 * x**6
        + 3.87 * x**8
        - 4.19 * x**10
    )


def rotlet_reflection(x: float) -> float:
    """Torque of a sphere spinning about the axis over Stokes', to O(x^10).

    The wall answers the rotlet with a rigid rotation -c x^3, c = (1/pi) int t^2 K1(t)/I1(t) dt
    (from the Fourier integral of the rotlet on the cylinder); the next reflection is of order x^10.
    """
    c = quad(lambda t: t * t * k1(t) / i1(t), 0.0, 40.0)[0] / np.pi
    return 1.0 / (1.0 - c * x**3)


@pytest.fixture(scope="module")
def sphere_in_cylinder() -> np.ndarray:
    """Radius ratio 0.3, closed ends 5 cylinder radii away."""
    level = Level(order=3, tail=1.6, body=0.35, far=0.25, grading=0.6)
    channel = Channel(diameter=2.0 / 0.3, length=10.0 / 0.3)
    return body_resistance(ms.Sphere(radius=1.0), channel=channel, level=level)


def test_sphere_on_the_axis_of_a_cylinder(sphere_in_cylinder):
    drag = sphere_in_cylinder[0, 0] / (6 * np.pi)
    assert drag == pytest.approx(bohlin(0.3), rel=0.01)


def test_spinning_sphere_on_the_axis_of_a_cylinder(sphere_in_cylinder):
    torque = sphere_in_cylinder[3, 3] / (8 * np.pi)
    assert torque == pytest.approx(rotlet_reflection(0.3), rel=0.01)
    assert torque > 1.0  # the wall is felt


def test_resistance_is_symmetric_and_definite(sphere_in_cylinder):
    R = sphere_in_cylinder
    assert np.all(np.linalg.eigvalsh(R) > 0)
    off = R - np.diag(np.diag(R))
    assert np.abs(off).max() < 2e-3 * R[0, 0]  # on the axis nothing couples
    assert R[1, 1] == pytest.approx(R[2, 2], rel=2e-3)


def test_drag_scales_with_length_and_viscosity():
    """R ~ mu l for translation, mu l^3 for rotation: the same mesh in other units."""
    level = Level(order=2, tail=1.6, body=0.7, far=0.5, grading=0.9)
    one = body_resistance(
        ms.Sphere(radius=1.0), channel=Channel(diameter=6.0, length=6.0), level=level
    )
    small = body_resistance(
        ms.Sphere(radius=1e-6),
        channel=Channel(diameter=6e-6, length=6e-6),
        level=level,
        viscosity=1e-3,
    )
    assert small[0, 0] == pytest.approx(one[0, 0] * 1e-9, rel=1e-9)
    assert small[3, 3] == pytest.approx(one[3, 3] * 1e-21, rel=1e-9)


@pytest.mark.slow
def test_open_ends_drag_less_than_closed():
    """Bodies that are pulled see the ends; opening them only removes constraints (Helmholtz)."""
    level = Level(order=2, tail=1.6, body=0.7, far=0.5, grading=0.9)
    drag = [
        body_resistance(
            ms.Sphere(radius=1.0),
            channel=Channel(diameter=6.0, length=6.0, ends=ends),
            level=level,
        )[0, 0]
        for ends in ("open", "closed")
    ]
    assert drag[0] < 0.95 * drag[1]


@pytest.mark.slow
def test_order_of_convergence():
    """Three meshes, each half as coarse: the drag falls to a limit with order two or better."""
    channel = Channel(diameter=5.0, length=5.0, shape="box")
    sizes = (0.8, 0.4, 0.2)
    drag = [
        body_resistance(
            ms.Sphere(radius=1.0),
            channel=channel,
            level=Level(order=2, tail=1.6, body=h, far=0.5 * h, grading=0.9, curvature=1.2 / h),
        )[0, 0]
        for h in sizes
    ]
    order = np.log2((drag[0] - drag[1]) / (drag[1] - drag[2]))
    assert order > 2.0, (drag, order)
