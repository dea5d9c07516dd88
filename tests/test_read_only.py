"""Nobody writes into what a frozen object holds: not into its arrays, however deep they lie."""

import copy
import pickle
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

import microswim as ms

HELIX = ms.Swimmer.preset("tabak/helix")
GAIT = HELIX.gait()
TIMES = np.linspace(0.0, 3.0, 40)
RUN = ms.io.dataset(HELIX, GAIT, periods=1)
OVER = {"tail.amplitude": (0.08, 0.12)}


def a_track():
    return ms.Track(time=TIMES, position=ms.trajectory(GAIT, TIMES).position.values)


def beat(s, phase):
    q = 0.1 * s * np.cos(3 * s - phase)
    return np.stack([s + 0 * q, q, 0 * q], axis=-1)


MADE = {
    "swimmer": lambda: HELIX,
    "custom tail": lambda: ms.CustomTail(shape=beat, length=2.0, radius=0.02, breaks=[0.5]),
    "gait": lambda: HELIX.gait(),
    "gait of a plane wave": lambda: ms.Swimmer.preset("tabak/plane_wave").gait(),
    "gait of the atlas": lambda: HELIX.gait("atlas"),
    "screw": lambda: ms.screw(GAIT),
    "stepper": lambda: ms.Stepper(GAIT, HELIX, moment=np.ones(3)),
    "state": lambda: ms.Stepper(GAIT).step(ms.State.at(), dt=0.1),
    "track": a_track,
    "observation": lambda: ms.Observation(
        swimmer=HELIX, quantity="velocity.us", value=TIMES, sigma=0.1 + TIMES, phase=TIMES
    ),
    "calibration": lambda: ms.calibrate(HELIX, GAIT, ["translation.s"]),
    "region": lambda: ms.calibrate_region(HELIX, OVER, "rft", solves=8, workers=0),
    "validation": lambda: ms.validate(HELIX, {"tail.amplitude": [0.1]}, "rft", workers=0),
    "optimum": lambda: ms.design(HELIX, OVER, "efficiency", samples=16),
    "identification": lambda: ms.identify_swimmer(HELIX, a_track(), ["tail.amplitude"], start={}),
}


def arrays(thing, path, seen):
    """Every array that can be reached by a name without underscore, with how."""
    if id(thing) in seen:
        return
    seen[id(thing)] = thing
    if isinstance(thing, np.ndarray):
        yield path, thing
    elif isinstance(thing, dict):
        for key, value in thing.items():
            yield from arrays(value, f"{path}[{key!r}]", seen)
    elif isinstance(thing, (tuple, list)):
        for i, value in enumerate(thing):
            yield from arrays(value, f"{path}[{i}]", seen)
    elif is_dataclass(thing) and not isinstance(thing, type):
        names = {f.name for f in fields(thing)} | set(vars(thing))  # and what was computed before
        for name in sorted(n for n in names if not n.startswith("_")):
            yield from arrays(getattr(thing, name), f"{path}.{name}", seen)


def touched(thing):
    """The object after every property was asked, so that what it keeps is there."""
    for name in dir(type(thing)):
        kept = getattr(type(thing), name)
        if not name.startswith("_") and (isinstance(kept, property) or hasattr(kept, "attrname")):
            getattr(thing, name)
    return thing


@pytest.mark.parametrize("name", MADE)
def test_what_an_object_holds_cannot_be_written(name):
    made = touched(MADE[name]())
    for again in (made, pickle.loads(pickle.dumps(made)) if name != "custom tail" else made):
        found = dict(arrays(again, name, {}))
        writable = [path for path, array in found.items() if array.flags.writeable]
        assert [p for p in writable if ".packed" not in p] == []  # for the compiled loops


def test_the_caller_keeps_his_array():
    own = np.array(GAIT.resistance_series)
    gait = ms.Gait(own, GAIT.propulsion_series, GAIT.activity_series, rate=1.0)
    own[:] = 0.0
    assert np.abs(gait.resistance_series).max() > 0
    with pytest.raises(ValueError, match="read-only"):
        gait.resistance_series[0] = 0.0
    with pytest.raises(ValueError, match="read-only"):
        gait.mean_velocity[0] = 0.0


def test_a_copy_is_as_its_original():
    for made in (copy.deepcopy(GAIT), copy.copy(GAIT)):
        assert made.mean_velocity.tolist() == GAIT.mean_velocity.tolist()
        assert not made.propulsion_series.flags.writeable


@pytest.mark.parametrize(
    "result",
    [
        lambda _: ms.trajectory(GAIT, TIMES),
        lambda _: ms.sweep(HELIX, {"tail.amplitude": [0.05, 0.1]}),
        lambda folder: ms.sweep(HELIX, {"tail.amplitude": [0.05, 0.1]}, out=folder / "a.zarr"),
        lambda _: ms.robustness(HELIX, {"tail.amplitude": "5%"}, samples=8),
        lambda _: ms.io.dataset(HELIX, GAIT, periods=1),
        lambda folder: ms.io.load(ms.io.save(RUN, folder / "run.nc")),
        lambda folder: ms.io.load(ms.io.save(RUN, folder / "run.zarr")),
    ],
)
def test_tables_of_results_cannot_be_written_in_place(result, tmp_path):
    """A new table from an old one is written freely."""
    table = result(tmp_path)
    for name, variable in table.data_vars.items():
        assert not variable.values.flags.writeable, name
    first = next(iter(table.data_vars))
    with pytest.raises(ValueError, match="read-only"):
        table[first].values[0] = 0.0
    own = table.copy(deep=True)
    own[first].values[0] = 0.0
