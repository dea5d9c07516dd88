"""The kernel of what is interpolated: by its own series of the exponential, as by NumPy's."""

from __future__ import annotations

import numpy as np
import pytest

from microswim.numerics.matern import matern, matern_of_arrays


@pytest.mark.parametrize("r", [0.0, 1e-9, 1e-3, 0.07, 0.4, 1.3, 3.0, 7.0, 12.0, 17.8])
def test_the_series_is_the_exponential(r):
    assert matern(r * r) == pytest.approx(matern_of_arrays(np.array([r * r]))[0], abs=2e-14)


def test_far_away_nothing_is_left_and_nan_stays_nan():
    assert 0.0 <= matern(1e12) < 1e-14
    assert np.isnan(matern(np.nan))


def test_a_complex_step_is_its_derivative():
    """``dM/d(r^2) = -5/6 (1 + q) exp(-q)``, from the closed form."""
    q = np.sqrt(5.0 * 0.6)
    slope = np.imag(matern(complex(0.6, 1e-30))) / 1e-30
    assert slope == pytest.approx(-5.0 / 6.0 * (1.0 + q) * np.exp(-q), rel=1e-12)
