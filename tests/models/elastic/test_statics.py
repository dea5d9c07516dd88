"""Shapes at rest against small deflection, the elastica's elliptic integrals, and shooting."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.special import ellipk, ellipkinc

from microswim.models.elastic.plane import Loads
from microswim.models.elastic.statics import static_shape

#: Deflection of a cantilever of length 1 and stiffness 1 under a small load.
SMALL = [
    (Loads(weight=(0.0, 1e-4)), (0.0, 0.0), 1.0 / 8.0),
    (Loads(end=(0.0, 1e-4)), (0.0, 0.0), 1.0 / 3.0),
    (Loads(flow=(0.0, 1e-4)), (0.5, 1.0), 1.0 / 8.0),
]


@pytest.mark.parametrize(("loads", "drag", "share"), SMALL)
def test_small_deflections(loads, drag, share):
    _, place = static_shape(loads, drag=drag)
    assert place[-1, 1] / 1e-4 == pytest.approx(share, rel=1e-6)


@pytest.mark.parametrize("tip_angle", [0.2, 0.8, 1.2])
def test_a_cantilever_under_a_force_at_its_end_is_the_elastica(tip_angle):
    """``sqrt(F) = K(k) - F(phi, k)``, ``k^2 = (1 + sin a) / 2``, ``sin phi = 1 / (k sqrt 2)``."""
    m = (1.0 + np.sin(tip_angle)) / 2.0
    force = (ellipk(m) - ellipkinc(np.arcsin(1.0 / np.sqrt(2.0 * m)), m)) ** 2
    theta, _ = static_shape(Loads(end=(0.0, float(force))))
    assert theta[-1] == pytest.approx(tip_angle, abs=1e-9)


def bent(load):
    """Tip of a cantilever by shooting: ``theta'' = -n . F(s)``, F the load beyond s."""

    def slopes(s, y):
        theta, kappa, _, _, fx, fy = y
        px, py = load(theta)
        shear = -np.sin(theta) * fx + np.cos(theta) * fy
        return np.array([kappa, -shear, np.cos(theta), np.sin(theta), -px, -py])

    def ends(a, b):
        return np.array([a[0], a[2], a[3], b[1], b[4], b[5]])

    s = np.linspace(0.0, 1.0, 41)
    straight = np.vstack([0 * s, 0 * s, s, 0 * s, 0 * s, 0 * s])
    found = solve_bvp(slopes, ends, s, straight, tol=1e-9, max_nodes=20_000)
    assert found.success
    return found.y[2:4, -1]


def test_a_heavy_cantilever():
    _, place = static_shape(Loads(weight=(0.0, -20.0)))
    truth = bent(lambda theta: (0.0 * theta, 0.0 * theta - 20.0))
    np.testing.assert_allclose(place[-1], truth, atol=1e-7)
    assert place[-1, 1] < -0.6  # far beyond small deflection


def test_a_filament_across_a_uniform_flow():
    """Local drag ``c_n n n' + c_t t t'`` of a flow across the base, ten times what bends it."""
    c_t, c_n, U = 5.0, 10.0, 2.0
    _, place = static_shape(Loads(flow=(0.0, U)), drag=(c_t, c_n))

    def load(theta):
        t, n = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
        return c_t * U * t[1] * t + c_n * U * n[1] * n

    np.testing.assert_allclose(place[-1], bent(load), atol=1e-7)


def test_a_hinge_with_a_spring_turns_by_the_moment_over_its_stiffness():
    theta, _ = static_shape(Loads(end=(0.0, 1e-5)), turning=0.1)
    assert theta[0] == pytest.approx(1e-5 / 0.1, rel=1e-4)
