"""The two tables of the README, from what was measured: docs/performance.json and pages of docs/.

    python benchmarks/readme.py

Called by report.py and accuracy.py; a test holds the README to what this module would write.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import microswim as ms

ROOT = Path(__file__).parents[1]
README, DOCS = ROOT / "README.md", ROOT / "docs"
HEADS = ("| what | against | error |", "| what | time | against |")


def _page(name):
    return (DOCS / name).read_text(encoding="utf-8")


def rows(page, *starts, skip=0):
    """Cells of the first row of a page's tables that starts with these cells, or of a later one."""
    for line in _page(page).splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        if tuple(cells[: len(starts)]) == starts:
            if not skip:
                return cells
            skip -= 1
    raise SystemExit(f"{page} has no row {starts}")


def digits(value, n=2):
    """A number with so many digits, and no exponent."""
    value = float(f"{float(value):.{n}g}")
    return f"{value:.0f}" if abs(value) >= 10 ** (n - 1) else f"{value:.{n}g}"


def spread(row, median, worst):
    return f"{digits(row[median])} % median, {digits(row[worst])} % worst"


def accurate():
    """How accurate: base case, one design, a region."""
    known = [rows("accuracy-bem.md", name) for name in ("u_s, six degrees of freedom", "Omega_s")]
    off = [max(abs(100 * (float(r[3]) / float(r[1]) - 1)), 0.01) for r in known]
    speed, turning = (rows("accuracy-atlas.md", name) for name in ("u_s", "Omega_s"))
    beat, turned, alone = (rows("accuracy-atlas.md", "u_s", skip=n) for n in (4, 7, 8))
    counts = re.findall(
        r"(\d+)\s+designs\s+(?:that\s+were\s+)?drawn\s+afterwards", _page("accuracy-atlas.md")
    )
    plain = ms.Swimmer.preset("tabak/helix").gait().mean_velocity[0] / float(known[0][1])
    one = rows("accuracy.md", "Lighthill, with spin", "loads too", "grid")
    tube = rows("accuracy-fem.md", "largest difference")
    forward, rate = (rows("accuracy.md", "helix", f"mean.{q}", "all (60)") for q in ("us", "os"))
    return [
        (
            "as it comes, helical tails (`--model auto`: the atlas)",
            f"boundary elements, {counts[0]} designs drawn afterwards over its range",
            f"u_s {speed[1]} median, {speed[4]} at 99 %; body rate {turning[1]}, {turning[4]}; "
            "[where](docs/accuracy-atlas.md)",
        ),
        (
            "as it comes, plane waves (the same)",
            f"boundary elements, {counts[1]} designs drawn afterwards over its range",
            f"u_s {beat[1]} median, {beat[4]} at 99 %; each answer states its own error, which "
            f"{beat[6]} of them hold",
        ),
        (
            "as it comes, helices without a body, turned by a field (the same)",
            f"boundary elements, {counts[2]} designs drawn afterwards",
            f"u_s {turned[1]} median, {turned[4]} at 99 %",
        ),
        (
            "as it comes, plane waves without a body (the same)",
            f"boundary elements, {counts[3]} designs drawn afterwards",
            f"u_s {alone[1]} median, {alone[4]} at 99 %",
        ),
        (
            "plain resistive force theory (Lighthill's coefficients), base case",
            "reference",
            f"a factor {digits(plain)} in u_s",
        ),
        (
            "surrogate calibrated at one design, amplitude and waves varied",
            "reference",
            f"u_s {spread(one, 4, 5)}",
        ),
        (
            "surrogate calibrated over a region, 100 solves",
            "60 designs drawn afterwards",
            f"u_s {spread(forward, 3, 5)}; body rate {spread(rate, 3, 5)}",
        ),
        (
            "boundary elements, base case",
            "another boundary-element code, written apart",
            f"{digits(off[0], 1)} % (u_s), {digits(off[1], 1)} % (body rate)",
        ),
        (
            "the same in a tube of ten diameters",
            "finite elements, ours",
            f"{tube[1]} (u_s), {tube[2]} (body rate)",
        ),
    ]


def fast():
    """How fast: the surrogate, the reference, the wait at the start."""
    kept = json.loads((DOCS / "performance.json").read_text(encoding="utf-8"))
    surrogate, start = kept["surrogate"], kept["startup"]["processor seconds"]
    solve = kept["bem"]["peers"]["time to per cent"]["0.5"]
    each = "microseconds per design, 32 nodes"
    narrow = surrogate["AVX2 alone"][each]["microswim"]
    ever = start["first ever microswim run, helix"]["seconds"]
    numpy = digits(start["import numpy, scipy.linalg"]["seconds"], 1)
    return [
        (
            "surrogate, one design in a batch",
            f"{digits(surrogate[each]['microswim'])} us; {digits(narrow)} us with AVX2 alone",
            f"{digits(surrogate['NumPy over microswim'])} x plain NumPy, "
            f"{digits(surrogate['C over microswim'], 3)} x hand-written C with vector lanes",
        ),
        (
            "surrogate, one gait from Python",
            f"{digits(surrogate['microseconds per gait from Python'])} us",
            f"with its mean velocity {digits(surrogate['microseconds with mean velocity'], 3)} us, "
            f"with all of a summary {digits(surrogate['milliseconds with summary'], 1)} ms",
        ),
        (
            "surrogate, map of 200 x 200 designs",
            f"{digits(surrogate['seconds per 200 x 200 map'], 1)} s",
            "",
        ),
        (
            "boundary elements, one helical design to 0.5 %",
            f"{digits(solve[0], 1)} s",
            f"{digits(solve[2])} x regularised Stokeslets; the paper: up to 20 hours a design",
        ),
        (
            "`import microswim`; `microswim run`, also the first time ever",
            f"{digits(start['import microswim']['seconds'], 1)} s; {digits(ever, 1)} s",
            f"import of NumPy and SciPy: {numpy} s",
        ),
    ]


def filled(text):
    """The README with its tables as measured."""
    for head, body in zip(HEADS, (accurate(), fast())):
        lines = "".join(f"| {' | '.join(row)} |\n".replace("|  |", "| |") for row in body)
        text = re.sub(rf"{re.escape(head)}\n(\|[-|]+\|\n)(\|.*\|\n)+", rf"{head}\n\1{lines}", text)
    return text


def main():
    README.write_text(filled(README.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main()
