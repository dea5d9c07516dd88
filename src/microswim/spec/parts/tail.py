"""Tables of [tail], one of each kind."""

from __future__ import annotations

from typing import Annotated, Literal

from microswim.spec.fields import About
from microswim.spec.parts.elastic import ElasticFields
from microswim.spec.types import Angle, Curvature, Frequency, Length, Number, Table

_KIND = About("Kind", "helix | plane_wave | elastic | waveform | custom | none: a body alone")
_SECTIONS = Literal["perpendicular", "sheared"]
_SURFACE = Literal["rigid", "translating", "bending"]


class _TailTable(Table):
    length: Annotated[Length, About("Length", "from the body to the tip", start=2.0)]
    radius: Annotated[Length, About("Filament radius", "of the filament", start=0.05)]
    frequency: Annotated[
        Frequency, About("Frequency", "of the motor: the tail relative to the body", start=1.0)
    ] = 1.0
    sections: Annotated[
        _SECTIONS | None,
        About("Sections", "bem, fem: sheared: circles in s = const planes",
              words={"perpendicular": "Normal"}),
    ] = None  # fmt: skip
    surface_motion: Annotated[
        _SURFACE | None, About("Surface motion", "rigid: turns as a whole | translating | bending")
    ] = None
    wavelength: Annotated[Length | None, About("Wavelength", "along s, or waves")] = None


class _PlacedTable(_TailTable):
    position: Annotated[
        list[Length] | None,
        About("Root", "of the tail, from the joint; the joint by default",
              entries=("Root along s", "Root along q", "Root along r")),
    ] = None  # fmt: skip
    direction: Annotated[
        list[Number] | None,
        About("Axis", "of the tail, about which its motor turns; along s by default",
              entries=("Axis, s", "Axis, q", "Axis, r")),
    ] = None  # fmt: skip
    phase: Annotated[
        Angle | None, About("Phase", "how far ahead the tail beats", usual=(-180.0, 180.0))
    ] = None


class _WaveTable(_PlacedTable):
    radius: Annotated[
        Length | None,
        About("Filament radius", "of the filament; left out with section", start=0.05),
    ] = None  # type: ignore[assignment]
    amplitude: Annotated[
        Length, About("Amplitude", "of the wave or of the heave; the radius of a helix", start=0.1)
    ]
    waves: Annotated[
        Number | None,
        About("Waves", "or wavelength, one of the two", start=3, usual=(0.5, 8.0)),
    ] = None
    ramp: Annotated[
        Number,
        About("Ramp", "fraction of the length over which the amplitude grows",
              start=0.1, usual=(0.0, 1.0)),
    ] = 0.1  # fmt: skip
    amplitude_end: Annotated[
        Length | None, About("Amplitude at the tip", "of a conical tail; else the amplitude")
    ] = None
    radius_end: Annotated[
        Length | None, About("Radius at the tip", "of a tapered filament; else the radius")
    ] = None
    section: Annotated[
        list[Length] | None,
        About("Section", "half axes of an elliptic section, along normal and binormal: a ribbon",
              entries=("Half axis, normal", "Half axis, binormal")),
    ] = None  # fmt: skip
    length_measure: Annotated[
        Literal["apparent", "arc"],
        About("Length is", "apparent: along the axis s | arc: along the filament",
              start="apparent"),
    ] = "apparent"  # fmt: skip


class HelixTable(_WaveTable):
    """[tail] of kind "helix"."""

    kind: Annotated[Literal["helix"], _KIND]
    handedness: Annotated[
        Literal["left", "right"], About("Hand", "right for the mirror image", start="left")
    ] = "left"


class PlaneWaveTable(_WaveTable):
    """[tail] of kind "plane_wave"."""

    kind: Annotated[Literal["plane_wave"], _KIND]
    mean_curvature: Annotated[
        Curvature | None, About("Mean curvature", "of a beat about a bent axis; towards q")
    ] = None


class CustomTable(_PlacedTable):
    """[tail] of kind "custom": `shape` is ``"module:function"`` of a trusted file."""

    kind: Annotated[Literal["custom"], _KIND]
    shape: Annotated[str, About("Centreline", "module:function of a file given to --trust")]
    breaks: Annotated[list[Number], About("Breaks", "fractions of the length with kinks")] = []
    sign: Annotated[
        Number | None, About("Sense", "+1 or -1, of a rigid tail's turning; found from the motion")
    ] = None
    tolerance: Annotated[
        Number, About("Tolerance", "how exactly the centreline is followed; 0: to rounding")
    ] = 0.0


class WaveformTable(_PlacedTable):
    """[tail] of kind "waveform": a beat as it was filmed, by its file or by its modes."""

    kind: Annotated[Literal["waveform"], _KIND]
    length: Annotated[Length | None, About("Length", "along the filament")] = None  # type: ignore[assignment]
    frequency: Annotated[Frequency | None, About("Frequency", "beats; found in the file")] = None  # type: ignore[assignment]
    file: Annotated[
        str | None, About("File", "table of the beat: t or frame, s, x, y[, z], or t, s, angle")
    ] = None
    pixel: Annotated[Length | None, About("Pixel", "its size, where the file has pixels")] = None
    fps: Annotated[Frequency | None, About("Frame rate", "where the file counts frames")] = None
    mode_count: Annotated[
        Number | None, About("Modes along s", "of the fit; found by cross-validation")
    ] = None
    harmonics: Annotated[
        Number | None, About("Harmonics", "of the fit; found by cross-validation")
    ] = None
    modes: Annotated[
        list[list[Number]] | None,
        About("Modes", "in place of file: a row for each, mean, cosine, sine, ... of the angle"),
    ] = None
    modes_out: Annotated[
        list[list[Number]] | None,
        About("Modes out of the plane", "of the angle out of the plane, for a beat in space"),
    ] = None
    tolerance: Annotated[Number, About("Tolerance", "how exactly the centreline is followed")] = (
        1e-7
    )


class ElasticTable(ElasticFields, _TailTable):
    """[tail] of kind "elastic"."""

    kind: Annotated[Literal["elastic"], _KIND]


class NoTailTable(Table):
    """[tail] of kind "none"."""

    kind: Annotated[Literal["none"], _KIND]


#: Tables of [tail], one of each kind.
TAILS: tuple[type[Table], ...] = (
    HelixTable,
    PlaneWaveTable,
    ElasticTable,
    WaveformTable,
    CustomTable,
    NoTailTable,
)
