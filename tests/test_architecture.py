"""The house rules that a machine can hold."""

import ast
import inspect
import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from importlib.resources import as_file, files
from pathlib import Path

import pytest

import microswim as ms
from microswim.spec import presets

ROOT = Path(__file__).parents[1]
PUBLIC = sorted(ms.__all__)


def tracked(*patterns):
    """Paths of the tracked text files that match the patterns."""
    command = ["git", "ls-files", "-z", "--", *patterns]
    listed = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [ROOT / name for name in listed.split("\0") if name and (ROOT / name).is_file()]


def in_a_fresh_interpreter(code):
    """Run code where nothing is imported yet; return what it printed."""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def test_dependencies_point_one_way():
    linter = Path(sys.executable).with_name("lint-imports")
    run = subprocess.run([linter], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


def test_no_address_of_a_registry_and_no_path_of_a_machine():
    hosts = ["pypi" + r"\.org", "python" + "hosted", r"registry\." + "npmjs", r"deb\." + "debian"]
    places = ["/" + "work/", "/" + "root/", "/" + r"home/[a-z]"]
    wrong = re.compile("|".join(hosts + places))
    hits = [
        f"{path.relative_to(ROOT)}:{number}"
        for path in tracked()
        if path.suffix not in {".png", ".jpg", ".svg", ".nc", ".npz", ".glb"}
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if wrong.search(line)
    ]
    assert hits == []


def test_rooms_are_small():
    long = {
        str(path.relative_to(ROOT)): length
        for path in tracked("src/*.py")
        if (length := len(path.read_text(encoding="utf-8").splitlines())) > 350
    }
    assert long == {}


def test_no_tracked_file_is_large():
    atlas = 4_000_000  # of weights, which do not compress
    most = {".npz": atlas}
    large = [p for p in tracked() if p.stat().st_size > most.get(p.suffix, 1_000_000)]
    assert [str(path) for path in large] == []


def test_nothing_is_left_undone_in_the_source():
    marks = re.compile(
        "|".join(["TO" + "DO", "FIX" + "ME", "XX" + "X", "NotImplemented" + "Error"])
    )
    files_ = tracked("src/*.py", "tests/*.py")
    assert [p.name for p in files_ if marks.search(p.read_text(encoding="utf-8"))] == []


@pytest.mark.parametrize("name", PUBLIC)
def test_public_names_exist_and_tell_what_they_are(name):
    thing = getattr(ms, name)
    assert inspect.getdoc(thing)
    if not inspect.isclass(thing):
        return
    for attribute, value in inspect.getmembers(thing):
        owner = next(c for c in thing.__mro__ if attribute in vars(c) or c is object)
        ours = owner.__module__.startswith("microswim") and not attribute.startswith("_")
        if ours and (callable(value) or isinstance(value, property)):
            assert inspect.getdoc(value), f"{name}.{attribute} has no docstring"


@pytest.mark.parametrize("name", PUBLIC)
def test_public_names_are_in_the_documentation(name):
    page = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
    assert f"::: microswim.{name}\n" in page


def test_the_face_is_lazy():
    """What costs time to import is imported by what needs it."""
    code = "import sys, microswim; print(*sorted({m.split('.')[0] for m in sys.modules}))"
    loaded = set(in_a_fresh_interpreter(code).split())
    assert "microswim" in loaded
    heavy = {
        "numpy",
        "scipy",
        "numba",
        "xarray",
        "pandas",
        "matplotlib",
        "pint",
        "pydantic",
        "rich",
    }
    assert not heavy & loaded


def test_the_root_holds_the_face_the_command_and_the_errors_alone():
    modules = {p.name for p in (ROOT / "src" / "microswim").glob("*.py*") if p.is_file()}
    assert modules == {"__init__.py", "__init__.pyi", "__main__.py", "errors.py"}


def test_modules_do_not_hide_the_functions_of_their_name():
    """`ms.trajectory` is the function, also after somebody imported the module `trajectory`."""
    code = """
import importlib, pkgutil, types
import microswim
for module in pkgutil.iter_modules(microswim.__path__):
    importlib.import_module(f"microswim.{module.name}")
found = {n: getattr(microswim, n) for n in microswim.__all__}
modules = {n for n, x in found.items() if isinstance(x, types.ModuleType) and not callable(x)}
print(*sorted(modules))
"""
    assert in_a_fresh_interpreter(code).split() == ["data", "io", "plots", "report"]


def test_every_library_that_is_imported_is_declared():
    """What another package happens to bring is not there on a fresh machine."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    listed = [project["dependencies"], *project["optional-dependencies"].values()]
    declared = {re.split(r"[^\w.-]", line)[0].lower() for lines in listed for line in lines}
    brought = {
        "pandas": "xarray",
        "pil": "matplotlib",
        "netgen": "ngsolve",
        "vtkmodules": "pyvista",
    }
    owners = packages_distributions()
    paths = tracked("src/*.py", "tests/*.py", "benchmarks/*.py", "examples/*.py")
    ours = {name for path in paths for name in (path.stem, path.parent.name)}
    ours.add("beating")  # written by a test of sweeps
    ours |= {"elastica", "jax", "mime", "pygrpy"}  # peers in environments of their own
    missing = set()
    for path in paths:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module]
            for top in {name.split(".")[0] for name in names}:
                if top in sys.stdlib_module_names or top in ours:
                    continue
                given = {brought.get(top.lower(), d).lower() for d in owners.get(top, [top])}
                if not given & declared:
                    missing.add(f"{path.relative_to(ROOT)}: {top}")
    assert missing == set()


def test_the_core_works_without_the_extras():
    """Every public name is importable where none of the optional packages is installed."""
    extras = (
        "ngsolve netgen dask distributed pyvista vtk starlette uvicorn pymoo SALib gymnasium fmpy"
    )
    code = f"""
import importlib.machinery as machinery
find = machinery.PathFinder.find_spec
def absent(cls, name, path=None, target=None):
    return None if name.split(".")[0] in {extras.split()!r} else find(name, path, target)
machinery.PathFinder.find_spec = classmethod(absent)
import microswim
for name in microswim.__all__:
    getattr(microswim, name)
"""
    in_a_fresh_interpreter(code)


@pytest.mark.parametrize("name", presets.names())
def test_every_preset_is_a_swimmer(name):
    with as_file(files("microswim.spec.presets") / f"{name}.toml") as path:
        assert isinstance(ms.Swimmer.from_toml(path), ms.Swimmer)


def test_colours_of_figures_stand_in_the_one_palette():
    """Of the reports' style sheets they are others."""
    others = {"gait/palette.py", "output/plots/style.py", "studies/paper/report.py"}
    colour = re.compile(r"""["']#[0-9a-fA-F]{6}["']""")
    package = ROOT / "src" / "microswim"
    found = {
        str(path.relative_to(package))
        for path in tracked("src/*.py")
        if colour.search(path.read_text(encoding="utf-8"))
    }
    assert found <= others


def test_public_modules_show_their_own_names_alone():
    """What an editor offers behind a dot is what a user may call."""
    from microswim.control import environments

    for module in (ms, ms.data, ms.io, ms.plots, ms.report, environments):
        shown = set(dir(module))
        assert shown == set(module.__all__)
        for name in shown:
            made = getattr(module, name)
            home = made.__name__ if inspect.ismodule(made) else made.__module__
            assert home.startswith("microswim"), name
