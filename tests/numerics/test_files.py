"""Files and folders appear whole or not at all; archives are believed only when whole."""

import contextlib
import io
import os
import subprocess
import sys
import zipfile

import numpy as np
import pytest

from microswim.errors import MachineError
from microswim.numerics import archive, files

NOTES, ARRAYS = {"name": "a"}, {"x": np.arange(6.0).reshape(2, 3), "z": np.array([1 + 2j])}


def full(*_):
    raise OSError(28, "No space left on device")


def test_a_file_appears_whole_or_not_at_all(tmp_path):
    path = tmp_path / "deep" / "a.txt"
    with contextlib.suppress(RuntimeError), files.fresh(path) as part:
        part.write_text("half")
        raise RuntimeError
    assert list(path.parent.iterdir()) == []
    files.write(path, "whole")
    assert [p.name for p in path.parent.iterdir()] == ["a.txt"]
    mask = os.umask(0)
    os.umask(mask)
    assert path.stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_full_disk_keeps_the_old_file_and_is_a_sentence(tmp_path):
    path = tmp_path / "a.txt"
    files.write(path, "old")
    path.chmod(0o640)
    with pytest.raises(MachineError, match=r"a\.txt: not written: No space"), files.fresh(path):
        full()
    assert path.read_text() == "old"
    files.write(path, b"new")
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_and_a_device_stay_what_they_are(tmp_path):
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("old")
    link.symlink_to(target)
    files.write(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"
    files.write("/dev/null", "nothing")
    assert not os.path.isfile("/dev/null")
    with pytest.raises(MachineError, match="/dev/full: not written: No space"):
        files.write("/dev/full", "nothing")


def test_what_a_killed_process_left_goes_with_the_next(tmp_path):
    """A folder and a file of a dead process; those of a living one stay."""
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    with files.scratch(tmp_path / "run") as made, files.fresh(tmp_path / "a.txt") as part:
        mine, other = (p.name.replace(str(os.getpid()), "{}") for p in (made, part))
        part.write_text("")
    for process in (dead.pid, os.getppid()):
        (tmp_path / mine.format(process)).mkdir()
        (tmp_path / other.format(process)).write_text("")
    with files.scratch(tmp_path / "run"):
        files.write(tmp_path / "a.txt", "")
    left = {p.name for p in tmp_path.iterdir()}
    assert left == {mine.format(os.getppid()), other.format(os.getppid()), "a.txt"}


def test_a_folder_that_cannot_be_filled_is_named_and_gone(tmp_path):
    with (
        pytest.raises(MachineError, match=rf"^{tmp_path}/run/b\.txt: not written: No space"),
        files.scratch(tmp_path / "run") as made,
        files.fresh(made / "b.txt"),
    ):
        full()
    assert list(tmp_path.iterdir()) == []


def test_an_archive_holds_its_content_to_the_last_bit():
    raw = archive.pack(NOTES, ARRAYS)
    notes, arrays = archive.unpack(raw)
    assert notes == NOTES
    assert {k: (v.tolist(), v.dtype) for k, v in arrays.items()} == {
        k: (v.tolist(), v.dtype) for k, v in ARRAYS.items()
    }
    assert archive.pack(NOTES, ARRAYS) == raw
    assert archive.digest(NOTES, ARRAYS) != archive.digest(NOTES, {**ARRAYS, "x": -ARRAYS["x"]})


def rewritten(change):
    """An archive with its members changed by hand."""
    out = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(archive.pack(NOTES, ARRAYS))) as old:
        held = {m.filename: old.read(m) for m in old.infolist()}
    change(held)
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new:
        for name, content in held.items():
            new.writestr(name, content)
    return out.getvalue()


def npy(array, **more):
    buffer = io.BytesIO()
    np.save(buffer, array, **more)
    return buffer.getvalue()


@pytest.mark.parametrize(
    "change",
    [
        lambda held: held.update({"x.npy": npy(np.zeros((2, 3)))}),
        lambda held: held.update({"more.npy": npy(np.zeros(1))}),
        lambda held: held.pop("z.npy"),
        lambda held: held.pop("checksum.npy"),
        lambda held: held.update({"x.npy": b""}),
        lambda held: held.update({"x.npy": npy(np.array([print], dtype=object))}),
        lambda held: held.update({"x.npy": npy(np.zeros(1)).replace(b"(1,)", b"(9**9,)")}),
        lambda held: held.update({"x.npy": npy(np.zeros(1)).replace(b"(1,), ", b"(9999999999,),")}),
        lambda held: held.update({"x.npy": held["x.npy"][:-8]}),
        lambda held: held.update({"notes.npy": npy(np.array("[" * 100_000))}),
        lambda held: held.clear(),
    ],
)
def test_an_archive_changed_by_hand_is_damaged(change):
    with pytest.raises(archive.DamagedError):
        archive.unpack(rewritten(change))


def test_an_archive_that_unpacks_to_gigabytes_is_refused_before_it_does():
    bomb = rewritten(lambda held: held.update({"x.npy": bytes(1 << 26)}))
    assert len(bomb) < 1 << 18
    with pytest.raises(archive.DamagedError, match="too large"):
        archive.unpack(bomb, 1 << 25)


def test_every_flipped_bit_of_an_archive_is_found_or_means_nothing():
    raw = archive.pack(NOTES, ARRAYS)
    for i in range(len(raw)):
        wrong = bytearray(raw)
        wrong[i] ^= 1 << (i % 8)
        with contextlib.suppress(archive.DamagedError):
            notes, arrays = archive.unpack(bytes(wrong))
            assert archive.digest(notes, arrays) == archive.digest(NOTES, ARRAYS)
