"""The stepper whose state holds the shape of an elastic tail."""

import numpy as np
import pytest

import microswim as ms


def swimmer(**tail):
    own = {"length": 1.0, "radius": 0.02, "bending": 0.2} | tail
    return ms.Swimmer(
        body=ms.Sphere(radius=0.2), tail=ms.ElasticTail(**own), fluid=ms.Fluid(viscosity=1.0),
        magnet=ms.Magnet(moment=(0.0, 0.1, 0.0)),
    )  # fmt: skip


def test_steps_make_the_path():
    one = swimmer(drive="pivot", angle=0.5)
    stepper = ms.ElasticStepper(one, tolerance=1e-6)
    state = stepper.start()
    for _ in range(4):
        state = stepper.step(state, dt=0.2)
    path = ms.path(one, 0.8, memory=True, samples=5)
    np.testing.assert_allclose(state.position, path.position[-1], atol=1e-5)
    np.testing.assert_allclose(state.filament, path.filament[-1], atol=2e-4)
    assert state.work[0] == pytest.approx(float(path.motor_work[-1]), rel=1e-3)
    assert state.time == pytest.approx(0.8)


def test_a_tail_springs_back_when_the_motor_stops():
    """Its memory is in the state: bent, it goes on moving without a drive."""
    stepper = ms.ElasticStepper(swimmer(drive="pivot", angle=0.5))
    bent = stepper.step(stepper.start(), dt=0.3)
    later = stepper.step(bent, dt=0.5, motor_rate=0.0)
    strains = [np.abs(s.shape.strains).max() for s in (bent, later)]
    assert strains[1] < 0.7 * strains[0]
    assert later.phase == pytest.approx(bent.phase)
    assert later.work[1] > bent.work[1]


def test_inputs_turn_and_carry_it():
    stepper = ms.ElasticStepper(swimmer(drive="none"))
    start = stepper.start()
    carried = stepper.step(start, dt=0.5, flow=(0.1, 0.0, 0.2))
    np.testing.assert_allclose(carried.position, [0.05, 0.0, 0.1], atol=1e-7)
    turned = stepper.step(start, dt=0.5, field=(-1.0, 0.0, 0.0))
    assert turned.quaternion[3] > 1e-3  # the moment along y turns towards -x, about +z
    pushed = stepper.step(start, dt=0.5, force=(1.0, 0.0, 0.0))
    assert pushed.position[0] > 0.01
    np.testing.assert_array_equal(stepper.step(start, dt=0.5).position, start.position)


@pytest.mark.parametrize(("inputs", "sentence"), [
    ({"push": 1.0}, "motor_rate"),
    ({"field": (1.0, 2.0)}, "three finite numbers"),
    ({"motor_rate": "fast"}, "a finite number"),
])  # fmt: skip
def test_wrong_inputs_are_refused(inputs, sentence):
    stepper = ms.ElasticStepper(swimmer(drive="none"))
    with pytest.raises(ms.SpecError, match=sentence):
        stepper.step(stepper.start(), dt=0.1, **inputs)
    with pytest.raises(ms.SpecError, match="positive"):
        stepper.step(stepper.start(), dt=0.0)


def test_other_tails_have_the_other_stepper():
    with pytest.raises(ms.SpecError, match="Stepper"):
        ms.ElasticStepper(ms.Swimmer.preset("tabak/helix"))
