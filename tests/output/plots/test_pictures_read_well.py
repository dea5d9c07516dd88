"""No picture cuts its words, lets numbers run into each other or names what it does not draw."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg

import microswim as ms
from microswim.output.plots import design as plots_design
from microswim.output.plots.run import track_and_fit
from microswim.output.plots.validation import error_maps
from microswim.studies.paper import item
from microswim.studies.paper.context import Context

HELIX = ms.Swimmer.preset("tabak/helix")
OVER = {"tail.amplitude": (0.02, 0.3), "tail.waves": (0.5, 4.0)}


def boxes(texts, renderer):
    shown = [t for t in texts if t.get_visible() and t.get_text().strip()]
    return [(t.get_text(), t.get_window_extent(renderer)) for t in shown]


def reads_well(figure):
    """Every word inside the figure, no two numbers of an axis over each other."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer, whole = canvas.get_renderer(), figure.bbox
    for axes in [a for a in figure.axes if a.get_visible()]:
        words = [axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label]
        for text, box in boxes(words, renderer):
            assert box.x0 >= whole.x0 - 1, text
            assert box.x1 <= whole.x1 + 1, text
            assert box.y1 <= whole.y1 + 1, text
        if axes.axison:
            numbers = boxes(axes.get_xticklabels(), renderer)
            for (one, a), (other, b) in zip(numbers, numbers[1:]):
                assert a.x1 <= b.x0 or b.x1 <= a.x0, (one, other)
    return True


@pytest.fixture(scope="module")
def best():
    """An objective with a long name; its optimum lies at the edge of what may vary."""
    wish = "swimming_speed / mean_torque + 0 * tail.amplitude"
    return ms.design(HELIX, OVER, maximize=wish, subject_to="tail.amplitude >= 0.25", samples=64)


def test_a_map_with_its_optimum(best):
    axes = {"tail.amplitude": np.linspace(0.02, 0.25, 6), "tail.waves": np.linspace(0.5, 4.0, 7)}
    result = ms.sweep(HELIX, axes)
    figure = plots_design.design_map(result, optimum=best)
    assert reads_well(figure)
    low, high = figure.axes[0].get_ylim()
    assert high - best.values["tail.amplitude"] > 0.02 * (high - low)  # the star is on the map
    micro = result.assign_coords(
        {"tail.amplitude": ("tail.amplitude", axes["tail.amplitude"] * 1e-5, {"units": "m"})}
    )
    assert plots_design.design_map(micro).axes[0].get_ylabel() == "tail.amplitude (µm)"


def test_a_histogram_names_the_robots_there_are():
    values = 6.7123e-4 + 1.1e-6 * np.random.default_rng(0).normal(size=256)
    made = xr.Dataset(
        {"swimming_speed": ("sample", values), "good": ("sample", np.ones(256, dtype=bool))},
        attrs={"yield": 1.0},
    )
    figure = plots_design.robustness(made, "swimming_speed", 6.7123e-4)
    assert reads_well(figure)
    legend = figure.axes[0].get_legend()
    assert legend is not None
    assert {t.get_text() for t in legend.get_texts()} == {"as designed", "good"}


def test_a_front_in_units_that_read_well():
    robot = ms.Swimmer.preset("goto/C")
    wishes = {"maximize": ["swimming_speed"], "minimize": ["mean_torque"]}
    over = {"tail.amplitude": (1e-7, 2e-7)}
    figure = plots_design.front(
        ms.pareto(robot, over, **wishes, population=8, generations=2), robot
    )
    assert reads_well(figure)
    assert figure.axes[0].get_ylabel() == "swimming speed (µm/s), more is better"


def test_a_track_far_from_the_origin():
    t = np.linspace(0.0, 1.0, 60)
    track = np.stack([1e-6 * np.sin(20 * t), 1e-5 * t], axis=-1) + 2.345e-3
    figure = track_and_fit(track, track, "m")
    assert reads_well(figure)
    assert figure.axes[0].get_xlabel() == "x from the start (µm)"


def test_a_track_that_is_next_to_a_line_shows_its_wobble():
    t = np.linspace(0.0, 1.0, 60)
    track = np.stack([-8e-6 * t, 5e-9 * np.sin(20 * t), 0 * t], axis=-1) + 2.345e-3
    figure = track_and_fit(track, track, "m")
    assert reads_well(figure)
    axes = figure.axes[0]
    assert axes.get_ylabel() == "y from the start, drawn larger than x (nm)"
    low, high = axes.get_ylim()
    assert high - low < 20.0


def test_an_optimum_of_a_magnetic_robot_has_its_unit():
    assert plots_design._value("speed_at_step_out", 0.0276, "SI") == "27.6 mm/s"
    assert plots_design._value("swimming_speed / mean_torque", 0.0276, "SI") == "0.0276"


def test_maps_of_a_validation():
    over = {"tail.amplitude": [0.05, 0.1, 0.15], "tail.waves": [2.0, 3.0]}
    result = ms.validate(HELIX, over, "rft", workers=0)
    assert result.at == {"tail.amplitude": 0.1, "tail.waves": 3.0}
    twice = {n: 2.0 * v if n == "mean.us" else v for n, v in result.reference.items()}
    off = replace(result, axis_units={"tail.amplitude": "m"}, surrogate=twice)
    figure = error_maps(off)
    assert reads_well(figure)
    assert figure.axes[0].get_xlabel() == "tail.amplitude (mm)"
    assert figure.axes[0].get_title() == "forward speed, worst +100 %"
    star = figure.axes[0].lines[-1]
    assert (star.get_xdata()[0], star.get_ydata()[0]) == pytest.approx((100.0, 3.0))


@pytest.mark.parametrize(
    "name", ["table1", "table2", "fig2", "fig3", "table3", "fig4", "fig5", "fig7"]
)
@pytest.mark.filterwarnings("ignore::microswim.ValidityWarning")
def test_figures_of_the_paper(name):
    """Without reference circles their name is not in the legend either."""
    module = item(name)
    figure = module.plot(module.compute(Context(circles=False)))
    assert reads_well(figure)
    words = [t.get_text() for legend in figure.legends for t in legend.get_texts()]
    assert not any("boundary elements" in word or "our reference" in word for word in words)
    assert "`" not in module.CAPTION
