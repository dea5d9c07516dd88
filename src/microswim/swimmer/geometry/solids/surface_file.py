"""A body of any shape, from a surface file."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike, fspath
from typing import Any, ClassVar, Self

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids import reading
from microswim.swimmer.geometry.solids.crossing import windings
from microswim.swimmer.geometry.solids.facets import Facet, Opening
from microswim.swimmer.geometry.solids.paired import facets_of
from microswim.swimmer.geometry.solids.rooted_surface import RootedSurface, rooted
from microswim.swimmer.geometry.solids.solved import SolvedBody
from microswim.swimmer.geometry.solids.triangles import Triangles

UNTURNED = (1.0, 0.0, 0.0, 0.0)
#: Plane distance that one radian about a root stands for, in half widths of the tail.
ROOM = 4.0
_SEEN = "directions of a surface from a file are those about a root: take `about`"


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class SurfaceFile(SolvedBody):
    """Body whose closed surface stands in an STL, PLY or OBJ file.

    Parameters
    ----------
    file
        The file. Points that coincide, triangles without area and surfaces that face inwards are
        mended; holes, edges of more than two triangles and self-intersections are refused.
    scale
        Length of one unit of the file.
    position
        Of the file's origin in the frame ``sqr``. By default the surface touches the joint with
        its rear end, the middle of its bounding box on the axis s.
    rotation
        Unit quaternion (wxyz) that turns the file's axes.

    Raises
    ------
    SpecError
        If the file cannot be read or bounds no body, or a field is out of range.
    MicroswimError
        If trimesh is not installed (extra ``mesh``).

    Notes
    -----
    Its resistance is solved on curved patches through the triangles. By boundary elements a tail
    grows out of any smooth part of it; finite elements do not take it.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.SurfaceFile(file="no.stl", scale=1e-3)
    Traceback (most recent call last):
        ...
    microswim.errors.SpecError: body.file = 'no.stl': No such file or directory
    """

    file: str
    scale: float
    position: tuple[float, float, float] | None = None
    rotation: tuple[float, float, float, float] = UNTURNED
    shape: ClassVar[str] = "mesh"
    is_balanced: ClassVar[bool] = False
    is_mirrored: ClassVar[bool] = False
    of_revolution: ClassVar[bool] = False

    def __post_init__(self) -> None:
        if not isinstance(self.file, (str, PathLike)):
            raise SpecError("body.file", self.file, "the name of a file")
        object.__setattr__(self, "file", fspath(self.file))
        checks.positive("body.scale", self.scale, "length")
        if self.position is not None:
            checks.numbers("body.position", self.position, 3, "three lengths [s, q, r]")
            object.__setattr__(self, "position", tuple(self.position))
        checks.numbers("body.rotation", self.rotation, 4, "a quaternion [w, x, y, z]")
        object.__setattr__(self, "rotation", tuple(self.rotation))
        if abs(float(np.linalg.norm(self.rotation)) - 1.0) > 1e-3:
            raise SpecError(
                "body.rotation", self.rotation, "of length one", "no turn: [1, 0, 0, 0]"
            )
        _ = self._placed

    @cached_property
    def _placed(self) -> Triangles:
        from scipy.spatial.transform import Rotation

        found = reading.read(self.file).surface
        turn = Rotation.from_quat(np.real(np.array(self.rotation)), scalar_first=True)
        points = turn.apply(found.points) * float(np.real(self.scale))
        if self.position is None:
            low, high = points.min(axis=0), points.max(axis=0)
            points = points - [high[0], *0.5 * (low + high)[1:]]
        else:
            points = points + np.real(np.array(self.position))
        return Triangles(points, found.faces)

    @property
    def triangles(self) -> Triangles | None:
        return self._placed

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was mended in the file, in words."""
        return reading.read(self.file).remarks

    @property
    def identity(self) -> str:
        own = self._placed
        digest = hashlib.sha256(np.round(own.points, 9).tobytes() + own.faces.tobytes())
        return f"mesh {digest.hexdigest()}"

    @property
    def semi_axes3(self) -> tuple[Any, Any, Any]:
        half = 0.5 * np.ptp(self._placed.points, axis=0)
        return (float(half[0]), float(half[1]), float(half[2]))

    @property
    def is_axisymmetric(self) -> bool:
        return False

    def scaled(self, factor: float) -> Self:
        at = None if self.position is None else tuple(x * factor for x in self.position)
        return replace(self, scale=self.scale * factor, position=at)

    def level(self, X: Array) -> Array:
        X = np.asarray(X, float)
        own = self._placed
        low, high = own.points.min(axis=0), own.points.max(axis=0)
        near = ((low <= X) & (high >= X)).all(axis=-1)
        inside = np.zeros(int(near.sum()))
        windings(np.ascontiguousarray(X[near]), own.points, own.faces, inside)
        out = np.ones(X.shape[:-1])
        out[near] = np.where(inside > 0.5, -1.0, 1.0)
        return out

    def about(self, X: Array, size: float) -> Body:
        return RootedSurface(self, *rooted(self._placed, X, size), ROOM * size)

    def surface_point(self, direction: Array) -> Array:
        raise TypeError(_SEEN)

    def direction(self, X: Array) -> Array:
        raise TypeError(_SEEN)

    @property
    def stretch(self) -> float:
        return float(max(self.semi_axes3))

    def opening(self, pole: Array, first: Array, reach: float) -> Opening:
        raise TypeError(_SEEN)

    def facets(self, splits: int, opening: Opening | None = None) -> list[Facet]:
        size = 0.5 * np.pi / splits * float(np.sqrt(self._placed.area / (4 * np.pi)))
        return facets_of(self._placed, size, 1)

    def drawing(self, fineness: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
        own = self._placed
        return own.points - self.centre, own.faces[:, [0, 1, 2, 2]]
