"""The paper, reproduced: one module per table and figure, and the claims it makes.

Every module holds ``compute(context)``, which returns a dict of arrays, ``plot(result)``, which
draws it with the paper's axes, and its ``TITLE`` and ``CAPTION``. `claims` judges each statement of
the paper by ``claims.toml``, `report` writes one self-contained page. The paper is Tabak &
Yesilyurt, "Hydrodynamic Surrogate Models for Bio-Inspired Micro-Swimming Robots".
"""

from __future__ import annotations

from types import ModuleType

ITEMS = (
    "table1",
    "table2",
    "fig2",
    "fig3",
    "table3",
    "fig4",
    "fig5",
    "table4",
    "fig6",
    "fig7",
)
"""Tables and figures in the order of the paper."""


def item(name: str) -> ModuleType:
    """Return the module of a table or figure.

    Raises
    ------
    SpecError
        If the paper has none of that name.
    """
    from importlib import import_module

    from microswim.errors import SpecError

    if name not in ITEMS:
        raise SpecError("only", name, "one of " + ", ".join(ITEMS))
    return import_module(f".{name}", __name__)
