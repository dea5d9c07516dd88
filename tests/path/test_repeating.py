"""After how many periods a shape comes back."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.path.repeating import repeats_after, words


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_a_motion_of_so_many_periods_is_told(count):
    t = np.linspace(0.0, 20.0, 641)
    x = np.stack([np.cos(2.0 * np.pi * t), 0.1 * np.sin(2.0 * np.pi * t / count)], axis=1)
    decaying = x + np.exp(-t)[:, None]
    assert repeats_after(t, decaying, 1.0) == count


def test_what_never_comes_back_is_told():
    t = np.linspace(0.0, 40.0, 1281)
    x = np.cos(2.0 * np.pi * t) + 0.1 * np.cos(2.0 * np.pi * t / np.sqrt(5.0))
    assert repeats_after(t, x[:, None], 1.0) == 0
    assert repeats_after(t[:65], np.cos(2.0 * np.pi * t[:65])[:, None], 1.0) == 0  # too short
    assert words(0) == "does not settle within this time"


def test_a_map_that_doubles_its_period_is_told_where_it_does():
    """The logistic map has its fixed point below 3, doubles at 3 and again at 1 + sqrt(6)."""
    told = {}
    for r in (2.8, 3.2, 3.5, 3.9):
        x = [0.4]
        for _ in range(900):
            x.append(r * x[-1] * (1.0 - x[-1]))
        strobes = np.array(x[-60:])
        t = np.linspace(0.0, 59.0, 59 * 16 + 1)
        told[r] = repeats_after(t, np.repeat(strobes, 16)[: len(t), None], 1.0)
    assert told == {2.8: 1, 3.2: 2, 3.5: 4, 3.9: 0}


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "count"), [(0.5, 2), (1.0, 1)])
def test_a_magnetic_tail_in_a_field_of_half_the_rate_takes_two_periods(rate, count):
    """Held, so that the field alone has another rate than the drive."""
    tail = ms.ElasticTail(
        length=1.0, radius=0.02, bending=0.5, drive="pivot", angle=0.2, magnet=(0.3, 0.0, 0.0)
    )
    held = ms.Swimmer(body=ms.Sphere(radius=0.2), tail=tail, fluid=ms.Fluid(viscosity=1.0))
    held = replace(held, motion=ms.Motion(free="none"))
    field = ms.RotatingField(strength=1.0, frequency=rate, axis=(1.0, 0.0, 0.0))
    found = ms.path(replace(held, field=field), 8.0, tolerance=1e-5)
    assert found.attrs["repeats_after"] == count
