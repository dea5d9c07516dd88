"""A wrong call of Python's face ends in one sentence that names what is wrong."""

import inspect
import warnings

import numpy as np
import pytest

import microswim as ms
from microswim.errors import RenamedWarning

HELIX = ms.Swimmer.preset("tabak/helix")
OVER = {"tail.amplitude": (0.05, 0.1)}

WRONG = {
    "fluid by position": (lambda: ms.Fluid(0.001), r"Fluid\(viscosity=\.\.\.\)"),
    "fluid without viscosity": (ms.Fluid, "viscosity must be given"),
    "fluid with another field": (lambda: ms.Fluid(viscosity=1.0, colour=2), "no field colour"),
    "swimmer by position": (lambda: ms.Swimmer(HELIX.body, HELIX.tail), "by name"),
    "interaction of a number": (lambda: ms.Interaction(coupling=5), "3 x 3"),
    "interaction of a set": (lambda: ms.Interaction(translation={1.0, 2.0, 3.0}), "three finite"),
    "interaction of text": (lambda: ms.Interaction(coupling="abc"), "3 x 3"),
    "bytes": (lambda: ms.Fluid(viscosity=b"5"), "positive"),
    "a complex number": (lambda: ms.Fluid(viscosity=np.complex128(1 + 1j)), "positive"),
    "an array for a number": (lambda: ms.Fluid(viscosity=np.array([1.0])), "positive"),
    "region": (
        lambda: ms.Swimmer(body=HELIX.body, tail=HELIX.tail, fluid=HELIX.fluid, region=1),
        "region calibration",
    ),
    "model": (lambda: HELIX.gait("cfd"), '"rft"'),
    "option of another model": (lambda: HELIX.gait("rft", level="fine"), "level.*nodes"),
    "no nodes": (lambda: HELIX.gait(nodes=0), "nodes = 0.*at least 1"),
    "half a node": (lambda: HELIX.gait(nodes=2.5), "whole number"),
    "tolerance below zero": (
        lambda: ms.evaluate(HELIX, {"tail.amplitude": [0.1]}, tolerance=-1),
        "tolerance = -1",
    ),
    "tolerance that is no number": (
        lambda: ms.design(HELIX, OVER, maximize="efficiency", tolerance=float("nan")),
        "tolerance",
    ),
    "option of design": (lambda: ms.design(HELIX, OVER, maximize="efficiency", foo=1), "foo = 1"),
}


@pytest.mark.parametrize("case", WRONG)
def test_one_sentence_says_what_is_wrong(case):
    call, words = WRONG[case]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ms.SpecError, match=words) as caught:
            call()
    assert "\n" not in str(caught.value)


def test_numbers_of_numpy_are_numbers():
    one = HELIX.with_({"tail.waves": np.int64(2), "tail.amplitude": np.float32(0.125)})
    assert one.gait().mean_velocity == pytest.approx(
        HELIX.with_({"tail.waves": 2, "tail.amplitude": 0.125}).gait().mean_velocity
    )


def test_signatures_name_what_may_be_given():
    """So that editors complete them; a decorated constructor keeps its own."""
    assert "Model" in str(inspect.signature(ms.Swimmer.gait).parameters["model"].annotation)
    for function in (ms.validate, ms.design, ms.calibrate_region):
        assert "bem" in str(inspect.signature(function).parameters["reference"].annotation)
    assert list(inspect.signature(ms.Fluid).parameters) == ["viscosity", "density"]


def test_old_keywords_work_and_name_the_new_one():
    over = {"tail.amplitude": [0.1]}
    with pytest.warns(RenamedWarning, match="reference="):
        old = ms.validate(HELIX, over, against="rft", workers=0)
    new = ms.validate(HELIX, over, reference="rft", workers=0)
    assert old.reference == new.reference
    with pytest.warns(RenamedWarning, match="reference="), pytest.raises(ms.SpecError):
        ms.design(HELIX, over, maximize="efficiency", verify="rft", colour="red")


def test_both_calibrations_hold_a_swimmer():
    region = {"tail.amplitude": (0.08, 0.12)}
    over = ms.calibrate_region(HELIX, region, "rft", solves=8, workers=0)
    at = ms.calibrate(HELIX, {"mean.us": -0.038}, ["translation.s"])
    for fit in (over, at):
        assert isinstance(fit, ms.Calibration)
        assert isinstance(fit.swimmer, ms.Swimmer)
        assert "warnings" in fit.as_dict()
    assert over.region is over.swimmer.region
    with pytest.warns(RenamedWarning, match="swimmer.gait"):
        assert over.gait().mean_velocity == pytest.approx(over.swimmer.gait().mean_velocity)
    with pytest.raises(AttributeError):
        over.colour  # noqa: B018


WRONG_BY_MEANING = {
    "evaluate of no design": (lambda: ms.evaluate(HELIX, {"tail.amplitude": []}), "amplitude"),
    "sweep at no level": (lambda: ms.sweep(HELIX, {"tail.waves": [2]}, "bem", level="x"), "level"),
    "force that is a word": (
        lambda: ms.trajectory(HELIX.gait(), [0, 1], force=lambda t: "x"),
        "force",
    ),
    "start that is a word": (
        lambda: ms.calibrate(
            HELIX, {"mean.us": -0.03}, ["translation.s"], start={"translation.s": "x"}
        ),
        "start",
    ),
    "start of nothing": (
        lambda: ms.calibrate(HELIX, {"mean.us": -0.03}, ["translation.s"], start={"tail.n": 1.0}),
        "start",
    ),
    "bounds of nothing": (
        lambda: ms.calibrate(HELIX, {"mean.us": -0.03}, ["tail.n"], bounds={"tail.t": (0.5, 2)}),
        "bounds",
    ),
    "region of nothing": (lambda: ms.calibrate_region(HELIX, {}, "rft"), "region"),
    "mobility of five": (lambda: ms.mobility(5), "what"),
    "tracks of five": (lambda: ms.read_tracks(5), "path"),
}


@pytest.mark.parametrize("case", WRONG_BY_MEANING)
def test_what_means_nothing_is_refused_in_a_sentence(case):
    call, words = WRONG_BY_MEANING[case]
    with pytest.raises(ms.SpecError, match=words) as caught:
        call()
    assert "\n" not in str(caught.value)
