"""The published data: each set has a birthplace, and the sets agree with each other."""

import csv
import tomllib
from importlib.resources import files
from pathlib import Path

import numpy as np
import pint
import pytest
import xarray as xr

import microswim as ms
from microswim.spec import presets

FOLDER = Path(str(files("microswim.data")))
SIDECAR = {"title", "source", "place", "obtained", "uncertainty", "rights", "note"}


@pytest.mark.parametrize("name", ms.data.names())
def test_every_set_has_a_birthplace(name):
    sidecar = tomllib.loads((FOLDER / f"{name}.toml").read_text())
    assert SIDECAR | {"index", "columns"} == set(sidecar)
    assert all(isinstance(sidecar[key], str) and sidecar[key] for key in SIDECAR)
    with (FOLDER / f"{name}.csv").open() as file:
        header, *rows = csv.reader(file)
    assert set(header) == set(sidecar["index"]) | set(sidecar["columns"])
    assert {len(row) for row in rows} == {len(header)}


@pytest.mark.parametrize("name", ms.data.names())
def test_every_column_has_a_unit_that_means_something(name):
    registry = pint.UnitRegistry()
    for variable in ms.data.load(name).data_vars.values():
        assert variable.attrs["long_name"]
        unit = variable.attrs["units"]
        assert unit == "dimensionless" or registry.Unit(unit if unit != "1" else "") is not None


def test_no_sidecar_without_its_data():
    stems = {path.stem for path in FOLDER.glob("*.toml")}
    assert stems == set(ms.data.names())


@pytest.mark.parametrize("name", ms.data.names())
def test_a_set_survives_the_trip_through_a_file(name, tmp_path):
    dataset = ms.data.load(name)
    dataset.to_netcdf(tmp_path / "set.nc")
    with xr.open_dataset(tmp_path / "set.nc") as back:
        xr.testing.assert_equal(dataset, back)
        assert back.attrs == dataset.attrs


def test_unknown_set_is_refused_with_the_list():
    with pytest.raises(ms.SpecError, match=r"data set = 'goto'.*tabak-table-2"):
        ms.data.load("goto")


def test_unknown_preset_is_refused_with_the_list():
    with pytest.raises(ms.SpecError, match=r"preset = '\.\./x'.*tabak/helix"):
        presets.read("../x")


def test_table_1_agrees_with_itself():
    """The Reynolds number fixes the viscosity, and that the body's two printed resistances."""
    table = ms.data.load("tabak-table-1").value
    value = {name: float(table.sel(parameter=name)) for name in table.parameter.values}
    radius = value["body_radius"]
    viscosity = value["density"] * value["frequency"] * (2 * radius) ** 2 / value["reynolds_number"]
    body = ms.Sphere(radius=radius).resistance(viscosity)
    half_a_digit = 0.05
    assert abs(body[0, 0] - value["body_translational_resistance"]) < half_a_digit
    assert abs(body[3, 3] - value["body_rotational_resistance"]) < half_a_digit
    waves = value["tail_apparent_length"] / value["wavelength"]
    assert waves == pytest.approx(round(waves), abs=1e-12)


def test_table_2_agrees_with_the_data_bank():
    """Tail lengths of the specimens lie in the spread that BOSO-Micro gives for the species."""
    length = ms.data.load("tabak-table-2").tail_length
    species = ms.data.load("boso-micro-bacteria").sel(Species="Vibrio alginolyticus")
    assert (abs(length - species.L) < species.dL).all()


def test_table_4_errors_are_smaller_than_what_they_are_errors_of():
    table = ms.data.load("tabak-table-4").stack(row=("tail", "quantity", "varied", "coefficients"))
    table = table.dropna("row")
    assert table.sizes["row"] == 24
    assert (table.range_from * table.range_to > 0).all()
    assert (table.absolute_error < np.maximum(abs(table.range_from), abs(table.range_to))).all()


def test_measured_helices_dissipate():
    """Drag and rotational resistance outweigh the coupling: the axial 2 x 2 matrix is positive."""
    purcell = ms.data.load("purcell1997-helices")
    assert (purcell.A_over_6pi * purcell.D_over_6pi > purcell.B_over_6pi**2).all()
    rodenborn = ms.data.load("rodenborn2013-helix")
    product = rodenborn.drag_over_eta_U_R * rodenborn.torque_over_eta_Omega_R3
    assert (product > rodenborn.thrust_over_eta_Omega_R2**2).all()


def test_methods_are_judged_against_the_measured_helix():
    helix = ms.data.load("rodenborn2013-helix").sel(lambda_over_R=9.811)
    measured = ms.data.load("rodenborn2013-methods").sel(model="experiment(digitised)")
    for column in measured.data_vars:
        assert float(measured[column]) == float(helix[column])


@pytest.mark.parametrize("specimen", "ABCDEFG")
def test_presets_of_the_specimens_hold_table_2(specimen):
    spec = tomllib.loads(presets.read(f"goto/{specimen}"))
    row = ms.data.load("tabak-table-2").sel(specimen=specimen)
    quantity = pint.UnitRegistry()
    pairs = {
        "frequency": spec["tail"]["frequency"],
        "tail_length": spec["tail"]["length"],
        "body_semi_axis_s": spec["body"]["semi_axes"][0],
        "body_semi_axis_q": spec["body"]["semi_axes"][1],
    }
    for column, text in pairs.items():
        assert quantity(text).m_as(row[column].units) == pytest.approx(float(row[column]))


@pytest.mark.parametrize("tail", ["helix", "plane_wave"])
@pytest.mark.parametrize("coefficients", ["constant", "sbt"])
def test_presets_of_the_paper_hold_table_3(tail, coefficients):
    spec = tomllib.loads(presets.read(f"tabak/{tail}-{coefficients}"))
    row = ms.data.load("tabak-table-3").sel(tail=tail, coefficients=coefficients)
    translation, rotation = spec["interaction"]["translation"], spec["interaction"]["rotation"]
    entries = {
        "gamma_N_s": translation[0],
        "gamma_N_q": translation[1],
        "gamma_R_s": rotation[0],
        "gamma_R_r": rotation[2],
    }
    for column, entry in entries.items():
        printed = float(row[column])
        assert entry == (1.0 if np.isnan(printed) else printed)


@pytest.mark.parametrize("name", [n for n in presets.names() if n.startswith("tabak/")])
def test_presets_of_the_paper_hold_table_1(name):
    table = ms.data.load("tabak-table-1").value
    spec = tomllib.loads(presets.read(name))
    tail, fluid = spec["tail"], spec["fluid"]
    pairs = {
        "body_radius": spec["body"]["radius"],
        "tail_radius": tail["radius"],
        "tail_apparent_length": tail["length"],
        "wavelength": tail["length"] / tail["waves"],
        "amplitude": tail["amplitude"],
        "frequency": tail["frequency"],
        "density": fluid["density"],
        "reynolds_number": fluid["density"] * tail["frequency"] / fluid["viscosity"],
    }
    for parameter, value in pairs.items():
        assert value == pytest.approx(float(table.sel(parameter=parameter)), rel=1e-12)
