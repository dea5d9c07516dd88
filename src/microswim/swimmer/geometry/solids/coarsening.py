"""A surface of many triangles as one of few, with corners and normals of the many."""

from __future__ import annotations

import numpy as np

from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.triangles import Indices, Triangles

#: Share of the volume with which a shape is lost: no such triangles are taken.
LOST = 0.05


def coarsened(surface: Triangles, most: int) -> Triangles:
    """Return the surface with at most `most` triangles, as far as its shape lets it.

    Edges collapse where that changes the surface least, or onto corners that stay (manifold3d),
    which sharp edges want: whichever keeps the volume within its curved patches better.
    """
    if len(surface.faces) <= most:
        return surface
    made = [_onto_corners(surface, most), _by_quadrics(surface, most)]
    whole = surface.curved_volume
    made = [c for c in made if c is not None and abs(c.curved_volume / whole - 1.0) < LOST]
    fits = [c for c in made if 8 <= len(c.faces) <= most]
    fits = fits or [c for c in made if len(c.faces) < len(surface.faces)]
    return min(fits, key=lambda c: abs(c.curved_volume / whole - 1.0), default=surface)


def _by_quadrics(surface: Triangles, most: int) -> Triangles | None:
    """Edges collapsed by the quadrics of their faces (Garland and Heckbert, Proc. SIGGRAPH 1997).

    What is left of the corners is moved to the nearest corners of the surface.
    """
    import fast_simplification

    points, faces, *_ = fast_simplification.simplify(
        np.asarray(surface.points, float), np.asarray(surface.faces, np.int32),
        target_count=most, agg=5.0,
    )  # fmt: skip
    return of_corners(surface, np.asarray(points, float), np.asarray(faces, np.int64))


def _onto_corners(surface: Triangles, most: int) -> Triangles | None:
    """Edges collapsed onto corners of the surface, up to the largest change that is needed."""
    import manifold3d

    middle, size = surface.points.mean(axis=0), float(np.ptp(surface.points, axis=0).max())
    points = np.asarray((surface.points - middle) / size, np.float32)
    solid = manifold3d.Manifold(manifold3d.Mesh(points, surface.faces.astype(np.uint32)))
    low, high, best = 1e-6, 0.1, solid
    for _ in range(12):
        epsilon = np.sqrt(low * high)
        made = solid.simplify(epsilon)
        if 8 <= made.num_tri() <= most:
            best, high = made, epsilon
        else:
            low, high = (low, epsilon) if made.num_tri() < 8 else (epsilon, high)
    if best.num_tri() >= len(surface.faces) or best.num_tri() < 8:
        return None
    mesh = best.to_mesh()
    at = np.asarray(mesh.vert_properties[:, :3], float) * size + middle
    return of_corners(surface, at, np.asarray(mesh.tri_verts, np.int64))


def of_corners(surface: Triangles, points: Array, faces: Indices) -> Triangles | None:
    """Return the triangles with their corners moved to the nearest ones of a finer surface."""
    from scipy.spatial import KDTree

    _, nearest = KDTree(surface.points).query(points)
    corners = np.atleast_1d(np.asarray(nearest, np.int64))
    if np.unique(corners).size < corners.size:
        return None
    made = Triangles(surface.points[corners], faces, surface, corners)
    return made if made.is_closed else None
