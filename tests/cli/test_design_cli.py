"""What ``microswim design`` says in a terminal."""

import re

import pytest

import microswim as ms
from microswim.cli._optimum import Said, show
from microswim.gait.readable import quantity


@pytest.fixture(scope="module")
def best():
    cell = ms.Swimmer.preset("goto/C")
    over = {"tail.amplitude": (1e-7, 3e-7)}
    return ms.design(cell, over, maximize="swimming_speed", subject_to="mean_torque <= 4e-19",
                     samples=64)  # fmt: skip


def test_an_optimum_is_said_in_units_that_people_read(best, capsys):
    show(best.as_dict(), "SI")
    said = capsys.readouterr().out
    assert f"maximize swimming_speed: {quantity(best.value, 'm/s')}" in said
    assert "µm/s" in said
    assert quantity(best.values["tail.amplitude"], "m") in said
    assert "mean_torque <= 0.4000 pN µm: active" in said
    assert not re.search(r"\de-\d\d(?! )", said.replace("% per %", "").split("fitted")[0])


def test_numbers_that_one_can_build_come_before_factors_of_a_fit(best, capsys):
    show(best.as_dict(), "SI")
    held = next(x for x in capsys.readouterr().out.splitlines() if x.startswith("held"))
    assert "interaction" not in held
    assert "tail.frequency" in held


def test_a_swimmer_without_units_has_bare_numbers():
    said = Said("dimensionless")
    assert said("mean_torque", 119.5) == "119.5"
    assert said.limit("mean_torque <= 300") == "mean_torque <= 300.0"
    assert said.limit("waves * amplitude <= 1") == "waves * amplitude <= 1"
    assert said("tail.handedness", "left") == "left"
