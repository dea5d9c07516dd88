"""Parabolas run along a path, against scipy's filter (another code of the same fit)."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from microswim.studies.identification import parabolas


@pytest.mark.parametrize("window", [5, 31, 255])
def test_they_are_the_filter_of_savitzky_and_golay(window: int) -> None:
    x = np.cumsum(np.random.default_rng(3).standard_normal((300, 2)), axis=0)
    smooth, v = parabolas.positions_and_velocities(x, window, 0.02)
    scale = np.abs(x).max()
    assert smooth == pytest.approx(savgol_filter(x, window, 2, axis=0), abs=1e-10 * scale)
    theirs = savgol_filter(x, window, 2, axis=0, deriv=1, delta=0.02)
    assert v == pytest.approx(theirs, abs=1e-9 * scale / 0.02)
    nearest = savgol_filter(x, window, 2, axis=0, mode="nearest")
    assert parabolas.middle(x, window) == pytest.approx(nearest, abs=1e-10 * scale)


def test_a_parabola_is_left_as_it_is() -> None:
    t = 0.1 * np.arange(40)
    x = np.stack([1.0 + t - t**2, 3.0 * t**2], axis=1)
    smooth, v = parabolas.positions_and_velocities(x, 11, 0.1)
    assert smooth == pytest.approx(x, abs=1e-12)
    assert v == pytest.approx(np.stack([1.0 - 2.0 * t, 6.0 * t], axis=1), abs=1e-11)
