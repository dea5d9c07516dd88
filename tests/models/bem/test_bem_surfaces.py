"""Single layer on closed rigid surfaces: exact results, slender limits, orders, the wall."""

import numpy as np
import pytest

import microswim as ms
from microswim.errors import MicroswimError
from microswim.models import bem
from microswim.models.bem import system
from microswim.models.bem.patches import element
from microswim.models.bem.patches.near_wall import over, refined
from microswim.models.bem.patches.surface import Surface, positions
from oracles.slender_body import slender_torus

EXACT_RULE = bem.Quadrature(points=7, near=3.0, far=1e6, radial=10, angular=14)


def test_sphere_drag_and_torque_at_standard():
    R = bem.body_resistance(ms.Sphere(radius=0.7), 3.0)
    exact = ms.Sphere(radius=0.7).resistance(3.0).diagonal()
    assert np.abs(R.diagonal()[:3] / exact[:3] - 1).max() < 1e-5
    assert np.abs(R.diagonal()[3:] / exact[3:] - 1).max() < 1e-3


@pytest.mark.parametrize(
    "body",
    [
        ms.Spheroid(semi_axes=(5.0, 1.0)),
        ms.Spheroid(semi_axes=(0.4, 1.0)),
        ms.Ellipsoid(semi_axes=(2.0, 1.0, 0.6)),
    ],
    ids=["prolate 5:1", "oblate", "ellipsoid"],
)
def test_ellipsoids_against_oberbeck_and_perrin(body):
    R = bem.body_resistance(body, 1.0)
    assert np.abs(R.diagonal() / body.resistance(1.0).diagonal() - 1).max() < 1e-3
    scale = np.sqrt(np.outer(R.diagonal(), R.diagonal()))
    assert np.abs((R - R.T) / scale).max() < 1e-4


@pytest.mark.parametrize(("order", "expected"), [(1, 1.8), (2, 2.7), (3, 4.0)])
def test_observed_order(order, expected):
    """Drag and torque of a spheroid converge at least with the expected power of the patch size.

    Piecewise polynomials of degree p - 1 approximate the density to order p; integrals of it are
    better.
    """
    body = ms.Spheroid(semi_axes=(1.5, 1.0))
    exact = body.resistance(1.0).diagonal()
    splits = (2, 4)
    errors = []
    for n in splits:
        R = bem.resistance(bem.ellipsoid(body.semi_axes3, n, order), 1.0, rule=EXACT_RULE)
        errors.append(np.abs(R.diagonal() / exact - 1).max())
    observed = np.log(errors[0] / errors[1]) / np.log(splits[1] / splits[0])
    assert observed > expected


def test_slender_torus_approaches_johnson_and_wu():
    """The difference is of order ratio^2 log(ratio): less than its 1/3 when the ratio halves
    twice."""
    differences = []
    for ratio in (0.1, 0.025):
        R = bem.resistance(bem.torus(1.0, ratio, 10, 4, 3), 1.0)
        computed = np.array([R[0, 0], R[1, 1], R[3, 3]])
        differences.append(np.abs(computed / np.array(slender_torus(ratio)) - 1))
    assert (differences[1] < 0.01).all()
    assert (differences[1] < differences[0] / 3).all()


def test_resistance_scales_with_size_and_viscosity():
    """R_tt ~ mu a, R_rr ~ mu a^3: the discrete operator scales exactly."""
    one = bem.resistance(bem.ellipsoid((1.0, 0.7, 0.5), 1), 1.0)
    big = bem.resistance(bem.ellipsoid((2.0, 1.4, 1.0), 1), 5.0)
    powers = np.add.outer(np.r_[0, 0, 0, 1, 1, 1], np.r_[0, 0, 0, 1, 1, 1]) + 1
    assert np.allclose(big, 5.0 * 2.0**powers * one, rtol=1e-9, atol=1e-9 * one.max())


def test_pressure_null_vector_is_taken_out():
    """Densities carry no constant pressure, and the single layer of the normal makes no flow."""
    surface = bem.ellipsoid((1.0, 0.8, 0.6), 2, 3)
    layer = bem.Layer(surface, 1.0, EXACT_RULE)
    modes = system.rigid_modes(surface.nodes, np.zeros(3))
    density = system.solve_density(layer, modes).density
    flux = surface.moments[2].reshape(-1)
    assert np.abs(flux @ density).max() < 1e-9 * np.abs(density).max()
    smooth = bem.ellipsoid((1.0, 0.8, 0.6), 2, 5)
    outside = np.array([[1.6, 0.3, 0.2], [0.0, 0.0, 0.61], [0.2, -1.1, 0.4]])
    normal = smooth.normals.reshape(-1)
    assert np.abs(bem.Layer(smooth, 1.0, EXACT_RULE).velocity(outside, normal)).max() < 1e-6


@pytest.mark.parametrize("angle", [0.0, 40.0, -70.0])
def test_singular_rule_on_a_slanting_patch(angle):
    """Potential of a flat parallelogram at a density node: each edge adds the closed form

    h [asinh(t2/h) - asinh(t1/h)],   h the edge's distance, t along it from its foot."""
    side = np.array([np.sin(np.radians(angle)), np.cos(np.radians(angle)), 0.0])
    edges = np.array([0.1, 0.0, 0.0]), 0.1 * 2**1.5 * side
    u = element.chebyshev_nodes()
    controls = u[:, None, None] * edges[0] + u[None, :, None] * edges[1]
    patch = bem.Surface(controls[None], np.zeros((1, *controls.shape)), np.zeros(1, bool), 2)
    layer = bem.Layer(patch, 1.0, EXACT_RULE)
    [(_, points, areas, _)] = layer._own_points
    corners = [a * edges[0] + b * edges[1] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for n, x in enumerate(patch.nodes[0]):
        exact = 0.0
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            along = (b - a) / np.linalg.norm(b - a)
            low, high = (a - x) @ along, (b - x) @ along
            h = np.linalg.norm(a - x - low * along)
            exact += h * (np.arcsinh(high / h) - np.arcsinh(low / h))
        distance = np.linalg.norm(points[0, n] - x, axis=-1)
        assert np.sum(areas[0, n] / distance) == pytest.approx(exact, rel=1e-6)


def test_velocity_near_and_far_of_a_sphere_is_stokes_solution():
    """u = U (3a/4r + a^3/4r^3) + (U.n) n (3a/4r - 3 a^3/4 r^3), also close to the surface."""
    surface = bem.ellipsoid((1.0, 1.0, 1.0), 2, 3)
    layer = bem.Layer(surface, 1.0)
    modes = system.rigid_modes(surface.nodes, np.zeros(3))
    density = system.solve_density(layer, modes).density[:, 0]
    n = np.array([[0.6, 0.64, 0.48], [1.0, 0, 0], [0, -0.8, 0.6]])
    for r in (1.0001, 1.01, 1.3, 4.0, 50.0):
        along = 0.75 / r + 0.25 / r**3
        exact = n[:, :1] * n * (0.75 / r - 0.75 / r**3)
        exact[:, 0] += along
        assert np.abs(layer.velocity(r * n, density) - exact).max() < 4e-4


def test_outer_traction_leaves_the_inner_fluid_out():
    """Rigid motion: all of it acts outside. Strain E x on a sphere: 2 mu E:E V inside, 3/2 of it
    outside.

    Together 5/2 of it, Einstein's stresslet 20/3 pi mu a^3 E : E (Batchelor 1970).
    """
    surface = bem.ellipsoid((1.0, 1.0, 1.0), 2, 3)
    layer = bem.Layer(surface, 1.0)
    strain = np.diag([1.0, 1.0, -2.0])
    motions = np.stack(
        [surface.nodes @ strain, np.broadcast_to([1.0, 0, 0], surface.nodes.shape)], -1
    )
    density = system.solve_density(layer, motions).density
    straining, rigid = (
        np.ascontiguousarray(density[:, i]).reshape(surface.nodes.shape) for i in (0, 1)
    )
    outer = layer.outer_traction(straining)
    power = [
        np.sum(np.sum(f * motions[..., 0], axis=-1) * surface.areas)
        for f in (straining - outer, outer)
    ]
    inside = 2 * 6 * 4 / 3 * np.pi
    assert power == pytest.approx([inside, 1.5 * inside], rel=1e-3)
    assert np.abs(layer.outer_traction(rigid) - rigid).max() < 5e-3 * np.abs(rigid).max()


# Sphere of radius 1, centre at height h = cosh(alpha) over the wall, in units of 6 pi mu a and 8
# pi mu a^3: across the wall the exact series of Brenner (1961) Chem. Eng. Sci. 16, 242, summed
# below; along it F, T of Goldman, Cox & Brenner (1967) Chem. Eng. Sci. 22, 637, tables 1 and 2.
ALONG_WALL = {3.7622: (1.1738, 1.0059), 1.5431: (1.5675, 1.0998), 1.1276: (2.1514, 1.3877)}


def brenner(height):
    a = np.arccosh(height)
    n = np.arange(1, 60 if height > 1.1 else 400)
    top = 2 * np.sinh((2 * n + 1) * a) + (2 * n + 1) * np.sinh(2 * a)
    bottom = 4 * np.sinh((n + 0.5) * a) ** 2 - (2 * n + 1) ** 2 * np.sinh(a) ** 2
    return (
        4 / 3 * np.sinh(a) * np.sum(n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1))
    )


@pytest.mark.parametrize("height", sorted(ALONG_WALL))
def test_sphere_near_a_wall(height):
    normal, along = np.array([0.6, 0.0, 0.8]), np.array([0.8, 0.0, -0.6])
    plane = np.concatenate([-height * normal, normal])
    R = bem.resistance(bem.ellipsoid((1.0, 1.0, 1.0), 2, 3), 1.0, wall=plane)
    force, torque = ALONG_WALL[height]
    assert normal @ R[:3, :3] @ normal / (6 * np.pi) == pytest.approx(brenner(height), rel=1e-3)
    assert along @ R[:3, :3] @ along / (6 * np.pi) == pytest.approx(force, rel=1e-3)
    assert along @ R[3:, 3:] @ along / (8 * np.pi) == pytest.approx(torque, rel=1e-3)


#: Largest error of the drag across at a gap, on the six patches of a sphere at level standard.
CLOSE = {0.1: 5e-3, 0.05: 5e-3, 0.02: 1e-2, 0.01: 1e-2}


@pytest.mark.parametrize("gap", sorted(CLOSE))
@pytest.mark.parametrize("normal", [(0.0, 1.0, 0.0), (0.3, 0.8, 0.5), (-0.2, 0.1, 0.7)])
def test_patches_follow_the_gap_wherever_the_wall_is(gap, normal):
    """Under a patch's middle, its edge or its corner: the exact series within a per cent."""
    n = np.array(normal) / np.linalg.norm(normal)
    plane = np.concatenate([-(1 + gap) * n, n])
    rule = bem.get_level("standard").rule
    R = bem.resistance(bem.ellipsoid((1.0, 1.0, 1.0), 1, 3), 1.0, rule=rule, wall=plane)
    assert n @ R[:3, :3] @ n / (6 * np.pi) == pytest.approx(brenner(1 + gap), rel=CLOSE[gap])
    assert np.abs(R - R.T).max() < 1e-3 * np.abs(R).max()


@pytest.mark.parametrize("normal", [(0.0, 1.0, 0.0), (-0.2, 0.1, 0.7)])
def test_a_sphere_a_fiftieth_of_its_radius_from_a_wall_slides_and_rolls_by_lubrication(normal):
    """Goldman, Cox & Brenner (1967): ``8/15 ln(1/d) + 0.9588`` and ``2/5 ln(1/d) + 0.3709``, gap d,
    with the terms in ``d ln(1/d)`` of Kim & Karrila (1991, sec. 7.3); what is left is of order d.
    """
    gap, n = 0.02, np.array(normal) / np.linalg.norm(normal)
    along = np.cross(n, [1.0, 0.0, 0.0])
    along /= np.linalg.norm(along)
    plane, rule = np.concatenate([-(1 + gap) * n, n]), bem.get_level("standard").rule
    R = bem.resistance(bem.ellipsoid((1.0, 1.0, 1.0), 1, 3), 1.0, rule=rule, wall=plane)
    log = np.log(1.0 / gap)
    slide = 8 / 15 * log + 0.9588 + 64 / 375 * gap * log
    roll = 2 / 5 * log + 0.3709 + 66 / 125 * gap * log
    assert along @ R[:3, :3] @ along / (6 * np.pi) == pytest.approx(slide, rel=5e-3)
    assert along @ R[3:, 3:] @ along / (8 * np.pi) == pytest.approx(roll, rel=1e-2)


def test_halves_of_a_patch_are_the_same_surface():
    sphere = bem.ellipsoid((1.0, 0.7, 0.5), 1, 3)
    finer = refined(sphere, over(np.array([-1.02, 0, 0, 1.0, 0, 0])))
    assert finer.patches > sphere.patches
    assert finer.extent == pytest.approx(sphere.extent, rel=1e-6)


def test_patches_resolve_two_near_points_of_one_side():
    """Where two turns of a tail pass the halves of a patch, distances at its ends are alike."""
    x = element.chebyshev_nodes()
    flat = np.stack(np.broadcast_arrays(x[:, None], x, 0.0), axis=-1)[None]
    patch = Surface(flat, np.zeros_like(flat), np.zeros(1, bool), 3)

    def distance(X):
        return np.min([np.linalg.norm(X - [s, 0.0, 0.05], axis=-1) for s in (-0.5, 0.5)], axis=0)

    h = distance(positions(refined(patch, distance, 3.0), 17)).reshape(-1, 17 * 17)
    assert (np.ptp(h, axis=1) / h.min(axis=1)).max() < 2.0 * 3.0


def test_far_wall_gives_faxens_correction():
    """Drag along a far wall: 1 / (1 - 9/16 a/h + 1/8 (a/h)^3), across it 1 / (1 - 9/8 a/h + 1/2
    (a/h)^3)."""
    h = 8.0
    plane = np.array([0, 0, -h, 0, 0, 1.0])
    R = bem.resistance(bem.ellipsoid((1.0, 1.0, 1.0), 1, 3), 1.0, wall=plane) / (6 * np.pi)
    assert R[0, 0] == pytest.approx(1 / (1 - 9 / 16 / h + 1 / 8 / h**3), rel=2e-4)
    assert R[2, 2] == pytest.approx(1 / (1 - 9 / 8 / h + 1 / 2 / h**3), rel=2e-4)


def test_no_slip_on_the_wall():
    surface = bem.ellipsoid((1.0, 0.5, 0.7), 1, 2)
    layer = bem.Layer(surface, 1.0, EXACT_RULE, np.array([0, 0, -1.2, 0, 0, 1.0]))
    density = np.random.default_rng(2).normal(size=surface.unknowns)
    on_wall = np.array([[0.3, 0.2, -1.2], [2.0, 1.0, -1.2], [-30.0, 4.0, -1.2]])
    free = bem.Layer(surface, 1.0, EXACT_RULE).velocity(on_wall, density)
    assert np.abs(layer.velocity(on_wall, density)).max() < 1e-5 * np.abs(free).max()


def test_memory_is_refused_in_a_sentence():
    surface = bem.ellipsoid((1.0, 1.0, 1.0), 1, 2)
    many = np.broadcast_to(surface.controls[:1], (200_000, *surface.controls.shape[1:]))
    huge = Surface(many, many, np.zeros(len(many), bool), 2)
    with pytest.raises(MicroswimError, match=r"unknowns need .* GB"):
        system.require_memory(huge.unknowns)


def test_a_spheroid_beside_a_wall_slides_and_sinks_by_brenners_law():
    """``R = R_0 / (1 - k R_0 / (6 pi mu h)) + O(h^-3)``, k = 9/16 along and 9/8 across the wall, of
    any body [Brenner 1962, J. Fluid Mech. 12, 35]; its rolling is changed by O(h^-3) too.
    """
    body, normal = bem.ellipsoid((2.0, 1.0, 1.0), 2, 3), np.array([0.0, 0.0, 1.0])
    free, k, off, rolled = bem.resistance(body, 1.0), np.array([9 / 16, 9 / 16, 9 / 8]), [], []
    for height in (6.0, 12.0):
        R = bem.resistance(body, 1.0, wall=np.concatenate([-height * normal, normal]))
        own = np.diag(free)
        law = own[:3] / (1.0 - k * own[:3] / (6 * np.pi * height))
        off.append(np.abs(np.diag(R)[:3] / law - 1.0))
        rolled.append(np.diag(R)[3:] / own[3:] - 1.0)
    assert off[1].max() < 2e-3
    assert off[0] / off[1] == pytest.approx(np.full(3, 8.0), rel=0.15)
    assert rolled[0] / rolled[1] == pytest.approx(np.full(3, 8.0), rel=0.15)
