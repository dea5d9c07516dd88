"""The inverse problem: planted truth comes back, intervals are honest, limits are told."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.calibration.observations import from_series
from microswim.cli import main
from microswim.models.rft.gait import body_resistance

HELIX = ms.Swimmer.preset("tabak/helix")
WAVE = ms.Swimmer.preset("tabak/plane_wave").with_({"motion.free": ("us", "uq", "or")})
GAMMA = {"translation": (2.24, 1.25, 1.25), "rotation": (1.3, 1.0, 0.7)}
LAWS = [ms.Lighthill(), ms.GrayHancock(spin=False), ms.Constant(normal=995.5, tangential=775.2)]


def planted(swimmer, **fields):
    """The truth; what a helix's calibration does not look for stays at one."""
    known = (
        {"rotation": (1.3, 1.0, 1.0)} if swimmer.tail.kind == "helix" else {"rotation": (1, 1, 0.7)}
    )
    truth = {"translation": GAMMA["translation"]} | known | fields
    return swimmer.with_({f"interaction.{k}": v for k, v in truth.items()})


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.law)
@pytest.mark.parametrize("swimmer", [HELIX, WAVE], ids=["helix", "plane_wave"])
def test_planted_truth_comes_back(swimmer, law):
    from dataclasses import replace

    swimmer = replace(swimmer, coefficients=law)
    truth = planted(swimmer)
    fit = ms.calibrate(swimmer, truth.gait())
    for name, value in fit.coefficients.items():
        part, axes = name.split(".")
        planted_one = 1.0 if part == "tail" else GAMMA[part]["sqr".index(axes[0])]
        assert value == pytest.approx(planted_one, rel=1e-6)
    assert fit.rank == len(fit.names) == (6 if swimmer.tail.is_rigid and law.spin else 5)
    assert fit.swimmer.gait().mean_velocity == pytest.approx(truth.gait().mean_velocity, abs=1e-9)


def test_tail_factors_come_back_from_thrust_torque_and_drag():
    truth = planted(HELIX, tail=(1.3, 0.7, 0.9))
    found = ["tail.t", "tail.n", "tail.r"]
    parts = ["tail_resistance.us.us", "tail_propulsion.us", "tail_propulsion.os"]
    fit = ms.calibrate(HELIX, truth.gait(), found, quantities=parts)
    assert fit.values == pytest.approx([1.3, 0.7, 0.9], rel=1e-6)


def test_coupling_comes_back_and_stays_definite():
    E = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.3), (0.0, -0.3, 0.0))
    truth = planted(HELIX, coupling=E)
    names = ["translation.s", "translation.qr", "rotation.s", "coupling.qr"]
    seen = ["mean.us", "amplitude.uq", "mean.os", "amplitude.or"]
    fit = ms.calibrate(HELIX, truth.gait(), names, quantities=seen, positive=True)
    assert fit.values == pytest.approx([2.24, 1.25, 1.3, 0.3], rel=1e-6)
    assert np.linalg.eigvalsh(body_resistance(fit.swimmer))[0] > 0


def test_several_swimmers_share_their_coefficients():
    truth = [ms.Swimmer.preset(f"goto/{c}") for c in "ACG"]
    data = []
    for swimmer in truth:
        gait = swimmer.with_(
            {"interaction.translation": (2.37, 1, 1), "interaction.rotation": (1.49, 1, 1)}
        ).gait()
        data += [
            ms.Observation(swimmer=swimmer, quantity=q, value=float(ms.observed(gait, q)))
            for q in ("forward_velocity", "body_rate_hz")
        ]
    fit = ms.calibrate(truth[0], data)
    assert fit.values == pytest.approx([2.37, 1.49], rel=1e-6)


def test_a_time_series_is_enough():
    truth = planted(WAVE)
    gait = truth.gait()
    time = np.linspace(0.0, 1.7, 40)
    V = gait.velocity(time * gait.rate)
    data = from_series(WAVE, time, {"us": V[:, 0], "uq": V[:, 1], "or": V[:, 5]})
    fit = ms.calibrate(WAVE, data)
    assert fit.values == pytest.approx([2.24, 1.25, 0.7], rel=1e-6)


def test_intervals_cover_the_truth_as_often_as_they_say():
    """Two standard errors of a share of 400 at 95 % are 2.2 %."""
    gait = planted(HELIX).gait()
    names = ("mean.us", "amplitude.uq", "mean.os")
    exact = np.array([float(ms.observed(gait, q)) for q in names])
    rng = np.random.default_rng(5)
    hits, truth = [], [2.24, 1.25, 1.3]
    for _ in range(134):
        noisy = exact * (1.0 + 0.01 * rng.standard_normal(3))
        data = {q: (y, abs(0.01 * x)) for q, y, x in zip(names, noisy, exact)}
        low, high = ms.calibrate(HELIX, data).interval(0.95).T
        hits += list((low < truth) & (truth < high))
    assert 0.92 <= np.mean(hits) <= 0.98


def test_speed_alone_determines_one_of_six():
    six = ["translation.s", "translation.qr", "rotation.s", "rotation.qr", "tail.t", "tail.n"]
    fit = ms.calibrate(HELIX, {"mean.us": -0.038}, six)
    assert fit.rank == 1
    assert fit.predicted[0] == pytest.approx(-0.038, rel=1e-6)
    assert np.isinf(fit.uncertainty).all()
    assert any("1 of 6" in sentence for sentence in fit.warnings)


def test_a_negative_resistance_earns_a_warning_in_physical_words():
    truth = planted(WAVE, rotation=(1.0, 1.0, -1.0), translation=(1.65, 8.0, 1.0))
    fit = ms.calibrate(WAVE, truth.gait())
    assert fit.coefficients["rotation.r"] == pytest.approx(-1.0, rel=1e-6)
    assert any("negative resistance" in s and "energy" in s for s in fit.warnings)


def test_ratios_of_a_gait_whose_body_knows_no_tail_are_its_coefficients():
    truth = planted(HELIX)
    fit = ms.calibrate(HELIX, truth.gait(), method="ratios")
    assert fit.coefficients["translation.s"] == pytest.approx(2.24, rel=1e-9)
    assert fit.coefficients["rotation.s"] == pytest.approx(1.3, rel=1e-9)


def test_bounds_hold():
    fit = ms.calibrate(HELIX, planted(HELIX).gait(), bounds={"translation.s": (0.5, 2.0)})
    assert fit.coefficients["translation.s"] == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"unknowns": ["translation.x"]}, "translation.s"),
        ({"unknowns": ["translation.q", "translation.qr"]}, "one unknown only"),
        ({"data": {"mean.x": 1.0}}, "such as mean.us"),
        ({"data": {"mean.us": (1.0, -1.0)}}, "positive"),
        ({"data": []}, "nothing was observed"),
        ({"method": "guess"}, "ratios"),
        ({"bounds": {"translation.s": (2.0, 3.0)}}, "between 2 and 3"),
    ],
)
def test_mistakes_are_told_in_a_sentence(change, words):
    given = {"data": {"mean.us": -0.038, "mean.os": -0.4, "amplitude.uq": 0.015}} | change
    with pytest.raises(ms.SpecError, match=words):
        ms.calibrate(HELIX, **given)


def test_an_uncertainty_that_nobody_gave_is_named():
    """Half the data with a sigma of their own: the other half is said to be assumed."""
    data = {"mean.us": (-0.038, 0.001), "mean.os": -0.4}
    report = ms.calibrate(HELIX, data, ["translation.s", "rotation.s"]).as_dict()
    assert report["assumed_uncertainty"] == {"mean.os": 0.01}
    asked = ["calibrate", "--preset", "tabak/helix", "--unknown", "translation.s,rotation.s"]
    measured = ["--measured", "mean.us=-0.038:0.001,mean.os=-0.4"]
    run = CliRunner().invoke(main, [*asked, *measured])
    assert run.exit_code == 0, run.output
    assert "an assumed 1 % of mean.os;" in run.output


@pytest.mark.parametrize(
    ("preset", "measured", "says"),
    [
        ("goto/C", "swimming_speed=6.2e-6", "must have a unit"),
        ("goto/C", "mean.os=5", "rad/s"),
        ("goto/C", "swimming_speed=6 um/s:0.1", "must have a unit"),
        ("goto/C", "swimming_speed=6 um", "dimension"),
        ("goto/C", "efficiency=1 um", "bare number"),
        ("tabak/helix", "swimming_speed=6 um/s", "no units"),
        ("goto/C", "swimming_speed=1 um/s:2 um/s:3 um/s", "NAME=VALUE"),
    ],
)
def test_measurements_on_the_line_have_the_units_of_the_spec(preset, measured, says):
    call = ["calibrate", "--preset", preset, "--measured", measured]
    run = CliRunner().invoke(main, call)
    assert run.exit_code == 2
    assert says in run.stderr.splitlines()[-1]


def test_a_measurement_in_micrometres_is_one_in_metres():
    call = ["calibrate", "--preset", "goto/C", "--unknown", "translation.s", "--json"]
    runs = [
        CliRunner().invoke(main, [*call, "--measured", f"swimming_speed={text}"])
        for text in ("6.2 um/s:0.1 um/s", "6.2e-6 m/s:100 nm/s")
    ]
    one, other = (json.loads(run.stdout) for run in runs)
    assert one["coefficients"] == pytest.approx(other["coefficients"], rel=1e-12)
    assert one["uncertainty"] == pytest.approx(other["uncertainty"], rel=1e-9)


@pytest.mark.parametrize("bound", [[2.0], (1.0, 2.0, 3.0), ("a", "b"), 5.0])
def test_a_bound_is_two_numbers(bound):
    with pytest.raises(ms.SpecError, match=r"bound translation\.s"):
        ms.calibrate(
            ms.Swimmer.preset("tabak/helix"),
            {"swimming_speed": 0.05},
            ["translation.s"],
            bounds={"translation.s": bound},
        )


def test_no_drag_is_written_that_every_model_refuses():
    """Slow for its thrust: the body's drag along s alone would have to be negative."""
    quick = {"mean.us": 3.0 * HELIX.gait().mean_velocity[0]}
    with pytest.raises(ms.SpecError, match="no model takes"):
        ms.calibrate(HELIX, quick, ["translation.s"], bounds={"translation.s": (-9.0, 9.0)})
    fit = ms.calibrate(HELIX, quick, ["translation.s"])
    assert fit.coefficients["translation.s"] >= 0.0
    assert any("kept positive" in sentence for sentence in fit.warnings)
    assert fit.swimmer.gait().mean_velocity[0] < 0  # the model takes it


def test_measurements_in_a_table_may_have_units(tmp_path):
    table = tmp_path / "cells.csv"
    asked = ["calibrate", "--preset", "goto/C", "--unknown", "translation.s", "--json"]
    for text in ("swimming_speed\n6.23 um/s\n", "swimming_speed (um/s)\n6.23\n",
                 "swimming_speed\n6.23e-6\n"):  # fmt: skip
        table.write_text(text)
        run = CliRunner().invoke(main, [*asked, "--table", str(table)])
        assert run.exit_code == 0, run.output
        assert json.loads(run.stdout)["data"][0]["measured"] == pytest.approx(6.23e-6)
    table.write_text("swimming_speed (um)\n6.23\n")
    run = CliRunner().invoke(main, [*asked, "--table", str(table)])
    assert run.exit_code == 2
    assert "swimming_speed" in run.stderr


def test_several_tails_ask_for_unknowns_by_name():
    """The paper's coefficients are those of one tail; of two they came out negative."""
    two = ms.Swimmer.preset("several/two-tails")
    truth = two.with_({"interaction.translation[0]": 1.5}).gait()
    with pytest.raises(ms.SpecError, match="name the unknowns"):
        ms.calibrate(two, truth)
    fit = ms.calibrate(two, truth, ["translation.s"], quantities=["mean.us"])
    assert fit.values == pytest.approx([1.5], rel=1e-6)
