"""Against the world: cells of the bank, and the paper's rotation coefficient."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.studies.paper import plane_wave_rotation as rotation
from microswim.studies.world import cells

SPERM = next(c for c in cells.CELLS if c.name == "bull sperm")
WAVE = ms.Swimmer.preset("tabak/plane_wave")


@pytest.mark.parametrize("cell", cells.CELLS, ids=lambda c: c.name)
def test_a_cell_is_the_row_of_the_bank(cell):
    row = ms.data.load(cell.table).sel(Species=cell.species)
    swimmer = cells.swimmer(cell)
    assert 2e6 * swimmer.body.semi_axes3[0] == pytest.approx(float(row["B"]))
    assert 1e6 * swimmer.tail.arc_length == pytest.approx(float(row["L"]), rel=1e-6)
    assert swimmer.tail.frequency == float(row["f"])
    assert cells.measured(cell)["swimming_speed"][0] == pytest.approx(1e-6 * float(row["U"]))


def test_spread_of_the_geometry_reaches_the_speed(monkeypatch):
    """Speed is proportional to the frequency: its spread alone must come out as it went in."""
    own = cells.measured(SPERM)
    narrow = {name: (mean, 1e-6 * mean) for name, (mean, _) in own.items()}
    narrow["tail.frequency"] = (own["tail.frequency"][0], 0.1 * own["tail.frequency"][0])
    monkeypatch.setattr(cells, "measured", lambda cell: narrow)
    drawn = cells.spread(SPERM, samples=400)
    assert len(drawn) == 400
    # a normal of 10 % cut at three deviations has 9.87 %; 400 samples tell it to 3.5 % of itself
    assert drawn.std() / drawn.mean() == pytest.approx(0.0987, rel=0.12)


def test_picture_of_the_cells_shows_each():
    rows = [
        {"cell": n, "measured": 100.0, "spread": 9.0, "rft": 80.0, "rft, 16 %": 70.0}
        | {"rft, 84 %": 95.0, "bem": 90.0}
        for n in "ab"
    ]
    labels = cells.picture(rows).axes[0].get_legend_handles_labels()[1]
    assert labels == ["a", "b", "bem"]


def test_the_tip_takes_power_and_keeps_momentum_balance():
    """Moved with its own velocity, the tip's force is its drag times velocity, as F_p says."""
    phase = np.linspace(0.0, 5.0, 7)
    gaits = [replace(WAVE, coefficients=ms.GrayHancock(tip=tip)).gait() for tip in (True, False)]
    R, F, G = (
        f(gaits[0]) - f(gaits[1])
        for f in (
            lambda g: g.resistance(phase),
            lambda g: g.propulsion(phase),
            lambda g: g.activity(phase),
        )
    )
    drag = 0.5 * ms.Sphere(radius=WAVE.tail.radius).diagonal(WAVE.fluid.viscosity)[0]
    assert R[:, 0, 0] == pytest.approx(drag)
    P, _, velocity = WAVE.tail.centreline(np.full_like(phase, WAVE.tail.apparent_length), phase)
    arm = P - WAVE.body.centre
    assert np.allclose(R, np.swapaxes(R, 1, 2))
    assert np.linalg.eigvalsh(R).min() > -1e-9 * np.abs(R).max()
    assert F[:, 3:] == pytest.approx(np.cross(arm, F[:, :3]), abs=1e-9)
    assert pytest.approx(np.sum(F[:, :3] * velocity, axis=1)) == G
    twist = np.concatenate([velocity, 0.0 * velocity], axis=1)
    assert np.einsum("nij,nj->ni", R, twist) == pytest.approx(F, abs=1e-9)


def test_a_planted_tip_is_what_the_study_finds():
    """A reference that is the model with a tip and known coefficients: that variant recovers them,
    and without the tip the rotation coefficient makes up for it.
    """
    truth = {"gamma_s": 1.3, "gamma_q": 1.6, "gamma_r": 0.8}
    swimmer = replace(WAVE, coefficients=ms.GrayHancock())
    with_tip = next(v for v in rotation.VARIANTS if v.name.startswith("tip, then"))
    reference = rotation._model(swimmer, rotation.START | truth, with_tip, None)
    plain, found = (
        rotation.fitted(swimmer, reference, v) for v in (rotation.VARIANTS[0], with_tip)
    )
    for name, value in truth.items():
        assert found[name] == pytest.approx(value, rel=1e-5)
    assert found["velocity error"] < 1e-6
    assert plain["gamma_r"] < 0.2
