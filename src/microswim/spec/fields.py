"""What there is to say about a field of the spec: read off the tables, for all who ask.

The tables of `microswim.spec.tables` say each field once. The file reader, ``--set``, ``--over``,
``--region``, ``--subject-to``, ``microswim new`` and the studio read it here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from microswim.spec.units import DIMENSIONS, Dimension


@dataclass(frozen=True)
class About:
    """What a person reads of a field.

    Parameters
    ----------
    label
        Its name on the page.
    help
        What it is, in a few words.
    start
        Its value in a new spec, lengths relative to a body of radius one half; None: left out.
    usual
        Where a slider runs: bare numbers, degrees for an angle.
    words
        What its choices are called, where it is not the word itself.
    entries
        What the entries of a list are called.
    """

    label: str
    help: str = ""
    start: Any = None
    usual: tuple[float, float] | None = None
    words: Mapping[str, str] = field(default_factory=dict)
    entries: tuple[str, ...] = ()


@dataclass(frozen=True)
class Measures:
    """Mark of a quantity in a table: the name of its dimension."""

    dimension: str


@dataclass(frozen=True)
class Field:
    """A field of the spec.

    Parameters
    ----------
    path
        Dotted name.
    kind
        ``"quantity"``, ``"number"``, ``"truth"``, ``"word"`` or ``"text"``.
    about
        What a person reads.
    measures
        Name of the dimension of a quantity.
    choices
        The words that are allowed.
    is_list
        Whether it holds a list (of lists).
    """

    path: str
    kind: Literal["quantity", "number", "truth", "word", "text"]
    about: About
    measures: str | None = None
    choices: tuple[str, ...] = ()
    is_list: bool = False

    @property
    def dimension(self) -> Dimension | None:
        """What it measures, or None for what is no quantity."""
        return DIMENSIONS[self.measures] if self.measures else None

    def said(self, word: str) -> str:
        """Return what one of its choices is called on the page."""
        return self.about.words.get(word, word.replace("_", " ").capitalize())


def read_off(tables: Mapping[str, tuple[type[BaseModel], ...]]) -> dict[str, Field]:
    """Return the fields of all tables by dotted name; kinds of one table share their fields."""
    found: dict[str, Field] = {}
    for name, kinds in tables.items():
        for kind in kinds:
            for entry in _fields(name, kind):
                old = found.get(entry.path)
                found[entry.path] = entry if old is None else _both(old, entry)
    return found


def _both(one: Field, other: Field) -> Field:
    words = tuple(dict.fromkeys((*one.choices, *other.choices)))
    return Field(one.path, one.kind, one.about, one.measures, words, one.is_list)


def _fields(table: str, owner: type[BaseModel]) -> Iterator[Field]:
    for name, info in owner.model_fields.items():
        about = next((m for m in info.metadata if isinstance(m, About)), None)
        if about is not None:
            hint = Annotated[info.annotation, *info.metadata]
            yield _field(f"{table}.{name}", hint, about)


def _field(path: str, hint: Any, about: About) -> Field:
    leaves, marks, is_list = [], [], False
    left = [hint]
    while left:
        hint = left.pop()
        origin = get_origin(hint)
        if origin is Annotated:
            marks += [m.dimension for m in hint.__metadata__ if isinstance(m, Measures)]
            left.append(get_args(hint)[0])
        elif origin in (Union, UnionType, list):
            is_list = is_list or origin is list
            left += [a for a in get_args(hint) if a is not NoneType]
        elif origin is Literal:
            leaves.append(("word", get_args(hint)))
        else:
            leaves.append(({bool: "truth", float: "number", str: "text"}[hint], ()))
    if marks:
        return Field(path, "quantity", about, marks[0], is_list=is_list)
    kinds = [kind for kind, _ in leaves]
    words = tuple(w for _, choices in leaves for w in choices)
    kind = "word" if words else kinds[0]
    return Field(path, kind, about, choices=words, is_list=is_list)  # type: ignore[arg-type]
