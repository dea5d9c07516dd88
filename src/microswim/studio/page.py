"""The built page: its files, and the page with its data inside.

The sources of the page are in ``studio/`` of the repository; what is in ``static`` is built.
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

from microswim.errors import MicroswimError, SpecError
from microswim.studio import answers, maps
from microswim.studio.spec_tables import swimmer_of
from microswim.studio.words import words

STATIC = files(__name__.rpartition(".")[0]) / "static"
MOST_DESIGNS = 2
KEPT = ("camera", "view", "pace", "arrows")  #: of the view of who took the snapshot


def text(name: str) -> str:
    """Return the text of one of the built files.

    Raises
    ------
    MicroswimError
        If the page was not built.
    """
    try:
        return (STATIC / name).read_text(encoding="utf-8")
    except FileNotFoundError:
        raise MicroswimError("the studio's page is not built; run `make studio`") from None


def snapshot(designs: Any, ask: Any = None, view: Any = None) -> str:
    """Return one HTML file that plays without a server: the page, its designs and their answers
    inside.

    Parameters
    ----------
    designs
        One or two of ``{"name": ..., "tables": ...}``; they are solved again here.
    ask
        Axes of the map to take along, ``{"x": ..., "y": ...}``, as the page asks for it.
    view
        Camera and pace, plain numbers and words.

    Raises
    ------
    SpecError
        If a design is wrong.
    """
    if not isinstance(designs, list) or not 1 <= len(designs) <= MOST_DESIGNS:
        raise SpecError("designs: give one or two")
    solved = []
    for design in designs:
        name = str(design.get("name", "design"))[:80]
        solved.append({"name": name, "answer": answers.solve(design.get("tables"), name)})
    data: dict[str, Any] = {"designs": solved, "view": _view(view), "words": words()}
    if isinstance(ask, dict) and ask:
        made = maps.map_(designs[0].get("tables"), ask.get("x"), ask.get("y"), ask.get("output"))
        data["map"] = {"ask": {k: ask[k] for k in ("x", "y", "output") if k in ask}, **made}
    return inlined(data)


def usual_map(tables: Any) -> dict[str, Any]:
    """Return axes of a map about a design: its amplitude and its waves or wavelength, or what it
    has in their place; nothing where it has no two such numbers.
    """
    numbers = swimmer_of(tables).numbers
    x, y = ([n for n in maps.AXES if numbers.get(n) is not None] + ["", ""])[:2]
    if not y:
        return {}
    side = {"field": x, "from": numbers[x] / 20 or 1e-9, "to": 2 * numbers[x] or 1e-6, "count": 24}
    n = numbers[y]
    top = min(2.5 * n, 20.0) if y == "tail.waves" else 2.5 * n
    up = {"field": y, "from": min(n / 3, top / 2), "to": top, "count": 18}
    return {"x": side, "y": up, "output": "swimming_speed"}


def _view(view: Any) -> dict[str, Any]:
    given = view if isinstance(view, dict) else {}
    plain = {k: given[k] for k in KEPT if k in given}
    if len(json.dumps(plain)) > 2000:
        raise SpecError("view: too long")
    return plain


def inlined(data: dict[str, Any]) -> str:
    """Return the page with script, style and data inside; nothing is fetched."""
    html = text("index.html")
    script = text("studio.js").replace("</script", "<\\/script").replace("<!--", "<\\!--")
    facts = json.dumps(data, allow_nan=False).replace("<", "\\u003c")
    style = f"<style>{text('studio.css')}</style>"
    inside = f'<script type="application/json" id="snapshot">{facts}</script>'
    lines = [line for line in html.splitlines() if "studio.css" not in line]
    lines = [line for line in lines if "studio.js" not in line and 'rel="icon"' not in line]
    html = "\n".join(lines)
    html = html.replace("</head>", style + "\n</head>", 1)
    return html.replace("</body>", f'{inside}\n<script type="module">{script}</script>\n</body>', 1)
