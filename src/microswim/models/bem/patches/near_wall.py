"""Patches next to a wall: their size follows the gap.

Between a surface at height h and a wall the pressure goes like 1/h^2 (lubrication), so a patch
resolves it if h changes little over it. A patch is halved, across the direction along which h
changes more, until the change is at most `CHANGE` of the smallest h on it. On a sphere of radius a
this gives patches of size sqrt(a h), as the theory has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from microswim.models.bem.patches.element import chebyshev_nodes, lagrange
from microswim.models.bem.patches.surface import Surface
from microswim.numerics.array import Array

#: Change of the height over a patch, in units of the smallest; halvings at most.
CHANGE, DEPTH = 2.0, 14


Height = Callable[[Array], Array]


def over(plane: Array) -> Height:
    """Return the height of points (..., 3) over a wall (point and normal, (6,))."""
    return lambda X: (X - plane[:3]) @ plane[3:]


def refined(surface: Surface, height: Height, most: float = CHANGE) -> Surface:
    """Return a surface whose patches resolve the gap to a boundary, of which `height` is given.

    Halves of a patch are the same polynomials: the surface does not change.
    """
    fine: list[Surface] = []
    for _ in range(DEPTH):
        u, v = _change(surface.controls, height)
        coarse = np.maximum(u, v) > most
        fine.append(chosen(surface, ~coarse))
        if not coarse.any():
            break
        u, v = u[coarse], v[coarse]
        surface = halved(chosen(surface, coarse), u >= v, u < v)
    else:
        fine.append(surface)
    return together(fine)


def chosen(surface: Surface, which: NDArray[np.bool_]) -> Surface:
    """Return some patches of a surface."""
    return replace(
        surface,
        controls=surface.controls[which],
        motion=surface.motion[which],
        of_tail=surface.of_tail[which],
        inner=None if surface.inner is None else surface.inner[:, which],
    )


def together(parts: list[Surface]) -> Surface:
    """Return one surface of the patches of several."""
    inner = [p.inner for p in parts if p.inner is not None]
    return replace(
        parts[0],
        controls=np.ascontiguousarray(np.concatenate([p.controls for p in parts])),
        motion=np.ascontiguousarray(np.concatenate([p.motion for p in parts])),
        of_tail=np.concatenate([p.of_tail for p in parts]),
        inner=np.concatenate(inner, axis=1) if inner else None,
    )


#: Points of a line over a patch at which heights are asked; parts of it, by half their length.
SAMPLES, PARTS = 9, (4, 2, 1)


def _change(controls: Array, height: Height) -> tuple[Array, Array]:
    """Change of the height along u and along v of each patch, over its smallest height, (e,) each.

    Along a line ``|h(1) - h(-1)| + 4 |h(1) + h(-1) - 2 h(0)|``: the slope's share and the bend's,
    so that a patch in whose middle the gap is smallest counts as well as one beside it. The most of
    it over the line, its halves and quarters: two turns of a tail may pass a patch at once.
    """
    L = lagrange(chebyshev_nodes(), np.linspace(-1, 1, SAMPLES))[0]
    h = height(np.einsum("mi,nj,eijc->emnc", L, L, controls, optimize=True))
    least = h.min(axis=(1, 2))

    def along(h: Array) -> Array:
        most = np.zeros(len(h))
        for half in PARTS:
            first, middle, last = h[:, : -2 * half], h[:, half:-half], h[:, 2 * half :]
            of_part = np.abs(last - first) + 4.0 * np.abs(last + first - 2.0 * middle)
            most = np.maximum(most, of_part.max(axis=(1, 2)))
        return most / least

    return along(h), along(h.transpose(0, 2, 1))


def halved(surface: Surface, across_u: NDArray[np.bool_], across_v: NDArray[np.bool_]) -> Surface:
    """Return the surface with some patches halved in u, others in v, in another order."""
    whole = ~(across_u | across_v)
    x = chebyshev_nodes()
    halves = [lagrange(x, 0.5 * (x + side))[0] for side in (-1.0, 1.0)]

    def cut(values: Array) -> Array:
        """Return values (e, q, q, n) at the nodes of the new patches."""
        parts = [values[whole]]
        for half in halves:
            parts.append(np.einsum("mi,eijc->emjc", half, values[across_u], optimize=True))
            parts.append(np.einsum("nj,eijc->einc", half, values[across_v], optimize=True))
        return np.concatenate(parts)

    tail = surface.of_tail
    both = [tail[across_u], tail[across_v]]
    inner = surface.inner
    if inner is not None and len(inner):
        inner = np.moveaxis(cut(np.moveaxis(inner, 0, -1)), -1, 0)
    return replace(
        surface,
        controls=np.ascontiguousarray(cut(surface.controls)),
        motion=np.ascontiguousarray(cut(surface.motion)),
        of_tail=np.concatenate([tail[whole], *both, *both]),
        inner=inner,
    )
