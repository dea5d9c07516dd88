"""How cells wander: planted persistence, diffusion, inclination come back, from two coordinates."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main

SPEED, TURN, FRAME = 20.0, 0.25, 0.04
TAU = 1.0 / (2.0 * TURN)


def cells(count, frames, seed, noise=0.05):
    """Active Brownian particles in space, (count, frames, 3), with noise on their positions."""
    rng = np.random.default_rng(seed)
    u = rng.normal(size=(count, 3))
    x, out = np.zeros((count, 3)), []
    for _ in range(frames):
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        out.append(x)
        x = x + SPEED * FRAME * u
        u = u + np.cross(np.sqrt(2.0 * TURN * FRAME) * rng.normal(size=(count, 3)), u)
    x = np.stack(out, axis=1)
    return x + noise * rng.normal(size=x.shape)


def tracks(x):
    t = FRAME * np.arange(x.shape[1])
    return [ms.Track(time=t, position=one) for one in x]


def holds(estimate, truth):
    return estimate.low <= truth <= estimate.high


def test_the_displacement_of_the_planted_cells_is_that_of_an_active_brownian_particle():
    """``2 v^2 tau^2 (t/tau - 1 + exp(-t/tau))``, and two thirds of it in the image."""
    x = cells(4000, 101, 3, noise=0.0)
    t = FRAME * 100 / TAU
    wanted = 2.0 * (SPEED * TAU) ** 2 * (t - 1.0 + np.exp(-t))
    moved = x[:, -1] - x[:, 0]
    assert np.mean(np.sum(moved**2, axis=1)) == pytest.approx(wanted, rel=0.03)
    seen = np.mean(np.sum(moved[:, :2] ** 2, axis=1))
    assert seen == pytest.approx(2.0 / 3.0 * wanted, rel=0.05)


@pytest.mark.parametrize("d", [2, 3])
def test_many_short_tracks_tell_persistence_and_speed_in_space(d):
    hits, trials = np.zeros(3), 12
    for seed in range(trials):
        found = ms.wandering(tracks(cells(24, 100, seed)[:, :, :d]))
        hits += [
            holds(found["persistence_time"], TAU),
            holds(found["effective_diffusion"], SPEED**2 * TAU / 3.0),
            holds(found["speed_in_space"], SPEED),
        ]
    assert (hits >= trials - 3).all()  # 19 of 20: three misses of twelve are one in fifty


def test_a_long_track_tells_them_alone():
    (track,) = tracks(cells(1, 5000, 8)[:, :, :2])
    found = ms.wandering([track])
    assert found["persistence_time"].value == pytest.approx(TAU, rel=0.3)
    assert holds(found["persistence_time"], TAU)
    assert found["rotational_diffusion"].value == pytest.approx(
        0.5 / found["persistence_time"].value
    )
    assert holds(found["speed_in_space"], SPEED)


@pytest.mark.parametrize("theta", [0.3, 0.6])
def test_a_helix_that_is_inclined_shows_it(theta):
    """It swings along its path by ``sin theta`` of what it swings across it."""
    t, rng = np.arange(300) / 50.0, np.random.default_rng(4)
    axis, e1 = np.array([np.cos(theta), 0.0, np.sin(theta)]), np.array([0.0, 1.0, 0.0])
    e2, angle = np.cross(axis, e1), 2.0 * np.pi * 3.0 * t[:, None]
    x = 10.0 * t[:, None] * axis + 0.5 * (np.cos(angle) * e1 + np.sin(angle) * e2)
    x = x[:, :2] + 0.02 * rng.normal(size=(300, 2))
    found = ms.wandering([ms.Track(time=t, position=x)])
    assert found["inclination"].value == pytest.approx(theta, abs=0.02)
    assert found["speed_in_space"].value == pytest.approx(10.0, rel=0.02)


def test_a_beat_in_the_plane_is_no_inclined_helix():
    t, rng = np.arange(300) / 50.0, np.random.default_rng(4)
    x = np.stack([10.0 * t, 0.5 * np.cos(2.0 * np.pi * 3.0 * t)], axis=-1)
    found = ms.wandering([ms.Track(time=t, position=x + 0.02 * rng.normal(size=x.shape))])
    assert found["inclination"] is None


def test_what_only_diffuses_has_the_coefficient_that_was_planted():
    rng, D = np.random.default_rng(6), 0.4
    steps = np.sqrt(2.0 * D * FRAME) * rng.normal(size=(3000, 2))
    x = np.cumsum(steps, axis=0) + 0.1 * rng.normal(size=(3000, 2))
    found = ms.wandering([ms.Track(time=FRAME * np.arange(3000), position=x)])
    assert found["diffusion"].value == pytest.approx(D, rel=0.1)
    assert holds(found["diffusion"], D)
    assert found["persistence_time"] is None


def test_the_command_tells_each_and_all(tmp_path):
    file = tmp_path / "spots.csv"
    rows = [f"{i},{a:.4f},{b:.4f},{k}" for k, x in enumerate(cells(12, 100, 1))
            for i, (a, b, _) in enumerate(x)]  # fmt: skip
    file.write_text("\n".join(["frame,x (um),y (um),particle", *rows]) + "\n")
    call = ["identify", str(file), "--fps", "25", "--noise", "--json"]
    run = CliRunner().invoke(main, call)
    assert run.exit_code == 0, run.output
    result = json.loads(run.stdout)
    whole = result["wandering"]
    low, high = whole["interval_95"]["speed_in_space"]
    assert whole["cells"] == 12
    assert low < 20e-6 < high
    assert "wandering" in result["cells"][0]
    read = CliRunner().invoke(main, call[:-1])
    assert "Wandering" in read.output
    assert "all 12" in read.output
    both = CliRunner().invoke(main, [*call, "--preset", "goto/C"])
    assert both.exit_code == 2
    assert "leave out the SPEC" in both.output
