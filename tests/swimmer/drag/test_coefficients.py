"""Local resistance: Lighthill's integrals against other formulas, laws in their limits."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import sici

import microswim as ms
from microswim.numerics.compiling.compiled import settled
from microswim.swimmer.drag.lighthill import THIN, lighthill_integrals


@pytest.mark.parametrize("epsilon", [1e-3, 0.1, 0.5, 2.0])
def test_integrals_of_a_straight_filament(epsilon):
    """At alpha = 1 both integrals are cosine integrals."""
    A1, A2 = lighthill_integrals(1.0, epsilon)
    log = np.log(epsilon)
    assert pytest.approx(log + np.sin(epsilon) / epsilon - sici(epsilon)[1], abs=1e-11) == A1
    half = np.sin(epsilon) ** 2 / (2 * epsilon**2) + np.sin(2 * epsilon) / (2 * epsilon)
    assert pytest.approx(log + half - sici(2 * epsilon)[1], abs=1e-11) == A2


@pytest.mark.parametrize(("alpha", "epsilon"), [(0.73, 0.28), (0.3, 0.1), (0.15, 0.02), (0.9, 1.5)])
def test_integrals_against_direct_summation(alpha, epsilon):
    """Eqs. (25)-(28) as they stand, period by period; the sums fall into line as powers of 1/n."""

    def phi(t):
        return (alpha**2 * t**2 + 2 * (1 - alpha**2) * (1 - np.cos(t))) ** 1.5

    for f, ours in zip(
        (lambda t: t * np.sin(t) / phi(t), lambda t: np.sin(t) ** 2 / phi(t)),
        lighthill_integrals(alpha, epsilon),
    ):
        ends = np.concatenate([[epsilon], np.pi * np.arange(1, 801)])
        parts = [quad(f, a, b, epsabs=1e-15, epsrel=1e-13)[0] for a, b in zip(ends, ends[1:])]
        n = np.arange(100, 401, 20)
        sums = np.log(epsilon) + np.cumsum(parts)[2 * n - 1]
        powers = np.stack([(100 / n) ** j for j in (0, 1, 2, 3, 4, 5)], axis=1)
        assert ours == pytest.approx(np.linalg.lstsq(powers, sums)[0][0], abs=1e-10)


def test_many_integrals_are_those_of_each():
    """Series and quadrature meet at the edge between them; compiled side by side, the same."""
    alpha = np.exp(np.linspace(np.log(0.02), 0.0, 37))
    edge = np.array([lighthill_integrals(a, THIN) for a in alpha])
    beyond = np.array([lighthill_integrals(a, np.nextafter(THIN, 1.0)) for a in alpha])
    assert edge == pytest.approx(beyond, rel=1e-12, abs=1e-12)
    epsilon = np.linspace(0.0, 0.7, 37)
    each = np.array([lighthill_integrals(*pair) for pair in zip(alpha, epsilon)]).T
    for compile_it in (False, True):
        with settled(compile_it):
            many = np.array(lighthill_integrals(alpha, epsilon))
        assert many == pytest.approx(each, rel=1e-13, abs=1e-13)


def test_integrals_of_arrays_and_their_range():
    alpha = np.array([0.5, 0.7, 0.001])
    A1, _ = lighthill_integrals(alpha, 0.1)
    assert A1[0] == pytest.approx(lighthill_integrals(0.5, 0.1)[0], rel=1e-14)
    assert np.isnan(A1[2])
    with pytest.raises(ms.SpecError, match="alpha"):
        lighthill_integrals(0.001, 0.1)


def helix(**changes):
    fields = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05, **changes}
    return ms.HelicalTail(**fields)


@pytest.mark.parametrize(
    ("waves", "amplitude", "c_n", "c_t"),
    # an independent evaluation of Eqs. (7)-(9) with adaptive quadrature, mu = 100
    [(3, 0.1, 780.37, 537.58), (3, 0.01, 911.09, 713.30), (1, 0.1, 504.79, 313.18)],
)
def test_lighthills_coefficients(waves, amplitude, c_n, c_t):
    ours = ms.Lighthill().pair(helix(waves=waves, amplitude=amplitude), 100.0)
    assert ours == pytest.approx((c_t, c_n), rel=2e-5)  # they are given to five digits


def test_lighthill_beyond_its_range():
    with pytest.warns(ms.ValidityWarning, match="gray_hancock"):
        ms.Lighthill().pair(helix(waves=4.5, amplitude=0.01), 100.0)
    with pytest.raises(ms.SpecError, match="gray_hancock"):
        ms.Lighthill().pair(helix(waves=8, amplitude=0.01), 100.0)


@pytest.mark.parametrize("law", [ms.Lighthill(), ms.GrayHancock(), ms.Cox()])
def test_very_slender_filaments_resist_twice_as_much_across(law):
    """c_n/c_t tends to 2 with the logarithm of the slenderness, from below for these laws."""
    ratios = []
    for radius in (1e-2, 1e-6, 1e-12, 1e-24):
        c_t, c_n = law.pair(helix(radius=radius, amplitude=1e-3, waves=1), 1.0)
        ratios.append(2 - c_n / c_t)
    assert all(a > b > 0 for a, b in zip(ratios, ratios[1:]))
    assert ratios[-1] < 0.05


def test_constant_pair_from_a_held_tail():
    """Eq. (20) there and back, either hand; the paper's pair is 995.5, 775.2."""
    for hand in ("left", "right"):
        tail = helix(handedness=hand)
        thrust, torque = ms.closed_form(tail, c_n=995.5, c_t=775.2)
        pair = ms.Constant.from_held_tail(tail, thrust, torque)
        assert (pair.normal, pair.tangential) == pytest.approx((995.5, 775.2), rel=1e-12)
    with pytest.raises(ms.SpecError, match="coefficients"):
        ms.Constant.from_held_tail(tail, 10 * thrust, torque)


def test_closed_form_is_the_quadrature_without_ramp():
    """Eq. (20) is Eq. (14) along s for a helix without ramp and without spin."""
    tail = helix(ramp=0.0, waves=2)
    swimmer = ms.Swimmer(
        body=ms.NoBody(),
        tail=tail,
        fluid=ms.Fluid(viscosity=1.0),
        coefficients=ms.Constant(normal=3.0, tangential=1.7, spin=False),
    )
    gait = swimmer.gait()
    thrust, torque = ms.closed_form(tail, c_n=3.0, c_t=1.7)
    held = -gait.propulsion(0.3) * tail.rate
    assert (held[0], held[3]) == pytest.approx((thrust, torque), rel=1e-12)
    drag, _ = ms.closed_form(tail, c_n=3.0, c_t=1.7, u_s=1.0)
    assert -gait.resistance(0.0)[0, 0] == pytest.approx(drag - thrust, rel=1e-12)


def test_spin_alone_is_a_spinning_cylinder():
    """A straight rigid tail turning about itself feels 4 pi mu r^2 L and nothing else."""
    swimmer = ms.Swimmer(
        body=ms.NoBody(),
        tail=helix(amplitude=0.0),
        fluid=ms.Fluid(viscosity=2.0),
        coefficients=ms.GrayHancock(),
    )
    F = swimmer.gait().propulsion(0.0)
    assert F[3] == pytest.approx(4 * np.pi * 2.0 * 0.05**2 * 2.0, rel=1e-12)
    assert np.abs(np.delete(F, 3)).max() < 1e-15
