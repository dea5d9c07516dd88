"""The one builder of HTML pages: a document that stands alone, and a table in it."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def document(title: str, style: str, parts: Iterable[str]) -> str:
    """Return a whole page; its style stands inside, nothing is loaded.

    Parameters
    ----------
    title
        Of the window, as plain text.
    style
        CSS.
    parts
        HTML of the body, one after the other.

    Examples
    --------
    >>> from microswim.output.report.document import document
    >>> document("A helix", "p{}", ["<p>swims</p>"]).splitlines()[0]
    '<!doctype html>'
    """
    head = [
        "<!doctype html>",
        f'<html lang="en"><head><meta charset="utf-8"><title>{escape(title)}</title>',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<style>{style}</style></head><body>",
    ]
    return "\n".join([*head, *parts, "</body></html>\n"])


def table(header: Iterable[str], rows: Iterable[str]) -> str:
    """Return a table that scrolls sideways where the window is narrow.

    Parameters
    ----------
    header
        Names of the columns, as HTML; no head if all are empty.
    rows
        Rows, as HTML from ``<tr>`` on.
    """
    names = list(header)
    head = "".join(f'<th scope="col">{name}</th>' for name in names)
    head = f"<thead><tr>{head}</tr></thead>" if any(names) else ""
    return f'<div class="wide"><table>{head}<tbody>{"".join(rows)}</tbody></table></div>'
