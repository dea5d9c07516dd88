"""The guides: every command on the site is one, every spec is read, and blocks run as they stand.

What a guide supposes to be there is in `GIVEN`; a block whose first line names a file,
``# pair.toml``, is that file, other TOML is put into a spec of its kind and read.
"""

import re
import shlex
import subprocess
import tomllib
from pathlib import Path

import click
import pytest

from microswim.cli import main
from microswim.spec.file import from_dict
from microswim.spec.presets import read
from test_docs import DOCS, PAGES, ROOT
from test_docs_commands import environment

GUIDES = [p for p in sorted(DOCS.glob("*.md")) if p.stem not in ("start", "gallery", "api")]
BLOCK = re.compile(r"(?:<!-- ([a-z ]+) -->\n)?```(\w+)\n(.*?)```", re.DOTALL)
COMMAND = re.compile(r"`(microswim [^`]*)`")
TEXTS = [*PAGES, ROOT / "README.md"]


def lines(code):
    """Commands of a block, a line each; what a line goes on with, and what is typed alone."""
    joined = code.replace("\\\n", " ")
    return [line.removeprefix("$ ").split("#")[0].strip() for line in joined.splitlines()]


def commands(page):
    text = page.read_text(encoding="utf-8")
    blocks = [code for _, kind, code in BLOCK.findall(text) if kind in ("sh", "console")]
    typed = [line for code in blocks for line in lines(code) if line.startswith("microswim ")]
    named = [" ".join(line.split()) for line in COMMAND.findall(text)]
    return [line for line in typed + named if "..." not in line]


def understood(words):
    """Refuse, as the command line does, what is no command, option or choice."""
    name, *rest = words
    found = main.get_command(click.Context(main), name)
    assert found is not None, f"there is no command {name}"
    context = click.Context(found)
    given = found.make_parser(context).parse_args(rest)[0]
    for parameter in found.params:
        value = given.get(parameter.name)
        if isinstance(parameter.type, click.Choice) and isinstance(value, str):
            parameter.type.convert(value, parameter, context)


@pytest.mark.parametrize("page", TEXTS, ids=lambda p: p.stem)
def test_what_pages_tell_to_type_is_understood(page):
    for line in commands(page):
        line = re.split(r" [|>&]|;|\)", line)[0]
        try:
            words = shlex.split(line)[1:]
            if words and not words[0].startswith("-"):
                understood(words)
        except (ValueError, click.UsageError) as error:
            if "requires an argument" in str(error):  # an option that is spoken of
                continue
            raise AssertionError(f"{line}: {error}") from None


def test_a_command_that_is_none_would_be_found():
    for words in (["rnu"], ["run", "--modle", "rft"], ["run", "--model", "magic"]):
        with pytest.raises((AssertionError, click.UsageError)):
            understood(words)


def fragments(page):
    """Specs and parts of specs on a page; where a table comes twice, one after the other."""
    for _, kind, code in BLOCK.findall(page.read_text(encoding="utf-8")):
        if kind == "toml" and "[[swimmer]]" not in code and "[[coil]]" not in code:
            try:
                yield tomllib.loads(code)
            except tomllib.TOMLDecodeError:
                yield from map(tomllib.loads, re.split(r"\n\n(?=\[)", code))


def has_units(value):
    if isinstance(value, dict):
        return any(map(has_units, value.values()))
    if isinstance(value, list):
        return any(map(has_units, value))
    number = r"-?[\d.e-]+ ?(?!deg)[a-zA-Z]"  # an angle has its unit anywhere
    return isinstance(value, str) and re.match(number, value) is not None


@pytest.mark.parametrize(
    "page", [p for p in GUIDES if "```toml" in p.read_text("utf-8")], ids=lambda p: p.stem
)
def test_what_pages_tell_to_write_is_read(page):
    for part in fragments(page):
        if any("file" in table for table in part.values() if isinstance(table, dict)):
            continue  # what is in the file is the reader's
        like = read("shapes/magnet" if has_units(part) else "tabak/helix")
        if has_units(part) and ("motor" in part or "hook" in part):
            like = TWO_FLAGELLA + MOTOR
        tables = tomllib.loads(like)
        if "body" not in part and "tail" in part and part["tail"] == {"kind": "none"}:
            tables.pop("motion", None)
        from_dict(tables | part)


MOTOR = '[motor]\ntorque = "1.26e-18 N m"\n[hook]\nstiffness = "6e-26 N m^2"\nlength = "60 nm"\n'


TWO_FLAGELLA = "[[tail]]".join(read("several/four-flagella").split("[[tail]]")[:3])


#: What a guide supposes: files by name, and commands that make some.
GIVEN = {
    "cad": ({"robot.toml": read("shapes/rod")}, ["microswim show robot.toml --stl head.stl"]),
    "control": ({}, []),
    "groups": (
        {
            "robot.toml": read("goto/C"),
            "cell.toml": read("goto/C"),
            "poses.csv": "pose,swimmer,x (um),y (um),z (um)\n0,1,0,20,0\n1,1,5,30,0\n",
            "cells.csv": "x (um),y (um),z (um),dx,dy,dz,phase (deg)\n0,0,0,1,0,0,0\n"
            "35,12,-8,0,1,1,90\n",
        },
        [],
    ),
    "magnets": ({"robot.toml": read("shapes/magnet")}, []),
    "paths": ({"cell.toml": read("goto/C") + '\n[noise]\ntemperature = "298 K"\n'}, []),
    "several-tails": (
        {"cell.toml": TWO_FLAGELLA + MOTOR},
        [],
    ),
}
RUN = [
    p for p in GUIDES
    if any(how != "not run" and kind in ("python", "sh", "console")
           for how, kind, _ in BLOCK.findall(p.read_text("utf-8")))
]  # fmt: skip


def shell(code, folder):
    run = subprocess.run(
        ["bash", "-e", "-c", code], cwd=folder, env=environment(), text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=1500,
    )  # fmt: skip
    assert run.returncode == 0, f"{code}\n{run.stdout}"


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN, ids=lambda p: p.stem)
def test_blocks_of_guides_run(page, tmp_path, monkeypatch):
    files, before = GIVEN.get(page.stem, ({}, []))
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    for command in before:
        shell(command, tmp_path)
    monkeypatch.chdir(tmp_path)
    names, ran = {}, 0
    for how, kind, code in BLOCK.findall(page.read_text("utf-8")):
        named = re.match(r"# (\w+\.toml)\n", code)
        if how == "not run":
            continue
        if kind == "toml" and named:
            Path(named[1]).write_text(code)
        elif kind == "python":
            exec(compile(code, page.name, "exec"), names)
            ran += 1
        elif kind in ("sh", "console"):
            typed = [line for line in code.splitlines() if kind == "sh" or line[:2] == "$ "]
            for line in filter(None, lines("\n".join(typed))):
                shell(line, tmp_path)
            ran += 1
    assert ran
