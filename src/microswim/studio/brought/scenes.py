"""Scenes of two swimmers: those of the menu, and a scene file that somebody drops."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.array import Array
from microswim.spec.readers.scene import read_scene
from microswim.spec.readers.text import toml
from microswim.studio import answers
from microswim.studio.spec_tables import canonical
from microswim.swimmer.group import Group
from microswim.swimmer.member import Member, direction_and_roll

SHIPPED = files(__name__.rpartition(".brought")[0]) / "scenes"
PAIR = 2
OF_A_FILE = ("file", "path")  #: fields of a [field] that name one


def shipped() -> dict[str, str]:
    """Return the texts of the menu's scenes by name, ``"family/member"``."""
    families = sorted((f for f in SHIPPED.iterdir() if f.is_dir()), key=lambda f: f.name)
    return {
        f"{family.name}/{scene.name[:-5]}": scene.read_text(encoding="utf-8")
        for family in families
        for scene in sorted(family.iterdir(), key=lambda f: f.name)
    }


def read(text: str) -> dict[str, Any]:
    """Return two designs, each with its answer, and where a scene puts them.

    Places are in the axes of the first swimmer, about its body's centre.

    Raises
    ------
    SpecError
        If it is no scene of two swimmers in free fluid that are presets. A field of the scene is
        that of both designs.
    """
    scene = toml(text, "the scene")
    tables = scene.get("swimmer")
    for n, one in enumerate(tables if isinstance(tables, list) else []):
        _check_data(n, one)
    field = scene.get("field")
    if isinstance(field, dict) and any(word in field for word in OF_A_FILE):
        raise SpecError(
            "field: the studio reads no file that a scene names; take microswim group, or a field "
            "that stands in the scene"
        )
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.toml"
        file.write_text(text, encoding="utf-8")
        try:
            group = read_scene(file)
        except SpecError as error:
            raise SpecError(str(error).replace(str(file), "the scene")) from None
    _check_pair(group)
    names = [str(one["preset"]) for one in tables]  # type: ignore[union-attr]
    made = [canonical(replace(m.swimmer, field=group.field)) for m in group.members]
    return {
        "designs": [
            {"name": name, "answer": answers.solve(own, name)}
            for name, own in zip(names, made, strict=True)
        ],
        "places": [_place(member, group.members[0]) for member in group.members],
    }


def _check_data(n: int, one: Any) -> None:
    """Refuse what names a file: the studio reads none that a scene names."""
    given = one if isinstance(one, dict) else {}
    changed = given.get("set", {})
    named = [k for k in changed if "file" in str(k)] if isinstance(changed, dict) else []
    if "spec" in given or named:
        field = "spec" if "spec" in given else f"set {named[0]!r}"
        raise SpecError(
            f"swimmer[{n}].{field}: the studio reads no file that a scene names; give preset, or "
            "open both specs here, one after Compare, and put them together under Path"
        )


def _check_pair(group: Group) -> None:
    members = group.members
    if len(members) != PAIR:
        raise SpecError("swimmer", len(members), "two of them here", "take microswim group")
    if group.wall is not None:
        raise SpecError("wall: two swimmers are shown in free fluid; take microswim group")
    first = group.members[0]
    if group.field is not None and not (np.eye(3) == first.rotation).all():
        raise SpecError(
            "swimmer[0].direction: a scene with a field is shown in the axes of its first swimmer; "
            "put that along x, without roll"
        )
    if group.field is not None and any(first.position):
        raise SpecError(
            "swimmer[0].position: a scene with a field is shown about its first swimmer; put that "
            "at the origin"
        )
    if any(any(m.force) or any(m.torque) for m in members):
        raise SpecError("force, torque: none are shown here; take microswim group")


def _place(member: Member, first: Member) -> dict[str, Any]:
    back: Array = first.rotation.T
    direction, roll = direction_and_roll(back @ member.rotation)
    position = back @ (np.array(member.position) - np.array(first.position))
    return {
        "position": (position + 0.0).tolist(),
        "direction": np.asarray(direction, float).tolist(),
        "roll": float(roll),
        "phase": float(member.phase),
    }
