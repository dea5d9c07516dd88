"""Ribbons, straight and helical, and cylinders in a spherical vessel, by two models.

Boundary and finite elements share nothing: not the formulas, not the mesh, not the way from flow
to force.
"""

import numpy as np
import pytest

import microswim as ms
from microswim.models.bem.levels import get_level
from microswim.models.bem.patches.mesh import body_surface, swimmer_surface
from microswim.models.bem.patches.surface import Surface, ellipsoid
from microswim.models.bem.system import Layer, rigid_modes, solve_density, wrench_rows

occ = pytest.importorskip("netgen.occ")

pytestmark = pytest.mark.slow

VESSEL = 1.2


def by_boundary_elements(surface, centre, rule):
    """Resistance of a still surface in the vessel, whose patches face the fluid inside."""
    outer = ellipsoid((VESSEL, VESSEL, VESSEL), 2, surface.order).controls[:, :, ::-1] + centre
    controls = np.ascontiguousarray(np.concatenate([surface.controls, outer]))
    own = np.arange(len(controls)) < surface.patches
    both = Surface(
        controls, np.zeros_like(controls), ~own & False, surface.order, vessel=~own, closed=True
    )
    modes = rigid_modes(both.nodes, centre) * own[:, None, None, None]
    found = solve_density(Layer(both, 1.0, rule), modes)
    R = wrench_rows(both, centre, own) @ found.density
    return 0.5 * (R + R.T)


def by_finite_elements(solid, centre, size, curved=1.0):
    """`curved`: elements over a radius of curvature; the round edges of a ribbon want many."""
    import ngsolve as ngs

    from microswim.models.fem.stokes import Stokes

    solid.faces.name = "body"
    for face in solid.faces:
        face.maxh = size
    outer = occ.Sphere(occ.Pnt(*centre), VESSEL)
    outer.faces.name = "wall"
    fluid = occ.OCCGeometry(outer - solid)
    mesh = ngs.Mesh(fluid.GenerateMesh(maxh=0.5, grading=0.5, curvaturesafety=curved))
    mesh.Curve(3)
    flow = Stokes(mesh, 3)
    flow.factorise(1.0)
    modes = flow.rigid_modes(np.asarray(centre))
    R = np.array([flow.forces(flow.apply(flow.solve(mode)), modes, "body") for mode in modes]).T
    return 0.5 * (R + R.T)


def misfit(R, S):
    scale = np.sqrt(np.diag(S))
    return np.abs((R - S) / np.outer(scale, scale)).max()


def test_a_ribbon_of_five_to_one_is_within_one_per_cent():
    """A straight one, its ends halves of ellipsoids; wide along q."""
    a, b, length = 0.15, 0.03, 0.6
    tail = ms.PlaneWaveTail(length=length, amplitude=0.0, waves=1, section=(a, b))
    level = get_level("standard")
    surface = swimmer_surface(ms.NoBody(), tail, 0.0, level.resolution)
    centre = (0.5 * length, 0.0, 0.0)
    plane = occ.WorkPlane(occ.Axes(occ.Pnt(0, 0, 0), n=occ.X, h=occ.Y))
    solid = plane.Ellipse(a, b).Face().Extrude(length * occ.X)
    for end in (0.0, length):
        solid += occ.Ellipsoid(occ.Axes(occ.Pnt(end, 0, 0), n=occ.X, h=occ.Y), b, a, b)
    S = by_finite_elements(solid, centre, 0.06)
    R = by_boundary_elements(surface, np.asarray(centre), level.rule)
    assert misfit(R, S) < 0.01


def test_a_helical_ribbon_of_five_to_one_is_within_one_per_cent():
    """One turn of a belt that is wide along its binormal, skinned over 17 sections."""
    a, b, length, amplitude = 0.15, 0.03, 0.8, 0.15
    tail = ms.HelicalTail(length=length, amplitude=amplitude, waves=1, section=(b, a), ramp=0.0)
    level = get_level("standard")
    surface = swimmer_surface(ms.NoBody(), tail, 0.0, level.resolution)
    centre = (0.5 * length, 0.0, 0.0)
    k = 2.0 * np.pi / length

    def axes(s):
        c, d = np.cos(k * s), np.sin(k * s)
        along = np.array([1.0, -amplitude * k * d, -amplitude * k * c])
        binormal = np.cross(along, [0.0, c, -d])
        place = occ.Pnt(s, amplitude * c, -amplitude * d)
        return occ.Axes(place, n=occ.Vec(*along), h=occ.Vec(*binormal))

    stations = np.linspace(0.0, length, 17)
    solid = occ.ThruSections(
        [occ.WorkPlane(axes(s)).Ellipse(a, b).Wire() for s in stations], solid=True
    )
    for s in (0.0, length):
        solid += occ.Ellipsoid(axes(s), b, a, b)
    assert solid.mass == pytest.approx(surface.extent[1], rel=1e-4)
    S = by_finite_elements(solid, centre, 0.1, curved=0.25)
    R = by_boundary_elements(surface, np.asarray(centre), level.rule)
    assert misfit(R, S) < 0.01


def test_a_cylinder_of_aspect_three_is_within_half_a_per_cent():
    """Its edges rounded by a fifth of the radius."""
    length, radius = 0.9, 0.15
    body = ms.Cylinder(length=length, radius=radius)
    level = get_level("standard")
    surface = body_surface(body, level.resolution)
    centre = (-0.5 * length, 0.0, 0.0)
    solid = occ.Cylinder(occ.Pnt(-length, 0, 0), occ.X, r=radius, h=length)
    solid = solid.MakeFillet(solid.edges, 0.2 * radius)
    S = by_finite_elements(solid, centre, 0.1)
    R = by_boundary_elements(surface, np.asarray(centre), level.rule)
    assert misfit(R, S) < 0.005
