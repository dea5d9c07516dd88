"""Nodal values <-> coefficients of NGSolve's hierarchical H1 space, and positions of the nodes.

NGSolve's basis is hierarchical: its coefficients are not values at points. On every element the
polynomials of order k are also fixed by their values on the lattice of points i/k, so values at the
lattice points of the mesh and coefficients are related by one sparse square matrix,

    value(x_n) = sum_j phi_j(x_n) c_j,

factorised once. With it the displacement and the surface's velocities are plain NumPy functions of
the nodes.
"""

from __future__ import annotations

from itertools import product

import ngsolve as ngs
import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.linalg import splu


def lattice(order: int, corners: int) -> np.ndarray:
    """Return the barycentric indices (i_1, .., i_corners) that sum to `order`."""
    grid = product(range(order + 1), repeat=corners)
    return np.array([index for index in grid if sum(index) == order])


class Nodes:
    """The lattice nodes of a mesh (undeformed) for a scalar H1 space of order k.

    Parameters
    ----------
    space
        Scalar `ngsolve.H1` space; the vector space of the same order has its coefficients in
        three blocks of the same layout.

    Attributes
    ----------
    points : ndarray of shape (n, 3)
        Node positions on the curved, undeformed mesh.
    """

    def __init__(self, space: ngs.H1) -> None:
        self.space = space
        mesh = space.mesh
        indices = lattice(space.globalorder, 4)
        corner = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]], dtype=float)
        reference = indices @ corner / space.globalorder
        places = _positions(mesh, reference)
        self._numbers: dict[tuple, int] = {}
        rows, columns, values, points = [], [], [], []
        shapes: dict[tuple, np.ndarray] = {}
        for element in space.Elements(ngs.VOL):
            corners, dofs = [v.nr for v in element.vertices], list(element.dofs)
            order = tuple(np.argsort(corners))  # the basis is oriented by the vertex numbers
            if order not in shapes:
                finite = space.GetFE(ngs.ElementId(ngs.VOL, element.nr))
                shapes[order] = np.array([list(finite.CalcShape(*at)) for at in reference])
            for local, key in enumerate(_keys(corners, indices)):
                if key in self._numbers:
                    continue
                self._numbers[key] = len(points)
                rows += [len(points)] * len(dofs)
                columns += dofs
                values.append(shapes[order][local])
                points.append(places[element.nr, local])
        n = space.ndof
        if len(points) != n:
            raise RuntimeError(f"{len(points)} nodes for {n} coefficients")
        self.points = np.array(points)
        self.matrix = csr_matrix((np.concatenate(values), (rows, columns)), shape=(n, n))
        self._factor = splu(self.matrix.tocsc())

    def coefficients(self, values: np.ndarray) -> np.ndarray:
        """Return coefficients of the function with these nodal values, (n,) or (n, m)."""
        return self._factor.solve(np.ascontiguousarray(values))

    def values(self, coefficients: np.ndarray) -> np.ndarray:
        """Return the nodal values of the function with these coefficients."""
        return self.matrix @ coefficients

    def on(self, boundary: str) -> np.ndarray:
        """Return the mask of the nodes on the boundaries that match a pattern."""
        mesh, order = self.space.mesh, self.space.globalorder
        indices = lattice(order, 3)
        mask = np.zeros(len(self.points), dtype=bool)
        for element in mesh.Boundaries(boundary).Elements():
            mask[self.numbers([v.nr for v in element.vertices], indices)] = True
        return mask

    def numbers(self, corners: list[int], indices: np.ndarray) -> list[int]:
        """Return numbers of the lattice nodes of a triangle or tetrahedron with these vertices."""
        return [self._numbers[key] for key in _keys(corners, indices)]


def _keys(corners: list[int], indices: np.ndarray) -> list[tuple]:
    """Name of each lattice node: the vertices it belongs to, each with its barycentric index."""
    ranked = np.argsort(corners)
    sorted_corners = [corners[i] for i in ranked]
    return [
        tuple((c, i) for c, i in zip(sorted_corners, index) if i)
        for index in indices[:, ranked].tolist()
    ]


def _positions(mesh: ngs.Mesh, reference: np.ndarray) -> np.ndarray:
    """Physical positions of reference points in all elements, (elements, points, 3)."""
    rule = ngs.IntegrationRule([tuple(map(float, at)) for at in reference], [0.0] * len(reference))
    here = ngs.CF((ngs.x, ngs.y, ngs.z))(mesh.MapToAllElements(rule, ngs.VOL))
    return np.asarray(here).reshape(mesh.ne, len(reference), 3)
