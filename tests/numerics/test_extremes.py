"""Amplitudes of many series at once, against those of each and against a fine grid."""

import numpy as np
import pytest

from microswim.numerics.compiling.compiled import settled
from microswim.numerics.series.extremes import half_range
from microswim.numerics.series.fourier import evaluate

RNG = np.random.default_rng(5)
#: Harmonics that decay as those of a twist do; a constant; nothing.
SERIES = RNG.normal(size=(31, 40, 6)) * 0.5 ** (np.arange(31) / 2.0)[:, None, None]
SERIES[1:, 0] = 0.0
SERIES[:, 1] = 0.0


@pytest.mark.parametrize("compile_it", [False, True])
def test_half_range_is_that_of_a_fine_grid(compile_it):
    fine = evaluate(SERIES, 2.0 * np.pi * np.arange(200_000) / 200_000)
    with settled(compile_it):
        found = half_range(SERIES)
    assert found == pytest.approx((fine.max(axis=0) - fine.min(axis=0)) / 2.0, abs=2e-8)
    assert not found[:2].any()


def test_half_range_is_the_same_compiled_and_as_python():
    with settled(True):
        compiled = half_range(SERIES)
    with settled(False):
        assert compiled == pytest.approx(half_range(SERIES), rel=1e-13)
