"""Signatures say by words what may be given, so that editors complete them; they say the truth."""

import inspect
from typing import get_args

import pytest

import microswim as ms
from microswim.control import motion
from microswim.control.inputs import Inputs
from microswim.gait import doors


@pytest.mark.parametrize("model", doors.MODELS)
def test_the_options_of_a_gait_are_those_that_the_models_take(model):
    takes = inspect.signature(doors._behind(doors.MODELS[model])).parameters.values()
    own = {p.name for p in takes if p.kind is p.KEYWORD_ONLY}
    assert own <= set(doors.GaitOptions.__annotations__)


def test_nothing_is_offered_that_no_model_takes():
    taken = set()
    for door in doors.MODELS.values():
        taken |= set(inspect.signature(doors._behind(door)).parameters)
    assert set(doors.GaitOptions.__annotations__) <= taken


def test_the_models_of_the_signature_are_those_of_the_table():
    assert set(get_args(doors.Model)) == set(doors.MODELS)


@pytest.mark.parametrize(
    ("function", "argument"),
    [
        (ms.sweep, "model"),
        (ms.sweep, "cluster"),
        (ms.validate, "reference"),
        (ms.design, "reference"),
        (ms.calibrate, "method"),
        (ms.calibrate_region, "reference"),
        (ms.c_model, "precision"),
        (ms.export_fmu, "fmi"),
        (ms.HelicalTail, "handedness"),
        (ms.Channel, "ends"),
        (ms.Swimmer, "units"),
    ],
)
def test_choices_are_words_in_the_signature(function, argument):
    assert "Literal[" in str(inspect.signature(function).parameters[argument].annotation)


def public_calls():
    """Every public function, class and public method, by name; exceptions are Python's own."""
    for name in ms.__all__:
        thing = getattr(ms, name)
        if inspect.isclass(thing) and issubclass(thing, Exception):
            continue
        if callable(thing):
            yield name, thing
        if inspect.isclass(thing):
            own = inspect.getmembers(thing, lambda x: inspect.isfunction(x) or inspect.ismethod(x))
            yield from ((f"{name}.{k}", v) for k, v in own if not k.startswith("_"))


@pytest.mark.parametrize(("name", "call"), list(public_calls()))
def test_nothing_public_takes_more_than_five_arguments_by_position(name, call):
    takes = inspect.signature(call).parameters.values()
    by_position = [p.name for p in takes if p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)]
    assert len([p for p in by_position if p != "self"]) <= 5


def test_the_inputs_of_a_step_are_those_of_the_signature():
    assert set(Inputs.__annotations__) == set(motion.INPUTS)
