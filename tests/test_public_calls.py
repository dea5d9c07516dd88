"""Every public callable, called wrongly in every way that a machine can think of.

`CALLS` holds one good call of each. One argument after the other is spoilt: the answer must be one
sentence that names the argument, before any work; `FITS` says which of the values that look odd are
right all the same.
"""

import inspect
import warnings

import numpy as np
import pytest
from matplotlib.figure import Figure

import microswim as ms

HELIX = ms.Swimmer.preset("tabak/helix")
GAIT = HELIX.gait()
NO_PARTS = dict.fromkeys(
    ("region", "wall", "channel", "magnet", "field", "gravity", "flow", "noise")
)
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
    "NoTail": {},
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
    "ElasticTail": {
        "length": 2.0,
        "radius": 0.02,
        "bending": 1.0,
        "twisting": None,
        "frequency": 1.0,
        "base": "clamped",
        "drive": "heave",
        "amplitude": 0.1,
        "angle": None,
        "moment": None,
        "rest_radius": None,
        "rest_pitch": None,
        "rest": None,
        "magnet": (0.0, 0.1, 0.0),
        "magnet_span": (0.0, 0.5),
        "wavelength": 1.0,
        "sections": "perpendicular",
        "surface_motion": "bending",
    },
    "Magnet": {
        "moment": (0.0, 1.0, 0.0),
        "remanence": None,
        "volume": None,
        "shape": "block",
        "size": None,
        "direction": None,
        "azimuth": 0.1,
    },
    "UniformField": {"strength": 1.0, "direction": (1.0, 0.0, 0.0)},
    "OscillatingField": {"strength": 1.0, "frequency": 1.0, "direction": (1.0, 0.0, 0.0)},
    "RotatingField": {"strength": 1.0, "frequency": 1.0, "axis": (1.0, 0.0, 0.0), "cone": 0.1},
    "Member": {
        "swimmer": HELIX,
        "roll": 0.1,
        "phase": 0.1,
    }
    | dict.fromkeys(("position", "direction", "force", "torque"), (0.0, 0.0, 1.0)),
    "Group": {"members": (ms.Member(swimmer=HELIX),), "wall": ((0.0, -2.0, 0.0), (0.0, 1.0, 0.0))},
    "Gravity": {
        "density": None,
        "body_density": 2.0,
        "tail_density": 3.0,
        "direction": (0.0, 0.0, -1.0),
        "acceleration": 9.0,
        "centre_of_mass": (0.0, 0.0, 0.1),
    },
    "UniformFlow": {"speed": 1.0, "direction": (1.0, 0.0, 0.0)},
    "ShearFlow": {"rate": 1.0, "direction": (1.0, 0.0, 0.0), "across": (0.0, 0.0, 1.0)},
    "StrainFlow": {"rate": 1.0, "direction": (1.0, 0.0, 0.0), "compression": (0.0, 0.0, 1.0)},
    "RotationFlow": {"rate": 1.0, "axis": (1.0, 0.0, 0.0)},
    "PoiseuilleFlow": {
        "speed": 1.0,
        "diameter": 4.0,
        "axis": (1.0, 0.0, 0.0),
        "centre": (0.0, 0.0, 0.1),
    },
    "Noise": {"temperature": 1.0},
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


def told(*args):
    """Stand for a function that is told of progress."""


OVER = {"tail.amplitude": (0.05, 0.1)}
SEARCH = {"swimmer": HELIX, "over": OVER, "subject_to": "", "seed": 0}
CHANCE = {"swimmer": HELIX, "uncertain": {"tail.amplitude": "5%"}, "samples": 8, "seed": 0}
SOLVES = {"reference": "rft", "folder": "solves", "workers": 0, "progress": told}
STEPPER, STATE = ms.Stepper(GAIT), ms.State.at()
RUN = ms.io.dataset(HELIX, GAIT, periods=1)
TRACK = ms.Track(**CALLS["Track"])

ALONE = ms.Group((ms.Member(swimmer=HELIX),))

#: Functions and methods, by a name that says where they are.
FUNCTIONS = {
    "design": SEARCH
    | {
        "maximize": "efficiency",
        "minimize": "mean_power",
        "samples": 8,
        "reference": "bem",
        "tolerance": 0.1,
        "progress": told,
    },
    "pareto": SEARCH
    | {
        "maximize": "efficiency",
        "minimize": "mean_power",
        "population": 8,
        "generations": 2,
    },
    "robust_design": SEARCH
    | {
        "maximize": "efficiency",
        "minimize": "mean_power",
        "uncertain": CHANCE["uncertain"],
        "quantile": 0.1,
        "least_yield": 0.9,
        "samples": 8,
    },
    "robustness": CHANCE | {"subject_to": ""},
    "sobol_indices": CHANCE | {"merit": "efficiency"},
    "sweep": {
        "swimmer": HELIX,
        "over": {"tail.amplitude": [0.1]},
        "model": "bem",
        "out": "sweep.zarr",
        "resume": False,
        "workers": 1,
        "scheduler": None,
        "cluster": None,
        "progress": told,
    },
    "validate": SOLVES
    | {"swimmer": HELIX, "over": {"tail.amplitude": [0.1]}, "quantities": ["mean.us"]},
    "calibrate": {
        "swimmer": HELIX,
        "data": GAIT,
        "unknowns": ["translation.s"],
        "quantities": ["mean.us"],
        "bounds": {},
        "start": {},
        "positive": False,
        "method": "least squares",
    },
    "calibrate_region": SOLVES | {"swimmer": HELIX, "region": OVER, "solves": 8, "seed": 1},
    "identify_swimmer": {
        "swimmer": HELIX,
        "track": TRACK,
        "unknowns": ["tail.amplitude"],
        "sigma": 0.1,
        "sigma_attitude": 0.1,
        "start": {},
        "starts": 2,
        "progress": told,
    },
    "evaluate": {"swimmer": HELIX, "values": {"tail.amplitude": [0.1]}, "tolerance": 1e-6},
    "trajectory": {
        "gait": GAIT,
        "times": [0.0, 1.0],
        "rate": 1.0,
        "position": (0.0,) * 3,
        "quaternion": (1.0, 0.0, 0.0, 0.0),
        "phase": 0.0,
        "max_step": 0.1,
    }
    | dict.fromkeys(("force", "torque", "moment", "field", "flow"), (0.0, 0.0, 1.0)),
    "path": {
        "swimmer": HELIX,
        "time": 0.1,
        "model": "rft",
        "gait": GAIT,
        "poses": None,
        "position": (0.0,) * 3,
        "quaternion": (1.0, 0.0, 0.0, 0.0),
        "tilt": None,
        "phase": 0.0,
        "force": (0.0,) * 3,
        "torque": (0.0,) * 3,
        "samples": 3,
        "tolerance": 1e-6,
        "contact": 0.1,
        "paths": 1,
        "seed": 1,
        "step": 0.1,
        "keep": "path.npz",
        "progress": told,
    },
    "group_path": {
        "group": ALONE,
        "times": [0.0, 1.0],
        "model": "estimate",
        "level": "coarse",
        "max_step": 0.1,
        "keep": "path.npz",
        "progress": told,
    },
    "screw": {"gait": GAIT, "steps": 256},
    "summary": {"gait": GAIT},
    "expected_error": {"swimmer": HELIX, "gait": GAIT},
    "observed": {"gait": GAIT, "quantity": "velocity.us", "phase": 0.0, "body_length": 1.0},
    "warm_up": {},
    "stability": {"swimmer": HELIX, "load": "tip"},
    "regimes": {"swimmer": HELIX, "frequency": [1.0], "model": "rft", "gait": GAIT},
    "starts": {
        "swimmer": HELIX,
        "time": 0.1,
        "over": {"tilt": [0.1]},
        "model": "rft",
        "workers": 0,
        "keep": "map.json",
        "progress": told,
    },
    "closed_form": {"tail": HELIX.tail, "c_n": 2.0, "c_t": 1.0, "u_s": 0.0},
    "c_model": {"stepper": STEPPER, "name": "robot", "spec": "", "precision": "double"},
    "export_fmu": {"stepper": STEPPER, "path": "x.fmu", "name": "robot", "fmi": "3.0", "spec": ""},
    "io.numbers": {"swimmer": HELIX, "gait": GAIT},
    "io.enough_periods": {"swimmer": HELIX, "gait": GAIT, "speed": 0.1},
    "io.dataset": {"swimmer": HELIX, "gait": GAIT, "periods": 1.0, "spec": "", "known": {}},
    "io.save": {"run": RUN, "path": "run.nc"},
    "io.load": {"path": "run.nc"},
    "plots.trajectory": {"run": RUN, "swimmer": HELIX},
    "plots.velocity": {"run": RUN},
    "plots.path": {"found": RUN},
    "plots.group_path": {"found": RUN},
    "plots.film": {
        "swimmer": HELIX,
        "found": RUN,
        "file": "path.gif",
        "frames": 2,
        "progress": told,
    },
    "data.load": {"name": "tabak-table-2"},
    "data.names": {},
    "Swimmer.from_toml": {"path": "spec.toml", "overrides": {}, "trust": "own.py"},
    "Group.from_toml": {"path": "scene.toml", "overrides": {}, "trust": "own.py"},
    "Group.moved": {"self": ALONE, "rolls": [0.1], "phases": [0.1]}
    | {name: [(0.0, 0.0, 1.0)] for name in ("positions", "directions")},
    "Group.prepared": {"self": ALONE, "level": "coarse"},
    "Group.at_poses": {"self": ALONE, "level": "coarse", "workers": 1, "progress": told}
    | {name: [[(0.0, 0.0, 1.0)]] for name in ("positions", "directions")}
    | {name: [[0.1]] for name in ("rolls", "phases")},
    "Group.estimate": {"self": ALONE, "level": "coarse"},
    "Group.solve": {"self": ALONE, "level": "coarse"},
    "Group.swim": {"self": ALONE, "level": "coarse", "progress": told},
    "Swimmer.preset": {"name": "tabak/helix", "overrides": {}},
    "Swimmer.gait": {"self": HELIX, "model": "rft"},
    "Swimmer.with_": {"self": HELIX, "changes": {}},
    "Swimmer.gradient": {"self": HELIX, "output": "efficiency", "wrt": "tail.amplitude"},
    "Constant.from_held_tail": {"tail": HELIX.tail, "thrust": -1.0, "torque": -1.0},
    "Stepper.of": {"swimmer": HELIX, "model": "rft"},
    "Stepper.step": {"self": STEPPER, "state": STATE, "dt": 0.1},
    "Stepper.scattered": {
        "self": STEPPER,
        "state": STATE,
        "dt": 0.1,
        "random": np.random.default_rng(0),
        "energy": 1.0,
    },
    "Stepper.outputs": {"self": STEPPER, "state": STATE},
    "Stepper.twist": {"self": STEPPER, "state": STATE},
    "Stepper.derivatives": {"self": STEPPER, "state": STATE, "dt": 0.1, "wrt": ("force",)},
    "Stepper.state_space": {"self": STEPPER, "state": STATE, "dt": 0.1, "wrt": ("force",)},
    "Gait.resistance": {"self": GAIT, "phase": 0.5},
    "Gait.propulsion": {"self": GAIT, "phase": 0.5},
    "Gait.activity": {"self": GAIT, "phase": 0.5},
    "Gait.velocity": {"self": GAIT, "phase": 0.5, "rate": 1.0, "wrench": np.zeros(6)},
    "Gait.power": {"self": GAIT, "phase": 0.5},
    "Gait.body_wrench": {"self": GAIT, "phase": 0.5},
    "Gait.at_rate": {"self": GAIT, "rate": 1.0},
    "Gait.in_lab_frame": {"self": GAIT, "rate": 1.0, "sign": 1.0},
    "Gait.plot": {"self": GAIT},
    "Gait.from_samples": {
        "R": np.eye(6)[None],
        "F": np.zeros((1, 6)),
        "G": np.zeros(1),
        "body_R": np.eye(6)[None],
        "body_F": np.zeros((1, 6)),
        "harmonics": 0,
    },
    "Gait.from_rotation": {
        "R": np.eye(6),
        "F": np.zeros(6),
        "G": 0.5,
        "sign": 1.0,
        "body_R": np.eye(6),
        "body_F": np.zeros(6),
    },
    "report.derived": {"swimmer": HELIX},
    "report.spec_table": {"swimmer": HELIX},
    "report.numbers_table": {"numbers": ms.io.numbers(HELIX, GAIT), "name": "helix"},
    "report.png": {"figure": Figure()},
    "plots.front": {"result": RUN, "swimmer": HELIX, "drawn": 4},
    "plots.design_map": {"result": RUN, "merit": "swimming_speed"},
    "io.unit": {"units": "SI", "kind": "speed"},
    "Sensor.read": {"self": ms.Sensor(), "time": 0.0, "state": STATE},
    "State.at": {"position": (0.0,) * 3, "quaternion": (1.0, 0.0, 0.0, 0.0), "phase": 0.0},
}
SELF = {name: good.pop("self") for name, good in FUNCTIONS.items() if "self" in good}
CLASSES = list(CALLS)
CALLS = CALLS | FUNCTIONS

WRONG = {"bytes": b"5", "set": {1.0}, "complex": 1j, "object": object(), "none": None}
NUMBERS = {"nan": float("nan"), "inf": float("inf"), "minus one": -1.0, "array": np.array(0.5)}

OF_PHASE = ("resistance", "propulsion", "activity", "velocity", "power", "body_wrench")
#: What looks odd and is right: a motor may run backwards, for one.
FITS = {
    ("HelicalTail", "frequency"): {"minus one"},
    ("PlaneWaveTail", "frequency"): {"minus one"},
    ("CustomTail", "frequency"): {"minus one"},
    ("CustomTail", "sign"): {"minus one"},
    ("ElasticTail", "frequency"): {"minus one"},
    ("RotatingField", "frequency"): {"minus one"},
    ("RotatingField", "cone"): {"minus one"},
    ("Magnet", "azimuth"): {"minus one"},
    ("Group", "time"): {"minus one"},
    ("Group.moved", "time"): {"minus one"},
    ("Member", "roll"): {"minus one"},
    ("Member", "phase"): {"minus one"},
    ("Wall", "tilt"): {"minus one"},
    ("Wall", "azimuth"): {"minus one"},
    ("Channel", "azimuth"): {"minus one"},
    ("Channel", "tilt"): {"minus one"},
    ("UniformFlow", "speed"): {"minus one"},
    ("ShearFlow", "rate"): {"minus one"},
    ("StrainFlow", "rate"): {"minus one"},
    ("RotationFlow", "rate"): {"minus one"},
    ("PoiseuilleFlow", "speed"): {"minus one"},
    ("path", "phase"): {"minus one", "array"},
    ("trajectory", "rate"): {"minus one", "array"},
    ("trajectory", "phase"): {"minus one", "array"},
    ("observed", "phase"): {"minus one", "array"},
    ("observed", "body_length"): {*NUMBERS, "complex"},  # by complex steps
    ("Observation", "sigma"): {"array"},
    ("closed_form", "c_n"): {"minus one", "nan", "inf", "array"},  # in a map of designs
    ("closed_form", "c_t"): {"minus one", "nan", "inf", "array"},
    ("closed_form", "u_s"): {"minus one", "nan", "inf", "array"},
    ("io.enough_periods", "speed"): {"minus one", "nan", "inf", "array"},
    ("io.dataset", "known"): {"minus one"},
    ("Constant.from_held_tail", "thrust"): {"minus one"},
    ("Constant.from_held_tail", "torque"): {"minus one"},
    ("State.at", "phase"): {"minus one", "array"},
    **{(f"Gait.{name}", "phase"): {"minus one", "complex", "array"} for name in OF_PHASE},
    ("Gait.velocity", "rate"): {"minus one", "complex", "array"},
    ("Gait.at_rate", "rate"): {"minus one", "complex", "array"},
    ("Gait.in_lab_frame", "rate"): {"minus one", "complex", "array"},
    ("Gait.in_lab_frame", "sign"): {"minus one"},
    ("Gait.from_rotation", "G"): {"minus one", "complex", "array"},
    ("Gait.from_rotation", "sign"): {"minus one"},
    ("Sensor.read", "time"): {"minus one"},
}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """What a call writes after all, it writes into a folder of its own."""
    monkeypatch.chdir(tmp_path)


def thing(name):
    """The class, function or method of a name, a method with its swimmer or stepper."""
    found = ms
    for part in name.split("."):
        found = getattr(found, part)
    return getattr(SELF[name], name.partition(".")[2]) if name in SELF else found


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def spoilt():
    """Name of a callable, argument, label and value of every wrong call."""
    for name, good in CALLS.items():
        for argument, about in inspect.signature(thing(name)).parameters.items():
            if about.kind is about.VAR_KEYWORD:
                continue
            left_out = about.default is None
            number = is_number(good.get(argument, about.default))
            wrong = WRONG | (NUMBERS if number else {})
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


@pytest.mark.parametrize("name", [n for n in ms.__all__ if callable(getattr(ms, n))])
def test_every_public_callable_says_what_it_does_not_take(name):
    """Also what has no good call above, such as results, which the package makes."""
    for call in (lambda: getattr(ms, name)(colour=1), lambda: getattr(ms, name)(*range(40))):
        if issubclass(type(getattr(ms, name)), type) and issubclass(getattr(ms, name), Exception):
            return
        with pytest.raises((ms.SpecError, TypeError)) as caught:
            call()
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", CALLS)
def test_wrong_names_and_too_many_places_are_named(name):
    call, good = thing(name), CALLS[name]
    refused(lambda: call(**good, colour=1), "colour")
    refused(lambda: call(*range(20)), name.rpartition(".")[2])
    takes = inspect.signature(call).parameters
    for argument, value in good.items():
        if takes[argument].default is inspect.Parameter.empty:
            rest = {k: v for k, v in good.items() if k != argument}
            refused(lambda rest=rest: call(**rest), argument)
        assert value is good[argument]


@pytest.mark.parametrize(("name", "argument", "value"), list(spoilt()))
def test_a_wrong_value_is_refused_by_name(name, argument, value):
    refused(lambda: thing(name)(**CALLS[name] | {argument: value}), argument)


@pytest.mark.parametrize("name", CLASSES)
def test_good_calls_are_taken_with_the_numbers_of_numpy(name):
    """`int64` and `float32` are numbers; a list is as good as a tuple."""

    def of_numpy(value):
        if isinstance(value, float):
            return np.float32(value) if value == np.float32(value) else np.float64(value)
        return np.int64(value) if is_number(value) else value

    assert thing(name)(**{k: of_numpy(v) for k, v in CALLS[name].items()}) is not None
