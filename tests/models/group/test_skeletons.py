"""Skeletons of swimmers: the answers of the whole system, at a fifth of its cost."""

import numpy as np
import pytest

import microswim as ms
from microswim.models.group.quick import QuickSolution, solve_quickly
from microswim.models.group.solution import GroupSolution

HELIX = ms.Swimmer.preset("tabak/helix")
WAVE = ms.Swimmer.preset("tabak/plane_wave")


def scaled(R, known):
    root = np.sqrt(known.diagonal())
    return R / np.outer(root, root)


@pytest.mark.parametrize(
    ("other", "level", "within"),
    [
        (HELIX, "coarse", 5e-4),
        pytest.param(HELIX, "standard", 2e-4, marks=pytest.mark.slow),
        pytest.param(WAVE, "standard", 2e-4, marks=pytest.mark.slow),
    ],
)
def test_they_answer_as_the_whole_system_does(other, level, within):
    """At random poses, from where they hold on: R to 2e-4, velocities to 2e-3 of the speeds.

    Coarse patches have fewer nodes to stand for the others.
    """
    pair = ms.Group((ms.Member(swimmer=HELIX), ms.Member(swimmer=other, phase=0.6)))
    blocks, rng, quick = pair.prepared(level), np.random.default_rng(2), 0
    longest = max(blocks.of(m).skeleton.distance for m in pair.members)
    while quick < 3:
        line = rng.normal(size=3)
        place = tuple(rng.uniform(1.2, 6.0) * line / np.linalg.norm(line))
        here = pair.moved(
            positions=[(0.3, 0.1, -0.2), place],
            directions=rng.normal(size=(2, 3)),
            rolls=rng.uniform(0, 6, 2),
        )
        try:
            whole = here.solve(blocks=blocks)
        except ms.SpecError:
            continue
        found = solve_quickly(here, blocks)
        if isinstance(found, GroupSolution):
            assert np.array_equal(found.resistance, whole.resistance)
            continue
        quick += 1
        assert found.gap >= longest
        assert found.gap == whole.gap
        known = whole.resistance
        assert scaled(found.resistance, known) == pytest.approx(scaled(known, known), abs=within)
        F = np.abs(whole.propulsion).max()
        assert found.propulsion == pytest.approx(whole.propulsion, abs=within * F)
        off = (found.velocity - whole.velocity).reshape(2, 2, 3)
        size = np.linalg.norm(whole.velocity.reshape(2, 2, 3), axis=-1)
        assert (np.linalg.norm(off, axis=-1) < 10 * within * size).all()


def test_three_swimmers_and_a_phase_that_turns_the_block():
    """A helix turns with its phase as a whole: its skeleton too, in a group of three."""
    places = [(0, 0, 0), (0.3, 2.2, 0.4), (-0.5, -0.6, 3.2)]
    three = ms.Group(tuple(ms.Member(swimmer=HELIX, position=x) for x in places))
    blocks = three.prepared("coarse")
    here = three.moved(phases=[0.4, 2.0, 5.0], directions=[(1, 0, 0), (0, 1, 1), (-1, 0.2, 0)])
    found, whole = solve_quickly(here, blocks), here.solve(blocks=blocks)
    assert isinstance(found, QuickSolution)
    assert found.velocity == pytest.approx(whole.velocity, abs=3e-4 * np.abs(whole.velocity).max())


def test_where_they_do_not_hold_the_whole_system_is_solved():
    """Near one another, beside a wall, alone, and at a phase that was not prepared."""
    pair = ms.Group((ms.Member(swimmer=HELIX), ms.Member(swimmer=WAVE, position=(0, 2.5, 0))))
    blocks = pair.prepared("coarse")
    assert isinstance(solve_quickly(pair, blocks), QuickSolution)
    for other in (
        pair.moved(positions=[(0, 0, 0), (0, 1.2, 0)]),
        pair.moved(phases=[0.0, 0.3]),
        ms.Group(pair.members, ((0, -2, 0), (0, 1, 0))),
        ms.Group(pair.members[:1]),
    ):
        assert isinstance(solve_quickly(other, blocks), GroupSolution)
