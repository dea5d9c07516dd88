"""The page docs/performance.md and its plot, from what the benchmarks left in results/.

    python benchmarks/report.py

Reads benchmarks/results/*.json, whichever are there, and keeps the numbers in
docs/performance.json, so that a machine that has run only some of the benchmarks renews only their
tables. Numbers and records become tables; lists of sizes and seconds are drawn on log-log axes. The
README's tables are filled too.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import readme
from aims import aims
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

HERE = Path(__file__).parent
DOCS = HERE.parent / "docs"
KEPT = DOCS / "performance.json"
GREY = "#808080"  # on light and on dark pages
STYLES = (("#0072B2", "o-"), ("#D55E00", "s--"), ("#009E73", "^-."), ("#CC79A7", "v:"))
STYLES += (("#E69F00", "D-"), ("#56B4E9", "P--"))
TITLES = {
    "surrogate": "The surrogate",
    "startup": "Start-up",
    "region": "Calibrated over a region, and the atlas (microseconds)",
    "bem": "Boundary elements",
    "fem": "Finite elements",
    "growth": "How the cost grows",
    "sweep": "Sweeps",
    "studio": "The studio's server",
    "control": "Control",
}
LEFT_OUT = {"accuracy"}  # has a page of its own
HEADERS = {
    ("bem", "peers", "rows"): (
        *("method", "unknowns", "seconds"),
        *("error of u_s (%)", "error of Omega_s (%)"),
    ),
    ("bem", "others", "rows"): ("method", "unknowns", "seconds", "largest error in R (%)"),
    ("bem", "peers", "time to per cent"): ("to (%)", "ours (s)", "theirs (s)", "ratio", "how"),
}
INTRO = """# Performance

Made by `python benchmarks/report.py` from the results of `make bench`; do not edit. Processor
seconds on one core unless it says by the clock, the least of several runs, measured on a shared
two-core machine, so that ratios mean more than seconds. Each part names its processor. The cost of
the reference solvers in full: [boundary elements](accuracy-bem.md),
[finite elements](accuracy-fem.md).
"""
CAPTION = """<figure markdown>
![Seconds against size, log-log](assets/performance.svg)
<figcaption>Seconds against the size of the problem, both axes logarithmic; the exponent of a fitted
power stands behind each name. At exponent one, twice the work takes twice the time. Left: the
surrogate. Right: boundary elements, where the factorisation, which tends to exponent three, takes
over above some three thousand unknowns.</figcaption>
</figure>
"""


def plain(value: Any) -> bool:
    return value is None or isinstance(value, (int, float, str, bool))


def shown(value: Any) -> str:
    """A number with three digits."""
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no"}.get(value, "")
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float) and 1000 <= abs(value) < 1e6:
        return f"{value:,.0f}"
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def table(header: Any, rows: list[Any]) -> str:
    lines = [header, ["---"] * len(header), *([shown(v) for v in row] for row in rows)]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines) + "\n"


def of_records(records: list[dict[str, Any]]) -> str:
    """Records of equal kind; what is not a plain number or word in all of them is left out."""
    names = [k for k in records[0] if all(plain(r.get(k)) for r in records)]
    return table(names, [[r.get(k) for k in names] for r in records[:20]]) if names else ""


def tables(data: Any, path: tuple[str, ...]) -> list[str]:
    """Markdown of whatever a benchmark has written."""
    header = HEADERS.get(path)
    if isinstance(data, list):
        if header and all(isinstance(r, list) for r in data):
            return [table(header, data)]
        records = data and all(isinstance(r, dict) for r in data)
        return [text] if records and (text := of_records(data)) else []
    if header:
        return [table(header, [[key, *row] for key, row in data.items()])]
    grown = {k: v for k, v in data.items() if isinstance(v, dict) and {"x", "seconds"} <= set(v)}
    if grown:
        rows = [
            [k, v["x"][0], v["x"][-1], v["seconds"][0], v["seconds"][-1], v.get("exponent")]
            for k, v in grown.items()
        ]
        return [table(("what", "from", "to", "seconds", "seconds", "exponent"), rows)]
    own = [(k, v) for k, v in data.items() if plain(v)]
    inner = {k: v for k, v in data.items() if not plain(v)}
    out = [table(("what", ""), own)] if own else []
    flat = {k: v for k, v in inner.items() if isinstance(v, dict) and all(map(plain, v.values()))}
    if len(flat) > 1 and len({tuple(v) for v in flat.values()}) == 1:
        names = list(next(iter(flat.values())))
        out.append(table(("", *names), [[k, *v.values()] for k, v in flat.items()]))
        inner = {k: v for k, v in inner.items() if k not in flat}
    for key, value in inner.items():
        if part := tables(value, (*path, key)):
            out += part if key == "rows" else [f"**{key.replace('_', ' ')}**\n", *part]
    return out


def curves(data: Any, name: str = "") -> dict[str, tuple[list[float], list[float], str]]:
    """Lists of sizes and seconds: name to (sizes, seconds, what the size is)."""
    if isinstance(data, dict) and isinstance(data.get("x"), list) and "seconds" in data:
        slope = f", {data['exponent']:.2f}" if "exponent" in data else ""
        return {f"{name}{slope}": (data["x"], data["seconds"], "count")}
    if isinstance(data, dict) and isinstance(data.get("rows"), list) and "exponents" in data:
        found = {}
        for part, slope in data["exponents"].items():
            sizes = [r["unknowns"] for r in data["rows"]]
            found[f"{part}, {slope:.2f}"] = (sizes, [r[part] for r in data["rows"]], "unknowns")
        return found
    found = {}
    for key, value in data.items() if isinstance(data, dict) else ():
        found |= curves(value, key)
    return found


def plot(lines: dict[str, Any], path: Path) -> None:
    """Log-log, in colours that serve on light and dark pages; one panel for each kind of size."""
    kinds = sorted({kind for *_, kind in lines.values()})
    figure = Figure(figsize=(3.6 * len(kinds), 4.2), layout="constrained")
    for axes, kind in zip(figure.subplots(1, len(kinds), squeeze=False)[0], kinds):
        chosen = {k: v for k, v in lines.items() if v[2] == kind}
        for (name, (x, y, _)), (colour, style) in zip(chosen.items(), STYLES):
            axes.loglog(x, y, style, color=colour, ms=4, lw=1.2, label=name)
        label = "unknowns" if kind == "unknowns" else "nodes, phases, designs, workers"
        axes.set_xlabel(label, color=GREY)
        axes.xaxis.set_minor_formatter(NullFormatter())  # names of 2, 3, 4 would meet
        axes.set_ylabel("processor seconds", color=GREY)
        axes.tick_params(which="both", colors=GREY, labelsize=7)
        axes.spines[:].set_color(GREY)
        legend = {"fontsize": 7, "labelcolor": GREY, "frameon": False}
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), **legend)
    with rc_context({"svg.hashsalt": "microswim"}):  # the same picture is the same file
        figure.savefig(path, transparent=True, metadata={"Date": None})


def part(name: str, data: dict[str, Any]) -> list[str]:
    """A part of the page: heading, processor, tables."""
    rest = {k: v for k, v in data.items() if k != "processor"}
    on = f"On: {data['processor']}.\n" if "processor" in data else "On: Intel Xeon, AVX-512.\n"
    return [f"## {TITLES.get(name, name.capitalize())}\n", on, *tables(rest, (name,))]


def main() -> None:
    kept = json.loads(KEPT.read_text(encoding="utf-8")) if KEPT.exists() else {}
    for path in sorted((HERE / "results").glob("*.json")):
        kept[path.stem] = json.loads(path.read_text(encoding="utf-8"))
    kept = {k: v for k, v in kept.items() if k not in LEFT_OUT}
    kept.get("bem", {}).pop("designs", None)  # hundreds of rows; the page on accuracy has them
    KEPT.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    page = [INTRO, "## Aims and limits\n", table(("what", "aim", "reached", "limit"), aims(kept))]
    lines = curves(kept)
    if lines:
        plot(lines, DOCS / "assets" / "performance.svg")
        page.append(CAPTION)
    for name in sorted(kept, key=lambda n: (list(TITLES).index(n) if n in TITLES else 99, n)):
        page += part(name, kept[name])
    (DOCS / "performance.md").write_text("\n".join(page), encoding="utf-8")
    readme.main()


if __name__ == "__main__":
    main()
