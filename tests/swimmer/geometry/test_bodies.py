"""Resistance of isolated bodies against closed forms and limits that share no code with them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import microswim as ms

lengths = st.floats(0.05, 20.0)


def perrin_prolate(a, b):
    """Drag along, across, torque along, across: Happel & Brenner, and Perrin, by logs."""
    e = np.sqrt(1 - (b / a) ** 2)
    log = np.log((1 + e) / (1 - e))
    along = 16 * np.pi * a * e**3 / ((1 + e**2) * log - 2 * e)
    across = 32 * np.pi * a * e**3 / (2 * e + (3 * e**2 - 1) * log)
    roll = 32 / 3 * np.pi * a * b**2 * e**3 / (2 * e - (1 - e**2) * log)
    turn = 32 / 3 * np.pi * a**3 * e**3 * (2 - e**2) / (-2 * e + (1 + e**2) * log)
    return along, across, across, roll, turn, turn


@pytest.mark.parametrize("ratio", [1.05, 2.0, 5.0, 30.0])
def test_prolate_spheroid_is_perrins(ratio):
    R = ms.Spheroid(semi_axes=(0.7 * ratio, 0.7)).resistance(1.3)
    assert np.diag(R) == pytest.approx(1.3 * np.array(perrin_prolate(0.7 * ratio, 0.7)), rel=1e-10)


def test_sphere_is_stokes_and_the_limit_of_the_ellipsoid():
    sphere = np.diag(ms.Sphere(radius=0.5).resistance(100.0))
    # Table 1 of the paper: 942.5 and 314.2
    assert sphere[0] == pytest.approx(942.5, abs=0.05)
    assert sphere[3] == pytest.approx(314.2, abs=0.05)
    almost = np.diag(ms.Ellipsoid(semi_axes=(0.5, 0.5 + 1e-7, 0.5)).resistance(100.0))
    assert almost == pytest.approx(sphere, rel=1e-6)


def test_flat_disk_limit():
    """A disk of radius 1 (Lamb): 16 broadside, 32/3 edgewise, 32/3 about any axis."""
    R = np.diag(ms.Spheroid(semi_axes=(1e-6, 1.0)).resistance(1.0))
    assert pytest.approx([16, 32 / 3, 32 / 3, 32 / 3, 32 / 3, 32 / 3], rel=1e-5) == R


@given(lengths, lengths, lengths)
def test_axes_can_be_renamed(a, b, c):
    one = np.diag(ms.Ellipsoid(semi_axes=(a, b, c)).resistance(1.0))
    other = np.diag(ms.Ellipsoid(semi_axes=(c, a, b)).resistance(1.0))
    assert one[[2, 0, 1, 5, 3, 4]] == pytest.approx(other, rel=1e-9)
    assert (one > 0).all()


def test_slender_formulas_approach_the_exact_ones():
    """Eqs. (18), (19): the error falls about as (r_q/r_s)^2 (times a logarithm)."""
    errors = []
    for ratio in (10.0, 20.0, 40.0):
        exact = np.diag(ms.Spheroid(semi_axes=(ratio, 1.0)).resistance(1.0))
        slender = np.diag(ms.Spheroid(semi_axes=(ratio, 1.0), drag="slender").resistance(1.0))
        errors.append(np.abs(slender / exact - 1))
    order = np.log2(errors[0] / errors[1]), np.log2(errors[1] / errors[2])
    assert (np.array(order) > 1.5).all()
    assert (errors[2] < 4e-3).all()


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: ms.Sphere(radius=-1.0), "body.radius = -1.0"),
        (lambda: ms.Sphere(radius=float("nan")), "body.radius"),
        (lambda: ms.Spheroid(semi_axes=(1.0,)), "body.semi_axes"),
        (lambda: ms.Spheroid(semi_axes=(1.0, 2.0), drag="slender"), "prolate"),
        (lambda: ms.Ellipsoid(semi_axes=(1.0, 2.0, 0.0)), "body.semi_axes"),
    ],
)
def test_senseless_bodies_are_refused(make, field):
    with pytest.raises(ms.SpecError, match=field):
        make()
