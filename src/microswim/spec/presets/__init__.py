"""Spec files that come with the package: base cases of the paper, measured cells, several tails.

A preset is a spec file like any other, and the best way to learn the format.
"""

from __future__ import annotations

from importlib.resources import files

from microswim.errors import SpecError

__all__ = ["names", "read"]

_HERE = files(__name__)


def names(*, one_tail: bool = False) -> list[str]:
    """Return names of all presets, ``"family/member"``, in alphabetical order.

    Parameters
    ----------
    one_tail
        Only those that have one tail.

    Examples
    --------
    >>> from microswim.spec import presets
    >>> "tabak/helix" in presets.names()
    True
    """
    families = [f for f in _HERE.iterdir() if f.is_dir()]
    files_ = [(family.name, f.name) for family in families for f in family.iterdir()]
    found = sorted(f"{family}/{f[:-5]}" for family, f in files_ if f.endswith(".toml"))
    return [name for name in found if not (one_tail and "[[tail]]" in _text(name))]


def read(name: str) -> str:
    """Return the text of a preset, comments included.

    Parameters
    ----------
    name
        One of `names()`.

    Raises
    ------
    SpecError
        If there is no preset of that name.
    """
    if name not in names():
        raise SpecError("preset", name, "one of " + ", ".join(names()))
    return _text(name)


def _text(name: str) -> str:
    return (_HERE / f"{name}.toml").read_text(encoding="utf-8")
