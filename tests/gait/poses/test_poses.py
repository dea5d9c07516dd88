"""A gait as a function of the pose, in free fluid: the gait itself, wherever it is."""

from __future__ import annotations

import numpy as np
import pytest

import microswim as ms
from microswim.errors import SpecError
from microswim.gait.poses.face import FreePoses
from microswim.gait.poses.table import WORK, resist
from microswim.numerics.compiling.compiled import settled


def test_a_free_gait_is_the_same_at_every_pose() -> None:
    gait = ms.Swimmer.preset("tabak/plane_wave").gait()
    poses = FreePoses(gait)
    for phase in (0.0, 1.3, -7.7):
        R, F = poses.at([1.0, 2.0, 3.0], [0.5, 0.5, -0.5, 0.5], phase)
        assert np.allclose(R, gait.resistance(phase), rtol=1e-12, atol=1e-9)
        assert np.allclose(F, gait.propulsion(phase), rtol=1e-12, atol=1e-9)
    assert poses.gap([0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 0.0) == np.inf


def test_compiled_and_python_agree() -> None:
    table = FreePoses(ms.Swimmer.preset("tabak/helix").gait()).table
    found = []
    for compile_it in (False, True):
        R, F, touch = np.empty((6, 6)), np.empty(6), np.empty(14)
        with settled(compile_it):
            q = np.array([1.0, 0.0, 0.0, 0.0])
            resist(table, np.zeros(3), q, 0.7, R, F, touch, np.empty(WORK))
        found.append((R, F))
    assert np.allclose(found[0][0], found[1][0], rtol=1e-12, atol=1e-12)
    assert np.allclose(found[0][1], found[1][1], rtol=1e-12, atol=1e-12)


def test_a_gait_that_holds_at_one_pose_is_refused() -> None:
    gait = ms.Swimmer.preset("tabak/helix").gait()
    held = ms.Gait(
        gait.resistance_series, gait.propulsion_series, gait.activity_series,
        rate=gait.rate, info={"one_pose": "wall"},
    )  # fmt: skip
    with pytest.raises(SpecError, match="one pose"):
        FreePoses(held)
