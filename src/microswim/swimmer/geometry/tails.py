"""Every kind of tail by the word of the spec: a new one is a file and a line here."""

from __future__ import annotations

from microswim.swimmer.geometry.custom_tail import CustomTail
from microswim.swimmer.geometry.elastic_tail import ElasticTail
from microswim.swimmer.geometry.helical_tail import HelicalTail
from microswim.swimmer.geometry.no_tail import NoTail
from microswim.swimmer.geometry.plane_wave_tail import PlaneWaveTail
from microswim.swimmer.geometry.tail import Tail
from microswim.swimmer.geometry.wave_tail import WaveTail, as_wave
from microswim.swimmer.geometry.waveform_tail import WaveformTail

__all__ = [
    "TAILS",
    "CustomTail",
    "ElasticTail",
    "HelicalTail",
    "NoTail",
    "PlaneWaveTail",
    "Tail",
    "WaveTail",
    "WaveformTail",
    "as_wave",
]

TAILS: dict[str, type[Tail]] = {
    t.kind: t for t in (HelicalTail, PlaneWaveTail, CustomTail, WaveformTail, ElasticTail, NoTail)
}
