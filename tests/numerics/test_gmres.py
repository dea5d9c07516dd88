"""GMRES for several right-hand sides against a direct solve."""

import numpy as np
import pytest

from microswim.numerics.gmres import gmres


def test_every_column_is_solved_to_the_tolerance():
    rng = np.random.default_rng(3)
    n = 60
    A = np.eye(n) + 0.3 * rng.standard_normal((n, n)) / np.sqrt(n)
    b = rng.standard_normal((n, 5)) * [1.0, 1e-12, 1e9, 1.0, 0.0]
    b[:, 3] = np.eye(n)[0]
    x, steps, left = gmres(lambda v: A @ v, b, 1e-10, 50)
    known = np.linalg.solve(A, b)
    size = np.linalg.norm(known, axis=0)
    assert (np.linalg.norm(x - known, axis=0) <= 1e-9 * size).all()
    assert left <= 1e-10
    assert steps < 40


def test_it_ends_exactly_where_the_krylov_space_does():
    """Columns with small invariant spaces are solved in as many steps, without 0/0."""
    A = np.diag([1.0, 2.0, 2.0, 5.0])
    b = np.array([[1.0, 1, 0], [0, 1, 0], [0, 0, 1], [0, 1, 0]])
    x, steps, left = gmres(lambda v: A @ v, b, 1e-12, 10)
    assert x == pytest.approx(np.linalg.solve(A, b), abs=1e-12)
    assert steps == 3
    assert left < 1e-12


def test_the_residual_that_is_left_is_told():
    A = np.diag(np.arange(1.0, 31.0))
    b = np.ones((30, 1))
    x, steps, left = gmres(lambda v: A @ v, b, 1e-12, 4)
    assert steps == 4
    assert left == pytest.approx(np.linalg.norm(b - A @ x) / np.linalg.norm(b), rel=1e-6)
