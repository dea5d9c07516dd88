"""Solves kept on disk: found again when nothing has changed, and only when they are whole."""

import dataclasses

import numpy as np
import pytest

import microswim as ms
from microswim.errors import MachineError
from microswim.jobs import references, store

HELIX = ms.Swimmer.preset("tabak/helix")


@pytest.fixture
def kept(tmp_path):
    place = store.place(tmp_path, HELIX, "rft", {})
    store.keep(place, HELIX.gait())
    return place


def test_a_solve_comes_back_to_the_last_bit(kept):
    found, gait = store.find(kept), HELIX.gait()
    for name in store._SERIES:
        assert np.array_equal(getattr(found, name), getattr(gait, name))
    assert (found.rate, found.free, found.model, found.units) == (
        *(gait.rate, gait.free, gait.model, gait.units),
    )


def test_a_reason_comes_back_as_said(tmp_path):
    store.keep(tmp_path / "a.npz", "the tail crosses itself")
    assert store.find(tmp_path / "a.npz") == "the tail crosses itself"


def test_no_damaged_file_is_believed(kept, tmp_path):
    """Every byte changed, the file cut anywhere, another file in its place."""
    raw = kept.read_bytes()
    rng = np.random.default_rng(1)
    gait = store.find(kept)
    for i in range(0, len(raw), 7):
        wrong = bytearray(raw)
        wrong[i] ^= 1 << int(rng.integers(8))
        kept.write_bytes(bytes(wrong))
        found = store.find(kept)  # a few bytes of a zip file mean nothing
        assert found is None or np.array_equal(found.resistance_series, gait.resistance_series)
        kept.write_bytes(raw[:i])
        assert store.find(kept) is None
    other = tmp_path / "other.npz"
    other.write_bytes(raw)
    assert store.find(other) is None


def test_another_version_does_not_find_old_solves(tmp_path, monkeypatch):
    """The code of the model is part of the name; comments and docstrings are not."""
    before = store.place(tmp_path, HELIX, "bem", {})
    assert store.place(tmp_path, HELIX, "bem", {}) == before
    monkeypatch.setattr(store, "version", lambda model: "mended")
    assert store.place(tmp_path, HELIX, "bem", {}) != before


def test_the_version_of_a_model_is_that_of_its_code():
    import ast

    def bare(text):
        return ast.dump(store._Bare().visit(ast.parse(text)))

    code = 'def f(x):\n    """Say."""\n    return x + 1\n'
    assert bare(code) == bare(code.replace("Say", "Tell").replace("1", "1  # one"))
    assert bare(code) != bare(code.replace("1", "2"))
    assert len({store.version(m) for m in ("rft", "bem", "fem")}) == 3


def test_the_version_of_a_model_is_that_of_all_its_rooms(tmp_path, monkeypatch):
    """A change in models/bem/patches left old solves current."""
    import shutil
    from pathlib import Path

    models = tmp_path / "models"
    shutil.copytree(Path(store.__file__).parents[1] / "models", models)
    monkeypatch.setattr(store, "files", lambda package: models)
    rooms = [p for p in models.rglob("*.py") if p.relative_to(models).parts[0] == "bem"]
    assert {len(p.relative_to(models).parts) for p in rooms} >= {2, 3}
    seen = {store.version.__wrapped__("bem")}
    for path in (rooms[0], next(p for p in rooms if len(p.relative_to(models).parts) == 3)):
        path.write_text(path.read_text() + "\nCHANGED = True\n")
        seen.add(store.version.__wrapped__("bem"))
    assert len(seen) == 3


@pytest.mark.parametrize(
    "change",
    [
        {"tail.amplitude": 0.11},
        {"fluid.viscosity": 2.0},
        {"interaction.translation": (1.0, 1.0, 2.0)},
        {"motion.free": ("us",)},
        {"tail.handedness": "right"},
    ],
)
def test_what_the_model_sees_is_in_the_name(change, tmp_path):
    assert store.place(tmp_path, HELIX.with_(change), "rft", {}) != store.place(
        tmp_path, HELIX, "rft", {}
    )


def test_what_has_no_lasting_name_is_not_kept(tmp_path):
    """A function is named by its address, which another one has tomorrow."""
    tail = ms.CustomTail(
        shape=lambda s, phase: np.stack(
            np.broadcast_arrays(s, 0.1 * s * np.cos(4 * s - phase), 0 * s), axis=-1
        ),
        length=1.0,
        radius=0.05,
        wavelength=1.5,
    )
    swimmer = dataclasses.replace(HELIX, tail=tail)
    assert store.place(tmp_path, swimmer, "bem", {}) is None
    assert isinstance(references.gaits([swimmer], "rft", folder=tmp_path, workers=0)[0], ms.Gait)
    assert list(tmp_path.iterdir()) == []


def test_the_machines_failures_are_not_kept_against_a_design(tmp_path, monkeypatch):
    """No memory today: the design is unsolved, and solved when asked again."""
    with monkeypatch.context() as patch:
        patch.setattr(ms.Swimmer, "gait", lambda *a, **k: (_ for _ in ()).throw(MemoryError))
        (why,) = references.gaits([HELIX], "rft", folder=tmp_path, workers=0)
        assert isinstance(why, references.Unsolved)
        assert why == "not enough memory"
        assert list(tmp_path.iterdir()) == []
    (gait,) = references.gaits([HELIX], "rft", folder=tmp_path, workers=0)
    assert isinstance(gait, ms.Gait)


def test_a_region_is_not_calibrated_without_what_the_machine_could_not_solve(monkeypatch):
    """The designs that memory left out would change the result for good."""
    solve = references.solve

    def forgetful(swimmer, model, options):
        if swimmer.tail.amplitude > 0.11:
            raise MemoryError
        return solve(swimmer, model, options)

    monkeypatch.setattr(references, "solve", forgetful)
    with pytest.raises(MachineError, match="not enough memory"):
        ms.calibrate_region(HELIX, {"tail.amplitude": (0.08, 0.12)}, "rft", solves=8, workers=0)


def test_a_full_disk_is_a_sentence_that_names_the_file(tmp_path, monkeypatch):
    from pathlib import Path

    def full(self, data):
        self.touch()
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(MachineError, match=r"\.npz: not written: No space left on device"):
        references.gaits([HELIX], "rft", folder=tmp_path, workers=0)
    assert list(tmp_path.iterdir()) == []
