"""The atlas: laws that hold whatever it was fitted to, the truth, and what it says of its error."""

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.atlas import campaign, coordinates, solves, text
from microswim.calibration.atlas.atlas import shipped
from microswim.calibration.atlas.choice import auto
from microswim.calibration.atlas.expected import expected_error
from microswim.calibration.atlas.fit import fit
from microswim.calibration.atlas.near import SHARE, Misses, measured, quantile
from microswim.calibration.region.fit import Solved
from microswim.errors import SpecError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.swimmer.fields import lifted

TAIL = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05)
ROBOT = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=TAIL, fluid=ms.Fluid(viscosity=100.0))
CELL = ms.Swimmer(
    body=ms.Spheroid(semi_axes=(1.0, 0.5)),
    tail=ms.HelicalTail(length=6.0, amplitude=0.2, wavelength=2.3, radius=0.03, ramp=0.2),
    fluid=ms.Fluid(viscosity=1.0),
)


@pytest.mark.parametrize("swimmer", [ROBOT, CELL], ids=["robot", "cell"])
def test_velocities_hold_what_the_atlas_promises(swimmer):
    """Boundary elements of these two designs, which no campaign has solved, lie within."""
    found, truth = swimmer.gait("atlas"), swimmer.gait("bem")
    error = expected_error(swimmer, found)
    for i in (0, 3):
        off = abs(found.mean_velocity[i] - truth.mean_velocity[i])
        assert off <= error[DEGREES_OF_FREEDOM[i]] * abs(found.mean_velocity[i])
    for i in (1, 5):
        off = abs(found.velocity_amplitude[i] - truth.velocity_amplitude[i])
        assert off <= error[DEGREES_OF_FREEDOM[i]] * found.velocity_amplitude[i]


@pytest.mark.parametrize("swimmer", [ROBOT, CELL], ids=["robot", "cell"])
def test_the_other_hand_is_the_mirror_image(swimmer):
    left = swimmer.gait("atlas")
    right = replace(swimmer, tail=replace(swimmer.tail, handedness="right")).gait("atlas")
    signs = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
    phase = 0.7
    both = np.outer(signs, signs)
    assert np.allclose(right.resistance(phase), left.resistance(phase) * both, atol=1e-9)
    assert np.allclose(right.propulsion(phase), left.propulsion(phase) * signs, atol=1e-9)
    assert np.allclose(right.body_wrench(phase), left.body_wrench(phase) * signs, atol=1e-9)


def test_shapes_count_and_not_sizes():
    """Ten times the size and a thousand times the viscosity: the same in lengths per period."""
    large = CELL.with_({"body.semi_axes[0]": 10.0, "body.semi_axes[1]": 5.0, "tail.length": 60.0})
    changes = {"tail.amplitude": 2.0, "tail.wavelength": 23.0, "tail.radius": 0.3}
    large = large.with_({**changes, "fluid.viscosity": 1000.0})
    scale = np.array([10.0] * 3 + [1.0] * 3)
    assert np.allclose(
        large.gait("atlas").velocity(0.3), scale * CELL.gait("atlas").velocity(0.3), rtol=1e-9
    )


def test_resistance_is_positive_definite_all_over_the_space():
    for x in campaign.drawn(64, seed=5):
        one = campaign.design(x)
        if one is None:
            continue
        (R,), _, (G,), extra = (x[0] for x in shipped().matrices(one))
        assert np.allclose(R, R.T)
        assert np.linalg.eigvalsh(R).min() > 0
        assert G > 0
        assert extra[0] > 0


def test_many_designs_side_by_side_are_those_one_by_one():
    values = {
        "tail.amplitude": np.array([0.06, 0.1, 0.14]),
        "body.radius": np.array([0.4, 0.5, 0.6]),
    }
    R, F, G, _ = shipped().matrices(lifted(ROBOT, values))
    for i in range(3):
        one = ROBOT.with_({name: float(v[i]) for name, v in values.items()})
        alone = shipped().matrices(one)
        for together, one in zip((R[i], F[i]), alone):  # sums of terms a million times the whole
            assert np.allclose(together, one[0], rtol=1e-8, atol=1e-8)
        assert G[i] == pytest.approx(alone[2][0])


@pytest.mark.parametrize("name", ["tail.amplitude", "tail.radius", "body.radius", "tail.ramp"])
def test_derivatives_by_complex_step(name):
    value, h = ROBOT.numbers[name], 2e-4  # far above the rounding of the sums

    def speed(v):
        return lifted(ROBOT, {name: v}).gait("atlas").mean_velocity[0]

    exact = np.imag(speed(value + 1e-30j)) / 1e-30
    slope = (speed(value + h) - speed(value - h)) / (2 * h)
    assert exact == pytest.approx(slope, rel=3e-4)


def test_drag_and_law_of_the_surrogate_do_not_count():
    slender = replace(CELL, body=ms.Spheroid(semi_axes=(1.0, 0.5), drag="slender"))
    other = replace(slender, coefficients=ms.Cox())
    assert np.array_equal(other.gait("atlas").velocity(0.0), CELL.gait("atlas").velocity(0.0))


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"tail.waves": 12.0, "tail.radius": 0.01}, "waves"),
        ({"body.radius": 5.0}, "body radius"),
        ({"tail.ramp": 0.0}, "ramp"),
    ],
)
def test_outside_is_refused_in_words_and_left_to_the_surrogate(changes, word):
    far = ROBOT.with_(changes)
    with pytest.raises(SpecError, match=word):
        far.gait("atlas")
    made = far.gait("auto")
    assert made.model == "rft"
    assert word in " ".join(made.info["remarks"])


def test_who_chooses_a_law_or_coefficients_gets_the_surrogate():
    chosen = (
        replace(ROBOT, coefficients=ms.Lighthill()),
        ROBOT.with_({"coefficients.spin": False}),
        ROBOT.with_({"interaction.translation[0]": 1.2}),
    )
    assert [s.gait("auto").model for s in (ROBOT, *chosen)] == ["atlas", "rft", "rft", "rft"]


def test_errors_of_the_surrogate_are_those_of_its_law():
    """The truth lies within, for coefficients of one's own too: the atlas is asked."""
    truth = ROBOT.gait("bem").mean_velocity
    for law in (ms.Lighthill(), ms.GrayHancock(), ms.Cox()):
        one = replace(ROBOT, coefficients=law)
        found = one.gait("rft")
        error = expected_error(one, found)
        assert abs(found.mean_velocity[0] - truth[0]) <= error["us"] * abs(found.mean_velocity[0])
    own = ROBOT.with_({"interaction.rotation[0]": 1.3}).gait("rft")
    off, size = np.abs(own.mean_velocity - truth), np.abs(own.mean_velocity)
    error = expected_error(ROBOT, own)
    assert off[0] <= error["us"] * size[0]
    assert off[3] <= error["os"] * size[3]


@pytest.mark.filterwarnings("error")
def test_a_tail_without_a_wave_is_not_said_to_be_known():
    straight = ROBOT.with_({"tail.amplitude": 0.0})
    error = straight.gait("auto").info["expected_error"]
    assert error["us"] is error["os"] is None


def test_boundary_elements_say_what_their_asymmetry_makes_of_a_velocity_that_cancels():
    """A filament on a head that is hardly thicker: its next order gives half the forward speed."""
    small = campaign.design([0.934, 0.027, 0.503, 2.18, 3.954, 0.433])
    assert small is not None
    found = small.gait("bem")
    error = expected_error(small, found)
    assert found.info["asymmetry"] > 1e-3
    assert error["us"] > 0.5
    assert "symmetry" in error["how"]
    assert expected_error(ROBOT, ROBOT.gait("bem"))["us"] == pytest.approx(0.002)
    wave = replace(ROBOT, tail=ms.PlaneWaveTail(length=2.0, amplitude=0.1, waves=1, radius=0.05))
    flat = expected_error(wave, wave.gait("bem", level="coarse"))
    assert max(flat[n] for n in DEGREES_OF_FREEDOM) < 0.05  # those that vanish are not off


def test_held_directions_have_no_error():
    held = replace(ROBOT, motion=ms.Motion(free=("us", "os")))
    error = expected_error(held, held.gait("auto"))
    assert error["uq"] == error["or"] == 0.0
    assert error["us"] > 0


def test_accuracy_takes_the_cheapest_that_holds_it():
    loose, tight = auto(ROBOT, 0.9), auto(ROBOT, 2e-3)
    assert loose.model == "atlas"
    assert (tight.model, tight.info["level"]) == ("bem", "standard")
    assert tight.info["expected_error"]["us"] <= 2e-3
    assert "atlas" in tight.info["remarks"][-1]
    with pytest.raises(SpecError, match="accuracy"):
        auto(ROBOT, 2.0)


def test_solves_in_a_file_come_back(tmp_path):
    """Of a design by its six numbers; what was refused, or cut off at the end, does not count."""
    x = [0.6, 0.2, 1.5, 5.0, 1.0, 0.1]
    swimmer = campaign.design(x)
    gait = swimmer.gait("bem", level="coarse")

    def pairs(name):
        return getattr(gait, f"{name}_series").astype(complex).view(float).ravel().tolist()

    line = {"i": 0, "x": x, "gait": {n: pairs(n) for n in solves.SERIES}, "asym": 1e-5}
    line["shape"] = [len(gait.resistance_series), True]
    refused = {"i": 1, "x": x, "why": "big head"}
    path = tmp_path / "solves.jsonl"
    path.write_text("\n".join([*map(json.dumps, (line, refused)), '{"i": 2, "x']), "utf-8")
    (found,) = solves.read(path, campaign.design)
    assert found.swimmer == swimmer
    assert np.allclose(found.gait.velocity(0.4), gait.velocity(0.4), rtol=1e-12)
    path.write_text("hello\n" + json.dumps(refused), "utf-8")
    with pytest.raises(SpecError, match="line 1 is no solve"):
        solves.read(path, campaign.design)


def test_quantile_is_that_of_the_weights():
    values = np.array([3.0, 1.0, 2.0, np.nan])
    assert quantile(values, np.array([0.0, 1.0, 0.0, 9.0]), 0.95) == 1.0
    assert quantile(values, np.ones(4), 0.6) == 2.0


def test_expected_error_follows_the_place_and_holds_its_share():
    """Errors with a heavy tail, ten times larger on one side, say so there."""
    rng = np.random.default_rng(3)
    spots = rng.uniform(-2.0, 2.0, (400, 3))
    size = np.where(spots[:, :1] > 0, 1.0, 0.1)
    missed = size * np.abs(rng.standard_t(2.0, (400, 4)))
    found = measured(spots, missed)
    assert np.all(np.abs(found.held() - SHARE) < 0.01)
    rough, smooth = found(np.array([[1.5, 0.0, 0.0], [-1.5, 0.0, 0.0]]))
    assert np.all(rough > 2.0 * smooth)


def test_expected_error_does_not_ask_the_design_itself():
    """One design off by far: its own error is not in what the others say of it."""
    spots = np.linspace(0.0, 1.0, 50)[:, None]
    missed = np.full((50, 4), 0.01)
    missed[20] = 5.0
    left = Misses(spots, missed, np.ones(4)).left_out()
    assert left[20, 0] == pytest.approx(0.01)


def test_errors_of_many_designs_are_those_one_by_one():
    misses, rng = shipped().misses, np.random.default_rng(1)
    z = misses.spots[rng.integers(0, len(misses.spots), 100)] + 0.1 * rng.normal(size=(100, 1))
    one = misses(z)
    for quantity in range(2):
        assert np.allclose(misses.of_many(z, quantity), one[:, quantity], rtol=1e-9)


def test_an_atlas_is_fitted_kept_and_read():
    """Truth by another law: left-out errors are far below the difference of the laws."""
    solved = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for x in campaign.drawn(64, seed=2):
            x = np.clip(x, (0.3, 0.1, 1.0, 5.0, 0.9, 0.1), (0.9, 0.3, 2.5, 12.0, 1.5, 0.3))
            one = campaign.design(x)
            truth = replace(one, coefficients=ms.GrayHancock(tip=True))
            solved.append(Solved(one, truth.gait("rft")))
        made = fit(solved[:48], {"reference": "rft"})
    missed = made.misses.missed
    assert np.median(missed[:, 0]) < 0.02
    assert np.median(missed[:, 0]) < 0.2 * np.median(made.plain["lighthill"].missed[:, 0])
    again = text.unpack(text.pack(made))
    for s in solved[48:52]:
        assert np.array_equal(again.matrices(s.swimmer)[0], made.matrices(s.swimmer)[0])
    assert again.about["solves"] == 48


def test_designs_of_the_campaign_fill_the_range():
    x = campaign.drawn(256)
    assert np.all(x >= np.array(campaign.LOW) * (1 - 1e-12))
    assert np.all(x <= np.array(campaign.HIGH) * (1 + 1e-12))
    inside = [s for s in map(campaign.design, x) if s is not None]
    assert len(inside) > 100
    numbers = np.array([coordinates.numbers(s) for s in inside])
    assert np.allclose(numbers[:, 2], [s.tail.waves for s in inside])


def test_elastic_tails_have_the_error_that_was_measured_for_their_like():
    def found(**changes):
        tail = ms.ElasticTail(length=1.0, radius=0.01, bending=0.5, drive="pivot", angle=0.5)
        swimmer = ms.Swimmer(body=ms.Sphere(radius=0.1), tail=tail, fluid=ms.Fluid(viscosity=1.0))
        return swimmer.with_(changes).gait("auto").info["expected_error"]

    assert found()["us"] == pytest.approx(0.85)
    assert found(**{"body.radius": 0.5})["us"] is None
    assert found(**{"tail.angle": 1.2})["us"] is None
    assert found(**{"tail.rest_radius": 0.03, "tail.rest_pitch": 0.8})["us"] == pytest.approx(2.6)
    assert found(**{"tail.rest_radius": 0.1, "tail.rest_pitch": 0.8})["us"] is None
    heave = {"tail.drive": "heave", "tail.angle": None}
    assert found(**heave, **{"tail.amplitude": 0.03})["us"] == pytest.approx(0.86)
    assert found(**heave, **{"tail.amplitude": 0.08})["us"] is None
