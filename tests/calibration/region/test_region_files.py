"""Region calibrations from damaged and made-up files: refused in a sentence, before any kernel."""

import base64
import dataclasses
import random

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.atlas.expected import LEVELS
from microswim.calibration.region import schema
from microswim.calibration.region.text import _parts, digest, pack, unpack
from microswim.numerics import archive

HELIX = ms.Swimmer.preset("tabak/helix")
WAVE = ms.Swimmer.preset("tabak/plane_wave")
REGION = {"tail.amplitude": (0.08, 0.12), "tail.waves": (2.0, 3.0)}


@pytest.fixture(scope="module", params=["helix", "plane_wave"])
def made(request):
    swimmer = HELIX if request.param == "helix" else WAVE
    return ms.calibrate_region(swimmer, REGION, "rft", solves=9, workers=0).region


def text_of(notes, arrays):
    """A text whose checksum holds, whatever it says."""
    return base64.b64encode(archive.pack(notes, arrays)).decode()


def refused(text):
    with pytest.raises(ms.SpecError, match=r"region\.data: must be what microswim cal") as error:
        unpack(text)
    assert "\n" not in str(error.value)


def test_what_calibrate_writes_is_read_to_the_last_bit(made):
    again = unpack(pack(made))
    assert digest(again) == digest(made)
    assert pack(again) == pack(made)


def damages(text, rng):
    """A text as a disk, an editor, a mail or a hand may leave it."""
    n = len(text)
    for _ in range(60):
        i, c = rng.randrange(n), rng.choice("ABCDabcd0189+/=-_ \x00é")
        yield text[:i] + c + text[i + 1 :]
    for _ in range(20):
        yield text[: rng.randrange(n)]
        yield text[rng.randrange(1, n) :]
        i, j = sorted((rng.randrange(n), rng.randrange(n)))
        yield text[:i] + text[j:]
        yield text[:i] + text[i:j] + text[i:]
    yield from ("", " ", "=", "AAAA", "region", "\x00", text + text, text[::-1], text.lower(), "é")
    yield base64.b64encode(b"PK\x05\x06" + bytes(18)).decode()
    yield "A" * (1 << 25) + "AAAA"


def test_no_damaged_text_is_believed(made):
    """All are refused, but for what does not change a bit of the content."""
    whole, text, tried = digest(made), pack(made), 0
    for wrong in damages(text, random.Random(5)):
        tried += 1
        try:
            found = unpack(wrong)
        except ms.SpecError:
            continue
        else:
            assert digest(found) == whole
    assert tried > 120


def wrong_arrays(arrays):
    """Each array emptied, shortened, of another type or shape, with what is no number."""
    for name, array in arrays.items():
        kinds = [array[:0], array[:-1], array[None]] if array.ndim else [np.zeros(2), np.zeros(0)]
        kinds += [np.array(np.abs(array)).astype(t) for t in ("c8", "f4", "U8", ">f8", "i8", "?")]
        kinds += [np.zeros((10**3, 10**3)), np.full(array.shape, np.nan)]
        for value in (np.nan, np.inf, -np.inf, 1e300):
            spoilt = array.copy()
            spoilt.reshape(-1)[-1] = value
            kinds.append(spoilt)
        for kind in kinds:
            yield {**arrays, name: kind}
        yield {k: v for k, v in arrays.items() if k != name}
    yield {**arrays, "more": np.zeros(1)}
    for name in ("N", "lengths0", "noise0", "ratios", "phasors0", "variance1"):
        yield {**arrays, name: -np.abs(arrays[name]) - 1.0}
    yield {**arrays, "columns": arrays["columns"] + 0.5}
    yield {**arrays, "columns": arrays["columns"][:, ::-1]}
    yield {**arrays, "columns": arrays["columns"] * [[100.0], [1.0], [1.0]]}


def wrong_notes(notes):
    """Each note missing, of another type, with what makes no sense."""
    for name in notes:
        yield {k: v for k, v in notes.items() if k != name}
        for value in (None, 1, "x", [], [1], {"x": "y"}, {"x": float("nan")}, {"x": None}):
            if (name, value) != ("about", {"x": "y"}):
                yield {**notes, name: value}
    yield {**notes, "more": 1}
    yield {**notes, "content": "region 3"}
    yield {**notes, "choices": {**notes["choices"], "kind": "custom"}}
    yield {**notes, "choices": {**notes["choices"], "kind": ["helix"]}}
    yield {**notes, "high": notes["low"]}
    yield {**notes, "low": {k: -v for k, v in notes["low"].items()}}
    yield {**notes, "low": {**notes["low"], "fluid.viscosity": 1.0}}
    yield {**notes, "errors": {}}
    yield {**notes, "errors": {**notes["errors"], "mean.us": {"median": 0.0}}}


def test_no_wrong_content_is_believed_though_its_checksum_holds(made):
    """What someone made on purpose: an array that compiled code would read beyond, for one."""
    notes, arrays = _parts(made)
    tried = 0
    for wrong in wrong_arrays(arrays):
        refused(text_of(notes, wrong))
        tried += 1
    for wrong in wrong_notes(notes):
        refused(text_of(wrong, arrays))
        tried += 1
    assert tried > 300


def test_a_covariance_that_is_none_is_refused(made):
    notes, arrays = _parts(made)
    same = {**arrays, "Z": np.zeros_like(arrays["Z"]), "N": np.ones_like(arrays["N"])}
    refused(text_of(notes, {**same, "noise0": np.array(1e-30)}))


def test_more_designs_than_memory_would_hold_are_refused(made):
    notes, arrays = _parts(made)
    n, f = 3 * schema.MOST_DESIGNS, arrays["Z"].shape[1]
    many = {**arrays, "N": np.ones(n), "Z": np.zeros((n, f)), "spots": np.zeros((n, f))}
    refused(text_of(notes, many))


def test_expected_errors_are_never_claimed_outside():
    fitted = ms.calibrate_region(HELIX, REGION, "rft", solves=9, workers=0).swimmer
    inside = fitted.gait().info
    assert inside["outside"] == []
    assert all(np.isfinite(e) for e in inside["expected_errors"].values())
    outside = [
        fitted.with_({"tail.amplitude": 0.2}),
        fitted.with_({"body.radius": 0.6}),
        dataclasses.replace(fitted, wall=ms.Wall(distance=2.0)),
    ]
    for swimmer in outside:
        with pytest.warns(UserWarning, match="outside the calibrated region"):
            info = swimmer.gait().info
        assert info["outside"]
        assert np.isnan(info["expected_error"])
        assert all(np.isnan(e) for e in info["expected_errors"].values())


def test_no_region_is_nearer_to_the_truth_than_its_reference():
    fitted = ms.calibrate_region(HELIX, REGION, "rft", solves=9, workers=0).swimmer
    own = ms.expected_error(fitted, fitted.gait())["us"]
    said = dataclasses.replace(fitted.calibration, reference="bem", level="coarse")
    coarse = dataclasses.replace(fitted, calibration=said)
    found = ms.expected_error(coarse, coarse.gait())
    assert found["us"] == pytest.approx(own + LEVELS["coarse"])
    assert "boundary elements (coarse)" in found["how"]


def test_a_spec_file_with_a_damaged_region_is_one_sentence(made, tmp_path):
    from click.testing import CliRunner

    from microswim.cli import main

    path = tmp_path / "robot.toml"
    for data in ("", "AAAA", pack(made).replace("\n", "")[:-8]):
        path.write_text(
            "[body]\nshape = 'sphere'\nradius = 0.5\n[fluid]\nviscosity = 1.0\n"
            "[tail]\nkind = 'helix'\nlength = 2.0\namplitude = 0.1\nwaves = 2.5\nradius = 0.05\n"
            f"frequency = 1.0\n[region]\ndata = '{data}'\n"
        )
        run = CliRunner().invoke(main, ["run", str(path)])
        assert run.exit_code == 2
        assert run.stderr.startswith("Error: region.data: must be what microswim calibrate wrote")
        assert run.stderr.count("\n") == 1
