"""What is printed is a few lines with units, whatever the gait or the swimmer."""

import numpy as np
import pytest

import microswim as ms
from microswim.gait.gait import Gait
from microswim.gait.readable import percent

CASES = ["tabak/helix", "tabak/plane_wave", "goto/C"]


@pytest.mark.parametrize("preset", CASES)
def test_a_few_lines_that_fit_a_screen(preset):
    swimmer = ms.Swimmer.preset(preset)
    for text in (str(swimmer), str(swimmer.gait()), repr(swimmer.gait())):
        lines = text.splitlines()
        assert 4 <= len(lines) <= 7
        assert max(map(len, lines)) <= 110
        assert "array" not in text
    for thing in (swimmer, swimmer.gait()):
        assert thing._repr_html_().startswith("<table>")


def test_what_is_found_is_a_few_lines_too():
    helix, robot = ms.Swimmer.preset("tabak/helix"), ms.Swimmer.preset("shapes/magnet")
    found = [
        ms.regimes(robot, [2.0, 300.0], model="rft"),
        ms.mobility(ms.Sphere(radius=1.0), level="coarse"),
        ms.calibrate(helix, {"swimming_speed": 0.03}, ["tail.t"]),
        ms.calibrate_region(helix, {"tail.amplitude": (0.08, 0.12)}, "rft", solves=8, workers=0),
        ms.design(helix, {"tail.waves": (2, 3)}, maximize="swimming_speed", samples=64),
    ]
    for thing in found:
        text = repr(thing)
        assert text == str(thing)
        assert 4 <= len(text.splitlines()) <= 8
        assert max(map(len, text.splitlines())) <= 110
        assert "array" not in text
        assert thing._repr_html_().startswith("<table>")
    assert "182.9 Hz ± 6.0 %" in repr(found[0])
    assert "1 wobbling" in repr(found[0]) or "wobbling at 1" in repr(found[0])


def test_units_carry_prefixes_and_a_dimensionless_swimmer_has_none():
    cell = str(ms.Swimmer.preset("goto/C").gait())
    assert "10.21 µm/s" in cell
    assert "Hz" in cell
    assert "m/s" not in str(ms.Swimmer.preset("tabak/helix").gait())


def test_rounding_is_not_shown_as_a_speed():
    assert "e-1" not in str(ms.Swimmer.preset("tabak/plane_wave").gait())
    four = ms.Swimmer.preset("several/four-flagella")  # a path straight by symmetry
    assert ms.io.numbers(four, four.gait())["path_radius"] == 0.0


def test_what_cannot_move_can_be_printed():
    still = Gait(np.zeros((1, 6, 6)), np.ones((1, 6)), np.ones(1), rate=1.0)
    assert "singular" in str(still)


def test_summary_is_plain():
    made = ms.summary(ms.Swimmer.preset("tabak/plane_wave").gait())
    assert all(type(v) is float or [type(x) for x in v] == [float] * 6 for v in made.values())


def test_one_call_draws():
    swimmer = ms.Swimmer.preset("tabak/helix")
    assert len(swimmer.gait().plot().axes) == 3
    assert swimmer.plot().axes


def test_a_circle_in_a_plane_is_printed_without_rounding():
    """Two tails side by side turn their mirror plane into itself: nothing leaves it."""
    robot = ms.Swimmer.preset("several/two-tails")
    rows = {
        r[0]: r[1:] for r in ms.report.numbers_table(ms.io.numbers(robot, robot.gait()), "").rows
    }
    assert rows["swimming speed"] == ("0", "0 body lengths per time")
    assert rows["path pitch"][0] == rows["body rate |Omega_s|"][0] == "0"
    assert float(rows["path radius"][0]) > 1.0


@pytest.mark.parametrize(("share", "said"), [
    (None, "not known"), (0.0, "0 %"), (0.00123, "0.12 %"), (0.05, "5 %"), (1.63, "160 %"),
    (93.0, "9300 %"),
])  # fmt: skip
def test_a_share_reads_as_per_cent_however_large(share, said):
    assert percent(share) == said
