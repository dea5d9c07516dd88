"""One swimmer into many: any field of the spec by its dotted name, kinds of parts included.

`Swimmer.with_` sets a part's own fields; here also one entry of a list
(``interaction.translation[0]``) and the kind of a part (``tail.kind``, ``body.shape``,
``coefficients.law``), which keeps the fields that both kinds have.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from microswim.checks import required
from microswim.errors import SpecError, nearest
from microswim.swimmer.drag.coefficients import LAWS, Unchosen
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.geometry.bodies import SHAPES
from microswim.swimmer.geometry.tails.kinds import TAILS, WaveTail
from microswim.swimmer.swimmer import Swimmer

KINDS = {
    "tail.kind": {kind: t for kind, t in TAILS.items() if issubclass(t, WaveTail)},
    "body.shape": SHAPES,
    "coefficients.law": LAWS,
}


def unchosen(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer as if nobody had chosen a law of local resistance or coefficients.

    Examples
    --------
    >>> import microswim as ms
    >>> unchosen(ms.Swimmer.preset("tabak/helix-constant")).is_open
    True
    """
    return replace(swimmer, coefficients=Unchosen(), interaction=Interaction(), calibration=None)


def vary(swimmer: Swimmer, values: Mapping[str, Any]) -> Swimmer:
    """Return the checked copy of a swimmer with fields replaced by dotted name.

    Parameters
    ----------
    swimmer
        Where to start from.
    values
        Dotted name to value: what `Swimmer.with_` takes, entries of lists, and kinds of parts.

    Raises
    ------
    SpecError
        If a field does not exist or a value is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> vary(swimmer, {"tail.kind": "plane_wave", "tail.amplitude": 0.2}).tail.kind
    'plane_wave'
    """
    rest: dict[str, Any] = {}
    for path in KINDS:
        if path in values:
            swimmer = _of_kind(swimmer, path, values[path])
    for path, value in values.items():
        if path in KINDS:
            continue
        if (
            path == "tail.handedness"
            and "tail.kind" in values
            and not hasattr(swimmer.tail, "handedness")
        ):
            continue  # a plane wave has no hand
        rest[path] = value.item() if isinstance(value, np.generic) else value
    return swimmer.with_(rest) if rest else swimmer


def _of_kind(swimmer: Swimmer, path: str, kind: Any) -> Swimmer:
    part, name = path.split(".")
    owner = getattr(swimmer, part)
    if kind not in KINDS[path]:
        raise SpecError(path, kind, "one of " + ", ".join(KINDS[path]))
    if getattr(owner, name) == kind:
        return swimmer
    known = {f.name for f in fields(KINDS[path][kind])} - {"sections", "surface_motion"}
    kept = {f.name: getattr(owner, f.name) for f in fields(owner) if f.name in known}
    missing = [name for name in required(KINDS[path][kind]) if name not in kept]
    if missing:
        raise SpecError(
            path, kind, f"a kind whose fields the spec holds ({', '.join(missing)} missing)"
        )
    return replace(swimmer, **{part: KINDS[path][kind](**kept)})


def check_names(swimmer: Swimmer, names: Any) -> None:
    """Refuse a name that is no field of this swimmer, whatever its value.

    Raises
    ------
    SpecError
        With the nearest name that exists.
    """
    known = known_names(swimmer)
    for name in names:
        if name not in known:
            mend = nearest(name, sorted(known))
            raise SpecError(f"{name}: no field of this swimmer that can vary; {mend}")


def known_names(swimmer: Swimmer) -> set[str]:
    """Return every dotted name that `vary` can set, those of both kinds of wave included."""
    own = {f"{part}.{f.name}" for part in swimmer.parts for f in fields(getattr(swimmer, part))}
    waves = {"tail.handedness"} if isinstance(swimmer.tail, WaveTail) else set()
    return own | set(swimmer.numbers) | set(KINDS) | waves


def designs(swimmer: Swimmer, front: Any) -> list[Swimmer]:
    """Return the swimmers of a front (or of any Dataset over ``design``)."""
    names = [str(name) for name in front.coords if "." in str(name)]
    return [
        vary(swimmer, {name: front[name].values[i].item() for name in names})
        for i in range(front.sizes["design"])
    ]
