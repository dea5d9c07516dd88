"""The site: what is cited exists, public names and pages are there, code on pages runs.

The site itself is built by ``make docs``, strictly; here is what needs no extra.
"""

import ast
import importlib
import inspect
import re
import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import microswim as ms

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAPER = set(range(1, 29)) - {23}  # equations of the paper; its text has no (23)
CODE = [p for folder in ("src", "examples") for p in sorted((ROOT / folder).rglob("*.py"))]
PAGES = sorted(p for p in DOCS.rglob("*.md") if p.name != "gallery.md")
BLOCK = re.compile(r"(<!-- slow -->\n)?```python\n(.*?)```", re.DOTALL)
WITH_CODE = [p for p in PAGES if p.parent.name == "tutorials" or p.stem in ("start", "howto")]


@cache
def flat(path):
    """Text of a file with its line breaks as spaces."""
    return " ".join(path.read_text(encoding="utf-8").split())


@cache
def equations():
    """Numbers of the equations in Theory, which are anchors there."""
    return re.findall(r"\\tag\{(\w+)\}", (DOCS / "theory.md").read_text(encoding="utf-8"))


def cited(text):
    """Numbers in tags such as ``[Tabak Eqs. 9, 25-28, Section 3.2.1]``."""
    numbers = set()
    for body in re.findall(r"\[Tabak Eqs?\.([^\]]*)\]", text):
        for first, last in re.findall(r"(\d+)(?:\s*-\s*(\d+))?", body.split("Section")[0]):
            numbers |= set(range(int(first), int(last or first) + 1))
    return numbers


def test_theory_has_every_equation_of_the_paper_once():
    numbers = [int(n) for n in equations() if n.isdigit()]
    assert sorted(numbers) == sorted(PAPER)
    assert len(set(equations())) == len(equations())


def test_tags_are_read():
    assert cited("[Tabak Eqs. 9, 25-28, Section 3.2.1] and [Tabak Eq. 14]") == {
        9,
        14,
        25,
        26,
        27,
        28,
    }


@pytest.mark.parametrize("folder", ["src", "docs", "examples", "tests", "benchmarks"])
def test_every_equation_tag_resolves_to_an_anchor(folder):
    files = [p for kind in ("*.py", "*.md") for p in (ROOT / folder).rglob(kind)]
    files = [p for p in files if p.name != "test_docs.py"]
    lost = {p.name: cited(flat(p)) - PAPER for p in files if cited(flat(p)) - PAPER}
    assert lost == {}
    if folder == "src":
        named = set().union(*(cited(flat(p)) for p in files))
        assert {4, 5, 7, 8, 12, 14, 15, 16, 17, 18, 19, 20, 21, 22, 24} <= named


def slug(work):
    words = re.findall(r"[^\W_]+", work.replace("et al.", ""))
    return "-".join(w.lower() for w in words if w != "and")


def test_every_cited_work_is_in_the_bibliography():
    works = re.findall(r"\{ *#([\w-]+) *\}", (DOCS / "bibliography.md").read_text(encoding="utf-8"))
    assert len(works) == len(set(works))
    name = r"[A-Z][^\W\d_]+"
    tag = re.compile(rf"\[({name}(?:-{name}|[ ,&]|and|et al\.|{name})* (?:18|19|20)\d\d)[\],]")
    files = CODE + PAGES
    lost = {(p.name, w) for p in files for w in tag.findall(flat(p)) if slug(w) not in works}
    assert lost == set()


def test_every_page_is_in_the_navigation():
    site = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    listed = set(re.findall(r"([\w./-]+\.md)\s*$", site.split("\nnav:")[1], re.MULTILINE))
    there = {str(p.relative_to(DOCS)) for p in PAGES}
    assert there | {"gallery/index.md"} == listed


@pytest.mark.parametrize("name", sorted(ms.__all__))
def test_every_public_name_has_an_example(name):
    thing = getattr(ms, name)
    if name == "path":  # a package that is called: docs/decisions/0018-path-is-called.md
        thing = importlib.import_module("microswim.path.following").path
    things = [thing]
    if inspect.ismodule(thing):  # its own functions and classes are the names
        members = [getattr(thing, name) for name in dir(thing) if name[0] != "_"]
        things = [x for x in members if getattr(x, "__module__", "").startswith(thing.__name__)]
        assert things
    without = [x.__name__ for x in things if "Examples\n---" not in (inspect.getdoc(x) or "")]
    assert without == []


def test_the_twelve_lines_of_the_readme_run():
    code = BLOCK.findall((ROOT / "README.md").read_text(encoding="utf-8"))[0][1]
    assert len([line for line in code.splitlines() if line.strip()]) <= 13
    names = {}
    exec(compile(code, "README.md", "exec"), names)
    assert names["gait"].mean_velocity[0] < 0


def test_the_tables_of_the_readme_are_what_was_measured(monkeypatch):
    """If not: python benchmarks/readme.py."""
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    readme = importlib.import_module("readme")
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert all(head in text for head in readme.HEADS)
    assert readme.filled(text) == text
    assert len(text.splitlines()) < 80  # one screen


def run(page, slow):
    """Run the blocks of a page one after the other; return its names."""
    names = {}
    for marked, code in BLOCK.findall(page.read_text(encoding="utf-8")):
        if slow or not marked:
            exec(compile(ast.parse(code, page.name), page.name, "exec"), names)
    return names


@pytest.mark.parametrize("page", WITH_CODE, ids=lambda p: p.stem)
def test_code_on_pages_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        names = run(page, slow=False)
    check = CHECKS.get(page.stem)
    assert check is None or check(names)


CHECKS = {  # what the sentences around the code say
    "start": lambda n: (
        np.isclose(n["gait"].mean_velocity[0], -0.0673, atol=5e-5)
        and np.isclose(n["fit"].swimmer.gait().mean_velocity[0], -0.0307, atol=2e-4)
    ),
    "bacterium": lambda n: (
        np.allclose(n["fit"].values, [2.37, 1.49], atol=0.005)
        and np.isclose(1e6 * n["predicted"]["G"], 33.0, atol=0.1)
    ),
    "calibrate": lambda n: (
        np.isclose(n["reference"].mean_velocity[0], -0.031, atol=1e-3)
        and np.isclose(n["robot"].gait().mean_velocity[0], -0.067, atol=1e-3)
    ),
    "loop": lambda n: np.isclose(n["state"].position[0], -1.03, atol=0.1),
    "magnetic-helix": lambda n: (
        np.isclose(n["speed"].max(), 44.2e-6, rtol=0.01)
        and np.isclose(n["judged"]["speed_at_step_out"], 38.7e-6, rtol=0.01)
        and np.isclose(n["judged"]["step_out"], 17.0, rtol=0.01)
        and np.isclose(n["best"].values["tail.amplitude"], 1.5e-6, rtol=0.05)
        and (np.abs(n["turned"] / (n["per_turn"] * n["rates"] / (2 * np.pi)))[:2] > 0.95).all()
        and n["turned"][2] < n["turned"][1]
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [p for p in WITH_CODE if "<!-- slow -->" in p.read_text()], ids=str
)
def test_code_that_compiles_long_runs_too(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(page, slow=True)


#: Guides whose subject is a table or a choice, not a thing that is seen.
BARE = {"api", "bibliography", "changes", "cite", "conventions", "errors", "howto", "notation"}
BARE |= {"odd", "can", "quantities", "paper", "theory"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_that_teaches_has_a_picture(page):
    about = page.parent.name == "decisions" or page.stem.startswith("accuracy")
    if about or page.stem in BARE or page == DOCS / "tutorials" / "index.md":
        return
    assert "![" in page.read_text(encoding="utf-8")
