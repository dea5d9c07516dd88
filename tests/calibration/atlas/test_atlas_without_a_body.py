"""The atlas of tails without a body: laws, and boundary elements at designs of its own."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.atlas import alone, coordinates
from microswim.calibration.atlas.gait import gait as by_atlas
from microswim.numerics.series.fourier import MIRROR_R
from microswim.swimmer.fields import lifted

HELIX = ms.Swimmer(
    body=ms.NoBody(),
    tail=ms.HelicalTail(length=5.3, amplitude=0.35, waves=2.6, radius=0.05, frequency=1.5),
    fluid=ms.Fluid(viscosity=2.0),
)
TURNED = {"motion.free": ("us", "uq", "ur", "oq", "or")}
WAVE = replace(HELIX, tail=ms.PlaneWaveTail(length=5.0, amplitude=0.35, waves=2, radius=0.05))


def resistance(swimmer, model="atlas"):
    return np.real(swimmer.gait(model).resistance(0.0))


def matrices(seed):
    """Two positive definite matrices whose axial coupling is positive."""
    rng = np.random.default_rng(seed)
    for _ in range(2):
        A = rng.normal(size=(6, 6))
        A[0], A[3] = np.abs(A[0]), np.abs(A[3])
        yield A @ A.T + np.eye(6)


@pytest.mark.parametrize("seed", range(4))
def test_corrections_take_one_resistance_to_another(seed):
    R, R0 = matrices(seed)
    assert alone.decode(alone.encode(R, R0, 2.3), R0, 2.3) == pytest.approx(R, rel=1e-10)


def test_whatever_the_corrections_the_resistance_is_positive_definite():
    R0 = next(matrices(7))
    for y in np.random.default_rng(3).normal(scale=2.0, size=(50, alone.COLUMNS)):
        R = alone.decode(y, R0, 1.7)
        assert pytest.approx(R.T) == R
        np.linalg.cholesky(R)


@pytest.mark.parametrize("ramp", [0.0, 0.17])
@pytest.mark.parametrize("hand", ["left", "right"])
def test_boundary_elements_agree_as_it_says(hand, ramp):
    swimmer = HELIX.with_({"tail.handedness": hand, "tail.ramp": ramp, **TURNED})
    ours, truth = swimmer.gait("auto"), swimmer.gait("bem", level="coarse")
    assert ours.model == "atlas"
    stated = ours.info["expected_error"]["us"]
    assert 0.001 < stated < 0.05
    off = abs(ours.mean_velocity[0] / truth.mean_velocity[0] - 1.0)
    assert off < stated + 0.0035  # what level coarse itself may be off by
    assert ours.mean_torque == pytest.approx(truth.mean_torque, rel=0.02)
    law = replace(swimmer, coefficients=ms.Lighthill()).gait("rft")
    assert abs(law.mean_velocity[0] / truth.mean_velocity[0] - 1.0) > 3.0 * off


@pytest.mark.parametrize("ramp", [0.0, 0.2])
def test_boundary_elements_agree_as_it_says_of_a_beat(ramp):
    swimmer = WAVE.with_({"tail.ramp": ramp})
    ours, truth = swimmer.gait("auto"), swimmer.gait("bem", level="coarse")
    assert ours.model == "atlas"
    stated = ours.info["expected_error"]["us"]
    assert 0.001 < stated < 0.05
    off = abs(ours.mean_velocity[0] / truth.mean_velocity[0] - 1.0)
    assert off < stated + 0.0035
    scale = abs(ours.rate) * np.repeat([swimmer.tail.amplitude, 1.0], 3)
    assert np.abs(ours.velocity_amplitude - truth.velocity_amplitude).max() < 0.01 * scale.min()
    law = replace(swimmer, coefficients=ms.Lighthill()).gait("rft")
    assert abs(law.mean_velocity[0] / truth.mean_velocity[0] - 1.0) > 2.0 * off


def test_the_other_hand_is_the_mirror_image():
    other = HELIX.with_({"tail.handedness": "right"})
    mirrored = resistance(HELIX) * np.outer(MIRROR_R, MIRROR_R)
    assert resistance(other) == pytest.approx(mirrored, rel=1e-12, abs=1e-12)


def test_free_in_all_it_rests():
    """The motor turns the tail back as fast as it turns it: nothing is in doubt."""
    found = HELIX.gait("auto")
    assert found.mean_velocity == pytest.approx([0, 0, 0, -3 * np.pi, 0, 0], abs=1e-9)
    assert found.info["expected_error"]["us"] == found.info["expected_error"]["os"] == 0.0


def test_size_viscosity_and_rate_only_scale():
    lengths = np.array([1, 1, 1, 2, 2, 2])
    scale = 3.0 * 2.0 ** (lengths[:, None] + lengths - 1.0)
    for small in (HELIX, WAVE):
        sizes = {
            f"tail.{n}": 2.0 * getattr(small.tail, n) for n in ("length", "amplitude", "radius")
        }
        large = small.with_({**sizes, "fluid.viscosity": 6.0})
        assert resistance(large) == pytest.approx(resistance(small) * scale, rel=1e-11, abs=1e-9)


@pytest.mark.parametrize(("swimmer", "entry"), [(HELIX, (0, 3)), (WAVE, (0, 1))])
def test_its_derivatives_are_exact(swimmer, entry):
    step = 1e-30

    def drag(b):
        return by_atlas(lifted(swimmer, {"tail.amplitude": b})).resistance(0.7)[entry]

    slope = np.imag(drag(0.35 + 1j * step)) / step
    assert slope == pytest.approx((drag(0.3501) - drag(0.3499)) / 2e-4, rel=1e-5)


@pytest.mark.parametrize("swimmer", [HELIX.with_(TURNED), WAVE], ids=["helix", "wave"])
def test_a_sweep_holds_the_gait_of_every_design(swimmer):
    made = ms.sweep(swimmer, {"tail.amplitude": [0.2, 0.35], "tail.ramp": [0.0, 0.2]})
    for b in (0.2, 0.35):
        for ramp in (0.0, 0.2):
            one = swimmer.with_({"tail.amplitude": b, "tail.ramp": ramp}).gait("auto")
            row = made.sel({"tail.amplitude": b, "tail.ramp": ramp})
            assert row.mean_velocity.values == pytest.approx(one.mean_velocity, rel=1e-9, abs=1e-12)
            assert float(row.expected_error) == pytest.approx(one.info["expected_error"]["us"])


def test_what_it_does_not_cover_it_says():
    thin = HELIX.with_({"tail.radius": 0.001})
    assert "filament radius x wavenumber" in coordinates.outside(thin)[0]
    long = WAVE.with_({"tail.length": 30.0, "tail.waves": 6})
    assert "length along the filament" in coordinates.outside(long)[0]
