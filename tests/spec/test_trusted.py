"""A spec is data: code runs from the file that the user trusts, and from no other."""

import json
import sys

import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.errors import SpecError
from microswim.studio.spec_tables import swimmer_of

SPEC = """
[fluid]
viscosity = 1.0
[body]
shape = "sphere"
radius = 0.5
[tail]
kind = "custom"
shape = "NAME"
length = 2.0
radius = 0.02
wavelength = 2.0
"""
BEAT = """
import numpy as np
from {helper} import slope
def beat(s, phase):
    q = slope * s * np.cos(3 * s - phase)
    return np.stack([s + 0 * q, q, 0 * q], axis=-1)
def broken(s, phase):
    return s[10**9]
def stops(s, phase):
    raise ZeroDivisionError("no")
number = 3
"""


@pytest.fixture
def files(tmp_path, request):
    """A spec, a module and a helper beside it, with names of their own."""
    stem = f"beat_{abs(hash(request.node.name))}"
    (tmp_path / f"{stem}_helper.py").write_text("slope = 0.1\n")
    (tmp_path / f"{stem}.py").write_text(BEAT.format(helper=f"{stem}_helper"))
    path = list(sys.path)
    yield tmp_path, stem
    sys.path[:] = path
    for name in (stem, f"{stem}_helper"):
        sys.modules.pop(name, None)


def call(folder, name, *arguments, command="run"):
    spec = folder / "robot.toml"
    spec.write_text(SPEC.replace("NAME", name))
    return CliRunner().invoke(main, [command, str(spec), *map(str, arguments)])


@pytest.mark.parametrize("command", ["run", "show", "studio"])
@pytest.mark.parametrize("name", ["antigravity:geohash", "os:system", "this:s", "json.tool:main"])
def test_a_spec_alone_imports_and_calls_nothing(tmp_path, command, name):
    module = name.partition(":")[0]
    before = sys.modules.pop(module, None) if module in ("antigravity", "this") else None
    result = call(tmp_path, name, command=command)
    assert result.exit_code == 2, result.output
    assert "--trust" in result.stderr or "module.py" in result.stderr
    if module in ("antigravity", "this"):
        assert module not in sys.modules
        if before is not None:
            sys.modules[module] = before


def test_the_studio_refuses_before_anything_else():
    with pytest.raises(SpecError, match="runs no code"):
        swimmer_of({"tail": {"kind": "custom", "shape": "antigravity:x"}})


def test_a_trusted_file_swims_as_in_python(files):
    folder, stem = files
    trust = folder / f"{stem}.py"
    result = call(folder, f"{stem}:beat", "--trust", trust, "--json")
    assert result.exit_code == 0, result.stderr
    module = sys.modules[stem]
    by_hand = ms.Swimmer(
        body=ms.Sphere(radius=0.5),
        tail=ms.CustomTail(shape=module.beat, length=2.0, radius=0.02, wavelength=2.0),
        fluid=ms.Fluid(viscosity=1.0),
    )
    found = json.loads(result.stdout)["mean_velocity"]
    assert found == pytest.approx(by_hand.gait().mean_velocity.tolist(), abs=1e-15)
    assert ms.Swimmer.from_toml(folder / "robot.toml", trust=trust).numbers == by_hand.numbers


def test_a_custom_tail_shows_and_prints(files):
    folder, stem = files
    for command in ("run", "show"):
        result = call(folder, f"{stem}:beat", "--trust", folder / f"{stem}.py", command=command)
        assert result.exit_code == 0, (result.stderr, result.exception)
        assert "wavenumber" not in result.stdout


@pytest.mark.parametrize(
    ("function", "says"),
    [
        ("broken", "IndexError"),
        ("stops", "ZeroDivisionError: no"),
        ("number", "function of"),
        ("missing", "function of"),
        ("__class__", "function of"),
    ],
)
def test_what_the_function_raises_is_a_sentence(files, function, says):
    folder, stem = files
    result = call(folder, f"{stem}:{function}", "--trust", folder / f"{stem}.py")
    assert result.exit_code == 2, result.output
    assert says in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_only_the_trusted_file_is_run(files):
    folder, stem = files
    other = folder / f"{stem}_other.py"
    other.write_text("raise SystemExit(7)\n")
    assert "a function of the trusted file" in call(folder, f"{stem}:beat", "--trust", other).stderr
    assert (
        "cannot be run: SystemExit" in call(folder, f"{stem}_other:beat", "--trust", other).stderr
    )
    for wrong in (folder, folder / "nothing.py", folder / "robot.toml"):
        assert "a Python file" in call(folder, f"{stem}:beat", "--trust", wrong).stderr
