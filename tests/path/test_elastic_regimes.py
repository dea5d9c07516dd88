"""Robots that bend in a turning field: rigid limits, laws, the same in time."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.models.elastic.unsteady.frozen import judged
from microswim.models.elastic.unsteady.held_by_field import held_by_field
from microswim.models.elastic.unsteady.march import at_rest, marched
from microswim.models.elastic.unsteady.numbers import units_of
from microswim.numerics.rigid_motion import rotation_matrix

LAW = ms.Constant(normal=2.0, tangential=1.2, spin=True)
FIELD = ms.RotatingField(strength=1.0, frequency=0.1)
LEANING = replace(FIELD, cone=0.8)


def robot(tail, *, moment=(0.0, 0.6, 0.0), field=FIELD, **parts):
    return ms.Swimmer(
        body=ms.Sphere(radius=0.2), tail=tail, fluid=ms.Fluid(viscosity=1.0), coefficients=LAW,
        magnet=moment and ms.Magnet(moment=moment), field=field, **parts,
    )  # fmt: skip


def soft(bending=0.2, **more):
    own = {"length": 1.0, "radius": 0.02, "drive": "none"} | more
    return ms.ElasticTail(bending=bending, **own)


def wire(bending=0.3, **more):
    """A straight tail and a head magnetised along it."""
    return robot(soft(bending), **({"moment": (0.6, 0.0, 0.0), "field": LEANING} | more))


def screw():
    """A rigid helix of length 1."""
    arc = np.hypot(2.0 * np.pi * 0.08, 0.4)
    return ms.HelicalTail(
        length=0.4 / arc, radius=0.02, amplitude=0.08, wavelength=0.4, ramp=0.0, handedness="right"
    )


@pytest.mark.parametrize("field", [FIELD, replace(FIELD, cone=0.2)])
def test_a_stiff_screw_is_held_as_a_rigid_one(field):
    tail = soft(1e4, rest_radius=0.08, rest_pitch=0.4)
    stiff = robot(tail, field=field, moment=(0.45, 0.45, 0.1))
    ours = ms.regimes(stiff, [0.03])
    rigid = ms.regimes(replace(stiff, tail=screw()), [0.03], model="rft")
    np.testing.assert_allclose(ours.precession_angle, rigid.precession_angle, rtol=1e-4)
    np.testing.assert_allclose(ours.velocity, rigid.velocity, rtol=1e-3)
    assert ours.regime == rigid.regime != ("stepped out",)
    assert "step-out lies beyond" in ours.remarks[-1]


@pytest.mark.slow
def test_a_stiff_screw_steps_out_as_a_rigid_one():
    tail = soft(1e4, rest_radius=0.08, rest_pitch=0.4)
    stiff = robot(tail, moment=(0.45, 0.45, 0.1))
    rigid = replace(stiff, tail=ms.CustomTail(
        shape=lambda s, phase: _helix(s, phase), length=1.0, radius=0.02
    ))  # fmt: skip
    truth = ms.regimes(rigid, [0.03], model="rft").step_out
    found = ms.regimes(stiff, [0.5 * truth, 2.0 * truth])
    assert found.regime[-1] == "stepped out"
    assert found.step_out == pytest.approx(truth, rel=0.01)


def _helix(s, phase):
    turn = s / np.hypot(0.08, 0.4 / (2.0 * np.pi))
    none = 0.0 * phase
    return np.stack(
        [0.4 * turn / (2.0 * np.pi) + none, 0.08 * np.cos(turn) + none, 0.08 * np.sin(turn) + none],
        axis=-1,
    )


def test_a_straight_robot_swims_alike_in_either_sense():
    """It has no hand: what pushes it is that its tail lags behind."""
    frequency = 0.3
    found, other = (
        ms.regimes(wire(field=replace(LEANING, frequency=sense)), [frequency])
        for sense in (1.0, -1.0)
    )
    assert found.velocity[0] < -1e-4  # the head leads, its pole points back along the axis
    np.testing.assert_allclose(other.velocity, found.velocity, rtol=1e-6)
    np.testing.assert_allclose(other.precession_angle, found.precession_angle, rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("one", "frequency", "cone"), [
    (wire(), 0.3, 0.8),
    (robot(soft(magnet=(0.3, 0.4, 0.0), magnet_span=(0.0, 0.3)), moment=None), 0.05, 0.3),
])  # fmt: skip
def test_it_settles_in_time_to_what_holds_it(one, frequency, cone):
    one = replace(one, field=replace(FIELD, frequency=frequency, cone=cone))
    held = ms.regimes(one, [frequency]).velocity[0]
    path = ms.path(one, 10.0 / frequency, samples=11, tolerance=1e-6)
    way = path.position.values[-1, 0] - path.position.values[-2, 0]
    assert way * frequency == pytest.approx(held, rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(("bending", "periods"), [(0.2, 14), (0.05, 8)])
def test_a_soft_screw_stays_in_time_where_it_is_held(bending, periods):
    """From that attitude on, straightened to its shape at rest."""
    one = robot(soft(bending, rest_radius=0.04, rest_pitch=0.5), moment=(0.1, 2.0, 0.0))
    one = replace(one, field=replace(FIELD, frequency=0.02))
    held, units = held_by_field(one), units_of(one)
    start = at_rest(one, np.zeros(3), held.quaternion, 0.0)
    shapes = marched(one, start, 50.0 * np.array([0.0, periods, periods + 1]), 1e-5).shapes
    way = 0.02 * (shapes[-1].position - shapes[-2].position)[0]
    assert way == pytest.approx(held.along * units.length / units.time, rel=5e-3)


def test_a_state_that_does_not_last_is_no_step_out():
    """Soft, it stands up across the axis first, where it does not stay; it is held as a stiff one
    is, nearer to the axis.
    """
    angles = []
    for bending in (1e3, 2.0, 0.2):
        tail = soft(bending, rest_radius=0.04, rest_pitch=0.5)
        found = ms.regimes(robot(tail, moment=(0.1, 2.0, 0.0)), [0.02])
        assert found.regime[0] in ("wobbling", "synchronous")
        angles.append(found.precession_angle[0])
    assert angles[0] > angles[1] > angles[2] > 0.05


@pytest.mark.parametrize(("change", "sentence"), [
    ({"tail": soft(drive="heave", amplitude=0.1)}, "tail.drive"),
    ({"magnet": None}, "magnet, tail.magnet: missing"),
    ({"field": ms.UniformField(strength=1.0)}, "rotating"),
    ({"motion": ms.Motion(free=["us", "os"])}, "motion.free"),
])  # fmt: skip
def test_what_a_field_cannot_turn_is_refused(change, sentence):
    with pytest.raises(ms.SpecError, match=sentence):
        ms.regimes(replace(wire(), **change), [0.3])


def test_a_rod_magnetised_along_itself_goes_round_with_a_leaning_field():
    """Nothing holds it about its own axis: no step-out, and a word on it."""
    rod = ms.Swimmer(
        body=ms.Capsule(length=1.0, radius=0.1), tail=ms.NoTail(), fluid=ms.Fluid(viscosity=1.0),
        magnet=ms.Magnet(moment=(1.0, 0.0, 0.0)), field=LEANING,
    )  # fmt: skip
    assert ms.summary(rod.gait())["swimming_speed"] == 0.0
    assert "spins at a rate of its own" in ms.regimes(rod, [0.01]).remarks[-1]


def test_no_gait_of_another_model_holds_it():
    with pytest.raises(ms.SpecError, match="model"):
        ms.regimes(wire(), [0.3], model="fem")
    assert "step_out" not in ms.summary(wire().gait())


def test_the_frozen_shape_swims_as_the_one_that_bends():
    """By local drag along a given motion, whose sums know nothing of strains; the spin of the wire
    about its own line is the body's, its sections' own left out (a thousandth).
    """
    for one, frequency in ((wire(), 0.3), (robot(soft(rest_radius=0.08, rest_pitch=0.4)), 0.03)):
        at = replace(one, field=replace(one.field, frequency=frequency))
        held = held_by_field(at)
        units = units_of(at)
        own = held.along * units.length / units.time
        assert judged(at, held, "rft").velocity == pytest.approx(own, rel=1e-6)


def test_boundary_elements_judge_how_a_field_turns_it():
    """A stiff screw as the rigid helix by its mobility, which is another mesh and other algebra."""
    stiff = robot(soft(1e4, rest_radius=0.08, rest_pitch=0.4), moment=(0.45, 0.45, 0.1))
    ours = ms.regimes(stiff, [0.03], model="bem", level="coarse")
    at = replace(stiff, field=replace(FIELD, frequency=0.03))
    held = held_by_field(at)
    R = replace(stiff, tail=screw()).gait("bem", level="coarse").resistance(0.0)
    M, Q = np.linalg.inv(R), rotation_matrix(held.quaternion)
    spin = Q.T @ [2.0 * np.pi * 0.03, 0.0, 0.0]
    torque = np.linalg.solve(M[3:, 3:], spin)
    v = Q @ M[:3, 3:] @ torque
    assert ours.velocity[0] == pytest.approx(v[0], abs=5e-3 * np.abs(v).max())
    own = judged(at, held, "rft").torque
    found = judged(at, held, "bem", level="coarse").torque
    np.testing.assert_allclose(found, -torque, atol=0.02 * np.abs(torque).max())
    share = found @ own / (own @ own)
    assert ours.expected_error["step_out"] == pytest.approx(abs(1.0 / share - 1.0), rel=1e-6)
    assert f"{share:.2f} times its torque" in ours.expected_error["how"]
    assert ours.model == "bem"
