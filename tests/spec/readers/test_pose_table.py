"""A table of poses: units, order, and what stays as it is in the scene."""

import numpy as np
import pytest

import microswim as ms
from microswim.spec.readers.pose_table import read_group_poses

CELL = ms.Swimmer.preset("goto/A")
PAIR = ms.Group((
    ms.Member(swimmer=CELL, position=(1e-6, 0, 0), phase=0.3),
    ms.Member(swimmer=CELL, position=(0, 2e-5, 0), roll=0.1),
))  # fmt: skip


def test_lengths_have_units_and_the_rest_stays(tmp_path):
    (tmp_path / "a.csv").write_text(
        "pose,swimmer,x (um),y (um),z (um),dx,dy,dz,phase (deg)\n"
        "7,1,0,30,0,0,1,0,90\n3,1,0,40,1,1,0,0,180\n"
    )
    found = read_group_poses(tmp_path / "a.csv", PAIR)
    assert set(found) == {"positions", "directions", "phases"}
    assert found["positions"] == pytest.approx(
        np.array([[[1, 0, 0], [0, 40, 1]], [[1, 0, 0], [0, 30, 0]]]) * 1e-6
    )
    assert found["directions"].tolist() == [[[1, 0, 0], [1, 0, 0]], [[1, 0, 0], [0, 1, 0]]]
    assert found["phases"] == pytest.approx(np.array([[0.3, np.pi], [0.3, np.pi / 2]]))


def test_angles_without_a_unit_are_radians_and_places_may_stay(tmp_path):
    (tmp_path / "a.csv").write_text("pose,swimmer,phase\n0,0,1.5\n1,1,0.5\n")
    found = read_group_poses(tmp_path / "a.csv", PAIR)
    assert found["phases"].tolist() == [[1.5, 0.0], [0.3, 0.5]]
    assert found["positions"][1].tolist() == [[1e-6, 0, 0], [0, 2e-5, 0]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("pose,swimmer,x,y,z\n0,1,0,3,0\n", "unit"),
        ("pose,swimmer,x (um),y (um)\n0,1,0,3\n", "x, y alone"),
        ("pose,swimmer,phase\n0,0.5,3\n", "whole numbers"),
        ("pose,swimmer,phase\n0,-1,3\n", "0 to 1"),
        ("pose,swimmer,phase\n0,1,\n", "a number is missing"),
        ("pose,x (um),y (um),z (um)\n0,0,3,0\n", "no column swimmer"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, text, said):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(ms.SpecError, match=said):
        read_group_poses(tmp_path / "a.csv", PAIR)
