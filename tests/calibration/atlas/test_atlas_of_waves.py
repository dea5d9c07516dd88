"""Plane waves by the atlas: laws of a beat, many and one, the truth, and what it says of it."""

import warnings
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.atlas import campaign, coordinates, text
from microswim.calibration.atlas.atlas import shipped
from microswim.calibration.atlas.everywhere import everywhere
from microswim.calibration.atlas.expected import expected_error
from microswim.calibration.atlas.fit import fit
from microswim.calibration.region.fit import Solved
from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.models.rft.batch import expected_errors
from microswim.numerics.compiling.compiled import settled
from microswim.numerics.series.fourier import MIRROR_Q
from microswim.swimmer.fields import lifted

TAIL = ms.PlaneWaveTail(length=2.0, amplitude=0.1, waves=1.5, radius=0.04)
ROBOT = ms.Swimmer(body=ms.Sphere(radius=0.4), tail=TAIL, fluid=ms.Fluid(viscosity=100.0))
SPERM = ms.Swimmer(
    body=ms.Spheroid(semi_axes=(2.3, 1.6)),
    tail=ms.PlaneWaveTail(length=40.0, amplitude=4.0, waves=1.3, radius=0.4, ramp=0.3),
    fluid=ms.Fluid(viscosity=1.0),
)
EACH = pytest.mark.parametrize("swimmer", [ROBOT, SPERM], ids=["robot", "sperm"])
VALUES = {"tail.amplitude": np.array([0.06, 0.1, 0.14]), "body.radius": np.array([0.3, 3.0, 0.5])}


@EACH
def test_velocities_hold_what_the_atlas_promises(swimmer):
    """Boundary elements of these two designs, which no campaign has solved, lie within."""
    found, truth = swimmer.gait("auto"), swimmer.gait("bem")
    error = found.info["expected_error"]
    assert found.model == "atlas"
    off = abs(found.mean_velocity[0] - truth.mean_velocity[0])
    assert off <= error["us"] * abs(found.mean_velocity[0])
    for i in (1, 5):
        off = abs(found.velocity_amplitude[i] - truth.velocity_amplitude[i])
        assert off <= error[DEGREES_OF_FREEDOM[i]] * found.velocity_amplitude[i]
    assert error["ur"] == error["os"] == error["oq"] == 0.0
    assert np.abs(found.velocity(np.linspace(0.0, 6.0, 7))[:, 2:5]).max() < 1e-12 * found.rate


@EACH
def test_half_a_period_on_the_beat_is_its_mirror_image(swimmer):
    made = swimmer.gait("atlas")
    for phase in (0.3, 2.0):
        now, later = made.velocity(phase), made.velocity(phase + np.pi)
        assert np.allclose(later, now * MIRROR_Q, rtol=1e-9, atol=1e-12 * np.abs(now).max())


def test_shapes_count_and_not_sizes():
    """Ten times the size and a thousand times the viscosity: the same in lengths per period."""
    lengths = ("semi_axes[0]", "semi_axes[1]"), ("length", "amplitude", "radius")
    names = [f"{part}.{n}" for part, some in zip(("body", "tail"), lengths) for n in some]
    large = SPERM.with_({n: 10.0 * SPERM.numbers[n] for n in names} | {"fluid.viscosity": 1000.0})
    scale = np.array([10.0] * 3 + [1.0] * 3)
    small = SPERM.gait("atlas").velocity(0.3)
    assert np.allclose(large.gait("atlas").velocity(0.3), scale * small, rtol=1e-9, atol=1e-12)


def test_resistance_is_positive_definite_all_over_the_space():
    for x in campaign.drawn(64, seed=5):
        one = campaign.design(x, "plane_wave")
        if one is None or coordinates.outside(one):
            continue
        R, _, G, _ = (x[0] for x in shipped("plane_wave").matrices(one))
        assert np.allclose(R, np.swapaxes(R, 1, 2))
        assert np.linalg.eigvalsh(R).min() > 0
        assert np.all(G > 0)


def test_a_batch_is_its_gaits_and_nan_outside():
    many = everywhere(ROBOT)
    assert many is not None
    found, errors = ms.evaluate(many, VALUES), expected_errors(many, VALUES)
    assert np.isnan(found["mean_velocity"][1]).all()
    assert np.isnan(errors[1])
    for i in (0, 2):
        gait = ROBOT.with_({n: float(v[i]) for n, v in VALUES.items()}).gait("auto")
        assert found["mean_velocity"][i] == pytest.approx(gait.mean_velocity, rel=1e-7, abs=1e-12)
        for name in ("mean_power", "efficiency", "swimming_speed"):
            assert found[name][i] == pytest.approx(ms.summary(gait)[name], rel=1e-7)
        assert errors[i] == pytest.approx(gait.info["expected_error"]["us"], rel=1e-7)


def test_compiled_and_as_python_it_is_the_same():
    """To the rounding of sums whose terms are a million times the whole."""
    values = {
        "tail.amplitude": np.linspace(0.05, 0.2, 20),
        "body.radius": np.linspace(0.3, 0.5, 20),
    }
    with settled(False):
        python = ms.evaluate(everywhere(ROBOT), values)
    with settled(True):
        compiled = ms.evaluate(everywhere(ROBOT), values)
    for name, value in python.items():
        scale = np.abs(value).max()
        assert np.allclose(compiled[name], value, rtol=1e-7, atol=1e-8 * scale), name


@pytest.mark.parametrize("name", ["tail.amplitude", "tail.radius", "body.radius", "tail.ramp"])
def test_derivatives_by_complex_step(name):
    value, h = ROBOT.numbers[name], 2e-4 * ROBOT.numbers[name]

    def speed(v):
        return lifted(ROBOT, {name: v}).gait("atlas").mean_velocity[0]

    exact = np.imag(speed(value + 1e-30j)) / 1e-30
    slope = (speed(value + h) - speed(value - h)) / (2 * h)
    assert exact == pytest.approx(slope, rel=1e-3)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"tail.radius": 0.004}, "length along the filament"),
        ({"tail.waves": 10.0, "tail.radius": 0.01}, "waves"),
        ({"tail.sections": "perpendicular"}, "sections"),
        ({"tail.surface_motion": "bending"}, "surface_motion"),
    ],
)
def test_outside_is_refused_in_words_and_left_to_the_surrogate(changes, word):
    other = ROBOT.with_(changes)
    with pytest.raises(SpecError, match=word):
        other.gait("atlas")
    made = other.gait("auto")
    assert made.model == "rft"
    assert word in " ".join(made.info["remarks"])


def test_errors_of_the_surrogate_hold_the_truth():
    truth = ROBOT.gait("bem").mean_velocity[0]
    for law in (ms.Lighthill(), ms.GrayHancock(), ms.Cox()):
        one = replace(ROBOT, coefficients=law)
        found = one.gait("rft")
        error = expected_error(one, found)
        size = abs(found.mean_velocity[0])
        assert abs(found.mean_velocity[0] - truth) <= error["us"] * size
        assert error["ur"] == 0.0


def test_an_atlas_of_waves_is_fitted_kept_and_read():
    """Truth by another law: left-out errors are far below the difference of the laws."""
    solved = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for x in campaign.drawn(48, seed=2):
            x = np.clip(x, (0.3, 0.1, 1.0, 5.0, 0.9, 0.1), (0.9, 0.3, 2.5, 12.0, 1.5, 0.3))
            one = campaign.design(x, "plane_wave")
            solved.append(Solved(one, replace(one, coefficients=ms.Cox(tip=True)).gait("rft")))
        made = fit(solved, {"reference": "rft"})
    missed = made.misses.missed
    assert np.all(missed[:, 2] == 0.0)
    assert np.median(missed[:, 0]) < 0.2 * np.median(made.plain["lighthill"].missed[:, 0])
    again = text.unpack(text.pack(made))
    for s in solved[:3]:
        assert np.array_equal(again.matrices(s.swimmer)[0], made.matrices(s.swimmer)[0])


def test_designs_of_the_campaign_are_no_longer_than_it_can_solve():
    designs = map(partial(campaign.design, kind="plane_wave"), campaign.drawn(256))
    made = [s for s in designs if s is not None]
    assert len(made) > 100
    for s in made:
        arc = s.tail.length * s.tail.stretch(s.tail.amplitude * s.tail.wavenumber)
        assert arc / s.tail.radius < 1.01 * campaign.LONGEST["plane_wave"]
