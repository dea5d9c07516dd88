"""Region calibration: exact at planted truth, definite, honest about its error and its limits."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region import kriging
from microswim.calibration.region import positive_definite as blocks
from microswim.calibration.region.correction import RegionWarning
from microswim.calibration.region.text import pack, unpack
from microswim.jobs import references
from microswim.models.rft.gait import gait as plain

HELIX = replace(
    ms.Swimmer.preset("tabak/helix"),
    coefficients=ms.Cox(),
    interaction=ms.Interaction(translation=(0.8, 1.3, 1.3), rotation=(1.1, 1.4, 1.4)),
)
WAVE = replace(HELIX, tail=ms.Swimmer.preset("tabak/plane_wave").tail)
REGION = {"tail.amplitude": (0.05, 0.15), "tail.waves": (1.0, 4.0), "body.radius": (0.4, 0.6)}


@pytest.fixture(scope="module")
def helix():
    return ms.calibrate_region(HELIX, REGION, "rft", solves=60, workers=0).swimmer


@pytest.fixture(scope="module")
def wave():
    return ms.calibrate_region(WAVE, REGION, "rft", solves=60, workers=0).swimmer


def designs(swimmer, count=12, seed=3):
    rng = np.random.default_rng(seed)
    return [
        swimmer.with_({k: float(rng.uniform(*v)) for k, v in REGION.items()}) for _ in range(count)
    ]


def surrogate(swimmer):
    """The reference: the plain surrogate under the law and coefficients that were solved."""
    own = {"coefficients": HELIX.coefficients, "interaction": HELIX.interaction}
    return plain(replace(swimmer, region=None, **own))


def velocities(gait):
    lateral = gait.velocity_amplitude
    return np.array([gait.mean_velocity[0], lateral[1], gait.mean_velocity[3], lateral[5]])


@pytest.mark.parametrize("kind", ["helix", "wave"])
def test_another_law_is_learnt_over_the_region(kind, request):
    """The reference is the surrogate under other coefficients, which no design was told."""
    fitted = request.getfixturevalue(kind)
    truth = np.array([velocities(surrogate(s)) for s in designs(fitted)])
    guess = np.array([velocities(s.gait()) for s in designs(fitted)])
    scale = np.abs(truth).max(axis=0) + 1e-300
    scale[0] = np.abs(truth[:, 0]).min()
    error = np.abs(guess - truth) / scale
    assert np.median(error, axis=0)[[0, 1]].max() < 0.005
    assert error[:, [0, 1]].max() < 0.05


@pytest.mark.parametrize("kind", ["helix", "wave"])
def test_the_expected_error_is_of_the_size_of_the_error(kind, request):
    """Root mean square of error over expected error, one if the expectation is right.

    Sixty designs tell it to some 30 %, as a few large errors weigh most.
    """
    fitted = request.getfixturevalue(kind)
    ratio = []
    for s in designs(fitted, 60, seed=8):
        gait, truth = s.gait(), surrogate(s).mean_velocity[0]
        ratio.append(abs(gait.mean_velocity[0] / truth - 1.0) / gait.info["expected_error"])
    assert 0.6 < np.sqrt(np.mean(np.square(ratio))) < 1.6


def test_designs_that_the_reference_refuses_are_replaced_and_reported(monkeypatch):
    """Steep ones are refused: as many designs as asked for, none of those, each with its reason."""

    def some(swimmers, *args, **options):
        return [
            "too steep" if s.tail.amplitude > 0.13 else g
            for s, g in zip(swimmers, solved(swimmers, *args, **options))
        ]

    solved = references.gaits
    monkeypatch.setattr(references, "gaits", some)
    fitted = ms.calibrate_region(HELIX, REGION, "rft", solves=24, workers=0).swimmer
    about = fitted.region.about
    assert about["solves"] == 24
    assert about["refused"]
    for design in about["refused"]:
        assert design["reason"] == "too steep"
        assert design["tail.amplitude"] > 0.13
    gait = fitted.with_({"tail.amplitude": 0.149}).gait()
    assert gait.info["expected_error"] > fitted.gait().info["expected_error"]


def test_a_spoilt_solve_is_set_aside_and_named(monkeypatch):
    """One of fifty solves pushes twice as hard as it should: it is left out, and only it."""
    spoilt = []

    def some(swimmers, *args, **options):
        gaits = solved(swimmers, *args, **options)
        if not spoilt:
            spoilt.append(swimmers[5].numbers)
            gaits[5] = replace(gaits[5], propulsion_series=2.0 * gaits[5].propulsion_series)
        return gaits

    solved = references.gaits
    monkeypatch.setattr(references, "gaits", some)
    fitted = ms.calibrate_region(HELIX, REGION, "rft", solves=50, workers=0).swimmer
    assert fitted.region.about["set_aside"] == [{name: spoilt[0][name] for name in REGION}]


def test_a_region_that_is_refused_says_why(monkeypatch):
    monkeypatch.setattr(references, "gaits", lambda s, *_, **__: ["too steep"] * len(s))
    with pytest.raises(ms.MicroswimError, match=r"only 0 designs .* too steep"):
        ms.calibrate_region(HELIX, REGION, "rft", solves=12, workers=0)


@pytest.mark.parametrize("kind", ["helix", "wave"])
def test_the_doubt_of_one_design_is_that_of_many(kind, request):
    fitted = request.getfixturevalue(kind)
    made, surfaces = fitted.region, fitted.region.surfaces
    for s in designs(fitted, 4):
        Z, N = made.inputs(s)
        assert surfaces.doubt_of_one(Z[0], N[0]) == pytest.approx(surfaces.doubt(Z, N)[0], rel=1e-6)


@pytest.mark.parametrize("kind", ["helix", "wave"])
def test_resistance_is_symmetric_and_positive_definite(kind, request):
    fitted = request.getfixturevalue(kind)
    phase = np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False)
    for s in designs(fitted, 4):
        R = s.gait().resistance(phase)
        size = np.abs(R).max()
        assert np.abs(R - np.swapaxes(R, 1, 2)).max() < 1e-12 * size
        assert np.linalg.eigvalsh(R).min() > 0


def test_corrections_can_be_wild_and_the_matrix_stays_definite():
    rng = np.random.default_rng(0)
    kinds = (
        (HELIX, 22, lambda *base: blocks.decode_helix(*base, 0.5, 100.0, 314.0)),
        (WAVE, 16, lambda *base: blocks.decode_wave(*base, 0.5, np.ones(4))),
    )
    for swimmer, columns, decode in kinds:
        before = [x[0] for x in shaded.base_of(swimmer, np.array([0.3]))]
        for _ in range(20):
            R, F, G = (x.copy() for x in before)
            decode(3.0 * rng.standard_normal(columns), R, F, G)
            d = np.sqrt(np.diag(R))
            assert np.abs(R - before[0]).max() > 0.1 * np.abs(before[0]).max()
            assert np.linalg.eigvalsh(R / np.outer(d, d))[0] > 0


def test_a_wave_is_coded_and_decoded_to_rounding():
    phase, scale = 0.7, np.array([1.0, 2.0, 3.0, 4.0])
    base = [x[0] for x in shaded.base_of(WAVE, np.array([phase]))]
    gait = surrogate(WAVE)
    truth = gait.resistance(phase), gait.propulsion(phase), gait.activity(phase)
    y = blocks.encode_wave(*truth, *base, 0.5, scale)
    G = blocks.decode_wave(y, *base, 0.5, scale)
    for back, right in zip((*base[:2], G), truth):
        assert np.allclose(back, right, rtol=1e-10, atol=1e-8 * np.abs(right).max())


def test_without_a_body_the_base_is_plain_resistive_force_theory_and_a_tip():
    """A body that is far smaller than its distance to the filament shades nothing.

    The tip feels half of Stokes' drag on a sphere of the filament's radius.
    """
    small = HELIX.with_({"body.radius": 1e-9, "tail.ramp": 0})
    R, F, G = (x[0] for x in shaded.base_of(small, np.array([0.4])))
    law = replace(small, coefficients=ms.GrayHancock(), interaction=ms.Interaction())
    bare = plain(law, nodes=60)
    half = 0.5 * ms.Sphere(radius=small.tail.radius).diagonal(100.0)[0]
    tip, _, velocity = small.tail.centreline(np.array(small.tail.apparent_length), np.array(0.4))
    arm = np.cross(np.eye(3), tip)  # e_j x X in row j
    carried = np.hstack([np.eye(3), arm.T])
    wrench = half * carried.T @ velocity
    assert pytest.approx(bare.propulsion(0.4) + wrench, rel=1e-6, abs=1e-6) == F
    assert pytest.approx(bare.activity(0.4) + half * velocity @ velocity, rel=1e-6) == G
    whole = bare.resistance(0.4) + half * carried.T @ carried
    assert pytest.approx(whole, rel=1e-4, abs=1e-4) == R


def test_mirror_image_swims_alike(helix):
    right = replace(helix, tail=replace(helix.tail, handedness="right"))
    left, mirrored = helix.gait(), right.gait()
    assert mirrored.mean_velocity[0] == pytest.approx(left.mean_velocity[0], rel=1e-12)
    assert mirrored.mean_velocity[3] == pytest.approx(-left.mean_velocity[3], rel=1e-12)
    mirror = np.array([1, 1, -1, -1, -1, 1])
    R = left.resistance(0.0) * np.outer(mirror, mirror)
    assert mirrored.resistance(0.0) == pytest.approx(R, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("kind", ["helix", "wave"])
def test_batch_and_single_evaluation_agree(kind, request):
    fitted = request.getfixturevalue(kind)
    amplitude = np.array([0.06, 0.1, 0.14])
    many = ms.evaluate(fitted, {"tail.amplitude": amplitude})
    for i, b in enumerate(amplitude):
        gait = fitted.with_({"tail.amplitude": float(b)}).gait()
        assert many["mean_velocity"][i] == pytest.approx(gait.mean_velocity, rel=1e-5, abs=1e-8)
        lateral = gait.velocity_amplitude
        assert many["velocity_amplitude"][i] == pytest.approx(lateral, rel=1e-3, abs=1e-8)
        assert many["mean_power"][i] == pytest.approx(gait.mean_power, rel=1e-4)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_efficiency_of_a_batch_is_that_of_the_gait_for_either_hand(hand, helix):
    """The body's share of the axial force turns its sign with the hand where it couples to spin."""
    one = helix.with_({"tail.handedness": hand})
    found = ms.evaluate(one, {"tail.amplitude": [0.1]})["efficiency"][0]
    gait = one.with_({"tail.amplitude": 0.1}).gait()
    assert found == pytest.approx(ms.summary(gait)["efficiency"], rel=1e-5)


@pytest.mark.parametrize("kind", ["helix", "wave"])
def test_a_sweep_prints_the_expected_error_of_every_design(kind, request):
    fitted = request.getfixturevalue(kind)
    name, low = next(iter(fitted.region.low.items()))
    high = fitted.region.high[name]
    values = [low, 0.6 * low + 0.4 * high, 1.2 * high]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = ms.sweep(fitted, {name: values})["expected_error"].values
        alone = [fitted.with_({name: v}).gait().info["expected_error"] for v in values]
    assert found[:2] == pytest.approx(alone[:2], rel=1e-6)
    assert np.isnan(found[2])
    assert np.isnan(alone[2])


def test_gradient_runs_through_the_correction(helix):
    d = helix.gradient("mean_velocity", "tail.amplitude")["tail.amplitude"][0]
    h, b = 1e-5, helix.tail.amplitude
    up, down = (helix.with_({"tail.amplitude": b + s * h}).gait().mean_velocity[0] for s in (1, -1))
    assert d == pytest.approx((up - down) / (2 * h), rel=1e-5)


def test_outside_is_said(helix):
    for change in ({"tail.amplitude": 0.2}, {"tail.radius": 0.04}):
        with pytest.warns(RegionWarning, match=next(iter(change))):
            gait = helix.with_(change).gait()
        assert np.isnan(gait.info["expected_error"])
    gait = helix.with_({"fluid.viscosity": 1.0, "tail.frequency": 3.0}).gait()
    assert gait.info["outside"] == []
    assert gait.mean_velocity[0] == pytest.approx(3 * helix.gait().mean_velocity[0], rel=1e-9)


def test_text_holds_the_correction_to_the_last_bit(helix, tmp_path):
    again = replace(helix, region=unpack(pack(helix.region)))
    assert np.array_equal(again.gait().mean_velocity, helix.gait().mean_velocity)
    assert again.gait().info == helix.gait().info
    with pytest.raises(ms.SpecError, match="calibrate again"):
        unpack(pack(helix.region)[:-400])


def test_left_out_residuals_are_those_of_refits():
    rng = np.random.default_rng(1)
    Z, N = rng.standard_normal((14, 2)), rng.uniform(1, 4, 14)
    y = np.sin(Z[:, :1]) + 1j * np.cos(Z[:, 1:]) * np.exp(-2j * np.pi * N)[:, None]
    whole = kriging.fit(Z, N, y, 1)
    residual, _ = whole.left_out()
    kernel = (whole.lengths, whole.phasors, False)
    for i in (0, 5, 13):
        keep = np.arange(14) != i
        K = kriging.covariance(Z[keep], N[keep], Z[keep], N[keep], *kernel)
        inverse = np.linalg.inv(K + whole.noise * np.eye(13))
        ones = inverse.sum(axis=0)
        mean = (ones @ y[keep]) / ones.sum()
        cross = kriging.covariance(Z[[i]], N[[i]], Z[keep], N[keep], *kernel)
        guess = mean + cross @ inverse @ (y[keep] - mean)
        assert y[i] - guess[0] == pytest.approx(residual[i], rel=1e-6, abs=1e-10)


def test_a_killed_run_keeps_what_it_had(tmp_path):
    swimmers = designs(HELIX, 5)
    first = references.gaits(swimmers[:3], "rft", folder=tmp_path, workers=0)
    files = {p: p.stat().st_mtime_ns for p in tmp_path.iterdir()}
    again = references.gaits(swimmers, "rft", folder=tmp_path, workers=0)
    assert {p: p.stat().st_mtime_ns for p in files} == files
    assert np.array_equal(again[0].resistance_series, first[0].resistance_series)
    next(iter(files)).write_bytes(b"half a file")
    assert all(
        not isinstance(g, str)
        for g in references.gaits(swimmers, "rft", folder=tmp_path, workers=0)
    )


def test_worker_processes_give_the_same(tmp_path):
    swimmers = designs(HELIX, 3)
    there = references.gaits(swimmers, "rft", workers=2)
    here = references.gaits(swimmers, "rft", workers=0)
    for a, b in zip(there, here):
        assert a.mean_velocity == pytest.approx(b.mean_velocity, rel=1e-12)


@pytest.mark.parametrize(
    ("region", "solves", "words"),
    [
        ({"tail.amplitude": (0.2, 0.1)}, 20, "lower one first"),
        ({"tail.frequency": (1.0, 2.0)}, 20, "decides the flow"),
        (
            {"wall.distance": (0.6, 2.0), "wall.tilt": (-0.5, 0.5)},
            20,
            r"--over wall\.distance=LOW:HIGH:N",
        ),
        ({"tail.amplitude": (0.1, 0.2)}, 2, "at least"),
    ],
)
def test_regions_that_make_no_sense(region, solves, words):
    with pytest.raises(ms.SpecError, match=words):
        ms.calibrate_region(HELIX, region, "rft", solves=solves, workers=0)


IGNORED = [
    {"interaction.translation": (2.0, 1.0, 1.0)},
    {"coefficients.spin": False},
    {"coefficients.tip": True},
]


@pytest.mark.parametrize("changes", IGNORED)
def test_what_a_region_does_not_heed_is_refused(changes, helix):
    with pytest.raises(ms.SpecError, match="take the place"):
        helix.with_(changes)
    with pytest.raises(ms.SpecError, match="take the place"):
        replace(helix, coefficients=ms.GrayHancock())
    with pytest.raises(ms.SpecError, match="do not heed"):
        ms.evaluate(helix, {"interaction.rotation[0]": [1.0, 2.0]})
    with pytest.raises(ms.SpecError, match="heeds no interaction"):
        ms.calibrate(helix, {"swimming_speed": 0.1}, ["translation.s"])


def test_noise_of_each_design_is_what_its_likelihood_says_and_a_noisy_one_counts_for_little():
    rng = np.random.default_rng(5)
    Z, N = np.linspace(-2.0, 2.0, 60)[:, None], np.zeros(60)
    truth = np.sin(2.0 * Z)
    off = np.where(np.arange(60) % 3 == 0, 1e-3, 0.0)
    y = truth + 300.0 * off[:, None] * rng.normal(size=truth.shape)
    known = Z, N, y, np.array([1.5]), np.zeros(3)
    even = kriging.conditioned(*known, 1e-6)
    assert np.allclose(even.alpha, kriging.conditioned(*known, np.full(60, 1e-6)).alpha)
    own = [1e-6 + (each * off) ** 2 for each in (0.0, 30.0, 300.0, 3000.0, 30000.0)]
    found = [kriging.likelihood(*known, noise) for noise in own]
    assert np.argmax(found) == 2
    made = kriging.conditioned(*known, own[2])
    between = np.linspace(-1.9, 1.9, 101)[:, None]

    def miss(process):
        return np.abs(process(between, np.zeros(101)) - np.sin(2.0 * between)).max()

    assert miss(made) < 0.02 < 0.2 < miss(even)
    # left out one by one, as with one noise for all
    rest = np.arange(60) != 31
    without = kriging.conditioned(Z[rest], N[rest], y[rest], *known[3:], own[2][rest])
    assert made.left_out()[0][31] == pytest.approx(y[31] - without(Z[[31]], N[[31]])[0], abs=1e-6)
