"""Many cells at once: each as it is alone, and one that cannot be fitted keeps none from it."""

import numpy as np
import pytest
from test_honest_fits import START, wave_track

import microswim as ms

NAMES = ("tail.amplitude", "tail.frequency")
FROM = {name: START[name] for name in NAMES}


def films():
    return {"a": wave_track(0), "slow": wave_track(0, n=40, duration=40.0), "b": wave_track(1)}


def test_many_are_fitted_as_each_is_alone():
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_({"tail.waves": 1.6})
    found = ms.identify_swimmers(swimmer, films(), NAMES, start=FROM, workers=0)
    assert list(found) == ["a", "slow", "b"]
    assert "above half the frame rate" in str(found["slow"])
    for name in "ab":
        alone = ms.identify_swimmer(swimmer, films()[name], NAMES, start=FROM)
        np.testing.assert_array_equal(found[name].interval(), alone.interval())


@pytest.mark.parametrize(
    ("tracks", "options"),
    [([1], {}), ({"a": 3}, {}), ({}, {"workers": -1}), ({}, {"starts": 0}), ({}, {"sigma": -1.0})],
)
def test_calls_that_make_no_sense(tracks, options):
    with pytest.raises(ms.SpecError):
        ms.identify_swimmers(ms.Swimmer.preset("tabak/plane_wave"), tracks, **options)


@pytest.mark.slow
def test_worker_processes_find_the_same():
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_({"tail.waves": 1.6})
    some = {f"{i}": wave_track(i) for i in range(5)}
    here = ms.identify_swimmers(swimmer, some, NAMES, workers=0)
    there = ms.identify_swimmers(swimmer, some, NAMES, workers=2)
    for name in some:
        np.testing.assert_allclose(there[name].interval(), here[name].interval(), rtol=1e-9)


@pytest.mark.slow
def test_many_long_tracks_hold_what_each_holds_alone():
    rng = np.random.default_rng(2)
    t = np.arange(40_000) / 100.0
    tracks = {
        name: ms.Track(time=t, position=np.stack([v * t, 0 * t], -1) + rng.normal(size=(t.size, 2)))
        for name, v in (("slow", 1.0), ("quick", 3.0), ("still", 0.0))
    }
    seen = []
    there = ms.describe_tracks(tracks, workers=2, progress=lambda k, n: seen.append((k, n)))
    assert list(there) == list(tracks)
    assert seen == [(1, 3), (2, 3), (3, 3)]
    for name, track in tracks.items():
        alone = ms.describe_track(track, name)
        assert there[name].notes == alone.notes
        assert there[name].name == name
        np.testing.assert_allclose(there[name].path, alone.path, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(there[name].displacement, alone.displacement, rtol=1e-9)
    assert there["quick"].numbers["speed"].low < 3.0 < there["quick"].numbers["speed"].high
