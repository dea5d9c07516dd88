"""B on a grid: free of sources between its points, and right to the order of its splines."""

from dataclasses import replace

import magpylib
import numpy as np
import pytest

import microswim as ms
from microswim.spec.file import from_dict
from microswim.spec.readers.magnetic import GridWarning
from microswim.spec.readers.text import toml
from microswim.swimmer.magnetism.grid import GridCoil

EDGE = 0.01
PLACES = np.random.default_rng(3).uniform(-0.95 * EDGE, 0.95 * EDGE, (200, 3))


def magnet():
    """A block beside the grid, by another package."""
    return magpylib.magnet.Cuboid(
        polarization=(0.4, -0.7, 0.9), dimension=(0.02, 0.03, 0.01), position=(0.03, 0.01, -0.02)
    )


def axes(n):
    """Planes of three unequal numbers; along z they are not evenly spaced."""
    u = np.linspace(-1.0, 1.0, n + 2)
    uneven = EDGE * (u + 0.1 * u**3) / 1.1
    return [EDGE * np.linspace(-1, 1, n), EDGE * np.linspace(-1, 1, n + 1), uneven]


def grid(n, field, noise=0.0):
    planes = axes(n)
    nodes = np.stack(np.meshgrid(*planes, indexing="ij"), axis=-1)
    B = field(nodes.reshape(-1, 3)).reshape(nodes.shape)
    return GridCoil("one", *planes, B + noise * np.random.default_rng(1).standard_normal(B.shape))


def off(found, wanted):
    return np.abs(found - wanted).max() / np.abs(wanted).max()


def test_it_converges_to_a_block_magnet_at_the_order_of_the_splines():
    field = magnet().getB
    exact = field(PLACES)
    missed = [off(grid(n, field).field(PLACES), exact) for n in (6, 12, 24)]
    assert missed[2] < 2e-6
    assert np.log2(missed[0] / missed[1]) > 4.0
    assert np.log2(missed[1] / missed[2]) > 4.0
    few = [off(grid(n, field).field(PLACES), exact) for n in (4, 5)]
    assert few[1] < few[0] < 0.05


def test_the_gradient_converges_to_that_of_a_dipole():
    dipole = ms.DipoleField(moment=(3.0, -7.0, 5.0), position=(0.05, 0.02, -0.04))
    exact = dipole.gradient(0.0, PLACES)
    one = [grid(n, lambda x: dipole.at(0.0, x)) for n in (6, 12, 24)]
    missed = [off(g.gradient(PLACES), exact) for g in one]
    assert missed[2] < 1e-5
    assert np.log2(missed[0] / missed[1]) > 3.0
    assert np.log2(missed[1] / missed[2]) > 3.0


@pytest.mark.parametrize("noise", [0.0, 0.05])
@pytest.mark.parametrize("n", [4, 9])
def test_it_has_no_sources_whatever_is_measured(n, noise):
    """Noise of a Gauss meter has sources; what is between the points has none."""
    field = magnet().getB
    one = grid(n, field, noise * np.abs(field(PLACES)).max())
    J = one.gradient(PLACES)
    trace = np.trace(J, axis1=-2, axis2=-1)
    assert np.abs(trace).max() < 1e-10 * np.abs(J).max()
    h = 1e-6
    sides = [one.field(PLACES + h * e) - one.field(PLACES - h * e) for e in np.eye(3)]
    assert np.stack(sides, axis=-1) / (2 * h) == pytest.approx(J, abs=1e-4 * np.abs(J).max())
    assert one.mended > 0.02 * noise


def test_noise_comes_out_no_larger_than_it_went_in():
    field = magnet().getB
    size = np.abs(field(PLACES)).max()
    miss = grid(9, field, 0.01 * size).field(PLACES) - field(PLACES)
    assert np.sqrt(np.mean(miss**2)) < 0.013 * size


def written(path, coils, planes, *, drop=0, unit="mT", shuffled=True):
    nodes = np.stack(np.meshgrid(*planes, indexing="ij"), axis=-1).reshape(-1, 3)
    rows = []
    for name, field in coils.items():
        B = field(nodes)
        rows += [[name, *(1e3 * x), *(1e3 * b)] for x, b in zip(nodes, B)]
    if shuffled:
        np.random.default_rng(0).shuffle(rows)
    head = f"coil,x (mm),y (mm),z (mm),Bx ({unit}),By ({unit}),Bz ({unit})"
    lines = [",".join(map(str, row)) for row in rows[drop:]]
    path.write_text("\n".join([head, *lines]), encoding="utf-8")
    return str(path)


def test_a_table_of_two_coils_is_read_in_any_order_of_points(tmp_path):
    dipoles = {
        "left": ms.DipoleField(moment=(3.0, -7.0, 5.0), position=(0.05, 0.02, -0.04)),
        "right": ms.DipoleField(moment=(1.0, 2.0, 5.0), position=(-0.06, 0.0, 0.0)),
    }
    coils = {name: (lambda x, d=d: d.at(0.0, x)) for name, d in dipoles.items()}
    file = written(tmp_path / "grid.csv", coils, axes(12))
    field = ms.CoilField(file=file, currents=(2.0, -0.5), frequency=1.0, phases=(0.0, 0.3))
    order = [coil.name for coil in field.coils]
    now = dict(zip(order, (2.0 * np.cos(0.2 * np.pi), -0.5 * np.cos(0.2 * np.pi + 0.3))))
    wanted = sum(now[name] * d.at(0.0, PLACES) for name, d in dipoles.items())
    assert off(field.at(0.1, PLACES), wanted) < 1e-5
    assert set(order) == {"left", "right"}


def test_a_path_in_a_grid_is_that_in_the_field_itself(tmp_path):
    dipole = ms.DipoleField(moment=(3.0, -7.0, 5.0), position=(0.05, 0.02, -0.04))
    file = written(tmp_path / "grid.csv", {"one": lambda x: dipole.at(0.0, x)}, axes(16))
    text = f"""
    [fluid]
    viscosity = "0.34 Pa s"
    [body]
    shape = "sphere"
    radius = "0.5 mm"
    [tail]
    kind = "none"
    [magnet]
    moment = ["1e-6 A m^2", "3e-6 A m^2", "0 A m^2"]
    [field]
    kind = "coils"
    file = {file!r}
    """
    robot = from_dict(toml(text, "robot"))
    one = ms.path(robot, 1.0, model="rft", samples=3)
    other = ms.path(replace(robot, field=None), 1.0, model="rft", samples=3)
    exact = ms.trajectory(
        robot.gait("rft"), one.time.values, rate=0, moment=robot.magnet, field=dipole
    )
    assert one.position.values[-1] == pytest.approx(exact.position.values[-1], rel=1e-4)
    assert np.linalg.norm(one.position.values[-1]) > 1e-4
    assert not other.position.values[-1].any()


def test_swapped_columns_are_noticed(tmp_path):
    """B with two components exchanged has sources as large as itself."""
    file = written(
        tmp_path / "grid.csv", {"one": lambda x: magnet().getB(x)[:, [1, 0, 2]]}, axes(6)
    )
    with pytest.warns(GridWarning, match="has sources"):
        ms.CoilField(file=file)


def test_what_lies_outside_is_said():
    one = grid(6, magnet().getB)
    with pytest.raises(ms.MicroswimError, match=r"x = 0\.011 m lies outside the grid"):
        one.field((0.011, 0.0, 0.0))


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"drop": 3}, "3 are missing"),
        ({"unit": "mm"}, "Bx"),
        ({"planes": [EDGE * np.linspace(-1, 1, 3)] * 3}, "4 or more"),
    ],
)
def test_what_is_no_grid_is_refused(tmp_path, change, word):
    given = {"planes": axes(5), **change}
    file = written(tmp_path / "grid.csv", {"one": magnet().getB}, **given)
    with pytest.raises(ms.SpecError, match=word):
        ms.CoilField(file=file)
