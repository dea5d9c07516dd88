"""Validation: no error against itself, the right stage blamed, maps and tables complete."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.calibration.validate import stages
from microswim.cli import main
from microswim.output.plots.validation import error_maps
from microswim.studies.world import page as world

HELIX = ms.Swimmer.preset("tabak/helix")
OVER = {"tail.amplitude": [0.05, 0.1, 0.15], "tail.waves": [2.0, 3.0]}


def test_a_model_agrees_with_itself():
    result = ms.validate(HELIX, OVER, "rft", workers=0)
    for name, s in result.statistics().items():
        assert s["worst"] < 1e-12, name
        assert s["within_5"] == 1.0


def test_the_stage_that_is_wrong_is_blamed():
    """More body drag changes the resistance alone; a thicker fluid both, not the velocity."""
    gait = HELIX.gait()
    heavy = stages(gait, HELIX.with_({"interaction.translation": (2.0, 2.0, 2.0)}).gait())
    assert heavy["resistance"] > 0.1
    assert heavy["propulsion"] == pytest.approx(0.0, abs=1e-12)
    assert heavy["velocity"] == pytest.approx(heavy["velocity_by_resistance"], rel=1e-12)
    thick = stages(gait, HELIX.with_({"fluid.viscosity": 200.0}).gait())
    assert thick["resistance"] == pytest.approx(1.0, rel=1e-9)
    assert thick["propulsion"] == pytest.approx(1.0, rel=1e-9)
    assert thick["velocity"] == pytest.approx(0.0, abs=1e-9)


def test_stages_do_not_depend_on_the_unit_of_time():
    a = stages(HELIX.gait(), HELIX.with_({"interaction.translation": (2, 2, 2)}).gait())
    fast = HELIX.with_({"tail.frequency": 7.0})
    b = stages(fast.gait(), fast.with_({"interaction.translation": (2, 2, 2)}).gait())
    assert a == pytest.approx(b, rel=1e-9)


def test_lateral_errors_refer_to_the_scale_over_the_map():
    result = ms.validate(HELIX, OVER, "rft", workers=0)
    shifted = {"amplitude.uq": result.surrogate["amplitude.uq"] + 0.001}
    result = replace(result, surrogate=result.surrogate | shifted)
    scale = result.reference["amplitude.uq"].max()
    assert result.error("amplitude.uq") == pytest.approx(np.full((3, 2), 0.001 / scale))


def test_designs_that_cannot_be_built_are_rows_with_reasons():
    result = ms.validate(HELIX, {"tail.radius": [0.05, 0.5]}, "rft", workers=0)
    assert list(result.reasons) == [1]
    assert "tail.radius" in result.reasons[1]
    assert result.rows()[1]["reason"]
    assert len(result.as_dict()["failed"]) == 1


def test_maps_of_one_and_two_axes_are_drawn():
    two = error_maps(ms.validate(HELIX, OVER, "rft", workers=0))
    one = error_maps(ms.validate(HELIX, {"tail.waves": [2.0, 3.0]}, "rft", workers=0))
    assert sum(ax.get_visible() for ax in one.axes) == 6
    assert sum(ax.get_visible() for ax in two.axes) == 7


def test_an_axis_that_does_not_exist_is_told():
    with pytest.raises(ms.SpecError, match=r"tail\.amplitud"):
        ms.validate(HELIX, {"tail.amplitud": [0.1]}, "rft")


def test_vibrio_gives_the_papers_coefficients():
    """Gamma 2.37 and 1.49, and 8.2 % for the speed of G, as the paper prints them."""
    rows = {row["specimen"]: row for row in world.vibrio()}
    gamma = [float(x) for x in rows["A"]["Gamma_N, Gamma_R"].split(",")]
    assert gamma == pytest.approx([2.37, 1.49], abs=0.01)
    assert rows["G"]["error (%)"] == pytest.approx(8.2, abs=0.5)


def test_rodenborns_own_resistive_force_theory_comes_out():
    """Thrust and drag of Gray and Hancock's law at lambda/R = 9.811 as digitised: 9.066, 35.18."""
    rows = [r for r in world.rodenborn(bem=False) if abs(r["lambda/R"] - 9.811) < 1e-6]
    row = next(r for r in rows if r["model"] == "gray_hancock")
    assert row["thrust"] == pytest.approx(9.066, rel=0.03)
    assert row["drag"] == pytest.approx(35.18, rel=0.03)


def test_each_set_of_the_plane_wave_follows_from_the_other():
    rows = {
        (r["coefficients"], r["source"]): r for r in world.table_3() if r["tail"] == "plane_wave"
    }
    for law, other in (("constant", "sbt"), ("sbt", "constant")):
        paper, found = rows[law, "paper"], rows[law, f"from the velocities of {other}"]
        assert found["gamma_N,q"] == pytest.approx(paper["gamma_N,q"], rel=0.02)
        assert found["gamma_R,r"] < 0


@pytest.mark.parametrize(
    ("over", "says"),
    [
        ({"a": ["b"]}, "no field of this swimmer"),
        ({"tail.waves": ["many"]}, "must be numbers"),
        ({"tail.kind": ["helix", "plane_wave"]}, "must be numbers"),
    ],
)
def test_axes_that_are_no_numbers_of_the_swimmer_are_refused(over, says):
    with pytest.raises(ms.SpecError, match=says):
        ms.validate(ms.Swimmer.preset("tabak/helix"), over, "rft", workers=0)


@pytest.mark.parametrize(
    "call",
    [
        ["validate", "--over", "tail.amplitude=0.1:0.11:2", "--quantity", "foo"],
        ["calibrate", "--reference", "bem", "--quantity", "foo"],
        ["calibrate", "--reference", "bem", "--unknown", "foo"],
        ["calibrate", "--reference", "bem", "--bound", "translation.s=x:2"],
    ],
)
def test_names_are_checked_before_the_reference_is_asked(call, monkeypatch):
    def solve(*args, **options):
        raise AssertionError("it was solved")

    monkeypatch.setattr(ms.Swimmer, "gait", solve)
    run = CliRunner().invoke(main, [*call, "--preset", "tabak/helix"])
    assert run.exit_code == 2
    assert "Error: " in run.stderr
