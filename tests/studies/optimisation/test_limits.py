"""Limits with units, and numbers at the edge: one sentence before anything starts."""

import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.studies.optimisation.expressions import constraints, parse
from microswim.studies.optimisation.limits import in_si

CELL = ms.Swimmer.preset("goto/C")
KNOWN = {"swimming_speed", "mean_torque", "tail.length"}


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("mean_torque <= 2 pN um", 2e-18),
        ("2 pN um >= mean_torque", 2e-18),
        ("swimming_speed >= 10 um/s", 1e-5),
        ("body_rate <= 60 rpm", 6.283185307179586),
        ("body_rate <= 1 Hz", 6.283185307179586),
        ("tail.frequency <= 60 rpm", 1.0),
        ("tail.length <= 5 um", 5e-6),
        ("2*tail.radius <= 1 um", 1e-6),
        ("efficiency >= 0.01", 0.01),
        ("swimming_speed*mean_torque <= 3 fW um", 3e-21),
        ("mean_torque <= 0", 0.0),
        ("tail.length*tail.radius**-1 <= 3", 3.0),
        ("sqrt(tail.length*tail.radius) <= 3 um", 3e-6),
        ("mean_power/body_rate <= 3 nN um", 3e-15),
    ],
)
def test_a_quantity_becomes_its_number(text, number):
    left, _, right = in_si(text, CELL, bare=False).replace(">=", "<=").partition("<=")
    found = left if text[0] == "2" and "pN" in text else right
    assert float(found) == pytest.approx(number, rel=1e-12)


def test_min_and_two_sided_limits_stay_whole():
    text = in_si("1 um <= tail.length <= 9 um, min(swimming_speed, 2*swimming_speed) >= 0", CELL)
    assert text == "1e-06<=tail.length<=9e-06, min(swimming_speed, 2*swimming_speed)>=0"


def refused(preset, limit, over="tail.amplitude=0.05 um:0.2 um"):
    call = ["design", "--preset", preset, "--over", over, "--maximize", "swimming_speed"]
    result = CliRunner().invoke(main, [*call, "--subject-to", limit])
    assert result.exit_code == 2, (result.stdout, result.stderr, result.exception)
    (line,) = result.stderr.splitlines()
    return line


@pytest.mark.parametrize(
    ("limit", "says"),
    [
        ("mean_torque<=2e-18", "must have a unit"),
        ("mean_torque<=2 nN", "dimension"),
        ("mean_torque<=2 px", "px"),
        ("0.1<=body_rate", "must have a unit"),
        ("tail.length<=5", "must have a unit"),
        ("swimming_speed/mean_torque<=2 nN", "same dimension"),
        ("swimming_speed/mean_torque<=2", "must have a unit"),
        ("swimming_speed + mean_torque<=2 nN", "unlike things"),
        ("min(tail.length, tail.frequency)>=1 um", "unlike things"),
        ("tail.length<=mean_torque", "same dimension"),
        ("tail.length**2<=3 um", "same dimension"),
        ("sqrt(tail.length*tail.radius)<=3 um^2", "same dimension"),
        ("2<=1", "about a quantity"),
        ("swimming_speed<=9**9**9", "finite"),
        ("swimming_speed<=2**100000", "finite"),
        ("swimming_speed<=1/0", "finite"),
        ("swimming_speed<=" + "9" * 400, "finite"),
    ],
)
def test_limits_that_make_no_sense(limit, says):
    assert says in refused("goto/C", limit)


def test_what_cannot_be_met_is_said_in_the_units_of_people():
    over = {"tail.amplitude": (5e-8, 2e-7)}
    with pytest.raises(ms.SpecError, match=r"relax mean_torque <= 0\.002000 pN µm$"):
        ms.design(CELL, over, maximize="swimming_speed", subject_to="mean_torque <= 2e-3 pN um")


def test_rounding_is_not_shown_in_an_error():
    assert str(ms.SpecError("x", 0.1 + 0.2, "one")).startswith("x = 0.3: ")
    assert str(ms.SpecError("x", [0.1 + 0.2, 1], "one")).startswith("x = [0.3, 1]: ")


def test_a_unit_without_units_is_refused():
    assert "no units" in refused("tabak/helix", "mean_torque<=2 nN m", "tail.amplitude=0.05:0.2")


@pytest.mark.parametrize(
    "text", ["3", "9**9**9", "swimming_speed*1e999", "swimming_speed + 10**400", "log(0)"]
)
def test_wishes_are_about_quantities_and_finite(text):
    with pytest.raises(ms.SpecError, match=r"finite|about a quantity"):
        parse(text, KNOWN)


def test_functions_and_powers_of_quantities_still_hold():
    (limit,) = constraints("sqrt(abs(swimming_speed)) * 2**3 <= max(mean_torque, 1)", KNOWN)
    assert limit.margin({"swimming_speed": 4.0, "mean_torque": 20.0}) == pytest.approx(
        (20 - 16) / 20
    )
