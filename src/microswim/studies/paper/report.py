"""One self-contained page: every table, figure and claim beside our numbers, no network.

Figures are inlined as SVG and saved beside the page as SVG and PDF.
"""

from __future__ import annotations

import html
import io
import json
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from microswim import __version__
from microswim.numerics.files import fresh, write
from microswim.output.plots.style import look
from microswim.output.report.document import document
from microswim.output.report.document import table as document_table
from microswim.studies.paper import ITEMS, item
from microswim.studies.paper.claims import Judgement, judge_all, load, shown
from microswim.studies.paper.context import Context

_COLOURS = {
    "agrees under reading": "under",
    "agrees": "yes",
    "sign agrees": "yes",
    "differs, because": "no",
}
_STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:62rem;margin:2rem auto;
  padding:0 1rem;color:#1a1a1a}
h1{font-size:1.6rem}h2{margin-top:2.5rem;font-size:1.2rem;border-bottom:1px solid #ccc}
table{border-collapse:collapse;font-size:.82rem;margin:1rem 0;width:100%}
th,td{padding:.25rem .5rem;text-align:left;vertical-align:top;border-bottom:1px solid #e3e3e3}
th{background:#f5f5f5;position:sticky;top:0}td.n{text-align:right;font-variant-numeric:tabular-nums}
svg{max-width:100%;height:auto}.yes{color:#00694d}.under{color:#0072B2}.no{color:#b34700}
.open{color:#6e6e6e}
.count{display:inline-block;margin-right:1.5rem}.count b{font-size:1.4rem}.wide{overflow-x:auto}
@media print{body{max-width:none}th{position:static}}
"""


def reproduce(
    out: Path,
    *,
    only: Iterable[str] = (),
    quick: bool = False,
    progress: Callable[[str], None] | None = None,
) -> dict[str, Any]:
    """Reproduce the paper, or some of its tables and figures, into a folder.

    Parameters
    ----------
    out
        Folder for ``report.html``, ``claims.json`` and the figures; finished reference solutions
        are kept in its ``solutions``, so that an interrupted run resumes.
    only
        Names out of `microswim.studies.paper.ITEMS`; all by default.
    quick
        Coarse reference solutions, and fewer of them.
    progress
        Called with a line on what is being done.

    Returns
    -------
    dict
        ``report`` (path), ``verdicts`` (counts), ``broken`` (claims whose verdict no longer
        matches the numbers), ``claims`` (one dict each).

    Raises
    ------
    SpecError
        If `only` names what the paper does not have.
    """
    names = tuple(only) or ITEMS
    modules = {name: item(name) for name in names}
    say = progress or (lambda line: None)
    context = Context(quick=quick, store=out / "solutions", progress=say)
    out.mkdir(parents=True, exist_ok=True)
    sections = []
    for name, module in modules.items():
        say(module.TITLE)
        result = module.compute(context)
        sections.append(_section(module, result, _save(module.plot(result), out / name)))
    say("Claims")
    chosen = [c for c in load() if len(names) == len(ITEMS) or c.item in names]
    judged = judge_all(context, chosen)
    page = out / "report.html"
    write(page, _page(judged, sections, context))
    listed = [as_dict(j) for j in judged]
    write(out / "claims.json", json.dumps(listed, indent=1))
    broken = [j.claim.id for j in judged if not j.holds]
    return {"report": str(page), "verdicts": counts(judged), "broken": broken, "claims": listed}


def as_dict(judgement: Judgement) -> dict[str, Any]:
    """Return a judged claim as plain numbers and text."""
    claim = judgement.claim
    mine = None if judgement.ours is None else np.asarray(judgement.ours, float).tolist()
    return {
        "id": claim.id, "where": claim.where, "says": claim.says, "paper": claim.value,
        "unit": claim.unit, "tolerance": claim.tolerance, "reason": claim.reason, "ours": mine,
        "side": claim.side or None,
        "verdict": judgement.sentence, "kind": judgement.kind, "holds": judgement.holds,
    }  # fmt: skip


def counts(judged: Iterable[Judgement]) -> dict[str, int]:
    """Return how many claims have which verdict."""
    out: dict[str, int] = {}
    for j in judged:
        key = j.kind.removesuffix(", because")
        out[key] = out.get(key, 0) + 1
    return out


def _save(figure: Any, path: Path) -> str:
    """Save a figure as SVG and PDF; return the SVG for inlining, with ids of its own."""
    text = io.StringIO()
    with look():
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None}, dpi=200)
        with fresh(path.with_suffix(".pdf")) as part:
            figure.savefig(part, metadata={"CreationDate": None})
    svg = text.getvalue()
    write(path.with_suffix(".svg"), svg)
    svg = svg[svg.index("<svg") :]
    prefix = path.stem
    svg = re.sub(r'id="([^"]+)"', rf'id="{prefix}-\1"', svg)
    svg = re.sub(r"url\(#([^)]+)\)", rf"url(#{prefix}-\1)", svg)
    return re.sub(r'href="#([^"]+)"', rf'href="#{prefix}-\1"', svg)


def _section(module: Any, result: dict[str, Any], svg: str) -> str:
    about = html.escape(module.CAPTION)
    tables = "".join(table(result[key]) for key in ("rows", "more", "readings") if result.get(key))
    return f"<h2>{html.escape(module.TITLE)}</h2>\n<p>{about}</p>\n{svg}\n{tables}\n"


def table(rows: list[dict[str, Any]]) -> str:
    """Return rows as an HTML table; entries that are arrays are left out."""
    names = [k for k, v in rows[0].items() if not isinstance(v, np.ndarray)]
    body = (f"<tr>{''.join(_cell(row[name]) for name in names)}</tr>\n" for row in rows)
    return document_table([html.escape(name) for name in names], body)


def _cell(value: Any) -> str:
    if isinstance(value, (float, np.floating)):
        return f'<td class="n">{"–" if np.isnan(value) else f"{value:.4g}"}</td>'
    return f"<td>{html.escape(str(value))}</td>"


def _page(judged: list[Judgement], sections: list[str], context: Context) -> str:
    number = counts(judged)
    summary = "".join(
        f'<span class="count"><b>{n}</b> {html.escape(kind)}</span>' for kind, n in number.items()
    )
    broken = [j.claim.id for j in judged if not j.holds]
    alarm = ""
    if broken:
        alarm = (
            f'<p class="no"><b>Verdicts that do not match the numbers:</b> {", ".join(broken)}</p>'
        )
    header = ("where", "statement", "paper", "ours", "verdict")
    lead = f"""<h1>The paper, reproduced</h1>
<p>Every table, every figure and every number of Tabak &amp; Yesilyurt, <i>Hydrodynamic Surrogate
Models for Bio-Inspired Micro-Swimming Robots</i>, beside ours. Circles are our boundary-element
solutions (level {context.level}) in place of the paper's CFD. microswim {__version__}.</p>
<p>{summary}</p>{alarm}
<h2>Claims</h2>"""
    claims = document_table(header, (_row(j) for j in judged))
    return document("The paper, reproduced", _STYLE, [lead, claims, *sections])


def _row(judgement: Judgement) -> str:
    claim = judgement.claim
    colour = _COLOURS.get(judgement.kind, "open")
    allowed = claim.side or f"±{shown(claim.tolerance)}"
    tolerance = f"allowed: {allowed} ({claim.reason})"
    paper = f"{claim.side} {shown(claim.value)}<br>{html.escape(claim.unit)}"
    cells = [
        f"<td>{html.escape(claim.where)}</td>",
        f"<td>{html.escape(claim.says)}</td>",
        f'<td class="n" title="{html.escape(tolerance)}">{paper}</td>',
        f'<td class="n">{shown(judgement.ours)}</td>',
        f'<td class="{colour}">{html.escape(judgement.sentence)}</td>',
    ]
    return f'<tr id="{html.escape(claim.id)}">{"".join(cells)}</tr>\n'
