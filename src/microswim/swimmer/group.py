"""Several swimmers in one fluid.

    R V + F rate = W,   R (6n, 6n),  F (6n, n),  V and W of all swimmers one below the other

Six-vectors are ``[linear; angular]`` in each swimmer's own frame, about its body's centre.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from microswim import checks
from microswim.errors import SpecError
from microswim.gait import doors
from microswim.numerics.array import Array
from microswim.swimmer import group_checks
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.magnetism.between import are_magnetic, wrenches
from microswim.swimmer.member import Member

Level = Literal["coarse", "standard", "fine"]
POSE = ("positions", "directions", "rolls", "phases")
LEVELS = checks.one_of("coarse", "standard", "fine")


@checks.by_name
@dataclass(frozen=True)
class Group:
    """Several swimmers in one fluid.

    Parameters
    ----------
    members
        Two or more `Member`; one is allowed, and swims as it does alone.
    wall
        A point of a plane no-slip wall, and its normal into the fluid; None: free fluid.
    field
        Magnetic, for swimmers with a `Magnet`, scene's axes. Magnets feel each other too, as
        dipoles at their bodies' centres (in SI).
    time
        At which the field is asked.

    Raises
    ------
    SpecError
        If they are not all in one system of units, or not in one fluid, or a field finds no magnet.

    Examples
    --------
    >>> import microswim as ms
    >>> helix = ms.Swimmer.preset("tabak/helix")
    >>> beside = ms.Member(swimmer=helix, position=(0.0, 3.0, 0.0))
    >>> pair = ms.Group((ms.Member(swimmer=helix), beside))
    >>> pair.units, len(pair.members)
    ('dimensionless', 2)
    """

    members: tuple[Member, ...]
    wall: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    field: AppliedField | None = None
    time: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "members", group_checks.checked_members(self.members))
        if self.wall is not None:
            object.__setattr__(self, "wall", group_checks.checked_wall(self.wall))
        checks.number("time", self.time, "a finite time")
        if self.field is not None:
            group_checks.checked_field(self.field, self.members)

    @classmethod
    @checks.given(path=checks.place, overrides=checks.mapping, trust=checks.place)
    def from_toml(
        cls,
        path: str | PathLike[str],
        overrides: dict[str, Any] | None = None,
        trust: str | PathLike[str] | None = None,
    ) -> Group:
        """Return the group of a scene file.

        Parameters
        ----------
        path
            Scene of ``[[swimmer]]`` tables; the specs that it names stand beside it.
        overrides
            Field to its value: ``swimmer[0].phase``, ``tail.amplitude`` of all specs.
        trust
            Python file whose functions the specs may name. None: they run no code.

        Raises
        ------
        SpecError
            One sentence: the field, its value, what is allowed, how to mend it.

        Examples
        --------
        >>> import microswim as ms
        >>> ms.Group.from_toml("nowhere.toml")
        Traceback (most recent call last):
            ...
        microswim.errors.SpecError: nowhere.toml: no such file; a scene holds [[swimmer]] tables \
with spec = "robot.toml" and position = [x, y, z]
        """
        return doors.go(doors.READ_SCENE, path, overrides, trust)

    @property
    def units(self) -> str:
        """``"SI"`` or ``"dimensionless"``."""
        return self.members[0].swimmer.units

    @property
    def viscosity(self) -> float:
        """Of the fluid."""
        return float(self.members[0].swimmer.fluid.viscosity)

    @property
    def plane(self) -> Array | None:
        """Point and unit normal (6,) of the wall, None without one."""
        if self.wall is None:
            return None
        point, normal = np.array(self.wall)
        return np.concatenate([point, normal / np.linalg.norm(normal)])

    @property
    def wrench(self) -> Array:
        """External forces and torques (6n,) in the swimmers' own axes, those on magnets too."""
        own = np.concatenate([m.wrench for m in self.members])
        if not are_magnetic(self.members):
            return own
        load = wrenches(self.members, self.field, self.time).reshape(-1, 2, 3)
        return own + np.ravel([w @ m.rotation for w, m in zip(load, self.members)])

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which of the 6n degrees of freedom are free."""
        return np.array([m.swimmer.motion.mask for m in self.members], bool).reshape(-1)

    @checks.given(**dict.fromkeys(POSE, checks.series), time=checks.finite)
    def moved(
        self,
        positions: Any = None,
        directions: Any = None,
        rolls: Any = None,
        phases: Any = None,
        time: float | None = None,
    ) -> Group:
        """Return the same swimmers at other poses or phases, or later; what is not given stays.

        Parameters
        ----------
        positions, directions
            (n, 3).
        rolls, phases
            (n,) (rad).
        time
            At which the field is asked.
        """
        given = {"position": positions, "direction": directions, "roll": rolls, "phase": phases}
        members = list(self.members)
        for name, values in given.items():
            if values is None:
                continue
            if np.ndim(values) == 0 or len(values) != len(members):
                raise SpecError(f"{name}s", values, f"{len(members)} values, one for each swimmer")
            members = [replace(m, **{name: v}) for m, v in zip(members, values, strict=True)]
        return replace(self, members=tuple(members), time=self.time if time is None else time)

    @checks.given(level=LEVELS)
    def prepared(self, level: Level = "standard") -> Any:
        """Return the swimmers' own blocks, factorised: what is the same at every pose.

        Examples
        --------
        >>> import microswim as ms
        >>> helix = ms.Swimmer.preset("tabak/helix")
        >>> beside = ms.Member(swimmer=helix, position=(0, 3, 0))
        >>> pair = ms.Group((ms.Member(swimmer=helix), beside))
        >>> blocks = pair.prepared("coarse")
        >>> far = pair.moved(positions=[(0, 0, 0), (0, 6, 0)])
        >>> carried = [p.solve(blocks=blocks).resistance[0, 6] for p in (pair, far)]
        >>> bool(carried[0] < carried[1] < 0)  # each carries the other along
        True
        """
        return doors.go(doors.GROUP_BLOCKS, self, level)

    @checks.given(level=LEVELS, blocks=group_checks.blocks)
    def solve(self, *, level: Level = "standard", blocks: Any = None) -> Any:
        """Solve for the flow about all swimmers at their phases, by boundary elements.

        Parameters
        ----------
        level
            ``"coarse"``, ``"standard"`` or ``"fine"``.
        blocks
            What `prepared` returned, for many poses of the same swimmers; its level counts.

        Returns
        -------
        GroupSolution
            With ``resistance``, ``propulsion``, ``velocity``, and the flow.

        Raises
        ------
        SpecError
            If swimmers overlap, or are too near each other to be resolved.
        MachineError
            If the system does not fit into memory.

        Examples
        --------
        >>> import microswim as ms
        >>> helix = ms.Swimmer.preset("tabak/helix")
        >>> beside = ms.Member(swimmer=helix, position=(0, 3, 0))
        >>> pair = ms.Group((ms.Member(swimmer=helix), beside))
        >>> found = pair.solve(level="coarse")
        >>> found.resistance.shape, found.velocity.shape
        ((12, 12), (2, 6))
        """
        return doors.go(doors.GROUP_SOLVE, self, level, blocks)

    @checks.given(level=LEVELS, blocks=group_checks.blocks)
    def estimate(self, *, level: Level = "standard", blocks: Any = None) -> Any:
        """Estimate velocities and resistance from afar, in a moment.

        Each swimmer is the cloud of point forces that its boundary elements have alone; a pair
        nearer than some three lengths is solved by few nodes of each. From a gap of a tenth of a
        swimmer's length on velocities are within one per cent of those of `solve`; the estimate
        says its own error.

        Parameters
        ----------
        level
            ``"coarse"``, ``"standard"`` or ``"fine"``.
        blocks
            What `prepared` returned; its level counts.

        Returns
        -------
        GroupEstimate
            With ``velocity``, ``resistance``, ``propulsion`` and ``expected_error``.
        """
        return doors.go(doors.GROUP_ESTIMATE, self, level, blocks)

    @checks.given(
        **dict.fromkeys(POSE, group_checks.poses),
        level=LEVELS,
        blocks=group_checks.blocks,
        workers=checks.at_least(1),
        keep=checks.place,
        progress=checks.function,
    )
    def at_poses(
        self,
        positions: Any,
        *,
        directions: Any = None,
        rolls: Any = None,
        phases: Any = None,
        level: Level = "standard",
        blocks: Any = None,
        workers: int | None = None,
        keep: str | PathLike[str] | None = None,
        progress: Any = None,
    ) -> Any:
        """Solve for these swimmers at many poses, several at a time.

        Swimmers an eighth of their extent apart or more answer each other by a skeleton of their
        nodes, a fifth of the cost of `solve` and within 2e-3 of its velocities.

        Parameters
        ----------
        positions
            (m, n, 3): m poses of n swimmers.
        directions, rolls, phases
            (m, n, 3), (m, n), (m, n) (rad); what is not given stays.
        level, blocks
            As of `solve`.
        workers, progress
            Poses at a time (default: one a core); called with (poses done, poses in all).
        keep
            File in which solved poses are kept; what it holds is not solved again.

        Returns
        -------
        GroupPoses
            With ``resistance``, ``propulsion``, ``velocity``, ``gap`` of each; NaN where swimmers
            overlap, with the reason in ``refused``.

        Examples
        --------
        >>> import microswim as ms
        >>> helix = ms.Swimmer.preset("tabak/helix")
        >>> one = ms.Group((ms.Member(swimmer=helix),))
        >>> one.at_poses([[(0, 0, 0)], [(0, 1, 0)]], level="coarse").velocity.shape
        (2, 1, 6)
        """
        given = {"positions": positions, "directions": directions, "rolls": rolls, "phases": phases}
        given = {name: values for name, values in given.items() if values is not None}
        for name, values in given.items():
            if len(values) != len(positions):
                raise SpecError(f"{name}: {len(values)} poses, positions has {len(positions)}")
        how = {"level": level, "blocks": blocks, "workers": workers}
        return doors.go(doors.GROUP_POSES, self, given, **how, keep=keep, progress=progress)

    @checks.given(level=LEVELS, progress=checks.function)
    def swim(self, *, level: Level = "standard", progress: Any = None) -> Any:
        """Return how the swimmers swim at their pose, averaged over the phases of their motors.

        Motors of one rate keep their differences of phase; motors of different rates come by all
        pairs of phases. The pose stands still meanwhile: it is the mean of velocities, not the
        velocity of a path.

        Parameters
        ----------
        level
            ``"coarse"``, ``"standard"`` or ``"fine"``.
        progress
            Called with (phases done, phases in all).

        Returns
        -------
        GroupMotion
            With ``mean_velocity`` (n, 6) of each swimmer in its own axes and its
            ``expected_error``.

        Raises
        ------
        SpecError
            As `solve`; if more than three rates differ.
        MachineError
            If the system does not fit into memory.

        Examples
        --------
        >>> import microswim as ms
        >>> helix = ms.Swimmer.preset("tabak/helix")
        >>> alone = ms.Group((ms.Member(swimmer=helix),)).swim(level="coarse")
        >>> bool(abs(alone.mean_velocity[0, 0] / -0.0307 - 1) < 0.02)
        True
        """
        return doors.go(doors.GROUP_SWIM, self, level, progress)
