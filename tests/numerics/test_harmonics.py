"""Sums of harmonics of several phases, at phases that fill the torus."""

import numpy as np
import pytest

from microswim.numerics.series.harmonics import Harmonics, fitted, harmonics, phases


@pytest.mark.parametrize(("n", "degree", "count"), [(1, 3, 3), (2, 2, 6), (3, 2, 12), (4, 1, 4)])
def test_one_of_each_pair_of_harmonics_up_to_the_degree(n, degree, count):
    h = harmonics(n, degree)
    assert len(h) == count
    assert np.abs(h).sum(axis=1).max() == degree
    assert len({tuple(x) for x in np.concatenate([h, -h])}) == 2 * count


@pytest.mark.parametrize("n", [1, 2, 3])
def test_a_sum_up_to_the_degree_is_found_and_met_anywhere(n):
    rng = np.random.default_rng(n)
    h = harmonics(n, 3)
    known = Harmonics(h, rng.normal(size=(1 + 2 * len(h), 4)))
    where = phases(2 * (1 + 2 * len(h)), n)
    found = fitted(where, np.array([known.at(p) for p in where]), 3)
    for phase in rng.uniform(-9.0, 9.0, (5, n)):
        assert found.at(phase) == pytest.approx(known.at(phase), abs=1e-11)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_phases_fill_the_torus(n):
    """Harmonics average out; more phases add to those before."""
    where = phases(200, n)
    assert np.array_equal(where[120:], phases(80, n, start=120))
    assert np.abs(np.exp(1j * where @ harmonics(n, 2).T).mean(axis=0)).max() < 0.08
