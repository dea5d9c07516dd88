"""The swimmer's surface: rounded ramp, sections, joint, closed patches, refused shapes."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.errors import SpecError
from microswim.models import bem, joint
from microswim.models import swimmer_surface as geometry
from microswim.models.bem.patches.mesh import swimmer_surface

BODY = ms.Sphere(radius=0.5)
BASE = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
STEEP = ms.HelicalTail(length=1.3, amplitude=0.18, waves=3.5, radius=0.05)
PLANE = ms.PlaneWaveTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
POINTED = ms.Ellipsoid(semi_axes=(1.0, 0.5, 0.4))
RESOLUTION = bem.get_level("standard").resolution


def test_rounded_ramp_is_the_sharp_one_outside_and_smooth_inside():
    s = np.linspace(-0.1, 0.5, 100_001)
    f, df, ddf = geometry.rounded_ramp(s, 0.2, 0.05)
    sharp = np.minimum(1.0, s / 0.2)
    away = np.abs(s - 0.2) > 0.05
    assert np.allclose(f[away], sharp[away], atol=1e-14)
    assert (f <= sharp + 1e-14).all()
    h = s[1] - s[0]
    assert np.abs(np.gradient(f, h) - df)[1:-1].max() < 1e-3
    assert np.abs(np.diff(df)).max() < 2 * h * np.abs(ddf).max()


@pytest.mark.parametrize("tail", [BASE, PLANE], ids=["helix", "plane wave"])
def test_smooth_centreline_is_the_tails_own_away_from_the_kink(tail):
    s = np.r_[np.linspace(0, 0.14, 20), np.linspace(0.26, 2.0, 50)]
    mine = geometry.smooth_centreline(tail, s, 0.7)
    for computed, given in zip(
        (mine.P, mine.P_s, mine.P_phi), tail.centreline(s, 0.7), strict=True
    ):
        assert np.allclose(computed, given, atol=1e-12)
    h = 1e-5
    ahead, behind = (geometry.smooth_centreline(tail, s + d, 0.7) for d in (h, -h))
    assert np.allclose(mine.P_ss, (ahead.P_s - behind.P_s) / (2 * h), atol=1e-5)
    assert np.allclose(mine.P_sphi, (ahead.P_phi - behind.P_phi) / (2 * h), atol=1e-6)


def test_sections_are_orthonormal_and_do_not_wind_after_untwisting():
    s = np.linspace(0.0, 2.0, 4001)
    curve = geometry.smooth_centreline(BASE, s, 0.3)
    n1, n2 = geometry.section_axes(BASE, curve)
    frame = np.stack([curve.tangent, n1, n2], axis=-1)
    assert np.allclose(frame.swapaxes(-1, -2) @ frame, np.eye(3), atol=1e-12)
    assert np.allclose(np.linalg.det(frame), 1.0)
    theta = 0.4 - geometry.section_twist(BASE, s, 0.3)
    n = np.cos(theta)[:, None] * n1 + np.sin(theta)[:, None] * n2
    winding = np.sum(np.gradient(n, s, axis=0) * np.cross(curve.tangent, n), axis=-1)
    assert np.abs(winding).max() < 0.02


@pytest.mark.parametrize(
    ("tail", "body"),
    [(BASE, BODY), (STEEP, BODY), (PLANE, BODY), (BASE, POINTED), (PLANE, POINTED)],
    ids=["base", "steep", "plane wave", "base, ellipsoid", "plane wave, ellipsoid"],
)
def test_joint_lies_on_body_and_tube(tail, body):
    curve = joint.trace_joint(body, tail, 0.6)
    psi = np.linspace(0.1, 6.2, 57)
    s, untwisted = curve.section(psi)
    X = body.centre + np.asarray(body.semi_axes3) * curve.sphere_point(curve.angle(psi), psi)
    assert np.abs(body.level(X)).max() < 1e-12
    grid = np.linspace(s.min() - 0.01, s.max() + 0.01, 2001)
    twist = geometry.section_twist(tail, grid, 0.6)
    theta = untwisted - np.interp(s, grid, twist) + np.interp(curve.s, grid, twist)
    on_tube = geometry.tube_point(tail, s, theta, 0.6)
    assert np.abs(on_tube - X).max() < 2e-3 * tail.radius


@pytest.mark.parametrize(
    ("body", "tail"),
    [
        (BODY, BASE),
        (BODY, STEEP),
        (BODY, PLANE),
        (ms.Spheroid(semi_axes=(1.5, 0.4)), BASE),
        (ms.Ellipsoid(semi_axes=(0.5, 0.7, 0.4)), BASE),
        (ms.NoBody(), BASE),
    ],
    ids=["base", "steep", "plane wave", "spheroid", "ellipsoid", "no body"],
)
def test_surface_is_closed_and_faces_the_fluid(body, tail):
    surface = swimmer_surface(body, tail, 0.6, RESOLUTION)
    area, arm, normal, _ = surface.moments
    assert np.abs(normal.sum(axis=(0, 1))).max() < 1e-4 * area.sum()
    a, b, c = body.semi_axes3
    volume = np.sum(surface.normals * surface.nodes, axis=-1) * surface.areas
    arc = np.linalg.norm(
        np.diff(tail.centreline(np.linspace(0, 2, 4001) * tail.length / 2, 0.6)[0], axis=0), axis=-1
    ).sum()
    length = tail.length if tail.sections == "sheared" else arc
    ends = 1 if a > 0 else 2
    expected = 4 / 3 * np.pi * a * b * c + np.pi * tail.radius**2 * (
        length + ends * 2 / 3 * tail.radius
    )
    assert volume.sum() / 3 == pytest.approx(expected, rel=2e-3)
    assert np.allclose(
        arm.sum(axis=(0, 1)),
        (surface.nodes * surface.areas[..., None]).sum((0, 1)),
        rtol=0.02,
        atol=1e-3,
    )


def test_surface_velocities():
    """Rigid: omega x X. Translating: P_phi. Bending keeps the distance to the centreline's
    section."""
    s, theta = np.linspace(0.3, 1.9, 9), np.linspace(0, 6, 9)
    X = geometry.tube_point(BASE, s, theta, 0.5)
    assert np.allclose(geometry.surface_velocity(BASE, X, s, 0.5), np.cross([1.0, 0, 0], X))
    h = 1e-6
    bending = ms.HelicalTail(
        length=2.0, amplitude=0.1, waves=3, radius=0.05, surface_motion="bending"
    )
    u = geometry.surface_velocity(bending, X, s, 0.5)
    now, later = (geometry.smooth_centreline(bending, s, 0.5 + d) for d in (0.0, h))
    moved = X + h * u - later.P
    assert np.allclose(np.linalg.norm(moved, axis=-1), 0.05, atol=1e-10)
    assert np.abs(np.sum(moved * later.tangent, axis=-1)).max() < 1e-10
    spin = np.cross(u - now.P_phi, X - now.P)
    assert np.abs(np.sum(spin * now.tangent, axis=-1)).max() < 1e-12


@pytest.mark.parametrize("part", ["body", "tail"])
def test_patches_of_steep_joints_do_not_fold(part):
    surface = swimmer_surface(BODY, STEEP, 0.0, RESOLUTION)
    n = surface.normals[surface.on_tail == (part == "tail")]
    assert np.einsum("eac,ebc->eab", n, n).min() > -0.5


def test_folding_tube_is_refused_with_its_reason():
    tail = ms.HelicalTail(length=1.0, amplitude=0.1, waves=6, radius=0.05)
    with pytest.raises(SpecError, match=r"radius of curvature .* fold into itself"):
        geometry.check(BODY, tail)


def test_touching_turns_are_refused():
    def coil(s, phase):
        return np.stack([0.05 * s + 0 * phase, np.cos(s - phase), np.sin(s - phase)], axis=-1)

    tail = ms.CustomTail(shape=coil, length=15.0, radius=0.17)
    with pytest.raises(SpecError, match="touch itself"):
        geometry.check(ms.NoBody(), tail)


def test_tail_beside_the_body_is_refused():
    tail = ms.HelicalTail(length=2.0, amplitude=0.6, waves=1, radius=0.05, ramp=0.0)
    with pytest.raises(SpecError, match=r"tail\.amplitude = 0\.6"):
        joint.trace_joint(BODY, tail)


def test_tube_along_the_body_is_refused():
    with pytest.raises(SpecError, match="lies along the body"):
        joint.trace_joint(POINTED, STEEP, 0.6)


def test_tail_that_comes_back_to_the_body_is_refused():
    def hook(s, phase):
        s = s + 0 * phase
        return np.stack([0.4 * np.sin(3 * s), 0.8 * s, 0 * s], axis=-1)

    tail = ms.CustomTail(shape=hook, length=1.04, radius=0.05, sections="perpendicular")
    body = ms.Ellipsoid(semi_axes=(0.3, 3.0, 0.5))
    with pytest.raises(SpecError, match="pierces the body"):
        swimmer_surface(body, tail, 0.0, RESOLUTION)


@pytest.mark.parametrize(("waves", "folds"), [(4.3, False), (4.4, True)])
def test_a_crease_counts_only_outside_the_body(waves, folds):
    """Curvature x radius at the root is 2 k r_t g / (1 + g^2), g = b / (ramp L): it reaches 0.98
    between 4.3 and 4.4 waves, where the inner side of the bend just looks out of the sphere.
    """
    tail = ms.HelicalTail(length=1.3, amplitude=0.19, waves=waves, radius=0.05)
    slope = 0.19 / 0.13
    fold = 2 * tail.wavenumber * 0.05 * slope / (1 + slope**2)
    assert (fold > geometry.FOLDED) == folds
    if folds:
        with pytest.raises(SpecError, match="fold into itself"):
            geometry.check(ms.Sphere(radius=0.6), tail)
    else:
        remarks = geometry.check(ms.Sphere(radius=0.6), tail)
        assert any("nearly a crease" in remark for remark in remarks)


def test_legitimate_corners_of_the_design_range_are_accepted():
    for amplitude, waves, radius, length in [
        (0.2, 4.5, 0.3, 3.0),
        (0.2, 0.8, 0.7, 1.2),
        (0.12, 4.2, 0.5, 1.4),
    ]:
        tail = ms.HelicalTail(length=length, amplitude=amplitude, waves=waves, radius=0.05)
        geometry.check(ms.Sphere(radius=radius), tail)


def test_extreme_geometry_is_flagged():
    assert geometry.check(BODY, BASE) == []
    assert any("slope of 1.38" in remark for remark in geometry.check(BODY, STEEP))


def test_surface_scales_with_the_unit_of_length():
    """Metres or micrometres: no length is hidden in the mesh."""
    micro = ms.HelicalTail(length=2e-6, amplitude=0.1e-6, waves=3, radius=0.05e-6)
    small = swimmer_surface(ms.Sphere(radius=0.5e-6), micro, 0.4, RESOLUTION)
    large = swimmer_surface(BODY, BASE, 0.4, RESOLUTION)
    assert np.allclose(1e6 * small.controls, large.controls, atol=1e-7)


def test_a_surface_is_kept_for_who_asks_again_with_the_same_numbers() -> None:
    """Poses beside a wall ask so; another phase, tail or body has another surface."""
    surface = swimmer_surface(BODY, BASE, 0.0, RESOLUTION)
    assert swimmer_surface(replace(BODY), replace(BASE), 0.0, RESOLUTION) is surface
    for body, tail, phase in (
        (BODY, BASE, 0.1),
        (BODY, replace(BASE, amplitude=0.101), 0.0),
        (ms.Sphere(radius=0.501), BASE, 0.0),
    ):
        other = swimmer_surface(body, tail, phase, RESOLUTION)
        assert not np.array_equal(other.controls, surface.controls)
