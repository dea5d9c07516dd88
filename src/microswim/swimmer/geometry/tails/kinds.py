"""Every kind of tail by the word of the spec: a new one is a file and a line here."""

from __future__ import annotations

from collections.abc import Sequence

from microswim.swimmer.geometry.tails.custom_tail import CustomTail
from microswim.swimmer.geometry.tails.elastic.elastic_tail import ElasticTail
from microswim.swimmer.geometry.tails.helical_tail import HelicalTail
from microswim.swimmer.geometry.tails.no_tail import NoTail
from microswim.swimmer.geometry.tails.plain_wave import as_wave
from microswim.swimmer.geometry.tails.plane_wave_tail import PlaneWaveTail
from microswim.swimmer.geometry.tails.several_tails import SeveralTails
from microswim.swimmer.geometry.tails.tail import Tail
from microswim.swimmer.geometry.tails.wave_tail import WaveTail
from microswim.swimmer.geometry.tails.waveforms.waveform_tail import WaveformTail

__all__ = [
    "TAILS",
    "CustomTail",
    "ElasticTail",
    "HelicalTail",
    "NoTail",
    "PlaneWaveTail",
    "SeveralTails",
    "Tail",
    "WaveTail",
    "WaveformTail",
    "as_wave",
    "of_tails",
]

TAILS: dict[str, type[Tail]] = {
    t.kind: t for t in (HelicalTail, PlaneWaveTail, CustomTail, WaveformTail, ElasticTail, NoTail)
}


def of_tails(tails: Sequence[Tail]) -> Tail:
    """Return what a swimmer with these tails has: none, the one, or several."""
    if not tails:
        return NoTail()
    return tails[0] if len(tails) == 1 else SeveralTails(tails=tuple(tails))
