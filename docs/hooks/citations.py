"""Links from ``[Tabak Eq. 14]`` to Theory, from ``[Lighthill 1976]`` to the bibliography.

Works in pages and in docstrings alike; what leads nowhere is a warning, and ends a strict build.
The built site asks no other host for anything: that is checked last.
"""

import html
import logging
import re
from pathlib import Path

from mkdocs.utils import get_relative_url

log = logging.getLogger("mkdocs.hooks.citations")
DOCS = Path(__file__).parents[1]
TAG = re.compile(r"\[Tabak (Eqs?\.[^\]<]*)\]")
NUMBERS = re.compile(r"\d+(?:\s*(?:-|–|to)\s*\d+)?")
NAME = r"[A-Z][^\W\d_]+"
WORK = re.compile(
    rf"\[({NAME}(?:-{NAME}|[ ,]|&amp;|&|and|et al\.|{NAME})* (?:18|19|20)\d\d[a-z]?)(?=[\],])"
)
ASKS = r"<(?:script|link|img|iframe|source)\b[^>]*"
OUTSIDE = re.compile(ASKS + r"\b(?:src|href)=\"?(?:https?:)?//[^\">]*")


def anchors(page, pattern):
    return set(re.findall(pattern, (DOCS / page).read_text(encoding="utf-8")))


def slug(work):
    """``Gray & Hancock 1955`` -> ``gray-hancock-1955``."""
    words = re.findall(r"[^\W_]+", html.unescape(work).replace("et al.", ""))
    return "-".join(w.lower() for w in words if w != "and")


def on_page_content(text, page, config, files):
    equations = anchors("theory.md", r"\\tag\{([\w-]+)\}")
    works = anchors("bibliography.md", r"\{ *#([\w-]+) *\}")
    theory = get_relative_url("theory.html", page.url)
    bibliography = get_relative_url("bibliography.html", page.url)

    def number(match):
        first, *last = re.findall(r"\d+", match[0])
        for n in (first, *last):
            if n not in equations:
                log.warning("%s: no equation (%s) in theory.md", page.file.src_uri, n)
        return f'<a href="{theory}#eq-{first}">{match[0]}</a>'

    def tag(match):
        body = match[1]
        numbers, section, rest = body.partition(", Section")
        numbers, by, more = numbers.partition(", by")
        return f"[Tabak {NUMBERS.sub(number, numbers)}{by}{more}{section}{rest}]"

    def work(match):
        name = slug(match[1])
        if name not in works:
            log.warning("%s: [%s] is not in bibliography.md", page.file.src_uri, match[1])
        return f'[<a href="{bibliography}#{name}">{match[1]}</a>'

    def bare(match):
        known = match[1] in equations  # the text of the paper has no (23)
        return f'(<a href="{theory}#eq-{match[1]}">{match[1]}</a>)' if known else match[0]

    if page.file.src_uri == "notation.md":  # its columns name the equations of the paper
        text = re.sub(r"\((\d+)\)", bare, text)
    return WORK.sub(work, TAG.sub(tag, text))


def on_post_build(config):
    for path in Path(config.site_dir).rglob("*.html"):
        for hit in OUTSIDE.findall(path.read_text(encoding="utf-8")):
            if 'rel="canonical"' not in hit:
                log.warning("%s asks another host: %s", path.name, hit)
