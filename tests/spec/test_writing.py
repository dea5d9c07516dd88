"""What is refused is said in the units in which it was written."""

import pickle
import re

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim import errors
from microswim.cli import main
from microswim.spec.describe import to_tables
from microswim.spec.file import from_dict
from microswim.spec.toml import to_toml
from microswim.spec.units import to_si
from microswim.spec.writing import as_written, in_units

BARE = re.compile(r"\d(?:\.\d+)?e-\d\d")  # a millionth of a metre as it stands inside


def refusal(make):
    with pytest.raises(ms.SpecError) as caught:
        make()
    return str(caught.value)


def tables(units="um"):
    """Tables of a cell with its lengths written in a unit."""
    made = to_tables(ms.Swimmer.preset("goto/C"))
    size = to_si(f"1 {units}", "m")

    def written(value):
        if isinstance(value, list):
            return [written(v) for v in value]
        if isinstance(value, str) and value.endswith(" m"):
            return f"{float(value[:-2]) / size:.9g} {units}"
        return value

    return {part: {k: written(v) for k, v in table.items()} for part, table in made.items()}


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"tail.radius": "12 um"}, "tail.radius = 12 um: must be less than 0.46842 um"),
        ({"tail.radius": "12e-3 mm"}, "tail.radius = 0.012 mm: must be less than 0.00046842 mm"),
        ({"tail.section": ["12 um", "1 um"], "tail.radius": "6.5 um"}, "less than 0.46842 um"),
        ({"wall": {"distance": "0.3 um", "tilt": "0 deg"}}, "more than 405 nm"),
        ({"body": {"shape": "capsule", "length": "1 um", "radius": "0.8 um"}}, "radius, 1.6 um"),
        (
            {"body": {"shape": "box", "size": ["1 um"] * 3, "edge": "2 um"}},
            "body.edge = 2 um: must be above zero and at most 0.5 um",
        ),
        ({"body.semi_axes": ["1 um", "-2 um"]}, "body.semi_axes[1] = -2 um"),
    ],
)
def test_a_file_in_micrometres_is_refused_in_micrometres(change, said):
    spec = tables()
    if "body" in change:
        del spec["body"]
    found = refusal(lambda: from_dict(spec, change).gait())
    assert said in found
    assert not BARE.search(found), found


def test_a_number_of_python_is_said_with_the_prefix_that_reads_well():
    cell = ms.Swimmer.preset("goto/C")
    found = refusal(lambda: cell.with_({"tail.radius": 1e-5}))
    assert "tail.radius = 10 µm: must be less than 468.42 nm" in found
    found = refusal(lambda: cell.with_({"tail.amplitude": 1.5e-6}).gait("bem"))
    assert "tail.amplitude = 1.5 µm" in found
    assert not BARE.search(found)
    beside = from_dict(to_tables(cell) | {"wall": {"distance": "0.3 um"}})
    wide = cell.with_({"tail.amplitude": 1.5e-6})
    for asked in (beside.view, beside.plot, lambda: ms.mobility(wide, level="coarse")):
        found = refusal(asked)
        assert "nm: must be" in found or "tail.amplitude = 1.5 µm" in found
        assert not BARE.search(found)


def test_a_swimmer_without_units_is_refused_in_bare_numbers():
    found = refusal(lambda: ms.Swimmer.preset("tabak/helix").with_({"tail.radius": 10}))
    assert "tail.radius = 10.0: must be less than 0.212579, the room" in found


def test_the_command_line_speaks_in_the_units_of_the_spec(tmp_path):
    place = tmp_path / "cell.toml"
    place.write_text(to_toml(tables(), "cell"))
    asked = ["run", str(place), "--model", "bem", "--set", "tail.amplitude=1.5 um"]
    found = CliRunner().invoke(main, asked)
    assert found.exit_code == 2
    assert "tail.amplitude = 1.5 um: must" in found.stderr, found.output
    assert errors.measured(1e-6) == "1e-06"  # and what it says holds for the command alone


def test_a_sentence_keeps_its_units_between_processes():
    cell = ms.Swimmer.preset("goto/C")
    with pytest.raises(ms.SpecError) as caught:
        cell.with_({"tail.radius": 1e-5})
    back = pickle.loads(pickle.dumps(caught.value))
    assert str(back) == str(caught.value)
    assert back.value == 1e-5


def test_the_unit_of_the_field_comes_before_the_first_of_its_kind():
    spec = {"body": {"radius": "1 mm"}, "tail": [{"radius": "3 um"}, {"radius": "4 um"}]}
    written = as_written(spec)
    assert written("tail[1].radius", 2e-6) == "2 um"
    assert written("length", 2e-6) == "0.002 mm"
    assert written("tail.frequency", 3.0) == "3 Hz"
    assert written("tail.waves", 3.0) is None
    assert as_written({"body": {"radius": 1.0}})("length", 2.0) is None
    assert as_written(None) is None


def test_what_is_no_multiple_of_a_unit_is_said_in_si():
    assert in_units("SI", "noise.temperature", 298.0, {"noise": {"temperature": "25 degC"}}) == (
        "298 K"
    )
    assert in_units("SI", "field.cone", 0.5) is None
    assert in_units("SI", "field.cone", np.pi / 6, {"field": {"cone": "5 deg"}}) == "30 deg"
    assert in_units("SI", "length", float("nan")) is None


def test_the_studio_refuses_in_the_unit_of_its_boxes():
    from microswim.studio.judge import jobs
    from microswim.studio.spec_tables import canonical, swimmer_of

    spec = canonical(ms.Swimmer.preset("goto/C"))
    spec["tail"]["radius"] = "12 um"
    assert "12 um: must be less than 0.46842 um" in refusal(lambda: swimmer_of(spec))
    spec = canonical(ms.Swimmer.preset("goto/C", {"tail.amplitude": "1.5 um"}))
    kind, found = jobs.answer("judge", {"tables": spec, "level": "coarse"}, lambda told: None)
    assert kind == "failed"
    assert "tail.amplitude = 1.5 um: must be" in found
