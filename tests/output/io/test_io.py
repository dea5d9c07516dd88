"""Runs in and out of files: nothing is lost, everything has a unit and a birthplace."""

import csv

import numpy as np
import pint
import pytest

import microswim as ms
from microswim.gait.readable import prefixed, quantity, significant
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.output.io.surface import BODY, TAIL, bent, surface
from microswim.output.io.vtk import poly_data, write_swimmer
from microswim.spec import presets


@pytest.fixture(scope="module")
def cell():
    swimmer = ms.Swimmer.preset("goto/C")
    run = ms.io.dataset(swimmer, swimmer.gait(), periods=4, spec=presets.read("goto/C"))
    return swimmer, run


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_files_give_back_what_was_saved(tmp_path, cell, ending):
    path = ms.io.save(cell[1], tmp_path / f"run.{ending}")
    back = ms.io.load(path)
    assert back.identical(cell[1])


def test_csv_holds_the_path(tmp_path, cell):
    path = ms.io.save(cell[1], tmp_path / "path.csv")
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    assert ms.__version__ in comments[0]
    assert "s, m, rad" in comments[1]
    rows = list(csv.DictReader(lines[len(comments) :]))
    x = np.array([float(row["x"]) for row in rows])
    assert x == pytest.approx(cell[1].position.values[:, 0], rel=1e-11)


def test_unknown_endings_and_unreadable_files(tmp_path, cell):
    with pytest.raises(ms.SpecError, match="file ending"):
        ms.io.save(cell[1], tmp_path / "run.xlsx")
    (tmp_path / "run.nc").write_text("not a run")
    for name in ("run.nc", "none.nc", "none.zarr"):
        with pytest.raises(ms.SpecError, match="no readable run"):
            ms.io.load(tmp_path / name)


def test_every_variable_has_a_meaning_and_si_units_are_units(cell):
    registry = pint.UnitRegistry()
    for name, variable in cell[1].data_vars.items():
        assert variable.attrs.get("long_name") or variable.attrs.get("units"), name
        for unit in variable.attrs.get("units", "").split(","):
            registry.parse_units(unit.strip().replace("N m", "N*m"))


def test_provenance_rebuilds_the_swimmer(tmp_path, cell):
    swimmer, run = cell
    assert run.attrs["microswim_version"] == ms.__version__
    assert run.attrs["created"].endswith("+00:00")
    (tmp_path / "again.toml").write_text(run.attrs["spec"], encoding="utf-8")
    again = ms.Swimmer.from_toml(tmp_path / "again.toml")
    assert again == swimmer
    speed = ms.io.numbers(again, again.gait(run.attrs["model"]))["swimming_speed"]
    assert speed == float(run.swimming_speed)


def test_dataset_is_the_gait_and_the_trajectory():
    swimmer = ms.Swimmer.preset("tabak/plane_wave")
    gait = swimmer.gait()
    run = ms.io.dataset(swimmer, gait, periods=2.5)
    assert run.velocity.values == pytest.approx(gait.velocity(run.phase.values), abs=1e-15)
    path = ms.trajectory(gait, run.time.values)
    assert run.position.values == pytest.approx(path.position.values, abs=1e-15)
    assert float(run.time[-1]) == pytest.approx(2.5 * gait.period)
    mean = run.velocity.values[:-1].mean(axis=0)
    assert mean == pytest.approx(run.mean_velocity.values, abs=1e-12)


def test_loads_reach_the_trajectory():
    swimmer = ms.Swimmer.preset("tabak/helix")
    gait = swimmer.gait()
    still, swept = (ms.io.dataset(swimmer, gait, periods=2, **k) for k in ({}, {"flow": [0, 0, 1]}))
    drift = (swept.position - still.position).values[-1]
    assert drift == pytest.approx([0, 0, 2 * gait.period], abs=1e-9)


def test_the_default_path_is_as_long_as_said():
    for name in ("tabak/helix", "goto/G"):
        swimmer = ms.Swimmer.preset(name)
        run = ms.io.dataset(swimmer, swimmer.gait())
        length = 2 * swimmer.body.semi_axes3[0] + swimmer.tail.apparent_length
        gone = np.linalg.norm(run.position.values[-1] - run.position.values[0])
        assert 1.4 < gone / length < 1.7


@pytest.mark.parametrize("periods", [0, -1, float("nan"), 1e9])
def test_senseless_periods_are_refused(periods):
    swimmer = ms.Swimmer.preset("tabak/helix")
    with pytest.raises(ms.SpecError, match="periods"):
        ms.io.dataset(swimmer, swimmer.gait(), periods=periods)


def volume(mesh, part):
    """Volume inside the faces of a part, by the divergence theorem; positive if they face out."""
    a, b, c, d = np.moveaxis(mesh.points[mesh.quads[mesh.part == part]], 1, 0)
    return sum(np.sum(p * np.cross(q, r)) for p, q, r in ((a, b, c), (a, c, d))) / 6.0


def test_the_surface_encloses_body_and_filament():
    tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=3, radius=0.01, ramp=0)
    body = ms.Ellipsoid(semi_axes=(0.6, 0.4, 0.3))
    swimmer = ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0))
    mesh = surface(swimmer, 0.3, fineness=4.0)
    assert volume(mesh, BODY) == pytest.approx(4 / 3 * np.pi * 0.6 * 0.4 * 0.3, rel=2e-3)

    alone = ms.Swimmer(body=ms.NoBody(), tail=tail, fluid=ms.Fluid(viscosity=1.0))
    filament = np.pi * 0.01**2 * tail.arc_length + 4 / 3 * np.pi * 0.01**3  # two round ends
    closed = surface(alone, 0.3, fineness=4.0)
    assert volume(closed, TAIL) == pytest.approx(filament, rel=5e-3)


def test_the_surface_of_a_bent_filament_is_that_of_a_tail_of_its_shape():
    """Points along a helix, at a pose of the lab: the volumes inside and the tip are the same."""
    tail = ms.HelicalTail(length=2.0, amplitude=0.1, waves=1, radius=0.02, ramp=0)
    fluid = ms.Fluid(viscosity=1.0)
    swimmer = ms.Swimmer(body=ms.Sphere(radius=0.3), tail=tail, fluid=fluid)
    turn, place = rotation_matrix(np.array([0.8, 0.6, 0.0, 0.0])), np.array([1.0, -2.0, 0.5])
    P = tail.centreline(np.linspace(0.0, 2.0, 41), 0.3)[0] - swimmer.body.centre
    mesh = bent(swimmer, P @ turn.T + place, place, turn, fineness=2.0)
    same = surface(swimmer, 0.3, fineness=2.0).moved(place, turn)
    for part in (BODY, TAIL):
        assert volume(mesh, part) == pytest.approx(volume(same, part), rel=2e-3)
    tips = [m.points[m.quads[m.part == TAIL]].reshape(-1, 3)[-1] for m in (mesh, same)]
    assert np.linalg.norm(tips[0] - tips[1]) < 0.03


def test_the_surface_of_a_helix_turns_as_a_whole():
    swimmer = ms.Swimmer.preset("tabak/helix")
    angle = 0.7
    turn = rotation_matrix(np.array([np.cos(angle / 2), np.sin(angle / 2), 0, 0]))
    start, later = surface(swimmer, 0.0), surface(swimmer, angle)
    tube = np.unique(start.quads[start.part == TAIL])
    rings = [m.points[tube].reshape(-1, 12, 3).mean(axis=1) for m in (start, later)]
    assert rings[1] == pytest.approx(rings[0] @ turn.T, abs=1e-12)


def test_vtk_files_are_read_by_vtk(tmp_path, cell):
    pv = pytest.importorskip("pyvista")
    swimmer, run = cell
    reader = pv.get_reader(str(write_swimmer(tmp_path, swimmer, run, frames=5)))
    assert len(reader.time_values) == 5
    reader.set_active_time_value(reader.time_values[2])
    (mesh,) = reader.read()
    index = int(np.argmin(np.abs(run.time.values - reader.time_values[2])))
    body = np.unique(mesh.faces.reshape(-1, 5)[mesh["part"] == BODY, 1:])
    centre = (mesh.points[body].min(axis=0) + mesh.points[body].max(axis=0)) / 2
    assert centre == pytest.approx(run.position.values[index], abs=2e-8)
    path = pv.read(str(tmp_path / "path.vtp"))
    assert path.points == pytest.approx(run.position.values, abs=1e-12)
    assert path["time"] == pytest.approx(run.time.values)


def test_poly_data_refuses_types_it_cannot_write():
    with pytest.raises(KeyError):
        poly_data(np.zeros((1, 3), dtype=complex))


@pytest.mark.parametrize(
    ("value", "unit", "shown"),
    [
        (2.353e-5, "m/s", "23.53 µm/s"),
        (1e-6, "m", "1.000 µm"),
        (999.9e-9, "m", "999.9 nm"),
        (-0.5, "m/s", "-500.0 mm/s"),
        (187.7, "Hz", "187.7 Hz"),
        (1.692e-19, "N m", "0.1692 pN µm"),
        (9.371e-10, "N m", "0.9371 nN m"),
        (1.817e-9, "N m", "1.817 nN m"),
        (4.0e-13, "N m", "400.0 nN µm"),
        (4.0e-17, "N m", "40.00 pN µm"),
        (2.5e-17, "W", "0.02500 fW"),
        (3.1e-13, "W", "310.0 fW"),
        (1e-12, "N", "1.000 pN"),
        (0.002, "N m", "2.000 mN m"),
        (1500.0, "m", "1500 m"),
        (0.0, "m/s", "0 m/s"),
        (float("inf"), "m", "infinite"),
        (float("nan"), "m", "not defined"),
        (-0.0369872, "length/time", "-0.03699"),
        (1e-9, "1", "1.000e-09"),
    ],
)
def test_quantities_read_well(value, unit, shown):
    assert quantity(value, unit) == shown


@pytest.mark.parametrize("size", [1e-30, 3e-7, 1e-6, 9.99, 1e3, 1e12])
def test_a_prefix_never_changes_the_value(size):
    registry = pint.UnitRegistry()
    for unit in ("m", "s", "Hz", "W", "N", "m/s", "N m"):
        factor, name = prefixed(size, unit)
        assert registry.Quantity(size * factor, name).to(unit).magnitude == pytest.approx(size)


def test_significant_digits():
    assert [significant(x, 3) for x in (0, 1234.5, 0.00012345, 1e7)] == [
        "0",
        "1234",
        "0.000123",
        "1.00e+07",
    ]


def test_a_moved_surface_has_its_pose():
    swimmer = ms.Swimmer.preset("tabak/helix")
    half = np.pi / 4  # a quarter turn about z takes s to y
    turn = rotation_matrix(np.array([np.cos(half), 0, 0, np.sin(half)]))
    mesh = surface(swimmer).moved(np.array([1.0, 2.0, 3.0]), turn)
    tail = mesh.points[np.unique(mesh.quads[mesh.part == TAIL])]
    assert tail[:, 1].max() == pytest.approx(2.0 + 0.5 + 2.0, abs=0.06)
    assert abs(tail[:, 0].mean() - 1.0) < 0.05
