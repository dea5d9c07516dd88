"""Motors that give a torque: closed forms of one tail, energy, symmetry, and phases that lock."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.path.motors import motors_of

WAVE = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}
TIMES = np.linspace(0.0, 3.0, 7)


def swimmer(tail, **more):
    return ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0), **more)


def pair():
    return [
        ms.HelicalTail(
            **WAVE, position=(-0.1, 0.3 * y, 0.0), direction=(1.0, 0.3 * y, 0.0),
            phase=0.0 if y > 0 else np.pi,
        )
        for y in (1.0, -1.0)
    ]  # fmt: skip


@pytest.mark.parametrize("free", ["all", "none"])
def test_one_helix_turns_at_the_rate_at_which_it_takes_the_torque(free):
    """The torque of a gait is its power over its rate; the path is that of the gait."""
    robot = swimmer(ms.HelicalTail(**WAVE, phase=0.4), motion=ms.Motion(free=free))
    found = ms.own_motors(robot, TIMES, torque=1.2)
    rate = float(found.rate[0, 0])
    assert found.rate.values == pytest.approx(rate, rel=1e-9)
    gait = robot.gait().at_rate(rate)
    assert ms.summary(gait)["mean_power"] == pytest.approx(1.2 * rate, rel=1e-9)
    same = ms.trajectory(gait, TIMES)
    assert np.allclose(found.position, same.position, atol=1e-6)
    assert np.allclose(found.quaternion, same.quaternion, atol=1e-6)
    assert np.allclose(found.phase[:, 0], 0.4 + rate * TIMES, atol=1e-6)


def test_the_work_of_the_motors_goes_into_the_fluid():
    """At any phases: ``sum tau w = V' R V + 2 V' F w + w' G w``, R and F of the tails apart."""
    tails = [
        *pair(),
        ms.PlaneWaveTail(**WAVE, position=(-0.5, 0.0, 0.5), direction=(0.0, 0.0, 1.0)),
    ]
    motors = motors_of(swimmer(tails), (1.0, -0.5, 2.0), (20.0, -10.0, 5e3))
    alone = [
        ms.Swimmer(body=ms.NoBody(), tail=t, fluid=ms.Fluid(viscosity=1.0)).gait() for t in tails
    ]
    rng = np.random.default_rng(3)
    for phases in rng.uniform(0.0, 2.0 * np.pi, (4, 3)):
        V, rate = motors.turning(phases)
        power = np.array(ms.Sphere(radius=0.5).diagonal(1.0)) @ V**2
        at_joint = np.concatenate([V[:3] + np.cross(V[3:], [0.5, 0.0, 0.0]), V[3:]])
        for tail, gait, phase, w in zip(tails, alone, phases, rate):
            own = phase - tail.ahead
            power += at_joint @ gait.resistance(own) @ at_joint + w * w * gait.activity(own)
            power += 2.0 * w * (at_joint @ gait.propulsion(own))
        torque = motors.law.torque * (1.0 - rate / motors.law.no_load)
        assert motors.given(rate) == pytest.approx(torque, rel=1e-12)
        assert torque @ rate == pytest.approx(power, rel=1e-10)


def test_equal_tails_across_stay_in_step():
    found = ms.own_motors(swimmer(pair()), TIMES, torque=1.2)
    assert np.allclose(found.phase[:, 1] - found.phase[:, 0], np.pi, atol=1e-7)
    assert np.allclose(found.rate[:, 0], found.rate[:, 1], rtol=1e-6)
    assert np.allclose(found.velocity[:, [1, 2, 4, 5]], 0.0, atol=1e-8)
    turned = 0.5 * (found.phase[-1] - found.phase[0]).values.sum()
    slowest, fastest = float(found.rate.min()), float(found.rate.max())
    assert slowest * 0.99 < turned / TIMES[-1] < fastest * 1.01


def test_a_motor_weakens_towards_its_rate_without_load():
    robot = swimmer(ms.HelicalTail(**WAVE), motion=ms.Motion(free="none"))
    G = float(robot.gait().activity(0.0))
    for W in (3.0, 30.0, 3e6):
        found = ms.own_motors(robot, TIMES, torque=1.2, no_load=W)
        assert float(found.rate[-1, 0]) == pytest.approx(1.2 / (G + 1.2 / W), rel=1e-9)
        assert float(found.torque[-1, 0]) == pytest.approx(G * float(found.rate[-1, 0]), rel=1e-9)


def test_beyond_the_knee_a_motor_weakens_and_before_it_does_not():
    """Held, one helix takes ``G w``: the rate is where that line meets plateau or slope."""
    G = float(swimmer(ms.HelicalTail(**WAVE), motion=ms.Motion(free="none")).gait().activity(0.0))
    T, K, W = 1.2, 4.0, 9.0
    for thick in (0.1, 0.5, 1.0, 3.0):
        robot = swimmer(ms.HelicalTail(**WAVE), motion=ms.Motion(free="none"))
        robot = robot.with_({"fluid.viscosity": thick})
        drag = thick * G
        slow = T / drag
        expected = slow if slow < K else T * W / (drag * (W - K) + T)
        rate = float(ms.own_motors(robot, TIMES, torque=T, no_load=W, knee=K).rate[0, 0])
        assert rate == pytest.approx(expected, rel=1e-9)
        turn = 2.0 * np.pi
        said = ms.Motor(torque=T, no_load_frequency=W / turn, knee_frequency=K / turn)
        same = ms.own_motors(replace(robot, motor=said), TIMES)
        assert float(same.rate[0, 0]) == pytest.approx(expected, rel=1e-9)


def test_a_path_by_torque_is_that_of_its_motors_and_takes_its_start():
    robot = replace(swimmer(pair()), motor=ms.Motor(torque=(1.2, -0.7)))
    found = ms.path(robot, 3.0, samples=7, position=(1.0, 2.0, 3.0), tilt=0.4, tolerance=1e-8)
    bare = ms.own_motors(robot, np.linspace(0.0, 3.0, 7))
    assert found.phase.values == pytest.approx(bare.phase.values, abs=1e-6)
    c, s = np.cos(0.4), np.sin(0.4)  # the nose, towards -x, goes down
    nosed = bare.position.values @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]).T
    assert found.position.values - (1.0, 2.0, 3.0) == pytest.approx(nosed, abs=1e-6)
    assert found.attrs["position_error"] < 1e-4
    work = np.trapezoid((bare.torque * bare.rate).sum("tail"), bare.time)
    assert float(found.motor_work[-1]) == pytest.approx(work, rel=0.02)


def test_a_path_by_torque_that_was_stopped_goes_on_to_the_same_numbers(tmp_path):
    robot = replace(swimmer(pair()), motor=ms.Motor(torque=(1.2, -0.7)))
    asked = {"time": 1.0, "samples": 9}
    whole = ms.path(robot, **asked)

    def stop(done, _):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ms.path(robot, **asked, keep=tmp_path / "kept.npz", progress=stop)
    done = []
    rest = ms.path(robot, **asked, keep=tmp_path / "kept.npz", progress=lambda n, _: done.append(n))
    assert done == [4, 5, 6, 7, 8]
    assert rest.equals(whole)
    with pytest.raises(ms.SpecError, match="another path"):
        ms.path(robot.with_({"fluid.viscosity": 2.0}), **asked, keep=tmp_path / "kept.npz")


def test_motors_that_are_reversed_on_the_way_lead_back_along_it():
    robot = replace(swimmer(pair()), motor=ms.Motor(torque=(1.2, -0.7)))
    there = ms.path(robot, 0.5, samples=3, tolerance=1e-8)
    phases = {f"tail[{n}].phase": float(there.phase[-1, n]) for n in range(2)}
    turned = replace(robot.with_(phases), motor=ms.Motor(torque=(-1.2, 0.7)))
    pose = {"position": there.position[-1].values, "quaternion": there.quaternion[-1].values}
    back = ms.path(turned, 0.5, samples=3, tolerance=1e-8, **pose)
    assert back.position.values[::-1] == pytest.approx(there.position.values, abs=1e-6)
    assert back.phase.values[-1] - back.phase.values[0] == pytest.approx(
        there.phase.values[0] - there.phase.values[-1], abs=1e-6
    )


def test_a_path_of_too_many_turns_is_refused_at_once():
    robot = replace(swimmer(pair()), motor=ms.Motor(torque=1.0))
    with pytest.raises(ms.SpecError, match="turns of the motors"):
        ms.path(robot, 1e9)


def test_a_motor_goes_through_the_file_and_set(tmp_path):
    robot = replace(swimmer(pair()), motor=ms.Motor(torque=(1.2, -0.7), no_load_frequency=3.0))
    spec = tmp_path / "two.toml"
    spec.write_text(robot.to_toml())
    assert ms.Swimmer.from_toml(spec) == robot
    other = ms.Swimmer.from_toml(spec, {"motor.torque": 2.0, "motor.knee_frequency": 1.5})
    assert other.motor == ms.Motor(torque=2.0, no_load_frequency=3.0, knee_frequency=1.5)
    assert any("motor" in remark for remark in other.remarks)


@pytest.mark.parametrize(
    ("motor", "match"),
    [
        ({"torque": 0.0}, "other than zero"),
        ({"torque": (1.0, 2.0, 3.0)}, "one for each tail"),
        ({"torque": 1.0, "no_load_frequency": -1.0}, "above zero"),
        ({"torque": 1.0, "knee_frequency": 1.0}, "no_load_frequency"),
        ({"torque": 1.0, "no_load_frequency": 1.0, "knee_frequency": 2.0}, "knee_frequency"),
    ],
)
def test_a_motor_that_makes_no_sense_is_refused(motor, match):
    with pytest.raises(ms.SpecError, match=match):
        replace(swimmer(pair()), motor=ms.Motor(**motor))


def test_what_does_not_act_beside_torques_is_refused():
    robot = replace(swimmer(pair()), motor=ms.Motor(torque=1.0))
    for around in ({"flow": ms.ShearFlow(rate=1.0)}, {"noise": ms.Noise(temperature=1.0)}):
        with pytest.raises(ms.SpecError, match=next(iter(around))):
            ms.path(replace(robot, **around), 1.0)
    with pytest.raises(ms.SpecError, match="model"):
        ms.path(robot, 1.0, model="fem")
    with pytest.raises(ms.SpecError, match="force"):
        ms.path(robot, 1.0, force=(1.0, 0.0, 0.0))
    with pytest.raises(ms.SpecError, match="motor"):
        replace(robot, tail=ms.NoTail())


def test_beating_tails_fall_into_step_through_the_body():
    """Two plane waves drift apart, on average over their beats, towards half a period."""
    wave = {"length": 1.5, "amplitude": 0.15, "waves": 1, "radius": 0.03}
    tails = [
        ms.PlaneWaveTail(**wave, position=(-0.1, y, 0.0), direction=(1.0, 2.0 * y, 0.0))
        for y in (0.15, -0.15)
    ]
    robot = ms.Swimmer(body=ms.Sphere(radius=0.3), tail=tails, fluid=ms.Fluid(viscosity=1.0))
    found = ms.own_motors(robot, [0.0, 10.0, 20.0], torque=1.0, phase=(0.0, 0.5))
    apart = (found.phase[:, 1] - found.phase[:, 0]).values
    assert (np.diff(apart) > 0.03).all()
    assert apart[-1] < np.pi


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"torque": (1.0, 2.0, 3.0)}, "torque"),
        ({"torque": np.nan}, r"torque\[0\]"),
        ({"no_load": -1.0}, "no_load"),
        ({"phase": (0.0,)}, "phase"),
        ({"times": [0.0]}, "times"),
        ({"times": [1.0, 0.0]}, "times"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_sentence(change, match):
    with pytest.raises(ms.SpecError, match=match):
        ms.own_motors(swimmer(pair()), **{"times": TIMES, "torque": 1.0} | change)
    with pytest.raises(ms.SpecError, match="tail"):
        ms.own_motors(swimmer(ms.NoTail()), TIMES, torque=1.0)


@pytest.mark.parametrize("given", [{"step": 0.1}, {"contact": 0.1}, {"force": (0, 0, 1.0)}])
def test_what_does_not_act_beside_a_motor_is_refused(given):
    robot = replace(ms.Swimmer.preset("tabak/helix"), motor=ms.Motor(torque=1.0))
    with pytest.raises(ms.SpecError, match=f"{next(iter(given))}.*motor"):
        ms.path(robot, 1.0, **given)
