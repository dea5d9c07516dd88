"""A robot of one's own along a path: by a field, and by currents of coils that pull as well."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import microswim as ms

SPEC = Path(__file__).parents[2] / "examples" / "control" / "coil_robot.toml"
BEND = 1e-3 * np.array([[0, 0, 0], [-0.5, 0.1, 0], [-1.0, 0.3, 0.1], [-1.4, 0.6, 0.3]])


def robot(**changes):
    return replace(ms.Swimmer.from_toml(SPEC), **changes)


def straight(**changes):
    """Its magnet along the easy axis: it hardly wobbles, so that what is off is the follower's."""
    turning = ms.RotatingField(strength=5e-3, frequency=1.0)
    one = robot(field=turning, **changes)
    return replace(one, body=ms.Spheroid(semi_axes=(6e-4, 5e-4)))


def swum(one, follow, dt, seconds):
    stepper, state, rows = ms.Stepper.of(one, locked=True), ms.State.at(), []
    for _ in range(int(seconds / dt)):
        command = follow(state, dt=dt)
        if command.done:
            break
        state = stepper.step(state, dt=dt, **command.inputs)
        rows.append(np.append(state.position, command.off))
    return np.array(rows), command


@pytest.mark.parametrize("frequency", [None, 6.0])
def test_it_arrives_near_its_path(frequency):
    one = straight()
    follow = ms.PathFollower(swimmer=one, path=BEND, frequency=frequency)
    rows, last = swum(one, follow, 5e-3, 8.0)
    assert last.done
    assert np.linalg.norm(rows[-1, :3] - BEND[-1]) < 0.3e-3
    assert np.sqrt(np.mean(rows[:, 3] ** 2)) < 0.2e-3
    assert last.currents is None


def test_the_mirrored_robot_turns_the_other_way():
    one = straight()
    other = one.with_({"tail.handedness": "right"})
    a, b = (
        ms.PathFollower(swimmer=r, path=BEND, frequency=6.0)(ms.State.at(), dt=1e-3)
        for r in (one, other)
    )
    assert a.field_rate == pytest.approx(-b.field_rate, rel=1e-9)


def test_currents_make_the_field_that_is_wanted_and_little_pull():
    one = robot()
    follow = ms.PathFollower(swimmer=one, path=BEND, strength=5e-3, frequency=8.0)
    state = ms.State.at([1e-3, -2e-3, 1e-3])
    command = follow(state, dt=1e-4)
    coils = one.field.at_currents(tuple(command.currents))
    assert np.linalg.norm(command.inputs["field"]) == pytest.approx(5e-3, rel=1e-9)
    assert coils.at(0.0, state.position) == pytest.approx(command.inputs["field"], rel=1e-9)
    plain = one.field.currents_for(command.inputs["field"], state.position)
    pull = np.linalg.norm(command.inputs["field_gradient"])
    assert pull < 0.5 * np.linalg.norm(one.field.per_ampere(state.position)[3:] @ plain)


def test_the_field_turns_on_from_where_it_was():
    one = straight()
    follow = ms.PathFollower(swimmer=one, path=[(0, 0, 0), (-1, 0, 0)], frequency=6.0)
    first = follow(ms.State.at(), dt=0.01)
    second = follow(ms.State.at(), dt=0.01)
    turn = np.linalg.norm(first.field_rate) * 0.01
    assert first.field @ second.field == pytest.approx(25e-6 * np.cos(turn), rel=1e-6)


@pytest.mark.parametrize(
    ("given", "word"),
    [
        ({"path": [(0, 0, 0)]}, "two at least"),
        ({"path": [(0, 0, 0), (0, 0, 0)]}, "differ"),
        ({"frequency": 500.0}, "below step-out"),
        ({"most_turn": 3.0}, "angle"),
    ],
)
def test_one_sentence_says_what_is_wrong(given, word):
    with pytest.raises(ms.SpecError, match=word):
        ms.PathFollower(**{"swimmer": straight(), "path": BEND, **given})


def test_coils_want_to_know_how_strong():
    with pytest.raises(ms.SpecError, match="strength"):
        ms.PathFollower(swimmer=robot(), path=BEND)
    with pytest.raises(ms.SpecError, match="magnet"):
        ms.PathFollower(swimmer=straight(magnet=None), path=BEND)
