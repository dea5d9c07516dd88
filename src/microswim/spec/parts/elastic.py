"""What a spec file may say of a tail that bends and of the hook before it."""

from __future__ import annotations

from typing import Annotated, Literal

from microswim.spec.fields import About
from microswim.spec.types import Angle, Bending, Length, Moment, Number, Table, Torque


class ElasticFields(Table):
    """What an elastic tail has beside what any tail has."""

    bending: Annotated[Bending, About("Bending stiffness", "of the filament, E I", start=400.0)]
    base: Annotated[
        Literal["clamped", "hinged"],
        About("Base", "clamped | hinged: turns freely", start="clamped"),
    ] = "clamped"
    drive: Annotated[
        Literal["heave", "pivot", "rotate", "moment", "none"],
        About("Drive", "heave: base moves across s | pivot: turns about r | rotate: about s | "
              "moment: waves of inner moment | none", start="heave"),
    ] = "heave"  # fmt: skip
    amplitude: Annotated[Length | None, About("Amplitude", "of the heave", start=0.1)] = None
    angle: Annotated[
        Angle | None,
        About("Angle", "of the pivot, or the tilt of a base that rotates", usual=(0.0, 60.0)),
    ] = None
    twisting: Annotated[
        Bending | None, About("Twisting stiffness", "for rotate; two thirds of bending by default")
    ] = None
    moment: Annotated[
        Torque | None, About("Inner moment", "of the waves that bend it, of this wavelength")
    ] = None
    rest_radius: Annotated[
        Length | None, About("Radius at rest", "of a helix that it is at rest; straight by default")
    ] = None
    rest_pitch: Annotated[
        Length | None, About("Pitch at rest", "of that helix; negative: left-handed; none: an arc")
    ] = None
    rest: Annotated[
        list[list[Number]] | None, About("Shape at rest", "points [s, q, r], drawn to the length")
    ] = None
    file: Annotated[
        str | None, About("File", "table of s, q, r (or x, y, z): points of the shape at rest")
    ] = None
    magnet: Annotated[
        list[Moment] | list[list[Moment]] | None,
        About("Moment of the filament", "magnetic, spread along it: [along, across, across]",
              entries=("Moment along", "Moment across, q", "Moment across, r")),
    ] = None  # fmt: skip
    magnet_susceptibility: Annotated[
        list[Number] | None,
        About("Susceptibility of the filament", "of beads that the field magnetises: along, across",
              entries=("Susceptibility along", "Susceptibility across")),
    ] = None  # fmt: skip
    magnet_span: Annotated[
        list[Number] | list[list[Number]] | None,
        About("Magnetic part", "of the filament, from and to: [0, 0.3], or such pairs: links"),
    ] = None


class HookTable(Table):
    """[hook]: between body and tail, an elastic one or rigid ones with a [motor]."""

    stiffness: Annotated[
        Bending | list[Bending],
        About("Hook's stiffness", "bending stiffness E I of each hook; a list for several tails"),
    ]
    length: Annotated[
        Length | list[Length], About("Hook's length", "short against the tail; a list for several")
    ]
