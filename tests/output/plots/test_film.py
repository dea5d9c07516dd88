"""Films of paths: what is in their frames, read back as pictures."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import microswim as ms
from boundaries import RADIUS, beside, inside

ROBOT = ms.Swimmer.preset("tabak/helix").with_({"motion.free": "all"})
TAIL = (0x3D, 0xB7, 0xAC)


def frames_of(file):
    with Image.open(file) as film:
        for i in range(film.n_frames):
            film.seek(i)
            yield np.asarray(film.convert("RGB"), float)


def coloured(shot, colour, most=40.0):
    """Return where a picture has a colour: columns and rows of its pixels."""
    return np.argwhere(np.abs(shot - colour).max(axis=-1) < most)[:, ::-1]


def test_the_swimmer_goes_along_its_path_from_above_and_stays_close_by(tmp_path):
    found = ms.path(ROBOT, 60.0, model="rft", samples=9)
    told = []
    file = ms.plots.film(
        ROBOT, found, tmp_path / "path.gif", frames=4, progress=lambda *n: told.append(n)
    )
    shots = list(frames_of(file))
    assert len(shots) == 4
    assert told[-1] == (4, 4)
    width = shots[0].shape[1]
    places = [coloured(shot, TAIL) for shot in shots]
    above = [p[p[:, 0] < width / 2, 0].mean() for p in places]
    near = [p[p[:, 0] > width / 2, 0].mean() for p in places]
    assert all(np.diff(above) < -5)  # it heads for -x
    assert np.ptp(near) < 3


@pytest.mark.parametrize("height", [0.6, 4.0])
def test_the_wall_is_as_far_below_the_swimmer_as_its_gap(tmp_path, height):
    robot = replace(ROBOT, wall=ms.Wall(height))
    found = ms.path(robot, 0.1, poses=beside(robot), samples=2)
    shot = next(frames_of(ms.plots.film(robot, found, tmp_path / "path.gif", frames=2)))
    half = shot[:, shot.shape[1] // 2 :]
    dark = (half.max(axis=-1) < 90).sum(axis=1)
    rows = np.flatnonzero(dark > 250)  # the wall's line, the longest there is
    body = coloured(half, (0xE3, 0xD5, 0xB8), 12.0)[:, 1]
    per = np.ptp(body) / 1.0  # pixels per unit: the body is one wide
    if height == 4.0:  # beyond what is shown, three and a half body widths below
        assert not rows.size
        return
    gap = (rows.mean() - body.max()) / per
    assert gap == pytest.approx(height - 0.5, abs=0.03)


def test_in_a_tube_its_wall_is_round_it(tmp_path):
    robot = replace(ROBOT, channel=ms.Channel(diameter=2 * RADIUS, length=30.0))
    found = ms.path(robot, 0.1, poses=inside(robot), samples=2)
    shot = next(frames_of(ms.plots.film(robot, found, tmp_path / "path.gif", frames=2)))
    half = shot[:, shot.shape[1] // 2 :]
    row = half[half.shape[0] // 2]
    assert (half.max(axis=-1) < 90).any(axis=1).mean() > 0.6
    assert row.min() < 200


def test_many_paths_and_other_files_are_refused(tmp_path):
    found = ms.path(ROBOT, 0.1, model="rft", samples=2)
    with pytest.raises(ms.SpecError, match=r"ends in \.gif"):
        ms.plots.film(ROBOT, found, tmp_path / "path.mp4")
    with pytest.raises(ms.SpecError, match="many paths"):
        ms.plots.film(ROBOT, found.expand_dims("path"), tmp_path / "path.gif")
