"""Many poses of a group: kept as they come, gone on with, refused where they are others."""

import numpy as np
import pytest

import microswim as ms
from microswim.models.group import poses as many

HELIX = ms.Swimmer.preset("tabak/helix")
PAIR = ms.Group((ms.Member(swimmer=HELIX), ms.Member(swimmer=HELIX, position=(0, 3, 0))))
PLACES = [[(0, 0, 0), (0.1 * k, 2.4, 0)] for k in range(9)]


@pytest.fixture(scope="module")
def blocks():
    return PAIR.prepared("coarse")


def test_interrupted_poses_go_on_where_they_were(blocks, tmp_path, monkeypatch):
    """An interrupt loses none of the poses that were told; the same numbers come out."""
    place, whole = tmp_path / "kept.npz", PAIR.at_poses(PLACES, blocks=blocks, workers=1)

    def interrupted(done, total):
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        PAIR.at_poses(PLACES, blocks=blocks, workers=1, keep=place, progress=interrupted)
    solved, told, quick = [], [], many.solve_quickly
    monkeypatch.setattr(many, "solve_quickly", lambda g, b: solved.append(g) or quick(g, b))
    found = PAIR.at_poses(
        PLACES, blocks=blocks, workers=1, keep=place, progress=lambda *n: told.append(n)
    )
    assert told[0] == (4, 9)
    assert told[-1] == (9, 9)
    assert len(solved) == 5
    assert np.array_equal(found.velocity[:4], whole.velocity[:4])
    assert found.velocity == pytest.approx(whole.velocity, rel=1e-9, abs=1e-12)
    again = PAIR.at_poses(PLACES, level="coarse", keep=place)  # nothing left to solve
    assert np.array_equal(again.resistance, found.resistance)
    with pytest.raises(ms.SpecError, match="holds other poses"):
        PAIR.at_poses(PLACES[:-1], level="coarse", keep=place)
    place.write_bytes(b"broken")
    with pytest.raises(ms.SpecError, match="no poses that can be gone on with"):
        PAIR.at_poses(PLACES, level="coarse", keep=place)


def test_a_refused_pose_is_kept_with_its_reason(blocks, tmp_path):
    places = [[(0, 0, 0), (0, y, 0)] for y in (0.2, 3.0)]
    for _ in range(2):
        found = PAIR.at_poses(places, blocks=blocks, keep=tmp_path / "kept.npz")
        assert "overlaps" in found.refused[0]
        assert np.isnan(found.gap[0])
        assert found.gap[1] > 1.0


def test_phases_that_many_poses_share_are_solved_once(monkeypatch):
    """A plane wave at another phase than the scene's: one block for all poses."""
    wave = ms.Swimmer.preset("tabak/plane_wave")
    pair = ms.Group((ms.Member(swimmer=wave), ms.Member(swimmer=wave, position=(0, 3, 0))))
    prepared, solved, alone = pair.prepared("coarse"), [], many.solve_alone
    monkeypatch.setattr(many, "solve_alone", lambda m, level: solved.append(m) or alone(m, level))
    found = pair.at_poses(PLACES, phases=np.full((9, 2), 0.7), blocks=prepared, workers=1)
    assert len(solved) == 1
    one = pair.moved(positions=PLACES[3], phases=[0.7, 0.7]).solve(level="coarse")
    assert found.velocity[3] == pytest.approx(one.velocity, abs=1e-3 * np.abs(one.velocity).max())
