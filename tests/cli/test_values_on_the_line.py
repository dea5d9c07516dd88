"""Values of fields on the command line: units, words, truths and numbers as in the file."""

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.cli._over import axes, bounds
from microswim.errors import SpecError


def refused(*arguments):
    result = CliRunner().invoke(main, [str(a) for a in arguments])
    assert result.exit_code == 2, (result.stdout, result.stderr, result.exception)
    (line,) = result.stderr.splitlines()
    return line


def test_a_swimmer_in_si_takes_quantities_and_one_without_units_bare_numbers():
    found = axes(("tail.amplitude=0.1um:0.3um:3,wall.distance=1 mm",), "SI")
    assert found["tail.amplitude"] == pytest.approx([1e-7, 2e-7, 3e-7])
    assert found["wall.distance"] == [1e-3]
    assert bounds(("tail.frequency=60rpm:2Hz",), "SI")["tail.frequency"] == (1.0, 2.0)
    assert axes(("wall.tilt=0:0.5:2",), "SI")["wall.tilt"].tolist() == [0.0, 0.5]
    tilt = axes(("wall.tilt=0 deg:90 deg:2",), "dimensionless")["wall.tilt"]
    assert tilt == pytest.approx([0.0, np.pi / 2])


SI = ["--preset", "goto/C"]
BARE = ["--preset", "tabak/helix"]
LINES = {
    "a bare number in SI": (["--over", "tail.amplitude=0.05:0.4:3"], SI, "must have a unit"),
    "a bare choice in SI": (["--over", "tail.amplitude=0.05,0.1"], SI, "must have a unit"),
    "a unit without units": (["--over", "tail.amplitude=1um:2um:3"], BARE, "no units"),
    "of another dimension": (["--over", "tail.amplitude=1Hz:2Hz:3"], SI, "dimension of m"),
    "an unknown unit": (["--over", "tail.amplitude=1px:2px:3"], SI, "px"),
    "a unit of a number": (["--over", "tail.ramp=1um"], BARE, "bare number"),
    "no truth": (["--over", "coefficients.spin=true,yes"], BARE, "true or false"),
    "a number for a truth": (["--over", "coefficients.spin=0:1:2"], BARE, "true or false"),
    "a misspelt choice": (["--over", "tail.kind=helix,plane_wvae"], BARE, '"plane_wave"?'),
    "a misspelt hand": (["--over", "tail.handedness=left,rihgt"], BARE, '"right"?'),
    "a misspelt number": (["--over", "tail.amplitude=0.05,x"], BARE, "number"),
    "a superscript": (["--over", "tail.waves=1:2:²"], BARE, "COUNT"),
    "a huge count": (["--over", "tail.waves=1:2:999999999999"], BARE, "1000000 values"),
    "infinite": (["--over", "tail.waves=1:1e999:3"], BARE, "finite"),
    "not a number": (["--over", "tail.waves=nan,1"], BARE, "number"),
    "zero values": (["--over", "tail.waves=1:2:0"], BARE, "values"),
}


@pytest.mark.parametrize("name", LINES)
@pytest.mark.parametrize("command", ["sweep", "validate"])
def test_axes_refuse_before_anything_starts(name, command, tmp_path):
    options, swimmer, says = LINES[name]
    out = ["--out", tmp_path / "a.zarr"]
    line = refused(command, *swimmer, *options, *out)
    assert says in line
    assert "--over" in line
    assert not (tmp_path / "a.zarr").exists()


@pytest.mark.parametrize(
    ("over", "swimmer", "says"),
    [
        ("tail.amplitude=0.05:0.4", SI, "must have a unit"),
        ("tail.amplitude=1um:2um", BARE, "no units"),
        ("tail.kind=helix,plane_wvae", BARE, "plane_wave"),
        ("tail.handedness=left,rihgt", BARE, "right"),
        ("tail.amplitude=0.05,x", BARE, "number"),
        ("coefficients.spin=yes", BARE, "true or false"),
        ("tail.kind=helix:plane_wave", BARE, "list of words"),
    ],
)
def test_design_drops_nothing_in_silence(over, swimmer, says):
    assert says in refused("design", *swimmer, "--over", over, "--maximize", "swimming_speed")


@pytest.mark.parametrize(
    ("option", "text", "swimmer"),
    [
        ("--region", "tail.amplitude=0.05:0.4", SI),
        ("--region", "tail.amplitude=1um:2um", BARE),
        ("--uncertain", "tail.amplitude=0.05:0.4", SI),
    ],
)
def test_regions_and_spreads_take_the_units_of_the_file(option, text, swimmer):
    more = (
        ["--over", "tail.waves=1:4", "--maximize", "swimming_speed"]
        if option == "--uncertain"
        else []
    )
    line = refused("design" if more else "calibrate", *swimmer, *more, option, text)
    assert "unit" in line
    assert option in line


def test_both_truths_are_computed():
    helix = ms.Swimmer.preset("tabak/helix")
    found = ms.sweep(helix, {**axes(("coefficients.spin=true,false",), "dimensionless")})
    for i, spin in enumerate((True, False)):
        gait = helix.with_({"coefficients.spin": spin}).gait()
        assert found.mean_power.values[i] == pytest.approx(gait.mean_power, rel=1e-9)
    assert found.mean_power.values[0] != found.mean_power.values[1]


def test_one_word_in_a_column_of_designs_names_its_row(tmp_path):
    designs = tmp_path / "designs.csv"
    designs.write_text("tail.amplitude,tail.waves\n0.1,2\nmany,3\n")
    line = refused("sweep", *BARE, "--designs", designs, "--out", tmp_path / "a.zarr")
    assert "row 2, tail.amplitude" in line


@pytest.mark.parametrize(
    ("over", "says"),
    [
        ({"coefficients.spin": ["true", "false"]}, "true or false"),
        ({"tail.handedness": ["left", "rihgt"]}, "right"),
        ({"tail.amplitude": ["0.1 mm"]}, "no units"),
    ],
)
def test_python_lists_are_read_by_the_same_rule(over, says):
    helix = ms.Swimmer.preset("tabak/helix")
    for call in (
        lambda: ms.sweep(helix, over),
        lambda: ms.sweep(helix, [{k: v[-1] for k, v in over.items()}]),
        lambda: ms.design(helix, {"tail.waves": (1.0, 2.0), **over}, maximize="swimming_speed"),
    ):
        with pytest.raises(SpecError, match=says):
            call()


@pytest.mark.parametrize("spin", ["yes", "true", 1, 0, None])
def test_a_law_takes_truths_alone(spin):
    with pytest.raises(SpecError, match="true or false"):
        ms.Lighthill(spin=spin)


SUGGESTED = {
    "tail.pitch=1": "tail.wavelength",
    "tail.diameter=1": "tail.radius",
    "field.strength=1": 'field.kind: missing; add one of "rotating"',
    "tail.file=beat.csv": 'it belongs to tail.kind = "elastic" or "waveform"',
    "body.edge=1": 'it belongs to body.shape = "cylinder" or "box"',
    "magnet.moment=1": "magnet.direction: missing; add a vector",
    "tial.length=1": '"tail"',
    "tail.zzz=1": "known: ",
}


@pytest.mark.parametrize("change", SUGGESTED)
def test_suggestions_know_the_physics_and_are_short(change):
    line = refused("run", *BARE, "--set", change)
    assert SUGGESTED[change] in line
    assert len(line) < 250


def test_a_grid_of_ten_thousand_million_designs_is_refused_before_it_starts(tmp_path):
    over = "tail.waves=1:2:100000,tail.amplitude=0.05:0.1:100000"
    line = refused("sweep", *BARE, "--over", over, "--out", tmp_path / "a.zarr")
    assert "10000000000 designs" in line
    assert not (tmp_path / "a.zarr").exists()
