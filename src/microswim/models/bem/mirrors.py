"""Mirror symmetry of a surface: its dense system falls into one for each parity.

A plane wave is its own mirror image under r -> -r, whatever the phase. With S the reflection and
m(i) the node onto which it carries node i, the matrix of the single layer obeys
A_m(i)m(j) = S A_ij S. So flows fall into even and odd ones, f_m(i) = +-S f_i, that do not meet:

    sum_j (A_ij +- A_im(j) S) f_j = u_i,   i and j one node of each pair

Of a node in the mirror's plane those components are left that S keeps (even) or turns (odd). With
k mirrors their products form the group Z_2^k: 2^k systems, one for each of its characters.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import hadamard
from scipy.spatial import KDTree

from microswim.models.bem.patches.surface import Surface
from microswim.numerics.array import Array
from microswim.numerics.compiling.compiled import njit

#: Distance of a node's image from a node, in sizes of the surface, that is rounding.
SAME = 1e-10


@njit(cache=True, fastmath=True)
def fold(rows, images, signs, times, own, taken, out):
    """Add to the columns of `out` the sums of the images' columns, of the rows `taken`.

    times : (o,) how often each node is among its images.
    """
    column = 0
    for j in range(own.shape[0]):
        for c in range(3):
            if not own[j, c]:
                continue
            for g in range(signs.shape[0]):
                weight = signs[g, c] / times[j]
                source = rows[:, 3 * images[g, j] + c]
                for i in range(taken.size):
                    out[i, column] += weight * source[taken[i]]
            column += 1


@dataclass(frozen=True, eq=False)
class Mirrors:
    """The products of the mirrors of a surface: with none, the identity alone.

    Parameters
    ----------
    signs : (g, 3)
        Reflections S, each the signs of the three axes; the identity first.
    images : (g, n)
        The node onto which each carries each node.
    """

    signs: Array
    images: NDArray[np.int64]

    @cached_property
    def nodes(self) -> NDArray[np.int64]:
        """One node of each set of images, (o,)."""
        return np.flatnonzero(self.images.min(axis=0) == np.arange(self.images.shape[1]))

    @cached_property
    def parities(self) -> list[Parity]:
        """All characters of the group that a field on these nodes can have, the even one first.

        Where all nodes lie in mirrors some have none.
        """
        every = [Parity(self, row) for row in hadamard(len(self.signs)).astype(float)]
        return [parity for parity in every if parity.own.any()]


@dataclass(frozen=True, eq=False)
class Parity:
    """Vector fields on the nodes that each mirror keeps or turns: ``f_m(i) = character S f_i``.

    Parameters
    ----------
    mirrors : Mirrors
    character : (g,)
        +1 or -1 for each reflection of the group.
    """

    mirrors: Mirrors
    character: Array

    @cached_property
    def signs(self) -> Array:
        """Signs (g, 3) of the images' components."""
        return self.character[:, None] * self.mirrors.signs

    @cached_property
    def images(self) -> NDArray[np.int64]:
        """Images (g, o) of the nodes that stand for all."""
        return self.mirrors.images[:, self.mirrors.nodes]

    @cached_property
    def own(self) -> NDArray[np.bool_]:
        """Components (o, 3) that are not zero by symmetry."""
        still = self.images == self.mirrors.nodes
        return np.all(~still[..., None] | (self.signs[:, None, :] > 0.0), axis=0)

    def part(self, values: Array) -> Array:
        """Return what of fields (n, 3, k) is of this parity, by its own components (m, k)."""
        at = self.signs[:, None, :, None] * values[self.images]
        return at.mean(axis=0)[self.own]

    def spread(self, own: Array) -> Array:
        """Return the fields (n, 3, k) of own components (m, k)."""
        at = np.zeros((*self.own.shape, own.shape[-1]))
        at[self.own] = own
        values = np.empty((self.mirrors.images.shape[1], 3, own.shape[-1]))
        for signs, images in zip(self.signs, self.images, strict=True):
            values[images] = signs[:, None] * at
        return values

    def folded(self, rows: Array, last: NDArray[np.bool_]) -> Array:
        """Return rows of a matrix as they act on own components, (m + b, m + b), Fortran order.

        Parameters
        ----------
        rows : (3 o + c, 3 n + c)
            Fortran order. Three rows of each node that stands for all, then c more; the last c
            columns do not count. Without a mirror it is what is returned.
        last : (c,)
            Which b of the last rows are taken; as many columns of zeros stand at the end.
        """
        if len(self.signs) == 1 and last.all():
            return rows
        taken = np.flatnonzero(np.concatenate([self.own.ravel(), last]))
        made = np.zeros((taken.size, taken.size), order="F")
        once = np.sum(self.images == self.mirrors.nodes, axis=0)
        fold(rows, self.images, self.signs, once, self.own, taken, made)
        return made


def mirrors(surface: Surface, wall: Array | None = None) -> Mirrors:
    """Return the mirrors of a surface, and of a wall (point and normal, (6,)) beside it.

    Planes across the three axes are tried, halfway between the surface's ends. It is the mesh that
    must be its own image: patches, their nodes and what they hold of the area.
    """
    carried = [(np.ones(3), np.arange(surface.nodes[..., 0].size))]
    for axis in range(3):
        image = None if _meets(wall, axis) else _image(surface, axis)
        if image is not None:
            sign = np.where(np.arange(3) == axis, -1.0, 1.0)
            carried += [(sign * s, image[nodes]) for s, nodes in carried]
    return Mirrors(*(np.array(x) for x in zip(*carried, strict=True)))


def _meets(wall: Array | None, axis: int) -> bool:
    """Whether a mirror across an axis moves the wall."""
    return wall is not None and bool(abs(wall[3 + axis]) > SAME)


def _image(surface: Surface, axis: int) -> NDArray[np.int64] | None:
    """Index (n,) of the node onto which a mirror across an axis carries each, None if it fails."""
    x = surface.nodes.reshape(-1, 3)
    sign = np.where(np.arange(3) == axis, -1.0, 1.0)
    middle = np.where(np.arange(3) == axis, 0.5 * (x.min(axis=0) + x.max(axis=0)), 0.0)
    size = float(np.ptp(x, axis=0).max())
    away, found = KDTree(x).query(2.0 * middle + sign * x)
    if np.max(away) > SAME * size:
        return None
    image = np.asarray(found, np.int64)
    patch = image.reshape(surface.patches, -1) // surface.order**2
    area = surface.area_vectors.reshape(-1, 3)
    change = np.abs(area[image] - sign * area).max() / np.abs(area).max()
    same = change < np.sqrt(SAME) and bool((patch == patch[:, :1]).all())
    return image if same and (image[image] == np.arange(len(image))).all() else None
