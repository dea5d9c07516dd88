"""What a report derives from a swimmer."""

import pytest

import microswim as ms


def test_reynolds_number_of_the_base_case_and_its_scale():
    """``rho f D^2 / mu``, 0.01 in the base case [Tabak Table 1]; a swimmer twice the size has 4."""
    robot = ms.Swimmer.preset("tabak/helix")
    lengths = ("body.radius", "tail.length", "tail.amplitude", "tail.radius")
    big = robot.with_({name: 2 * robot.numbers[name] for name in lengths})
    quick = robot.with_({"tail.frequency": 3.0})
    found = [ms.report.derived(s)["reynolds_number"] for s in (robot, big, quick)]
    assert found == pytest.approx([0.01, 0.04, 0.03])
