"""The stiffness and the length that swim best, by the laws of a bending filament."""

from dataclasses import replace

import pytest

import microswim as ms


def shaken(viscosity=1.0, size=1.0):
    """A sphere with a tail turned at its base; all lengths times a size, the same frequency."""
    tail = ms.ElasticTail(
        length=size, radius=0.02 * size, bending=0.2, drive="pivot", angle=0.2, frequency=1.0
    )
    body = ms.Sphere(radius=0.2 * size)
    return ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=viscosity))


def best(swimmer, **over):
    found = ms.design(swimmer, over, maximize="swimming_speed", samples=64)
    return next(iter(found.values.values())), found.value


@pytest.mark.slow
def test_the_best_stiffness_goes_with_viscosity_and_the_fourth_power_of_the_size():
    """Only ``bending / (viscosity frequency L^4)`` counts, and speeds go with the size."""
    stiff, speed = best(shaken(), **{"tail.bending": (0.02, 1.0)})
    thick, same = best(shaken(viscosity=3.0), **{"tail.bending": (0.06, 3.0)})
    large, twice = best(shaken(size=2.0), **{"tail.bending": (0.32, 16.0)})
    assert thick / stiff == pytest.approx(3.0, rel=1e-3)
    assert large / stiff == pytest.approx(16.0, rel=1e-3)
    assert same == pytest.approx(speed, rel=1e-6)
    assert twice == pytest.approx(2.0 * speed, rel=1e-6)


@pytest.mark.slow
def test_the_best_length_is_faster_than_its_neighbours():
    start = shaken()
    length, speed = best(start, **{"tail.length": (0.4, 3.0)})
    assert 0.45 < length < 2.9
    for share in (0.97, 1.03):
        near = replace(start, tail=replace(start.tail, length=share * length))
        there = float(ms.observed(near.gait("elastic"), "swimming_speed"))
        assert 0.9 * speed < there < speed
