"""A start that reaches into the boundary is refused before any pose is solved."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

import microswim as ms
from microswim.calibration.poses.around import outline
from microswim.errors import SpecError
from microswim.jobs import references

HELIX = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
WAVE = ms.Swimmer.preset("tabak/plane_wave").with_({"motion.free": "all"})
TUBE = ms.Channel(diameter=3.0, length=20.0)


@pytest.fixture(autouse=True)
def unsolved(monkeypatch: pytest.MonkeyPatch) -> None:
    def gaits(*_: Any, **__: Any) -> None:
        raise AssertionError("poses are solved")

    monkeypatch.setattr(references, "gaits", gaits)


@pytest.mark.parametrize(
    ("swimmer", "start", "deep"),
    [
        (replace(HELIX, wall=ms.Wall(0.4)), {}, "0.1"),
        (replace(HELIX, wall=ms.Wall(2.0)), {"position": (3.0, 1.0, 0.2)}, "0.3"),
        (replace(WAVE, wall=ms.Wall(0.3)), {}, "0.2"),
        (replace(HELIX, channel=TUBE), {"position": (0.0, 0.0, -1.25)}, "0.25"),
    ],
    ids=["as-the-spec-says", "as-asked", "any-shape", "tube"],
)
def test_a_start_in_the_boundary_costs_no_solve(
    swimmer: ms.Swimmer, start: dict[str, Any], deep: str
) -> None:
    """How deep is that of the body: its half width is .5."""
    with pytest.raises(SpecError, match=f"would reach {deep} into the boundary"):
        ms.path(swimmer, time=1.0, **start)


def test_many_paths_that_would_be_the_same_cost_no_solve() -> None:
    with pytest.raises(SpecError, match="1 without"):
        ms.path(replace(HELIX, channel=TUBE), time=1.0, paths=3)


def test_a_start_that_is_clear_is_solved() -> None:
    with pytest.raises(AssertionError, match="are solved"):
        ms.path(replace(HELIX, wall=ms.Wall(0.6)), time=1.0)


def test_the_outline_is_as_far_from_the_wall_as_its_lowest_part() -> None:
    """A tilted robot's nearest part is its tail: amplitude and filament below the line of s."""
    steep = outline(replace(HELIX, wall=ms.Wall(2.0, tilt=-0.5)))
    level = outline(replace(HELIX, wall=ms.Wall(2.0)))
    assert steep is not None
    assert level is not None
    assert level.gap(*level.start, 0.0) == pytest.approx(1.5)
    assert 0.0 < steep.gap(*steep.start, 0.0) < 1.5
    assert outline(HELIX) is None
