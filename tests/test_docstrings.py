"""Docstrings say in plain English what a function does, or what a property is."""

import ast
from pathlib import Path

import pytest

import microswim

ROOT = Path(microswim.__file__).parent
#: Verbs with which a function's docstring begins; add one where none of these says it.
VERBS = {
    "Add",
    "Advance",
    "Answer",
    "Apply",
    "Assemble",
    "Begin",
    "Calibrate",
    "Compare",
    "Compile",
    "Compute",
    "Condition",
    "Decorate",
    "Draw",
    "End",
    "Fill",
    "Find",
    "Carry",
    "Fit",
    "Follow",
    "Estimate",
    "Give",
    "Hold",
    "Import",
    "Judge",
    "Leave",
    "Load",
    "Make",
    "Move",
    "Name",
    "Overwrite",
    "Print",
    "Put",
    "Read",
    "Refuse",
    "Remove",
    "Replace",
    "Reproduce",
    "Return",
    "Run",
    "Send",
    "Serve",
    "Set",
    "Show",
    "Solve",
    "Sort",
    "Start",
    "Step",
    "Swim",
    "Take",
    "Tell",
    "Thin",
    "Turn",
    "Warn",
    "Write",
    "Yield",
}


def docstrings(path):
    """Every function of a module with its docstring: name, whether a property, text."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef) and (text := ast.get_docstring(node)):
            decorators = [ast.unparse(d) for d in node.decorator_list]
            if not any(".command" in d or ".group" in d for d in decorators):
                yield node.name, any("property" in d for d in decorators), text


MODULES = sorted(ROOT.rglob("*.py"))


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(ROOT)))
def test_the_first_line_is_in_the_imperative_or_names_a_property(path):
    for name, is_property, text in docstrings(path):
        first, summary = text.split()[0], text.split("\n\n")[0].rstrip()
        assert summary[-1] in ".:?", f"{name}: its summary ends without a full stop: {summary}"
        if not name.startswith("_"):
            begins = first != "Return" if is_property else first in VERBS
            assert begins, f"{name} begins with {first}: {'a noun' if is_property else VERBS}"


def test_every_verb_is_used():
    used = {text.split()[0] for path in MODULES for _, _, text in docstrings(path)}
    assert used >= VERBS
