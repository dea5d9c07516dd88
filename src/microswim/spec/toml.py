"""Spec tables as the text of a file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from microswim.numerics.plain import plain


def to_toml(tables: Mapping[str, Any], comment: str) -> str:
    """Return the text of a spec file, a line of comment first.

    Parameters
    ----------
    tables
        Tables of numbers, words and lists; what is None is left out.
    comment
        What it is and where it comes from.

    Examples
    --------
    >>> print(to_toml({"tail": {"radius": 0.05}}, "a tail"), end="")
    # a tail
    <BLANKLINE>
    [tail]
    radius = 0.05
    """
    import tomli_w  # nobody waits for it who only reads

    words = " ".join("".join(c if c.isprintable() else " " for c in comment).split())
    text = tomli_w.dumps(plain(tables, nan=True, none=False), indent=0)
    for many, one in (("[\n", "["), (",\n]", "]"), (",\n", ", ")):  # a list stays on its line
        text = text.replace(many, one)
    return f"# {words}\n\n{text}"
