"""Nobody asks of what kind a tail, a body or a law is: a new one is a file and a line."""

import ast
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

import microswim as ms
from microswim.models import swimmer_surface
from microswim.swimmer.drag.coefficients import LAWS, Coefficients
from microswim.swimmer.geometry.bodies import SHAPES, Body
from microswim.swimmer.geometry.tails.kinds import TAILS, WaveTail
from microswim.swimmer.geometry.tails.tail import Tail

SOURCE = Path(ms.__file__).parent
#: Where kinds are made, and the spec's table, which turns words into them.
HOME = ("swimmer/geometry/", "swimmer/drag/", "spec/")
WORDS = {"kind", "shape", "law"}
CONCRETE = {c.__name__ for table in (TAILS, SHAPES, LAWS) for c in table.values()}


def is_word(node):
    """Whether an expression is a kind, ``tail.kind`` and the like (no dtype's, no spec field's)."""
    if not isinstance(node, ast.Attribute) or node.attr not in WORDS:
        return False
    return getattr(node.value, "attr", getattr(node.value, "id", "")) not in ("dtype", "field")


def is_text(node):
    if isinstance(node, (ast.Tuple, ast.Set, ast.List)):
        return all(is_text(e) for e in node.elts)
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def asks_a_kind(node):
    if isinstance(node, ast.Compare):
        sides = [node.left, *node.comparators]
        return any(map(is_word, sides)) and any(map(is_text, sides))
    if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "isinstance":
        return any(getattr(n, "id", "") in CONCRETE for n in ast.walk(node.args[1]))
    if isinstance(node, ast.Subscript):
        return isinstance(node.value, ast.Dict) and is_word(node.slice)
    return isinstance(node, ast.Match) and is_word(node.subject)


def questions(text):
    return [node.lineno for node in ast.walk(ast.parse(text)) if asks_a_kind(node)]


def test_nobody_outside_asks_for_a_kind():
    found = {
        str(path.relative_to(SOURCE)): lines
        for path in sorted(SOURCE.rglob("*.py"))
        if not path.relative_to(SOURCE).as_posix().startswith(HOME)
        and (lines := questions(path.read_text(encoding="utf-8")))
    }
    assert found == {}


@pytest.mark.parametrize(
    "line",
    [
        'a = swimmer.tail.kind == "helix"',
        'a = "none" != body.shape',
        'a = tail.kind not in ("helix", "plane_wave")',
        "a = isinstance(swimmer.coefficients, Lighthill)",
        'a = {"helix": 1}[tail.kind]',
    ],
)
def test_such_questions_are_seen(line):
    assert questions(line) == [1]


@pytest.mark.parametrize(
    ("whole", "table"), [(Tail, TAILS), (Body, SHAPES), (Coefficients, LAWS), (WaveTail, {})]
)
def test_the_general_part_is_abstract_and_all_in_the_table_are_whole(whole, table):
    with pytest.raises(TypeError, match="abstract"):
        whole()
    assert all(issubclass(c, whole) and not c.__abstractmethods__ for c in table.values())


@dataclass(frozen=True, kw_only=True)
class Whip(Tail):
    """A tail of a new kind: a wave whose amplitude grows along it, known to this file alone."""

    length: float
    radius: float
    frequency: float = 1.0
    sections: str = "perpendicular"
    surface_motion: str = "translating"
    kind: ClassVar[str] = "whip"

    sign = 1.0
    alpha = 0.99
    number_of_waves = 1.0
    wavelength_along_s = None
    edges = np.array([0.0, 1.0])

    @property
    def apparent_length(self):
        return self.length

    @property
    def arc_length(self):
        return self.length / self.alpha

    def curve(self, s, phase):
        s, phase = np.broadcast_arrays(s, phase)
        c, d, zero = np.cos(3 * s - phase), np.sin(3 * s - phase), 0 * s
        P = np.stack([s + zero, 0.1 * s * c, zero], axis=-1)
        P_s = np.stack([1 + zero, 0.1 * c - 0.3 * s * d, zero], axis=-1)
        return P, P_s, np.stack([zero, 0.1 * s * d, zero], axis=-1)


def test_a_tail_of_a_new_kind_swims_by_its_interface_alone():
    whip = Whip(length=2.0, radius=0.05)
    same = ms.CustomTail(shape=lambda s, p: whip.centreline(s, p)[0], length=2.0, radius=0.05)
    ours, known = (
        ms.Swimmer(
            body=ms.Sphere(radius=0.3), tail=tail, fluid=ms.Fluid(viscosity=1.0),
            coefficients=ms.Constant(normal=2.0, tangential=1.2),
        )
        for tail in (whip, same)
    )  # fmt: skip
    V, W = ours.gait().mean_velocity, known.gait().mean_velocity
    assert pytest.approx(W, rel=1e-9, abs=1e-12) == V
    assert swimmer_surface.check(ours.body, whip) == swimmer_surface.check(ours.body, same)
    assert set(ms.summary(ours.gait())) == set(ms.summary(known.gait()))
