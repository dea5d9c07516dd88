"""What half a beat says, compiled, against the plain arrays of many designs and dense samples."""

import numpy as np
import pytest

from microswim.models.rft import batch_numbers, half_beats

PLANAR = ((0, 0), (1, 1), (5, 1))  # velocities, and whether their harmonics are odd


def twists(m, ratio=0.15, designs=40, decays=None):
    """Twists (n, m, 6) of random beats over half a period, whose harmonics die out."""
    rng, phase = np.random.default_rng(m), np.pi * np.arange(m) / m
    V = np.zeros((designs, m, 6))
    for i, odd in PLANAR:
        for h in range(odd, decays or m, 2):
            a, b = rng.normal(size=(2, designs, 1)) * ratio**h
            V[:, :, i] += a * np.cos(h * phase) + b * np.sin(h * phase)
    return V


@pytest.mark.parametrize("m", [16, 24, 32])
def test_compiled_they_are_those_of_arrays(m):
    V = twists(m)
    V[3] = 0.0
    found, arrays = half_beats.half_beats(V), batch_numbers.half_beats(V)
    assert found[0].all()
    assert arrays[0].all()
    for one, other in zip(found[1:], arrays[1:]):
        assert one == pytest.approx(other, rel=1e-12, abs=1e-13)


def test_amplitudes_are_half_of_peak_to_peak_of_dense_samples():
    V, m = twists(16, ratio=0.3, decays=8), 16
    h = np.arange(-m, m)
    phase = 2.0 * np.pi * np.arange(20_000) / 20_000
    amplitude = half_beats.half_beats(V)[2]
    for i, odd in PLANAR:
        period = np.concatenate([V[..., i], V[..., i] * (-1.0) ** odd], axis=1)
        terms = np.fft.fft(period, axis=1) / (2 * m)
        values = np.real(terms[:, h] @ np.exp(1j * h[:, None] * phase))
        assert amplitude[:, i] == pytest.approx(np.ptp(values, axis=1) / 2.0, rel=1e-6)


def test_a_beat_whose_harmonics_do_not_die_out_is_not_resolved():
    V = np.concatenate([twists(16, ratio=0.9), twists(16)])
    assert half_beats.half_beats(V)[0].tolist() == [False] * 40 + [True] * 40


def test_a_design_that_is_not_answered_is_not_resolved():
    V = twists(16)
    V[3] = np.nan
    for found in (half_beats.half_beats(np.tile(V, (100, 1, 1))), batch_numbers.half_beats(V)):
        assert not found[0][3]
        assert found[0][:3].all()
