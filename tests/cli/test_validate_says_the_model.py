"""What ``microswim validate`` judges: the surrogate, which may not be what run takes."""

from __future__ import annotations

from dataclasses import replace

import pytest

import microswim as ms
from microswim.cli.validate import heading

OPEN = ms.Swimmer(
    body=ms.Sphere(radius=0.5),
    tail=ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.05),
    fluid=ms.Fluid(viscosity=1.0),
)
REPORT = {"model": "rft", "against": "bem", "over": {"tail.waves": [1, 2], "tail.length": [1, 2]}}


@pytest.mark.parametrize(
    ("swimmer", "takes_it"),
    [(OPEN, True), (replace(OPEN, coefficients=ms.GrayHancock()), False),
     (replace(OPEN, body=ms.Sphere(radius=50.0)), False)],
)  # fmt: skip
def test_the_heading_says_where_run_takes_the_atlas(swimmer, takes_it):
    said = heading(swimmer, REPORT)
    assert said.startswith("rft against bem, 4 designs")
    assert ("run takes the atlas" in said) is takes_it
    assert (swimmer.gait("auto").model == "atlas") is takes_it
