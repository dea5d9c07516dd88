"""What the boundary elements measure of their own error is acted on."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.errors import SpecError
from microswim.models import bem, swimmer_surface
from microswim.models.bem import trust

ROBOT = ms.Swimmer(
    body=ms.Sphere(radius=0.5),
    tail=ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05),
    fluid=ms.Fluid(viscosity=1.0),
)
COARSE = replace(bem.get_level("coarse"), phases=1)


def beside(distance):
    return replace(ROBOT, wall=ms.Wall(distance))


def test_a_resistance_that_is_not_positive_definite_has_no_small_asymmetry():
    """At a gap of 0.001 radii the coarse mesh gives a body that the fluid pushes along."""
    solved = bem.solve(beside(0.5005), level=COARSE)
    assert np.linalg.eigvalsh(solved.resistance).min() < 0
    assert solved.asymmetry == np.inf
    assert trust.misfit(solved) == np.inf


def test_a_flow_that_is_not_resolved_is_refused():
    with pytest.raises(SpecError, match=r"wall\.distance = 0\.5005: .*passive body.*gap"):
        beside(0.5005).gait("bem", level=COARSE)


def test_smaller_panels_are_tried_first_and_what_is_left_is_said():
    gap = beside(0.5003)
    plain = trust.misfit(bem.solve(gap, level=COARSE))
    gait = gap.gait("bem", level=COARSE)
    left = gait.info["asymmetry"]
    assert trust.DOUBTFUL < left < plain
    assert any("reciprocal only to" in remark for remark in gait.info["remarks"])


def test_a_flow_that_is_resolved_needs_no_word():
    gait = ROBOT.gait("bem", level="coarse")
    assert trust.doubts([bem.solve(ROBOT, level="coarse")]) == []
    assert gait.info["remarks"] == []


@pytest.mark.parametrize(("share", "refused"), [(0.985, True), (0.97, False)])
def test_a_crease_that_no_level_resolves_is_refused(share, refused):
    """Curvature of a helix ``b k^2 / (1 + b^2 k^2)``; its product with the radius is `share`."""
    b, k = 0.1, 3 * np.pi
    radius = share * (1 + (b * k) ** 2) / (b * k**2)
    tail = ms.HelicalTail(length=2.0, amplitude=b, waves=3, radius=radius, ramp=0.0)
    if refused:
        with pytest.raises(SpecError, match=r"tail\.radius"):
            swimmer_surface.check(ms.NoBody(), tail)
    else:
        assert "nearly a crease" in " ".join(swimmer_surface.check(ms.NoBody(), tail))


@pytest.mark.parametrize("phase", [1.0, 2.5])
def test_a_steep_root_is_resolved_alike_at_every_phase(phase):
    """On a sphere phase turns the whole swimmer about s, and the patches with it."""
    root = replace(ROBOT, tail=ms.HelicalTail(length=0.81, amplitude=0.12, waves=1.2, radius=0.09))
    first, later = (bem.solve(root, at, level=COARSE) for at in (0.0, phase))
    turn = np.kron(np.eye(2), np.array([
        [1.0, 0.0, 0.0],
        [0.0, np.cos(phase), -np.sin(phase)],
        [0.0, np.sin(phase), np.cos(phase)],
    ]))  # fmt: skip
    R = turn @ first.resistance @ turn.T
    size = np.sqrt(np.outer(R.diagonal(), R.diagonal()))
    assert np.abs((later.resistance - R) / size).max() < 1e-4
    assert later.activity == pytest.approx(first.activity, rel=1e-5)
    assert trust.misfit(later) == pytest.approx(trust.misfit(first), rel=0.3)


def test_a_root_that_comes_out_of_its_body_is_said():
    body = ms.Ellipsoid(semi_axes=(2.6, 0.56, 0.56))
    tail = ms.HelicalTail(length=3.8, amplitude=0.3, waves=0.6, ramp=0.07, radius=0.15)
    solved = bem.solve(
        ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0)), level="coarse"
    )
    assert trust.OPEN in trust.doubts([solved])
