"""Reading a surface file: the harmless is mended and said, all else refused with its place.

STL, PLY and OBJ, binary or text, through trimesh (extra ``mesh``); the topology is checked here.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.numerics.array import Array
from microswim.swimmer.geometry.solids.crossing import first_crossing, winding
from microswim.swimmer.geometry.solids.triangles import Indices, Triangles

FORMATS = (".stl", ".ply", ".obj")
MOST_BYTES, MOST_FACES = 1 << 28, 400_000
#: Coordinates from which on products of three have no room.
LARGEST = 1e90


@dataclass(frozen=True, eq=False)
class Reading:
    """A closed surface from a file, in the file's own coordinates.

    Parameters
    ----------
    surface
        Its triangles, oriented outwards.
    remarks
        What was mended or left out, in words.
    """

    surface: Triangles
    remarks: tuple[str, ...]


def read(path: str | Path) -> Reading:
    """Return the closed surface of a file; read anew when the file changes.

    Raises
    ------
    SpecError
        If it cannot be read, or bounds no body: one sentence with the place and the mend.
    MicroswimError
        If trimesh is not installed.
    """
    place = Path(path)
    if place.suffix.lower() not in FORMATS:
        raise SpecError("body.file", str(path), "an STL, PLY or OBJ file")
    try:
        about = place.stat()
    except OSError as error:
        raise SpecError(f"body.file = {str(path)!r}: {error.strerror or error}") from None
    if about.st_size > MOST_BYTES:
        raise SpecError("body.file", str(path), f"of at most {MOST_BYTES >> 20} MB",
                        "export it coarser")  # fmt: skip
    return _read(str(place), about.st_mtime_ns, about.st_size)


@lru_cache(maxsize=8)
def _read(path: str, changed: int, size: int) -> Reading:
    mesh = _loaded(path)
    with _silent():
        points = np.asarray(getattr(mesh, "vertices", np.empty((0, 3))), float)
        faces = np.asarray(getattr(mesh, "faces", np.empty((0, 3))), np.int64)
    return checked(points, faces, path)


def _loaded(path: str) -> Any:
    try:
        import trimesh
    except ImportError:
        raise MicroswimError(
            'surface files need trimesh; install it with pip install "microswim[mesh]"'
        ) from None
    try:
        with _silent():
            return trimesh.load_mesh(path, process=False)
    except Exception:  # whatever the readers of broken files raise
        what = Path(path).suffix[1:].upper()
        raise _refused(path, f"cannot be read as {what}: it ends early, or its header or its text "
                       "is damaged; export it anew") from None  # fmt: skip


@contextmanager
def _silent() -> Iterator[None]:
    """Keep what the reader says of broken numbers to itself: they are looked at here."""
    log = logging.getLogger("trimesh")
    level = log.level
    log.setLevel(logging.CRITICAL + 1)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            yield
    finally:
        log.setLevel(level)


def _refused(path: str, why: str) -> SpecError:
    return SpecError(f"body.file = {path!r}: {why}")


def checked(points: Array, faces: Indices, path: str = "surface") -> Reading:
    """Return triangles that bound a body, with what was mended to get there.

    Raises
    ------
    SpecError
        If they do not.
    """
    if points.ndim != 2 or points.shape[1:] != (3,) or faces.ndim != 2 or len(faces) < 4:
        raise _refused(
            path, "holds no surface of triangles, or is cut off; export the body as triangles"
        )
    if faces.min() < 0 or faces.max() >= len(points):
        raise _refused(path, "names points that it does not hold; export it anew")
    if len(faces) > MOST_FACES:
        raise _refused(path, f"has {len(faces):,} triangles, {MOST_FACES:,} at most can be taken; "
                       "export it coarser")  # fmt: skip
    if not (np.abs(points[faces]) < LARGEST).all():
        raise _refused(path, "holds coordinates that are no numbers; export it anew")
    remarks: list[str] = []
    points, faces = _merged(points, faces, remarks)
    if len(faces) < 4:
        raise _refused(path, "bounds no volume: its triangles have no area; export it anew")
    _check_closed(points, faces, path)
    faces = _oriented(points, faces, remarks, path)
    faces = _outwards(points, faces, remarks, path)
    crossing = first_crossing(points, faces)
    if crossing is not None:
        raise _refused(path, f"its surface passes through itself {_at(crossing)}; unite the parts "
                       "in the CAD program before exporting")  # fmt: skip
    used, faces = np.unique(faces, return_inverse=True)
    return Reading(Triangles(points[used], faces.reshape(-1, 3)), tuple(remarks))


def _at(place: Array) -> str:
    return "at (" + ", ".join(f"{x:.4g}" for x in place) + ") of the file"


def _merged(points: Array, faces: Indices, remarks: list[str]) -> tuple[Array, Indices]:
    """Points that coincide made one, triangles without area or twice there left out."""
    size = float(np.ptp(points[faces.ravel()], axis=0).max())
    points = points - 0.0
    grid = np.round(points / max(1e-7 * size, 1e-300)).astype(np.int64)
    _, first, which = np.unique(grid, axis=0, return_index=True, return_inverse=True)
    points, faces = points[first], which.reshape(-1)[faces]
    if len(first) < len(grid) and len(grid) != 3 * len(faces):  # STL repeats every corner
        remarks.append(f"{len(grid) - len(first)} points that coincide were made one")
    two_alike = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    _, kept = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    good = np.zeros(len(faces), bool)
    good[kept] = True
    good &= ~two_alike
    if not good.all():
        remarks.append(f"{int((~good).sum())} triangles without area or twice there were left out")
    return points, faces[good]


def _halves(faces: Indices) -> tuple[Indices, Indices, Indices]:
    """Directed edges (3 m, 2), the undirected edge of each, and the faces at each of those."""
    halves = faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    _, which, count = np.unique(np.sort(halves, axis=1), axis=0, return_inverse=True,
                                return_counts=True)  # fmt: skip
    return halves, which.reshape(-1), count


def _check_closed(points: Array, faces: Indices, path: str) -> None:
    """Refuse holes, and edges at which more than two triangles meet."""
    halves, which, count = _halves(faces)
    for wrong, what, mend in (
        (count == 1, "is not closed: it has a hole", "close it in the CAD program"),
        (count > 2, "is no surface of a body: more than two triangles meet in an edge",
         "separate the parts that touch there, or unite them"),
    ):  # fmt: skip
        if wrong.any():
            n = int(np.argmax(wrong[which]))
            place = points[halves[n]].mean(axis=0)
            raise _refused(path, f"{what} {_at(place)} ({int(wrong.sum())} edges); {mend}")


def _oriented(points: Array, faces: Indices, remarks: list[str], path: str) -> Indices:
    """Triangles turned so that neighbours agree; said when some did not."""
    halves, which, _ = _halves(faces)
    order = np.argsort(which, kind="stable").reshape(-1, 2)
    same = (halves[order[:, 0], 0] == halves[order[:, 1], 0]).astype(np.int64)
    if not same.any():
        return faces
    sign = _signs(order // 3, same, len(faces))
    if sign is None:
        raise _refused(path, "has one side only, as a Moebius band; export it anew")
    flipped = np.where(sign[:, None] < 0, faces[:, ::-1], faces)
    remarks.append(f"{int(min((sign < 0).sum(), (sign > 0).sum()))} triangles that faced the "
                   "other way were turned")  # fmt: skip
    return flipped


def _signs(pairs: Indices, same: Indices, count: int) -> Indices | None:
    """+1 or -1 for each face, so that neighbours agree; None if there is no such choice."""
    neighbours: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for (a, b), s in zip(pairs.tolist(), same.tolist()):
        neighbours[a].append((b, -1 if s else 1))
        neighbours[b].append((a, -1 if s else 1))
    sign = np.zeros(count, np.int64)
    for start in range(count):
        if sign[start]:
            continue
        sign[start], left = 1, [start]
        while left:
            at = left.pop()
            for other, s in neighbours[at]:
                if not sign[other]:
                    sign[other] = s * sign[at]
                    left.append(other)
                elif sign[other] != s * sign[at]:
                    return None
    return sign


def _outwards(points: Array, faces: Indices, remarks: list[str], path: str) -> Indices:
    """Every shell turned outwards; shells within others, which no fluid reaches, left out."""
    shells = _shells(faces)
    kept = []
    for n in range(int(shells.max()) + 1):
        own = faces[shells == n]
        volume = Triangles(points, own).volume
        if abs(volume) <= 1e-9 * np.ptp(points[own.ravel()], axis=0).max() ** 3:
            raise _refused(path, f"bounds no volume {_at(points[own[0, 0]])}; export it anew")
        others = faces[shells != n]
        if len(others) and abs(winding(points[own[0, 0]], points, others)) > 0.5:
            remarks.append("a hollow inside the body, which no fluid reaches, was left out")
            continue
        if volume < 0:
            remarks.append("a surface that faced inwards was turned")
        kept.append(own[:, ::-1] if volume < 0 else own)
    if not kept:
        raise _refused(path, "bounds no body: its shells lie within each other; export it anew")
    return np.concatenate(kept)


def _shells(faces: Indices) -> Indices:
    """Number of the connected shell that each face belongs to."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = faces[:, [0, 1, 1, 2]].reshape(-1, 2)
    count = int(faces.max()) + 1
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    of_point = connected_components(graph, directed=False)[1][faces[:, 0]]
    return np.unique(of_point, return_inverse=True)[1].astype(np.int64)
