"""What is printed or stored as JSON is JSON."""

import json

import numpy as np

from microswim.numerics.plain import plain


def test_what_json_has_no_word_for_becomes_what_it_has():
    given = {
        1: np.float32(0.5),
        "array": np.array([[1, 2], [3, 4]]),
        "truth": np.bool_(True),
        "mixed": (np.int64(3), None, float("inf"), [np.float64("nan")]),
        "path": {"a": object},
    }
    made = json.loads(json.dumps(plain(given), allow_nan=False))
    assert made["1"] == 0.5
    assert made["array"] == [[1, 2], [3, 4]]
    assert made["truth"] is True
    assert made["mixed"] == [3, None, None, [None]]
    assert isinstance(made["path"]["a"], str)


def test_plain_values_stay_as_they_are():
    given = {"a": [1, 2.5, "x", True, None]}
    assert plain(given) == given


def test_our_own_files_keep_nan_and_toml_leaves_out_what_is_none():
    given = {"a": None, "b": [np.nan, {"c": None, "d": np.inf}]}
    made = plain(given, nan=True)
    assert np.isnan(made["b"][0])
    assert made["a"] is None
    assert plain(given, none=False) == {"b": [None, {"d": None}]}
