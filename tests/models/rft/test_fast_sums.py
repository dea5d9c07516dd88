"""The fast kernels against the plain quadrature: same formulas, other ways to sum them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microswim as ms
from microswim.models.rft import gait as rft
from microswim.models.rft import helix as rigidhelix
from microswim.models.rft import loops_compiled, loops_python
from microswim.models.rft import plane_wave as planarwave
from microswim.models.rft import segment as kernels
from microswim.models.rft.segment import HELIX, PLANE_WAVE
from microswim.numerics.quadrature import gauss

ramps = st.just(0.0) | st.floats(1e-3, 1.0)
#: waves, bk, ramp, phase, hand, spin, arc
SHAPES = st.tuples(
    st.floats(rigidhelix.FEWEST_WAVES, 6.0), st.floats(0.01, 6.0), ramps, st.floats(-7.0, 7.0),
    st.sampled_from([-1.0, 1.0]), st.sampled_from([0.0, -1.0, 1.0]), st.booleans(),
)  # fmt: skip


def parameters(waves, bk, ramp, sign, spin):
    L = 2.0
    k = 2 * np.pi * waves / L
    return np.array([L, bk / k, k, ramp, sign, 2.1, 3.4, 0.02, 0.6, spin, 0.3])


def differences(one, other):
    """Of R, F and G, on the scale of each degree of freedom and of the power."""
    (R, F, G), (S, H, K) = one, other
    size = np.sqrt(np.diag(S.real) + 1e-300)
    return [
        np.abs((R - S) / np.outer(size, size)).max(),
        np.abs((F - H) / size).max() / np.sqrt(K.real),
        abs(G - K) / K.real,
    ]


@settings(max_examples=150, deadline=None)
@given(SHAPES)
def test_helix_closed_integrals_equal_quadrature(shape):
    waves, bk, ramp, phase, sign, spin, arc = shape
    p = parameters(waves, bk, ramp, sign, spin)
    plain = kernels.wave_tail(HELIX, arc, p, phase, gauss(120 if ramp > 0 else 0), gauss(160))
    rule = gauss(rigidhelix.ramp_nodes(waves * ramp, bk, 12.0))
    fast = rigidhelix.helix_tail(arc, p, phase, rule)
    assert max(differences(fast, plain)) < 1e-10


@settings(max_examples=60, deadline=None)
@given(SHAPES)
def test_eight_digits_on_the_ramp_are_eight_digits(shape):
    waves, bk, ramp, phase, sign, spin, arc = shape
    p = parameters(waves, bk, ramp, sign, spin)
    rough = gauss(rigidhelix.ramp_nodes(waves * ramp, bk, 8.0))
    fast = rigidhelix.helix_tail(arc, p, phase, rough)
    many = gauss(96 if ramp > 0 else 0)
    assert max(differences(fast, rigidhelix.helix_tail(arc, p, phase, many))) < 2e-8


@settings(max_examples=60, deadline=None)
@given(SHAPES)
def test_plane_wave_table_equals_quadrature(shape):
    waves, bk, ramp, phase, _, _, arc = shape
    p = parameters(waves, bk, ramp, 1.0, 0.0)  # no section of a plane wave spins
    rules = gauss(40 if ramp > 0 else 0), gauss(60)
    fast = planarwave.wave_phases(arc, p, np.array([0.3, phase]), *rules)
    plain = kernels.wave_tail(PLANE_WAVE, arc, p, phase, *rules)
    assert max(differences([x[1] for x in fast], plain)) < 1e-12


@pytest.mark.parametrize("index", [0, 1, 2, 3, 5, 6, 7, 8, 9])
def test_derivatives_run_through_the_fast_kernels(index):
    """Complex steps in each parameter but the hand, which is a sign."""
    p, planar = (parameters(2.3, 0.9, 0.15, -1.0, spin).astype(complex) for spin in (1.0, 0.0))
    p[index] += 1e-30j
    planar[index] += 1e-30j * (index != 9)  # no section of a plane wave spins
    rule, phase = gauss(30), np.array([0.7])
    beats = planarwave.wave_phases(True, planar, phase, rule, gauss(120))
    pairs = [
        (rigidhelix.helix_tail(True, p, 0.7, rule), HELIX, p),
        ([x[0] for x in beats], PLANE_WAVE, planar),
    ]
    for fast, kind, own in pairs:
        plain = kernels.wave_tail(kind, True, own, 0.7, rule, gauss(120))
        for x, y in zip(fast, plain):
            scale = max(np.abs(np.imag(y)).max(), 1e-30 * np.abs(y).max() * 1e-3)
            assert np.abs(np.imag(x) - np.imag(y)).max() < 1e-9 * scale


def test_a_batch_equals_gaits_also_where_the_closed_integrals_do_not_serve():
    helix = ms.Swimmer.preset("tabak/helix", {"coefficients.law": "gray_hancock"})
    waves = np.array([0.02, 0.3, 2.0, 4.0])
    batch = ms.evaluate(helix, {"tail.waves": waves}, tolerance=1e-12)
    for i, n in enumerate(waves):
        gait = helix.with_({"tail.waves": n}).gait()
        assert batch["mean_velocity"][i] == pytest.approx(gait.mean_velocity, rel=1e-9, abs=1e-13)


def test_a_design_does_not_know_what_stands_beside_it():
    """Designs go through the processor side by side: with ramps of few nodes, of many, of none."""
    rng = np.random.default_rng(3)
    shapes = zip(rng.uniform(0.3, 5.0, 40), rng.uniform(0.05, 4.0, 40), rng.uniform(0.0, 1.0, 40))
    p = np.array([parameters(N, bk, ramp * (ramp > 0.3), 1.0, 1.0) for N, bk, ramp in shapes])
    drag, free = rng.uniform(1.0, 3.0, (40, 6)), np.array([True] * 5 + [False])
    waves, steep, ramp = p[:, 2] / np.pi, p[:, 1] * p[:, 2], p[:, 3]
    counts = rigidhelix.ramp_nodes.written(waves * ramp, steep, 12.0).astype(np.int64)
    counts[7] = -1
    solved = np.column_stack(loops_compiled.solve_helices(True, p, drag, free, counts))
    assert np.isnan(solved[7]).all()
    assert not solved[:7, 5].any()  # held
    some = rng.permutation(40)[:11]
    alone = loops_compiled.solve_helices(True, p[some], drag[some], free, counts[some])
    np.testing.assert_array_equal(np.column_stack(alone), solved[some])
    other = np.column_stack(loops_python.solve_helices(True, p, drag, free, counts))
    np.testing.assert_allclose(solved, other, rtol=1e-10, atol=1e-12 * np.nanmax(np.abs(other)))


def test_nodes_asked_for_are_used():
    helix = ms.Swimmer.preset("tabak/helix")
    rough, plain = (rft.gait(helix, nodes=n).mean_velocity for n in (3, 40))
    assert plain == pytest.approx(helix.gait().mean_velocity, abs=1e-13)
    assert abs(rough[0] / plain[0] - 1) > 1e-3
