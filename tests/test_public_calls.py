"""Every public callable, called wrongly in every way that a machine can think of.

`CALLS` holds one good call of each with all its arguments. One after the other is spoilt: the
answer must be one sentence that names the argument, before any work; `FITS` says which of the
values that look odd are right all the same.
"""

import inspect
import warnings

import numpy as np
import pytest

import microswim as ms

HELIX = ms.Swimmer.preset("tabak/helix")
GAIT = HELIX.gait()
NO_PARTS = {"region": None, "wall": None, "channel": None}
WAVE = {
    "length": 2.0,
    "amplitude": 0.1,
    "radius": 0.05,
    "waves": 3.0,
    "wavelength": None,
    "frequency": 1.0,
    "ramp": 0.1,
    "length_measure": "apparent",
    "surface_motion": "translating",
}
LAW = {"spin": True, "tip": False}


def beat(s, phase):
    q = 0.1 * s * np.cos(3 * s - phase)
    return np.stack([s + 0 * q, q, 0 * q], axis=-1)


CALLS = {
    "Sphere": {"radius": 0.5},
    "Spheroid": {"semi_axes": (1.0, 0.5), "drag": "exact"},
    "Ellipsoid": {"semi_axes": (1.0, 0.5, 0.4)},
    "NoBody": {},
    "HelicalTail": WAVE | {"handedness": "left", "sections": "perpendicular"},
    "PlaneWaveTail": WAVE | {"sections": "sheared"},
    "CustomTail": {
        "shape": beat,
        "length": 2.0,
        "radius": 0.02,
        "frequency": 1.0,
        "wavelength": 2.0,
        "breaks": (0.5,),
        "sign": 1.0,
        "sections": "perpendicular",
        "surface_motion": "translating",
    },
    "Lighthill": LAW,
    "GrayHancock": LAW,
    "Cox": LAW,
    "Constant": LAW | {"normal": 2.0, "tangential": 1.0},
    "Interaction": {
        "translation": (1.0,) * 3,
        "rotation": (1.0,) * 3,
        "coupling": np.zeros((3, 3)),
        "tail": (1.0,) * 3,
    },
    "Fluid": {"viscosity": 1.0, "density": 0.0},
    "Motion": {"free": "all", "frequency_frame": "body", "line_element": "arc"},
    "Wall": {"distance": 2.0, "tilt": 0.1, "azimuth": 0.1},
    "Channel": {
        "diameter": 5.0,
        "length": 9.0,
        "shape": "box",
        "position": (0.0, 0.0, 0.1),
        "tilt": 0.1,
        "ends": "open",
    },
    "Swimmer": {part: getattr(HELIX, part) for part in (*HELIX.parts, "units")} | NO_PARTS,
    "Observation": {
        "swimmer": HELIX,
        "quantity": "velocity.us",
        "value": [1.0, 2.0],
        "sigma": 0.1,
        "phase": [0.0, 1.0],
    },
    "Sensor": {
        "interval": 0.1,
        "latency": 0.1,
        "position_noise": 0.1,
        "angle_noise": 0.1,
        "seed": 1,
    },
    "Stepper": {
        "gait": GAIT,
        "swimmer": HELIX,
        "moment": (0.0, 0.0, 1.0),
        "locked": False,
        "resolution": 64.0,
        "steps": 20,
        "most_steps": 1000,
    },
    "State": {"values": np.array([0, 0, 0, 1.0, 0, 0, 0, 0])},
    "Track": {
        "time": np.arange(12.0),
        "position": np.ones((12, 2)),
        "quaternion": np.tile([1.0, 0, 0, 0], (12, 1)),
    },
}

WRONG = {"bytes": b"5", "set": {1.0}, "complex": 1j, "object": object(), "none": None}
NUMBERS = {"nan": float("nan"), "inf": float("inf"), "minus one": -1.0}

#: What looks odd and is right: a motor may run backwards, for one.
FITS = {
    ("HelicalTail", "frequency"): {"minus one"},
    ("PlaneWaveTail", "frequency"): {"minus one"},
    ("CustomTail", "frequency"): {"minus one"},
    ("CustomTail", "sign"): {"minus one"},
    ("Wall", "tilt"): {"minus one"},
    ("Wall", "azimuth"): {"minus one"},
    ("Channel", "tilt"): {"minus one"},
}


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def spoilt():
    """Name of a callable, argument, label and value of every wrong call."""
    for name, good in CALLS.items():
        for argument, value in good.items():
            left_out = inspect.signature(getattr(ms, name)).parameters[argument].default is None
            wrong = WRONG | (NUMBERS if is_number(value) else {})
            for label, other in wrong.items():
                if label in FITS.get((name, argument), ()) or (label == "none" and left_out):
                    continue
                yield pytest.param(name, argument, other, id=f"{name}-{argument}-{label}")


def refused(call, words):
    """One sentence that holds the words, and no warning before it."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ms.SpecError) as caught:
            call()
    sentence = str(caught.value)
    assert words in sentence
    assert "\n" not in sentence
    assert len(sentence) < 300


@pytest.mark.parametrize("name", CALLS)
def test_a_good_call_names_every_argument(name):
    takes = inspect.signature(getattr(ms, name)).parameters.values()
    known = {p.name for p in takes if p.kind is not p.VAR_KEYWORD}
    assert known == set(CALLS[name])


@pytest.mark.parametrize("name", CALLS)
def test_wrong_names_and_too_many_places_are_named(name):
    thing, good = getattr(ms, name), CALLS[name]
    refused(lambda: thing(**good, colour=1), "colour")
    refused(lambda: thing(*range(20)), name)
    takes = inspect.signature(thing).parameters
    for argument, value in good.items():
        if takes[argument].default is inspect.Parameter.empty:
            rest = {k: v for k, v in good.items() if k != argument}
            refused(lambda rest=rest: thing(**rest), argument)
        assert value is good[argument]


@pytest.mark.parametrize(("name", "argument", "value"), list(spoilt()))
def test_a_wrong_value_is_refused_by_name(name, argument, value):
    refused(lambda: getattr(ms, name)(**CALLS[name] | {argument: value}), argument)


@pytest.mark.parametrize("name", [n for n in CALLS if inspect.isclass(getattr(ms, n))])
def test_good_calls_are_taken_with_the_numbers_of_numpy(name):
    """`int64` and `float32` are numbers; a list is as good as a tuple."""

    def of_numpy(value):
        if isinstance(value, float):
            return np.float32(value) if value == np.float32(value) else np.float64(value)
        return np.int64(value) if is_number(value) else value

    assert getattr(ms, name)(**{k: of_numpy(v) for k, v in CALLS[name].items()}) is not None
