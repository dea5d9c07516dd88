"""A mesh of its own for every phase: the wave carries the surface, the volume is filled in anew.

Where a steep wave folds every straight mesh, only the surface triangles of one are displaced, and
Netgen fills the fluid between them with tetrahedra that know the wave. What is left to displace is
what makes flat triangles curved: with X_j the lattice nodes of the straight mesh's surface,

    x_j = X_j + d(X_j) on the surface,    c_i = 0 for every coefficient of the interior,

so that edges and faces within follow by the basis alone. An element that even this folds has its
curving shrunk until it does not; flat ones are valid as Netgen made them, so that this ends.
A mesh so made has no memory of the phase before: it serves the quasi-steady solver, not a run in
time.
"""

# Netgen has no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import ngsolve as ngs
import numpy as np
from netgen.meshing import Element2D, FaceDescriptor, Mesh, MeshPoint, Pnt
from scipy.spatial import cKDTree

from microswim.errors import MicroswimError
from microswim.models.fem.displacement import Wave
from microswim.models.fem.mesh import Level, Outline, sizes, surface_mesh
from microswim.models.fem.nodes import lattice
from microswim.models.fem.stokes import FOLDED, Stokes
from microswim.swimmer.geometry.surroundings import Channel

_FINENESS = 0.22  # mesh size on the tail over (1/k * level.tail): a quarter of a radian at most
_FINER = (1.0, 0.8, 0.64)  # tried in turn where Netgen finds no tetrahedra


@dataclass(frozen=True)
class Laid:
    """A mesh with the wave on it at one phase.

    Attributes
    ----------
    flow : Stokes
        Spaces on the mesh.
    straight : ndarray of shape (n, 3)
        Where its nodes lie on the straight outline (of nodes within a filled mesh: unused).
    places : ndarray of shape (n, 3)
        Where they lie under the wave.
    """

    flow: Stokes
    straight: np.ndarray
    places: np.ndarray


@dataclass(frozen=True)
class Skin:
    """Surface triangles of the straight mesh: vertices, corners, lattice nodes, boundary names."""

    vertices: np.ndarray
    corners: np.ndarray
    nodes: np.ndarray
    names: tuple[str, ...]


def filled(wave: Wave, channel: Channel, level: Level, phase: float) -> Laid:
    """Return the mesh of the fluid about the wave at one phase.

    Raises
    ------
    MicroswimError
        One sentence, where no fineness of the surface lets the fluid be filled.
    """
    outline = wave.outline
    for finer in _FINER:
        tail = min(level.tail, finer * _FINENESS * level.tail * wave.scale / outline.radius)
        skin = straight_skin(outline, channel, replace(level, tail=tail))
        moved = replace(skin, vertices=skin.vertices + wave.displacement(skin.vertices, phase))
        net = _netgen_mesh(moved)
        with _silent():
            net.GenerateVolumeMesh(sizes(outline, channel, level))
        if len(net.Elements3D()):
            return _curved(ngs.Mesh(net), level.order, skin, moved.vertices, wave, phase)
    raise MicroswimError(
        "no tetrahedra fit between this wave and the channel (its surface comes too close to "
        "itself); lower the wave, use fewer waves or a thinner filament"
    )


@lru_cache(maxsize=4)
def straight_skin(outline: Outline, channel: Channel, level: Level) -> Skin:
    """Return the surface of the straight mesh with its curved lattice nodes."""
    net = surface_mesh(outline, channel, level)
    mesh = ngs.Mesh(net)
    mesh.Curve(level.order)
    at = lattice(level.order, 3)[:, :2] / level.order
    rule = ngs.IntegrationRule([(float(x), float(y)) for x, y in at], [0.0] * len(at))
    here = ngs.CF((ngs.x, ngs.y, ngs.z))(mesh.MapToAllElements(rule, ngs.BND))
    triangles = list(mesh.Elements(ngs.BND))
    return Skin(
        vertices=np.array([point.p for point in net.Points()]),
        corners=np.array([[v.nr for v in triangle.vertices] for triangle in triangles]),
        nodes=np.asarray(here).reshape(len(triangles), len(at), 3),
        names=tuple(triangle.mat for triangle in triangles),
    )


@contextmanager
def _silent() -> Iterator[None]:
    """Keep Netgen's remarks on a surface it cannot fill out of what a command prints."""
    kept = [os.dup(stream) for stream in (1, 2)]
    try:
        with open(os.devnull, "wb") as nowhere:
            for stream in (1, 2):
                os.dup2(nowhere.fileno(), stream)
        yield
    finally:
        for stream, before in zip((1, 2), kept):
            os.dup2(before, stream)
            os.close(before)


def _netgen_mesh(skin: Skin) -> Any:
    """A surface in Netgen, with one face of each name and the fluid inside."""
    net, kinds = Mesh(dim=3), sorted(set(skin.names))
    points = [net.Add(MeshPoint(Pnt(*map(float, vertex)))) for vertex in skin.vertices]
    for i, name in enumerate(kinds):
        net.Add(FaceDescriptor(surfnr=i + 1, domin=1, domout=0, bc=i + 1))
        net.SetBCName(i, name)
    for corners, name in zip(skin.corners, skin.names):
        net.Add(Element2D(kinds.index(name) + 1, [points[v] for v in corners]))
    return net


def _curved(
    mesh: ngs.Mesh, order: int, skin: Skin, vertices: np.ndarray, wave: Wave, phase: float
) -> Laid:
    """The nodes of the surface put on the wave, those within following by the basis."""
    flow = Stokes(mesh, order)
    nodes, indices = flow.nodes, lattice(order, 3)
    now = np.array([vertex.point for vertex in mesh.vertices])
    gap, number = cKDTree(now).query(vertices)
    if gap.max() > 1e-9:
        raise RuntimeError("Netgen moved the surface while filling it")
    straight, flat = nodes.points.copy(), nodes.points
    for corners, places in zip(number[skin.corners].tolist(), skin.nodes):
        straight[nodes.numbers(corners, indices)] = places
    on = nodes.on(".*")
    target = flat.copy()
    target[on] = straight[on] + wave.displacement(straight[on], phase)
    bits: Any = nodes.space.GetDofs(mesh.Boundaries(".*"))
    outer = np.fromiter(bits, bool, len(flat))
    bend = np.where(outer[:, None], nodes.coefficients(target - flat), 0.0)
    return Laid(flow, straight, _unfolded(flow, bend))


def _unfolded(flow: Stokes, bend: np.ndarray) -> np.ndarray:
    """Places of the nodes with the coefficients `bend`, shrunk where an element would fold."""
    nodes, share = flow.nodes, np.ones(len(bend))
    elements = [list(element.dofs) for element in nodes.space.Elements(ngs.VOL)]
    for shrink in (0.7, 0.7, 0.7, 0.7, 0.0, 0.0, 0.0, 0.0):
        places = nodes.points + nodes.values(share[:, None] * bend)
        folded = np.flatnonzero(flow.jacobians(places) <= 2 * FOLDED)
        if not len(folded):
            break
        share[np.unique(np.concatenate([elements[i] for i in folded]))] *= shrink
    return places
