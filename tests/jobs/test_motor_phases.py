"""Motors by boundary elements: against direct solves, by the path, kept and gone on with."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.jobs import motor_phases
from microswim.models.bem.levels import get_level
from microswim.models.bem.solution import solve
from microswim.path.motors import motors_of

SHORT = {"length": 0.5, "amplitude": 0.08, "waves": 0.5, "radius": 0.06}
LONGER = {"length": 1.0, "amplitude": 0.08, "waves": 1.5, "radius": 0.05}
LEVEL = replace(get_level("coarse", 1), name="own")
TORQUE = (1.2, -1.0)


def tails(*frequencies, phases=(0.0, 0.0), root=(0.0, 0.3), shape=SHORT):
    return [
        ms.HelicalTail(**shape, position=(root[0], y, 0.0), direction=(1.0, 4 * y / 3, 0.0),
                       frequency=f, phase=p)
        for y, f, p in zip((root[1], -root[1]), frequencies, phases)
    ]  # fmt: skip


def swimmer(each, body=None, **more):
    body = body or ms.NoBody()
    return ms.Swimmer(body=body, tail=each, fluid=ms.Fluid(viscosity=1.0), **more)


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def motors():
    return motors_of(swimmer(tails(1.0, 1.0)), TORQUE, model="bem", level=LEVEL, workers=0)


def directly(body, phases, level, **place):
    """R, F, G of one motor at a time, and of both: three whole solves with a common phase."""
    one, other, both = (
        solve(swimmer(tails(*f, phases=phases, **place), body), level=level)
        for f in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0))
    )
    across = 0.5 * (both.activity - one.activity - other.activity)
    G = np.array([[one.activity, across], [across, other.activity]])
    return both.resistance, np.array([one.propulsion, other.propulsion]).T, G


def turned(R, F, G, torque):
    """Twist and rates of free tails that take constant torques."""
    both = np.linalg.solve(np.block([[R, F], [F.T, G]]), [*np.zeros(6), *torque])
    return both[:6], both[6:]


def off(found, known):
    V, w = found
    size = np.repeat([np.linalg.norm(known[0][:3]), np.linalg.norm(known[0][3:])], 3)
    return np.concatenate([np.abs(V - known[0]) / size, np.abs(w / known[1] - 1.0)])


def test_at_phases_never_solved_motors_turn_as_a_direct_solve_says(motors):
    rng = np.random.default_rng(7)
    for phases in rng.uniform(0.0, 2.0 * np.pi, (4, 2)):
        known = turned(*directly(None, phases, LEVEL), TORQUE)
        assert off(motors.turning(phases), known).max() < 2e-3
    assert max(motors.error["rates"]) < 1e-3


def test_tails_feel_one_another_and_are_passive(motors):
    """A tail held beside one that turns takes a torque; nothing comes of nothing."""
    R, F, G = motors.tails.at(np.array([0.3, 2.0]))
    assert abs(G[0, 1]) > 2e-3 * G[0, 0]
    assert np.linalg.eigvalsh(np.block([[R, F], [F.T, G]])).min() > 0.0
    V, w = motors.turning(np.array([0.3, 2.0]))
    work = V @ R @ V + 2.0 * V @ F @ w + w @ G @ w
    assert work == pytest.approx(np.dot(TORQUE, w), rel=1e-9)


def test_what_was_solved_is_found_again_whatever_the_torque(motors, monkeypatch):
    def never(*_):
        raise AssertionError("solved again")

    monkeypatch.setattr(motor_phases, "at_own_phases", never)
    back = motors_of(swimmer(tails(3.0, 1.0, phases=(1.0, 2.0))), (-1.2, 1.0), model="bem",
                     level=LEVEL, workers=0)  # fmt: skip
    V = motors.turning(np.array([0.3, 2.0]))[0]
    assert back.turning(np.array([0.3, 2.0]))[0] == pytest.approx(-V, rel=1e-12)
    assert back.error == motors.error


def test_solves_that_were_stopped_are_gone_on_with(monkeypatch):
    thick = swimmer(tails(1.0, 1.0)).with_({"fluid.viscosity": 2.0})
    solved, plain = [], motor_phases.at_own_phases

    def counted(*args):
        solved.append(args)
        return plain(*args)

    monkeypatch.setattr(motor_phases, "at_own_phases", counted)
    for new, end in ((5, 5), (3, 8)):
        told = []

        def stop(done, _, told=told, end=end):
            told.append(done)
            if done == end:
                raise KeyboardInterrupt

        solved.clear()
        with pytest.raises(KeyboardInterrupt):
            motors_of(thick, TORQUE, model="bem", level=LEVEL, workers=0, progress=stop)
        assert told == sorted(told)
        assert told[-1] == end
        assert len(solved) == new


def test_what_it_takes_is_known_before():
    """Two tails: thirteen numbers fitted twice over, and eight phases that judge."""
    two = ms.Swimmer.preset("several/two-tails")
    solves, unknowns = motor_phases.foreseen(two, "coarse")
    assert (solves, unknowns) == (34, 2448)


def test_tails_that_touch_at_some_phases_are_refused_with_them():
    near = swimmer([
        ms.HelicalTail(**SHORT, position=(0.0, y, 0.0)) for y in (0.13, -0.13)
    ])  # fmt: skip
    with pytest.raises(ms.MicroswimError, match=r"at phases .* rad tail\[1\].position.*touch"):
        motors_of(near, TORQUE, model="bem", level=LEVEL, workers=0)


def test_one_helix_turns_at_the_rate_at_which_its_gait_takes_the_torque():
    """The torque of a gait by boundary elements is its power over its rate."""
    robot = swimmer(ms.HelicalTail(**LONGER, phase=0.4), ms.Sphere(radius=0.5))
    times = np.linspace(0.0, 0.4, 5)
    found = ms.own_motors(robot, times, torque=1.2, model="bem", level="coarse", workers=0)
    rate = float(found.rate[0, 0])
    gait = robot.gait("bem", level="coarse").at_rate(rate)
    assert ms.summary(gait)["mean_power"] == pytest.approx(1.2 * rate, rel=5e-3)
    same = ms.trajectory(gait, times)
    assert np.allclose(found.position, same.position, atol=5e-3 * 0.5)
    assert found.attrs["model"] == "bem"
    assert len(found.attrs["velocity_error"]) == 6


@pytest.mark.slow
def test_two_tails_on_a_sphere_against_direct_solves():
    """Stated error and truth at phases of a fresh draw; equal torques keep half a turn.

    Harmonics end where the level itself is known no better: what turns the swimmer is small at
    some phases, and then missed by more of itself than its speed and the rates are.
    """
    body, level = ms.Sphere(radius=0.5), get_level("coarse")
    place = {"root": (-0.1, 0.3), "shape": LONGER}
    robot = swimmer(tails(1.0, 1.0, **place), body)
    motors = motors_of(robot, TORQUE, model="bem", level="coarse")
    rng = np.random.default_rng(11)
    worst = np.zeros(8)
    for phases in rng.uniform(0.0, 2.0 * np.pi, (6, 2)):
        known = turned(*directly(body, phases, level, **place), TORQUE)
        worst = np.maximum(worst, off(motors.turning(phases), known))
    stated = [motors.error[name] for name in ("us", "uq", "ur", "os", "oq", "or")]
    assert (worst < [*stated, *motors.error["rates"]]).all()
    assert worst[[0, 1, 2, 6, 7]].max() < 5e-3
    equal = ms.own_motors(
        robot, [0.0, 1.0], torque=1.0, phase=(0.0, np.pi), model="bem", level="coarse"
    )
    apart = (equal.phase[:, 1] - equal.phase[:, 0]).values
    assert abs(apart[1] - np.pi) < 5e-3 * float(equal.phase[1, 0])
