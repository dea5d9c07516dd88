"""How a rigid body of any shape moves: its 6x6 resistance and mobility by boundary elements.

    [F; T] = R [U; Omega],   M = R^-1 = [ a  b'; b  c ]

At the centre of mobility, ``r = (tr(c) I - c)^-1 beta`` away, beta the axial vector of ``b' - b``,
the coupling b is symmetric (Kim & Karrila, Microhydrodynamics, 1991, sec. 5.3). Its trace depends
on no point and changes sign in the mirror: the chirality is ``tr b / sqrt(tr a tr c)``.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal

import numpy as np

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.gait.portrait import Printed, Rows
from microswim.gait.readable import percent, significant
from microswim.models.bem.balance import balanced, turning_of
from microswim.models.bem.levels import coarser as level_below
from microswim.models.bem.levels import get_level
from microswim.models.bem.output import write_mesh
from microswim.models.bem.patches import triangles as patches
from microswim.models.bem.patches.mesh import swimmer_surface
from microswim.models.bem.patches.surface import Surface, sampled, still
from microswim.models.bem.system import Quadrature
from microswim.models.bem.system import resistance as resistance_of
from microswim.numerics.array import Array
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.solids import reading
from microswim.swimmer.geometry.solids.triangles import Triangles
from microswim.swimmer.in_units import in_its_units
from microswim.swimmer.swimmer import Swimmer

#: Viscosity where none is given: water's (Pa s), one without units.
WATER = {"SI": 1e-3, "dimensionless": 1.0}


FROM_A_FILE = "by fewer triangles and other cuts at sharp edges, no less than known shapes show"
FROM_LEVELS = "the difference from the next coarser level"
#: A solve to compare with: its surface and rule, and the error over the difference from it.
Other = tuple[Surface, Quadrature, float]


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Mobility(Printed):
    """Resistance and mobility of a rigid body.

    Parameters
    ----------
    resistance
        (6, 6), symmetric: force and torque on the fluid per velocity and angular velocity.
    about
        Point (3,) of the body that velocities and torques refer to, in the body's coordinates.
    viscosity
        Of the fluid.
    expected_error
        Of the entries ``|dR_ij| / sqrt(R_ii R_jj)``: the difference from the next coarser level; of
        a file from fewer triangles and from other cuts at its sharp edges, and no less than files
        of known answers have shown. No less than the asymmetry of the solution.
    surface
        What was solved on.
    units
        ``"SI"`` or ``"dimensionless"``.
    level, unknowns, seconds, remarks
        How it was solved, and what was mended in a file.
    how
        How the expected error is known, in words.

    Examples
    --------
    >>> import microswim as ms
    >>> found = ms.mobility(ms.Sphere(radius=1.0), level="coarse")
    >>> round(found.volume, 2), bool(found.expected_error < 0.01)
    (4.19, True)
    """

    resistance: Array
    about: Array
    viscosity: float
    expected_error: float
    surface: Surface
    units: Literal["SI", "dimensionless"]
    level: str
    unknowns: int
    seconds: float
    remarks: tuple[str, ...] = ()
    how: str = FROM_LEVELS

    def _portrait(self) -> tuple[str, Rows]:
        drag, turning = np.diag(self.resistance)[:3], np.diag(self.resistance)[3:]
        return f"Mobility, {self.units}, boundary elements at {self.level}", [
            ("drag", ", ".join(map(significant, drag)) + " along its axes (diagonal of R)"),
            ("turning", ", ".join(map(significant, turning)) + " about them"),
            ("chirality", f"{self.chirality:.3f}"),
            ("error", f"{percent(self.expected_error)} of sqrt(R_ii R_jj), by {self.how}"),
            ("more", "resistance and mobility are the matrices, surface what was solved on"),
        ]

    @property
    def mobility(self) -> Array:
        """Inverse of the resistance, (6, 6)."""
        M = np.linalg.inv(self.resistance)
        return 0.5 * (M + M.T)

    @property
    def centre_of_mobility(self) -> Array:
        """Point (3,) about which the coupling of the mobility is symmetric."""
        M = self.mobility
        b, c = M[3:, :3], M[3:, 3:]
        odd = b.T - b
        beta = np.array([odd[2, 1], odd[0, 2], odd[1, 0]])
        return self.about + np.linalg.solve(np.trace(c) * np.eye(3) - c, beta)

    @property
    def chirality(self) -> float:
        """``tr b / sqrt(tr a tr c)``: positive for a right-handed screw, 0 without a hand."""
        M = self.mobility
        scale = np.sqrt(np.trace(M[:3, :3]) * np.trace(M[3:, 3:]))
        return float(np.trace(M[3:, :3]) / scale)

    @property
    def surface_area(self) -> float:
        """Area of the surface."""
        return self.surface.extent[0]

    @property
    def volume(self) -> float:
        """Volume within the surface."""
        return self.surface.extent[1]

    def as_dict(self) -> dict[str, Any]:
        """Return everything but the surface, as the command prints it."""
        names = ("resistance", "about", "mobility", "centre_of_mobility", "chirality", "units",
                 "viscosity", "surface_area", "volume", "expected_error", "how", "level",
                 "unknowns", "seconds", "remarks")  # fmt: skip
        return {name: getattr(self, name) for name in names}

    def to_vtk(self, path: str | Path) -> Path:
        """Write the surface that was solved on for ParaView, ``path`` with ``.vtp``."""
        return write_mesh(self.surface, path)


def mobility(
    what: str | PathLike[str] | Swimmer | Body,
    *,
    scale: float | str | None = None,
    level: Literal["coarse", "standard", "fine"] = "standard",
    viscosity: float | None = None,
    phase: float = 0.0,
) -> Mobility:
    """Solve for resistance and mobility of a surface file, a body, or a swimmer that is held rigid.

    Parameters
    ----------
    what
        An STL, PLY or OBJ file; a spec file (TOML); a `Swimmer`, whose tail does not turn; a body
        such as `Capsule`.
    scale
        Length of one unit of the file: a quantity such as ``"1 mm"``, or a number for a body
        without units. Needed for a surface file.
    level
        ``"coarse"``, ``"standard"`` or ``"fine"``.
    viscosity
        Of the fluid; by default the swimmer's, water's 1 mPa s for a file with a unit, else one.
    phase
        Of a swimmer's tail (rad).

    Returns
    -------
    Mobility
        About the middle of a file's volume, in the file's coordinates; about the centre of a body
        or of a swimmer's body.

    Raises
    ------
    SpecError
        If a file bounds no body, or has no unit.
    MachineError
        If the system does not fit into memory.

    Examples
    --------
    >>> import microswim as ms
    >>> found = ms.mobility(ms.Capsule(length=2.0, radius=1.0), level="coarse")
    >>> bool(abs(found.resistance[0, 0] / 18.85 - 1) < 0.01)
    True
    """
    start = time.perf_counter()
    get_level(level)
    if viscosity is not None:
        checks.positive("viscosity", viscosity)
    fine, others, about, mu, units, remarks, rule, error = _of(what, scale, level, viscosity, phase)
    whole = resistance_of(fine, mu, about, rule)
    R = balanced(whole, turning_of(fine, about))
    root = np.sqrt(np.abs(R.diagonal()))
    if not np.linalg.eigvalsh(R / np.outer(root, root)).min() > 0.0:
        raise SpecError(
            f"level = {level!r}: the resistance of this surface is not that of a passive body; "
            "take level fine, or a surface without gaps and creases that are so narrow"
        )
    how = FROM_A_FILE if error else FROM_LEVELS
    error = max(error, float((np.abs(whole - whole.T) / np.outer(root, root)).max()))
    for other, its_rule, share in others:
        off = np.abs(R - _symmetric(other, mu, about, its_rule)) / np.outer(root, root)
        error = max(error, share * float(off.max()))
    return Mobility(
        resistance=R,
        about=about,
        viscosity=mu,
        expected_error=error,
        surface=fine,
        units=units,
        level=level,
        unknowns=fine.unknowns,
        seconds=time.perf_counter() - start,
        remarks=remarks,
        how=how,
    )


def _symmetric(surface: Surface, viscosity: float, about: Array, rule: Quadrature) -> Array:
    return balanced(resistance_of(surface, viscosity, about, rule), turning_of(surface, about))


def _of(what: Any, scale: Any, level: str, viscosity: float | None, phase: float) -> Any:
    """Surface of the level, those to compare with, point, viscosity, units, remarks, rule, and the
    least error that is told.
    """
    if isinstance(what, Swimmer):
        return _of_swimmer(what, level, viscosity, phase)
    if isinstance(what, Body):
        mu = WATER["dimensionless"] if viscosity is None else viscosity
        if what.is_absent:
            raise SpecError("body.shape", "none", "a body here", "it has no surface")
        return _of_body(what, level, mu, "dimensionless")
    if not isinstance(what, (str, PathLike)):
        raise SpecError("what", what, "a surface file, a spec file, a Swimmer or a body")
    if Path(fspath(what)).suffix.lower() == ".toml":
        return _of_swimmer(doors.go(doors.READ, what), level, viscosity, phase)
    unit, units = _unit(scale)
    found = reading.read(Path(what))
    placed = Triangles(found.surface.points * unit, found.surface.faces)
    mu = WATER[units] if viscosity is None else viscosity
    return _of_triangles(placed, placed.centroid, level, mu, units, found.remarks)


def _of_body(body: Body, level: str, mu: float, units: str) -> Any:
    if body.triangles is not None:
        remarks = tuple(getattr(body, "remarks", ()))
        return _of_triangles(body.triangles, body.centre, level, mu, units, remarks)
    splits = 1 + patches_index(level)
    fine = still(sampled(body.facets(splits)), 3)
    rough = still(sampled(body.facets(splits)), 2)
    rule = get_level("standard").rule
    others = [(rough, rule, 1.0)]
    return fine, others, np.asarray(body.centre, float), mu, units, (), rule, 0.0


def patches_index(level: str) -> int:
    """Return 0 for coarse, 1 for standard, 2 for fine."""
    return list(patches.LEVELS).index(level)


def _unit(scale: Any) -> tuple[float, Literal["SI", "dimensionless"]]:
    """Length of one unit of a file, and in which units that is."""
    if scale is None:
        raise SpecError(
            'scale: missing; a surface file has no unit: say the length of one, as in "1 mm"'
        )
    units: Literal["SI", "dimensionless"] = "SI" if isinstance(scale, str) else "dimensionless"
    value = doors.go(doors.READ_VALUE, "body.scale", scale, units)
    checks.positive("scale", value, "length")
    return float(value), units


def _of_triangles(
    triangles: Triangles, about: Array, level: str, mu: float, units: str, remarks: tuple[str, ...]
) -> Any:
    fine, used = patches.surface_of(triangles, level)
    said = list(remarks)
    if used is not triangles:
        said.append(f"{len(triangles.faces)} triangles were coarsened to {len(used.faces)}: the "
                    f"answer at level {level} needs no more")  # fmt: skip
    compared = patches.fewer(used, level, fine.order), patches.recut(used, level, fine.order)
    others: list[Other] = [(c[0], patches.RULE, c[1]) for c in compared if c is not None]
    least = patches.least_error(used, level, fine.order)
    return fine, others, about, mu, units, tuple(said), patches.RULE, least


@in_its_units
def _of_swimmer(swimmer: Swimmer, level: str, viscosity: float | None, phase: float) -> Any:
    for name in ("wall", "channel"):
        if getattr(swimmer, name) is not None:
            raise SpecError(f"{name}: a mobility is that in free fluid; remove [{name}]")
    mu = float(swimmer.fluid.viscosity) if viscosity is None else viscosity
    if swimmer.tail.is_absent:
        return _of_body(swimmer.body, level, mu, swimmer.units)
    made = []
    for name in (level, level_below(level) or "coarse"):
        chosen = get_level(name, 1 if name == level == "coarse" and made else None)
        parts = swimmer.body, swimmer.tail, phase, chosen.resolution
        made.append((swimmer_surface(*parts), chosen.rule))
    (fine, rule), (rough, other) = made
    about = np.asarray(swimmer.body.centre, float)
    return fine, [(rough, other, 1.0)], about, mu, swimmer.units, (), rule, 0.0
