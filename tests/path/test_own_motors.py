"""Motors that give a torque: closed forms of one tail, energy, symmetry, and phases that lock."""

import numpy as np
import pytest

import microswim as ms
from microswim.path.own_motors import motors_of

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
        torque = motors.torque * (1.0 - rate / motors.no_load)
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
