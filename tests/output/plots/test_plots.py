"""Figures: they show what the Dataset holds, to scale, with units, for every eye."""

import itertools

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb

import microswim as ms
from microswim.output.plots.drawing import COLOURS, Camera
from microswim.output.plots.run import LINES
from microswim.spec import presets


def run_of(name, **options):
    swimmer = ms.Swimmer.preset(name)
    return ms.io.dataset(swimmer, swimmer.gait(), spec=presets.read(name), **options)


@pytest.fixture(scope="module")
def cell():
    return run_of("goto/C", periods=20)


def labels(figure):
    return [text for a in figure.axes for text in (a.get_xlabel(), a.get_ylabel()) if text]


def pixels(figure):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3]


def test_velocity_curves_are_the_datasets(cell):
    run = run_of("tabak/helix", periods=1)
    axes = ms.plots.velocity(run).axes
    curves = [line.get_ydata() for line in axes[0].lines if len(line.get_ydata()) > 2]
    np.testing.assert_allclose(np.transpose(curves), run.velocity.values[:, :3])
    si = [line.get_ydata() for line in ms.plots.velocity(cell).axes[0].lines][1]
    assert si == pytest.approx(1e6 * cell.velocity.values[:, 0])


def test_every_axis_has_a_label_and_si_has_units(cell):
    assert {"velocity (µm/s)", "body rate (rad/s)", "motor power (fW)"} <= set(
        labels(ms.plots.velocity(cell))
    )
    assert {"displacement (nm)", "time (periods)"} <= set(labels(ms.plots.trajectory(cell)))


@pytest.mark.parametrize("name", ["tabak/helix", "tabak/plane_wave", "goto/C"])
def test_figures_are_drawn_without_a_spec_and_with_one(name):
    run = run_of(name, periods=3)
    bare = pixels(ms.plots.trajectory(run.assign_attrs(spec="")))
    full = pixels(ms.plots.trajectory(run))
    coloured = [(np.ptp(p.astype(int), axis=-1) > 60).sum() for p in (bare, full)]
    assert coloured[1] > 2 * coloured[0]


def test_a_swimmer_that_stays_where_it_is_can_be_drawn():
    swimmer = ms.Swimmer.preset("tabak/helix").with_({"tail.frequency": 0.0})
    run = ms.io.dataset(swimmer, swimmer.gait())
    pixels(ms.plots.trajectory(run, swimmer))
    pixels(ms.plots.velocity(run))


def test_the_scene_is_to_scale(cell):
    """The scale bar is as long as it says, in the same units as the path."""
    scene = ms.plots.trajectory(cell).axes[0]
    bar = next(line for line in scene.lines if line.get_linewidth() == 2.0)
    (text,) = [t.get_text() for t in scene.texts if "µm" in t.get_text()]
    assert np.ptp(bar.get_xdata()) == pytest.approx(1e-6 * float(text.split()[0]))
    assert scene.get_aspect() == 1.0


def test_camera_is_a_rotation():
    camera = Camera.behind(np.eye(3), azimuth=-28.0, elevation=16.0)
    assert camera.axes @ camera.axes.T == pytest.approx(np.eye(3), abs=1e-15)
    assert np.linalg.det(camera.axes) == pytest.approx(1.0)
    assert camera.axes[0, 0] > 0.8  # it swims to the right
    assert camera.axes[1, 2] > 0.8  # and what is up is up


# Machado, Oliveira & Fernandes, IEEE Trans. Vis. Comput. Graph. 15 (2009), severity 1.0
BLIND = {
    "protanopia": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "deuteranopia": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
    "tritanopia": [[1.256, -0.077, -0.179], [-0.078, 0.931, 0.148], [0.005, 0.691, 0.304]],
}


@pytest.mark.parametrize("eye", BLIND)
@pytest.mark.parametrize("colours", [[c for c, _ in LINES], list(COLOURS.values())])
def test_colours_can_be_told_apart_by_every_eye(eye, colours):
    linear = np.array([to_rgb(c) for c in colours]) ** 2.2
    seen = np.clip(linear @ np.transpose(BLIND[eye]), 0, 1) ** (1 / 2.2)
    for a, b in itertools.combinations(seen, 2):
        assert np.linalg.norm(a - b) > 0.2


def test_lines_differ_without_any_colour():
    assert len({style for _, style in LINES}) == len(LINES)
