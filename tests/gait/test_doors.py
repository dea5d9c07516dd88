"""What reaches up goes through one table, and every name in it leads somewhere."""

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

import microswim
from microswim.gait import doors

TABLE = {
    **{n: door for n, door in vars(doors).items() if n.isupper() and isinstance(door, str)},
    **{f"model {name}": door for name, door in doors.MODELS.items()},
}


@pytest.mark.parametrize("name", TABLE)
def test_every_door_leads_to_a_function_that_is_there(name):
    module, _, function = TABLE[name].partition(":")
    source = Path(microswim.__file__).parents[1].joinpath(*module.split("."))
    file = source / "__init__.py" if source.is_dir() else source.with_suffix(".py")
    named = {n.name for n in ast.walk(ast.parse(file.read_text("utf-8"))) if hasattr(n, "name")}
    assert function in named


def test_nothing_else_names_a_function_to_import():
    root, found = Path(microswim.__file__).parent, set()
    for path in root.rglob("*.py"):
        texts = (n.value for n in ast.walk(ast.parse(path.read_text("utf-8"))) if is_text(n))
        if any(re.fullmatch(r"microswim(\.\w+)+:\w+", text) for text in texts):
            found.add(str(path.relative_to(root)))
    assert found == {"gait/doors.py"}


def is_text(node):
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def test_a_door_is_walked_through():
    assert doors.go("math:hypot", 3.0, 4.0) == 5.0
    assert import_module("microswim.gait.doors") is doors
