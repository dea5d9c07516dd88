"""Maps and curves of a sweep say how wrong u_s may be."""

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import FillBetweenPolyCollection
from matplotlib.contour import QuadContourSet

import microswim as ms
from microswim.output.plots import doubt
from microswim.output.plots.design import design_map

ROBOT = ms.Swimmer(
    body=ms.Sphere(radius=0.5),
    tail=ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05),
    fluid=ms.Fluid(viscosity=1.0),
)


def swept(errors):
    """A sweep over two numbers with the expected errors (n, m)."""
    names = ("tail.amplitude", "tail.waves")
    n, m = np.shape(errors)
    speed = np.add.outer(np.arange(n), np.arange(m)) + 1.0
    data = {"swimming_speed": (names, speed), "expected_error": (names, np.array(errors))}
    return xr.Dataset(data, coords={names[0]: np.arange(n) + 1.0, names[1]: np.arange(m) + 1.0})


def test_lines_lie_where_the_error_is_and_large_ones_are_hatched():
    errors = np.outer([0.002, 0.02, 0.4], np.ones(3))
    axes = design_map(swept(errors)).axes[0]
    drawn = [c for c in axes.collections if isinstance(c, QuadContourSet)]
    dashed = next(c for c in drawn if c.linestyles == "--")
    assert dashed.levels.tolist() == [0.01, 0.05]
    for level, path in zip(dashed.levels, dashed.get_paths(), strict=True):
        crossed = np.interp(path.vertices[:, 1], [1.0, 2.0, 3.0], errors[:, 0])
        assert np.allclose(crossed, level)
    hatched = [c for c in drawn if any(c.hatches)]
    assert [c.levels[0] for c in hatched] == [doubt.LARGE]
    assert axes.get_title() == "expected error of u_s: 0.2 to 40 %"


def test_what_is_not_known_is_hatched_beside_what_is():
    errors = np.full((3, 3), 0.01)
    errors[2] = np.nan
    axes = design_map(swept(errors)).axes[0]
    drawn = [c for c in axes.collections if isinstance(c, QuadContourSet)]
    (hatched,) = [c for c in drawn if any(c.hatches)]
    lowest = min(path.vertices[:, 1].min() for path in hatched.get_paths() if len(path.vertices))
    assert 2.0 < lowest < 3.0
    assert axes.get_title() == "expected error of u_s: 1 %"


def test_a_map_that_knows_no_error_says_so():
    axes = design_map(swept(np.full((3, 3), np.nan))).axes[0]
    assert axes.get_title() == "expected error of u_s: not known"
    assert not any(any(c.hatches) for c in axes.collections if isinstance(c, QuadContourSet))


def test_a_curve_of_a_speed_has_a_band_as_wide_as_its_error():
    over = {"tail.amplitude": [0.08, 0.1, 0.12]}
    result = ms.sweep(ROBOT, over)
    axes = design_map(result).axes[0]
    (band,) = [c for c in axes.collections if isinstance(c, FillBetweenPolyCollection)]
    at = band.get_paths()[0].vertices
    for b, speed, error in zip(
        over["tail.amplitude"], result.swimming_speed.values, result.expected_error.values
    ):
        edge = at[np.isclose(at[:, 0], b), 1]
        assert edge.min() == pytest.approx(speed * (1 - error))
        assert edge.max() == pytest.approx(speed * (1 + error))
    assert not design_map(result, "mean_power").axes[0].collections


def test_a_list_of_designs_has_no_axis():
    result = ms.sweep(ROBOT, [{"tail.amplitude": 0.1}, {"tail.amplitude": 0.12}])
    with pytest.raises(ms.SpecError, match="one or two numbers"):
        design_map(result)
