"""What the page says of fields, units and quantities: read off the tables that say each once."""

from __future__ import annotations

import math
from typing import Any

from microswim.gait import palette
from microswim.gait.observed import ALL
from microswim.gait.quantities import NUMBERS
from microswim.gait.readable import READ_IN
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.units import is_dimensionless, unit
from microswim.path.regimes import STEEP, STRAIGHT
from microswim.spec.fields import Field
from microswim.spec.tables import FIELDS
from microswim.spec.units import SIZES
from microswim.studio.brought.films import FORMATS as FILMS
from microswim.studio.judge.jobs import LEVELS
from microswim.studio.maps import AXES, MAP_OUTPUTS
from microswim.studio.spec_tables import LARGEST_SPEC
from microswim.swimmer.geometry.solids.reading import FORMATS as SURFACES

#: What the page cannot make of another swimmer: a tail by code, which it never runs; what is in a
#: file, which is dropped.
NOT_CHOSEN = ("custom", "waveform", "mesh")


def words() -> dict[str, Any]:
    """Return fields by dotted name, sizes of units in SI, quantities, and what can be asked."""
    return {
        "fields": {path: _field(field) for path, field in FIELDS.items()},
        "units": {name: size for sizes in SIZES.values() for name, size in sizes.items()},
        "quantities": {name: _quantity(name) for name in (*NUMBERS, *DRIVEN)},
        "read_in": READ_IN,
        "outputs": MAP_OUTPUTS,
        "axes": AXES,
        "lean": [math.degrees(STRAIGHT), math.degrees(STEEP)],
        "levels": LEVELS,
        "palette": {
            "swimmers": [[palette.BODY, palette.TAIL, palette.PATH], palette.SECOND],
            "map": palette.MAP,
        },
        "largest": LARGEST_SPEC,
        "surfaces": SURFACES,
        "films": FILMS,
        "lengths": list(SIZES["m"]),
    }


def _field(field: Field) -> dict[str, Any]:
    about = field.about
    return {
        "kind": field.kind,
        "label": about.label,
        "help": about.help,
        "entries": about.entries,
        "usual": about.usual,
        "choices": [(word, field.said(word)) for word in field.choices if word not in NOT_CHOSEN],
        "called": {word: field.said(word) for word in field.choices if word in NOT_CHOSEN},
    }


def _quantity(name: str) -> dict[str, str]:
    about = ALL[name]
    si = unit("SI", about.dimension)
    return {
        "label": about.label[0].upper() + about.label[1:],
        "unit": "" if is_dimensionless(si) else si,
        "meaning": about.meaning,
    }
