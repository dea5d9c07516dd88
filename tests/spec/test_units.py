"""Units at the door: what each means, which are none, and one rule for every door."""

import math
import tomllib

import pint
import pytest

import microswim as ms
from microswim.spec.file import from_dict
from microswim.spec.units import SIZES, _registry, parse, to_si

TURN = 2 * math.pi


@pytest.mark.parametrize(
    ("text", "hertz"),
    [
        ("1 rps", 1.0),
        ("60 rpm", 1.0),
        ("2 krpm", 2000 / 60),
        ("1 rad/s", 1 / TURN),
        ("1 mrad/s", 1e-3 / TURN),
        ("1 krad/s", 1e3 / TURN),
        ("360 deg/s", 1.0),
        ("360 °/s", 1.0),
        ("3 turn/min", 0.05),
        ("2 cycles/s", 2.0),
        ("2 rev/s", 2.0),
        ("5 kHz", 5000.0),
        ("2 s^-1", 2.0),
        ("2 /s", 2.0),
    ],
)
def test_a_turn_is_a_cycle_whatever_the_prefix(text, hertz):
    assert to_si(text, "Hz") == pytest.approx(hertz, rel=1e-14)
    assert to_si(text, "rad/s") == pytest.approx(hertz * TURN, rel=1e-14)


WRONG = [
    ("5 px", "m"), ("1 pi", "m"), ("2 pi", "rad"), ("1 ppm", "m"), ("1 percent", "m"),
    ("1 light_year", "m"), ("1 m rad", "m"), ("1 m Hz", "m/s^2"), ("1 Bq", "Hz"), ("1 %/s", "Hz"),
    ("1 count/s", "Hz"), ("1 bit/s", "Hz"), ("10 dB", "Hz"), ("1 rad^2/s", "Hz"),
    ("1 Hz rad", "Hz"), ("1 sr", "rad"), ("1 e/s", "Hz"), ("1 speed_of_light", "m/s"),
    ("1 dozen m", "m"), ("9**9 m", "m"), ("1e999 m", "m"), ("1 rad", "m"), ("350 cSt", "Pa s"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "unit"), WRONG)
def test_what_measures_something_else_is_refused_in_a_sentence(text, unit):
    with pytest.raises(ValueError, match="must") as error:
        to_si(text, unit)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("registry", [pint.UnitRegistry(), _registry()], ids=["pint's", "ours"])
def test_the_common_units_mean_what_pint_says(registry):
    for unit, known in SIZES.items():
        for text, size in known.items():
            there = registry.Quantity(1.0, text).to(unit).magnitude
            assert size == pytest.approx(there, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "1 um",
        "1 µm",
        "1 μm",
        "1 micron",
        "1 Å",
        "1 in",
        "1 cm",
        "1 mPa s",
        "1 cP",
        "1 P",
        "1 kg/L",
        "1 g/cm^3",
        "1 cSt",
        "1 mbar s",
        "2 nN m",
        "1 dyn s/cm^2",
        "1 aW",
        "5 mT",
        "1 A m^2",
        "30 arcmin",
        "1 degree",
        "2 hour",
        "25 degC",
        "1 mPa·s",
        "1 N s/m^2",
    ],
)
def test_the_list_means_what_pint_says(text):
    ours, there = parse(text).to_base_units(), pint.UnitRegistry()
    number, unit = text.split(" ", 1)
    theirs = there.Quantity(float(number), unit.replace("·", "*")).to_base_units()
    grams = (ours.to("kg" if "kg" in str(ours.units) else ours.units)).magnitude
    kilo = 1e-3 if "gram" in str(ours.units) and "kilogram" not in str(ours.units) else 1.0
    power = int(ours.dimensionality.get("[mass]", 0))
    assert grams * kilo**power == pytest.approx(theirs.magnitude, rel=1e-13)


def test_a_kinematic_viscosity_times_the_density_is_the_viscosity():
    si = ms.Swimmer.preset("goto/C")
    for change in (
        {"fluid.viscosity": "350 cSt"},
        {"fluid.kinematic_viscosity": "350 cSt"},
        {"fluid.kinematic_viscosity": "3.5e-4 m^2/s"},
        {"fluid.kinematic_viscosity": "3.5 St"},
    ):
        swimmer = ms.Swimmer.preset("goto/C", {**change, "fluid.density": "970 kg/m^3"})
        assert swimmer.fluid.viscosity == pytest.approx(0.3395, rel=1e-12)
        assert swimmer.units == si.units
    bare = ms.Swimmer.preset(
        "tabak/helix", {"fluid.kinematic_viscosity": 50.0, "fluid.density": 2.0}
    )
    assert bare.fluid.viscosity == 100.0


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"fluid.viscosity": "350 cSt", "fluid.density": "0 kg/m^3"}, "fluid.density"),
        ({"fluid.viscosity": "350 cSt", "fluid.kinematic_viscosity": "1 cSt"}, "one of the two"),
        ({"fluid.kinematic_viscosity": "1 Pa s"}, "dimension"),
        ({"fluid.kinematic_viscosity": True}, "number"),
        ({"fluid.kinematic_viscosity": "-1 cSt"}, "positive"),
    ],
)
def test_a_kinematic_viscosity_that_makes_no_sense(changes, says):
    with pytest.raises(ms.SpecError, match=says):
        ms.Swimmer.preset("goto/C", changes)


def test_a_swimmer_in_si_takes_quantities_by_dotted_name():
    cell = ms.Swimmer.preset("goto/C")
    assert cell.with_({"tail.radius": "20 nm"}).tail.radius == pytest.approx(2e-8)
    assert cell.with_({"body.semi_axes[1]": "0.4 um"}).body.semi_axes[1] == pytest.approx(4e-7)
    for name, value in (("tail.radius", "20 Hz"), ("tail.radius", "big"), ("tail.ramp", "1 um")):
        with pytest.raises(ms.SpecError, match=name.replace(".", r"\.")):
            cell.with_({name: value})
    with pytest.raises(ms.SpecError, match="bare number; the spec has no units"):
        ms.Swimmer.preset("tabak/helix").with_({"tail.radius": "20 nm"})


def test_objects_take_numbers_and_say_where_units_are_read():
    for make in (
        lambda: ms.Sphere(radius="2 mm"),
        lambda: ms.Fluid(viscosity="1 mPa s"),
        lambda: ms.Spheroid(semi_axes=("2 um", "1 um")),
        lambda: ms.HelicalTail(length="2 mm", amplitude=0.1, waves=3, radius=0.05),
    ):
        with pytest.raises(ms.SpecError, match="units are read in spec files and by with_"):
            make()


FAR = [("1e300 m", "body.radius"), ("1e-300 m", "body.radius"), ("1e5 km", "tail.length")]


@pytest.mark.parametrize(("text", "name"), FAR)
def test_what_is_beyond_what_swims_is_refused(text, name):
    with pytest.raises(ms.SpecError, match="beyond what is computed"):
        ms.Swimmer.preset("tabak/helix", {name: text})


@pytest.mark.parametrize("text", ["19.1 rad/mm", "0.0191 1/um", "19.1 1/mm", "1094.349388 deg/mm"])
def test_a_curvature_is_an_angle_per_length_or_one_over_a_length(text):
    assert to_si(text, "1/m") == pytest.approx(19.1e3, rel=1e-8)


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ({"shape": "sphere", "diameter": "1 um"}, r'diameter: no .* "body.radius \(half of it\)"'),
        ({"shape": "box", "radius": "1 um"}, "radius: no such .* belongs to body.shape"),
        ({"shape": "sphere"}, "radius: missing; add it"),
    ],
)
def test_a_field_by_another_name_is_named_before_the_one_that_is_missing(body, said):
    tables = tomllib.loads(ms.Swimmer.preset("goto/C").to_toml()) | {"body": body}
    with pytest.raises(ms.SpecError, match=said):
        from_dict(tables)


def test_a_spec_with_units_of_its_own_is_told_where_they_go():
    tables = tomllib.loads(ms.Swimmer.preset("goto/C").to_toml()) | {"units": "SI"}
    said = "units: no such field here; write a unit with each number"
    with pytest.raises(ms.SpecError, match=said):
        from_dict(tables)
