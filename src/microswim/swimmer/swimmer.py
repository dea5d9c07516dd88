"""Swimmer: body, tail, fluid, local coefficients and interaction; the one noun of the package."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, fields, is_dataclass
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, Unpack

import numpy as np

from microswim import checks
from microswim.errors import SpecError, nearest
from microswim.gait import doors
from microswim.swimmer import fitting, physical_sense, provenance
from microswim.swimmer.drag.coefficients import Coefficients, Unchosen
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.fields import numbers_of, set_item, without_other_names
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.surroundings import Channel, Wall
from microswim.swimmer.geometry.tails.elastic.hook import Hook
from microswim.swimmer.geometry.tails.kinds import Tail, of_tails
from microswim.swimmer.gradient import gradient
from microswim.swimmer.in_units import in_its_units
from microswim.swimmer.magnetism.applied_field import AppliedField
from microswim.swimmer.magnetism.magnet import Magnet
from microswim.swimmer.motion import Motion
from microswim.swimmer.motor import Motor
from microswim.swimmer.parts import changed, part_of, spread
from microswim.swimmer.provenance import Provenance
from microswim.swimmer.region import Region
from microswim.swimmer.shown import Shown
from microswim.swimmer.surroundings import clearance
from microswim.swimmer.surroundings.flow import Flow
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.surroundings.gravity import Gravity
from microswim.swimmer.surroundings.noise import Noise

if TYPE_CHECKING:
    from microswim.gait.gait import Gait

PARTS = ("fluid", "body", "tail", "coefficients", "interaction", "motion")
SURROUNDINGS = ("wall", "channel")
DRIVE = ("magnet", "field")
OUTSIDE = ("gravity", "flow", "noise")


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Swimmer(Shown):
    """A micro-swimmer: a body with its tail or tails in a fluid.

    Parameters
    ----------
    body
        `Sphere`, `Spheroid`, `Ellipsoid`, `Capsule`, `Cylinder`, `Box`, `Revolution` or `NoBody`.
    tail
        `HelicalTail`, `PlaneWaveTail`, `ElasticTail`, `CustomTail`; `NoTail` for a body alone; a
        list of tails that turn together, `SeveralTails`.
    fluid
        `Fluid`.
    coefficients
        Local resistance of the filament, Lighthill's with spin by default (surrogate only).
    interaction
        `Interaction` coefficients, all one by default (surrogate only).
    motion
        `Motion`: free degrees of freedom and readings.
    units
        ``"dimensionless"`` (any consistent units) or ``"SI"``.
    region
        Region calibration that the surrogate uses, as `calibrate_region` makes it.
    wall
        `Wall` beside the swimmer, for the boundary elements; none by default.
    channel
        `Channel` around the swimmer, for boundary and finite elements; a default of the latter.
    magnet
        `Magnet` in the body; none by default.
    field
        Magnetic field that it is in, `RotatingField`, `UniformField` or `OscillatingField`; none
        by default. A gait does not depend on magnet and field; what follows a path does.
    gravity, flow, noise
        `Gravity`, background flow (`ShearFlow` and others) and thermal `Noise`; none by default.
        A gait does not depend on them either.
    hook
        `Hook` between body and elastic tail; none by default.
    motor
        `Motor`, the torque of the motors, which a path follows; none by default: tails turn at
        their ``frequency``, as in every gait.
    calibration
        Where its coefficients or its region come from, if it was calibrated; no part of what it
        is, so that swimmers compare without it.

    Raises
    ------
    SpecError
        If parts do not fit together.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer(
    ...     body=ms.Sphere(radius=0.5),
    ...     tail=ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05),
    ...     fluid=ms.Fluid(viscosity=100.0),
    ... )
    >>> swimmer.gait().mean_velocity.shape
    (6,)
    """

    body: Body
    tail: Tail
    fluid: Fluid
    coefficients: Coefficients = dataclasses.field(default_factory=Unchosen)
    interaction: Interaction = dataclasses.field(default_factory=Interaction)
    motion: Motion = dataclasses.field(default_factory=Motion)
    units: Literal["dimensionless", "SI"] = "dimensionless"
    region: Region | None = dataclasses.field(default=None, repr=False)
    wall: Wall | None = None
    channel: Channel | None = None
    magnet: Magnet | None = None
    field: AppliedField | None = None
    hook: Hook | None = None
    motor: Motor | None = None
    gravity: Gravity | None = None
    flow: Flow | None = None
    noise: Noise | None = None
    calibration: Provenance | None = dataclasses.field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        if isinstance(self.tail, (list, tuple)):
            object.__setattr__(self, "tail", of_tails(self.tail))
        for name, kind in zip(PARTS, (Fluid, Body, Tail, Coefficients, Interaction, Motion)):
            self._check_part(name, kind)
        kinds = (Wall, Channel, Magnet, AppliedField, Gravity, Flow, Noise, Hook, Motor, Provenance)
        for name, kind in zip(
            (*SURROUNDINGS, *DRIVE, *OUTSIDE, "hook", "motor", "calibration"), kinds
        ):
            if getattr(self, name) is not None:
                self._check_part(name, kind)
        if self.hook is not None:
            self.hook.check(self.tail)
        if self.motor is not None:
            self.motor.check(self.tail)
        checks.choice("units", self.units, ("dimensionless", "SI"))
        fitting.check(self)

    def _check_part(self, name: str, kind: type) -> None:
        if not isinstance(getattr(self, name), kind):
            raise SpecError(name, type(getattr(self, name)).__name__, f"a {kind.__name__}")

    remarks = cached_property(physical_sense.remarks)
    remarks_on_drag = cached_property(physical_sense.remarks_on_drag)

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the parts it has, as the tables of a spec file."""
        others = (*SURROUNDINGS, *DRIVE, *OUTSIDE, "hook", "motor")
        return PARTS + tuple(n for n in others if getattr(self, n) is not None)

    @property
    def is_open(self) -> bool:
        """Whether nobody chose a law of local resistance or coefficients for the surrogate."""
        law = self.coefficients
        return isinstance(law, Unchosen) and law.is_usual and self.interaction == Interaction()

    @property
    def body_length(self) -> Any:
        """Length of the body along s; without a body that of the tail."""
        axis = self.body.semi_axes3[0]
        return 2.0 * axis if np.any(axis) else self.tail.apparent_length

    @classmethod
    @checks.given(path=checks.place, overrides=checks.mapping, trust=checks.place)
    def from_toml(
        cls,
        path: str | PathLike[str],
        overrides: dict[str, Any] | None = None,
        trust: str | PathLike[str] | None = None,
    ) -> Swimmer:
        """Read a spec file; `overrides` maps dotted fields to values, as ``--set`` does.

        `trust` is the Python file whose functions the spec may name (``tail.kind = "custom"``).

        Raises
        ------
        SpecError
            One sentence: the field, its value, what is allowed, how to mend it.
        """
        return doors.go(doors.READ, path, overrides, trust)

    @checks.given()
    def to_toml(self) -> str:
        """Return the text of a spec file that reads back as this swimmer.

        Quantities have their units, where the swimmer has, and must be of a size that a file may
        hold (lengths from 1e-12 m to 1e4 m, for one); a custom tail is written by the name of
        its function, which has to stand in a file of its own to be read again.

        Examples
        --------
        >>> import microswim as ms
        >>> print(ms.Swimmer.preset("goto/C").to_toml().partition("[body]")[0], end="")
        # A swimmer in SI units, by microswim 0.1.0
        <BLANKLINE>
        [fluid]
        viscosity = "0.001 Pa s"
        density = "1000.0 kg/m^3"
        <BLANKLINE>
        """
        return doors.go(doors.WRITE, self)

    @classmethod
    @checks.given(name=checks.text, overrides=checks.mapping)
    def preset(cls, name: str, overrides: dict[str, Any] | None = None) -> Swimmer:
        """Return a swimmer that comes with the package, such as ``"tabak/helix"``, ``"goto/C"``."""
        return doors.go(doors.READ_PRESET, name, overrides)

    @property
    def settled(self) -> Swimmer:
        """The swimmer with the tail that its elastic one settles to; itself with any other tail.

        Examples
        --------
        >>> import microswim as ms
        >>> swimmer = ms.Swimmer.preset("tabak/helix")
        >>> swimmer.settled is swimmer
        True
        """
        return doors.go(doors.SETTLED, self) if self.tail.settles else self

    @checks.given()
    @in_its_units
    def gait(
        self,
        model: doors.Model | str = "rft",
        **options: Unpack[doors.GaitOptions],
    ) -> Gait:
        """Return the gait by a model: surrogate ``"rft"`` or ``"atlas"``, reference ``"bem"`` or
        ``"fem"``.

        An elastic tail is one for the model ``"elastic"``, which finds the beat that it settles
        to; the other models take that beat as the tail's motion.

        By the surrogate it takes about a millisecond, the first as the thousandth; after
        `microswim.warm_up` less than a tenth of that.

        Parameters
        ----------
        model
            Name of the model; ``"auto"`` takes the cheapest that is honest for the swimmer, and
            says how far off it may be in ``info["expected_error"]``.
        options
            What the model takes, such as ``level="fine"`` of the boundary elements.

        Raises
        ------
        SpecError
            If the model is unknown or the swimmer is beyond its range.
        MicroswimError
            If the model's extra is not installed.
        """
        if self.tail.settles and model == "rft":  # its theory is that of the elastic tail too
            model = "elastic"
        doors.check_options(model, options)
        if model not in ("bem", "fem"):  # these look at what they solve, at the phases they solve
            clearance.check(self)
        if self.tail.settles and model not in ("auto", "elastic"):
            return self.settled.gait(model, **options)
        if model == "rft" and self.region is not None and not options:
            made = self.region.gait(self)
        else:
            made = doors.go(doors.MODELS[model], self, **options)
        made = physical_sense.said_with(self, made)
        return provenance.told(self, made) if model == "rft" else made

    @checks.given(changes=checks.mapping)
    @in_its_units
    def with_(self, changes: dict[str, Any]) -> Swimmer:
        """Return a copy with dotted fields replaced, checked again: ``{"tail.amplitude": 0.12}``.

        An entry of a list is ``"interaction.translation[1]"``. Setting one of `waves` and
        `wavelength` clears the other. Of several tails ``"tail[0].radius"`` is one's, and
        ``"tail.radius"`` that of all. Numbers are SI or, without units, the swimmer's own; a
        swimmer in SI also takes quantities as the spec file has them, ``"0.12 mm"``.

        Raises
        ------
        SpecError
            If a field does not exist or a value is out of range.
        """
        grouped: dict[str, dict[str, Any]] = {}
        for path, value in (changes := spread(self, changes)).items():
            if isinstance(value, str):  # a quantity with its unit, or a word
                value = doors.go(doors.READ_VALUE, path, value, self.units)
            part, _, name = path.partition(".")
            name, *index = name.replace("]", "").split("[")
            owner, new = part_of(self, part), grouped.setdefault(part, {})
            if not is_dataclass(owner) or name not in {f.name for f in fields(owner)}:
                raise SpecError(path, value, "a field of this swimmer", nearest(path, self.numbers))
            if index and path not in self.numbers:
                raise SpecError(path, value, "an entry of a list of this swimmer")
            old = new.get(name, getattr(owner, name))
            new[name] = set_item(old, [int(i) for i in index], value) if index else value
        for path in without_other_names(changes) & self.numbers.keys():
            part, _, name = path.partition(".")
            grouped[part][name] = None
        return changed(self, grouped)

    @property
    def numbers(self) -> dict[str, float]:
        """Every number of the spec by its dotted name (entries of lists as ``name[i]``)."""
        return {
            f"{part}{path}": value
            for part in self.parts
            for path, value in numbers_of(getattr(self, part))
        }

    @checks.given(output=checks.text, wrt=checks.words)
    def gradient(self, output: str = "mean_velocity", wrt: Any = None) -> dict[str, Any]:
        """Return the exact derivatives of an output with respect to numbers of the spec.

        By the complex step ``Im f(x + ih)/h`` through the surrogate's kernels: exact to rounding.

        Parameters
        ----------
        output
            Any number or array that a gait gives: ``mean_velocity``, ``velocity_amplitude``,
            ``mean_power``, ``efficiency``, ``swimming_speed``, ``resistance_series``, ...
        wrt
            Dotted name or names; every number of the spec by default.

        Returns
        -------
        dict
            Name to derivative, of the output's shape.

        Examples
        --------
        >>> import microswim as ms
        >>> swimmer = ms.Swimmer.preset("tabak/helix")
        >>> d = swimmer.gradient("mean_velocity", "fluid.viscosity")
        >>> bool(abs(d["fluid.viscosity"][0]) < 1e-12)
        True
        """
        return gradient(self, output, wrt)
