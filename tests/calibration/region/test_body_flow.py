"""Base of the region calibration: a node against matrices, the quadrature against one rule."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.region import body_flow
from microswim.models.rft.plane_wave import fill_nodes
from microswim.models.rft.segment import MOST_NODES, segment
from microswim.numerics.quadrature import gauss

HELIX = ms.Swimmer.preset("tabak/helix")
WAVE = replace(HELIX, tail=ms.Swimmer.preset("tabak/plane_wave").tail)
LOWER = np.tril_indices(6)


def node(seed):
    """Position, tangent, velocity and the three resistances of a segment, made up."""
    rng = np.random.default_rng(seed)
    X, T, U = rng.standard_normal((3, 3))
    return 1.5 * X / np.linalg.norm(X), T, U, *rng.uniform(0.5, 2.0, 3)


def cross(x):
    return np.cross(np.eye(3), x)  # x^ as a matrix: rows are e_i x x, so this times v is x x v


@pytest.mark.parametrize("seed", range(4))
def test_a_segment_is_the_local_drag_between_two_flows(seed):
    """``H' C H``, ``H' C U`` and ``U' C U`` as products of matrices; the flow by its Green tensor.

    ``u = 6 pi mu a (1 + a^2/6 laplace) G . U`` of the sphere that moves, ``(a/r)^3 W x x`` of the
    one that turns.
    """
    X, T, U, n, d, w = node(seed)
    a, r, e, one = 0.9, np.linalg.norm(X), X / np.linalg.norm(X), np.eye(3)
    stokeslet = (one + np.outer(e, e)) / r
    laplacian = 2.0 * (one - 3.0 * np.outer(e, e)) / r**3
    M = 0.75 * a * (stokeslet + a**2 / 6.0 * laplacian)
    H = np.hstack([one - M, -(1.0 - (a / r) ** 3) * cross(X)])
    C = n * one + d * np.outer(T, T)
    turn = np.concatenate([np.zeros(3), T])
    sums = np.array(body_flow.shaded_segment.written(X, T, U, n, d, w, 1.0, a))
    whole = H.T @ C @ H + w * np.outer(turn, turn)
    assert sums[:21] == pytest.approx(whole[LOWER], rel=1e-12, abs=1e-12)
    assert sums[21:27] == pytest.approx(H.T @ C @ U + w * turn, rel=1e-12, abs=1e-12)
    assert sums[27] == pytest.approx(U @ C @ U + w, rel=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_without_a_sphere_it_is_the_segment_of_resistive_force_theory(seed):
    X, (_, *across), (_, *moving), n, d, w = node(seed)
    at = X, (1.0, *across), (0.0, *moving), n, d, w, 1.0
    shaded = np.array(body_flow.shaded_segment.written(*at, 0.0))
    assert shaded == pytest.approx(np.array(segment.written(*at)), rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("swimmer", [HELIX, WAVE])
@pytest.mark.parametrize("waves", [14.0, 40.0])
def test_panels_agree_with_one_rule(swimmer, waves):
    """Where a tail takes more nodes than the largest rule: a helix, and a flat plane wave.

    The arc length of a steep plane wave takes more nodes than the base of corrections is given.
    """
    low, digits = 0.15, 1e-10
    if swimmer is WAVE:
        digits = (np.pi * low) ** 2 / 100.0  # (b k)^2 / 100, as said at `sizes`
    many = swimmer.with_({"tail.waves": waves, "tail.radius": 0.002, "tail.amplitude": low / waves})
    p = body_flow.parameters(many)
    D = np.array(many.body.diagonal(many.fluid.viscosity))
    phase, g = np.array([0.3]), body_flow.hand(many)
    size = int(body_flow.sizes(waves))
    assert size > 64
    panelled = body_flow.table.written(p, size, *body_flow.rules(size))
    xi, weight = gauss(8 * size)
    exact = np.zeros((7, body_flow.ON_RAMP + xi.size + 1))
    rule = np.append(xi, 1.0), np.append(weight, 0.0)
    fill_nodes.written(exact, p, gauss(body_flow.ON_RAMP), rule)
    exact[6, -1] = 1.0
    R, F, G = body_flow.base(p, D, panelled, phase, g)
    right = body_flow.base(p, D, exact, phase, g)
    size, power = np.abs(right[0]).max(), right[2][0]
    assert np.abs(R - right[0]).max() < digits * size
    assert np.abs(F - right[1]).max() < digits * np.sqrt(size * power)
    assert power == pytest.approx(G[0], rel=digits)


def test_thousands_of_turns_take_memory_in_proportion():
    """A table of all rules up to the longest took 1.3 GB for two thousand waves."""
    xi, weight = body_flow.rules(int(body_flow.sizes(2000.0)))[1:]
    assert xi.size + weight.size < 10_000
    nodes, weights = body_flow.behind_ramp.written(9006, xi, weight)
    assert 9006 < nodes.size < 9006 + 34
    assert weights.sum() == pytest.approx(1.0)
    assert np.all(np.diff(nodes) > 0)


def test_more_turns_than_can_be_resolved_are_refused():
    with pytest.raises(ms.SpecError, match=r"tail\.waves = 1000000.*at most"):
        body_flow.sizes(1e6)
    assert body_flow.sizes(22_000.0) < MOST_NODES
