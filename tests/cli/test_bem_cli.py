"""Boundary elements from the command line: the error estimate is printed, and a number in JSON."""

import json

from click.testing import CliRunner

from microswim.cli import main


def run(*arguments):
    result = CliRunner().invoke(
        main, ["run", "--preset", "tabak/helix", "--model", "bem", *arguments]
    )
    assert result.exit_code == 0, result.output
    return result.stdout


def test_run_says_how_far_the_next_coarser_level_is_off():
    assert "% from level coarse" in run()


def test_error_estimate_in_json_and_no_coarser_level_than_coarse():
    assert json.loads(run("--json"))["info"]["error"]["against"] == "coarse"
    coarse = json.loads(run("--json", "--level", "coarse"))
    assert coarse["info"]["error"] is None
    assert -0.0315 < coarse["mean_velocity"][0] < -0.0300
