"""Beats that leave the plane: filaments traced in three dimensions."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from test_waveform import written as film

import microswim as ms
from microswim.cli import main

LENGTH, RATE, LAMBDA = 58.3, 31.0, 71.6  # um, Hz


def angles(s, phase):
    x = s / LENGTH
    wave = phase - 2 * np.pi * s / LAMBDA
    return 0.9 * x + 1.5 * x * np.cos(wave), 0.2 * x + 0.7 * x * np.sin(wave)


def place(s, phase):
    """The filament by quadrature of its own, (…, 3)."""
    s, phase = np.broadcast_arrays(s, phase)
    xi, w = np.polynomial.legendre.leggauss(40)
    psi, out = angles(s[..., None] * (xi + 1) / 2, phase[..., None])
    tangent = np.cos(out) * np.cos(psi), np.cos(out) * np.sin(psi), np.sin(out)
    return np.stack([s / 2 * (component @ w) for component in tangent], axis=-1)


def written(folder, noise=0.05):
    """Return a spec beside a film of 24 frames of one beat, in space."""
    rng = np.random.default_rng(0)
    frame, s = np.meshgrid(np.arange(24), np.linspace(0, LENGTH, 25), indexing="ij")
    x = place(s, 2 * np.pi * frame / 24.0) + noise * rng.normal(size=(*s.shape, 3))
    table = np.column_stack([frame.ravel(), s.ravel(), x.reshape(-1, 3)])
    return film(folder, table, "frame,s (um),x (um),y (um),z (um)")


def smooth():
    """Return the swimmer behind the film, its beat as a function."""

    def metres(s, phase):
        return 1e-6 * place(1e6 * s, phase)

    tail = ms.CustomTail(
        shape=metres, length=LENGTH * 1e-6, radius=2e-7, wavelength=LAMBDA * 1e-6, frequency=RATE
    )
    body, fluid = ms.Sphere(radius=3e-6), ms.Fluid(viscosity=7e-4)
    return ms.Swimmer(body=body, tail=tail, fluid=fluid, coefficients=ms.Cox())


def off(found, truth):
    """Return the largest differences of speeds and of rates of turning, over the largest."""
    V, W = found.mean_velocity.reshape(2, 3), truth.mean_velocity.reshape(2, 3)
    return np.abs(V - W).max(axis=1) / np.abs(W).max(axis=1)


def test_velocities_are_those_of_the_smooth_beat_in_space(tmp_path):
    swimmer = ms.Swimmer.from_toml(written(tmp_path))
    truth = smooth().gait()
    assert not swimmer.tail.is_planar
    assert swimmer.tail.bend == 0.0  # no curvature in a plane, so no ratio of the path's to it
    assert off(swimmer.gait(), truth).max() < 0.01
    assert np.abs(truth.mean_velocity[3]) > 0.1 * np.abs(truth.mean_velocity[5])  # it rolls


@pytest.mark.slow
def test_boundary_elements_take_a_film_in_space(tmp_path):
    swimmer = ms.Swimmer.from_toml(written(tmp_path))
    truth = smooth().gait("bem", level="coarse")
    assert off(swimmer.gait("bem", level="coarse"), truth).max() < 0.01


def test_the_same_film_in_its_plane_has_no_angle_out_of_it(tmp_path):
    spec = written(tmp_path)
    table = np.loadtxt(tmp_path / "beat.csv", delimiter=",", skiprows=1)
    table[:, 4] = 3.0
    header = "frame,s (um),x (um),y (um),z (um)"
    np.savetxt(tmp_path / "beat.csv", table, delimiter=",", header=header, comments="")
    tail = ms.Swimmer.from_toml(spec).tail
    assert tail.modes_out is None
    assert tail.is_planar


def test_identify_writes_a_tail_in_space_that_runs_alike(tmp_path):
    spec, out = written(tmp_path), tmp_path / "out"
    call = ["identify", str(tmp_path / "beat.csv"), "--fps", "744", "--out", str(out), "--json"]
    told = CliRunner().invoke(main, call)
    assert told.exit_code == 0, told.stderr
    found = json.loads(told.stdout)["waveform"]
    assert found["noise"] == pytest.approx(0.05e-6, rel=0.1)
    assert np.shape(found["modes_out"]) == np.shape(found["modes"])
    swimmer = ms.Swimmer.from_toml(spec)
    again = tmp_path / "again.toml"
    again.write_text(swimmer.to_toml())
    assert ms.Swimmer.from_toml(again).tail == swimmer.tail
    text = spec.read_text().replace('[tail]\nkind = "waveform"\nfile = "beat.csv"\n', "@")
    text = text.replace('fps = "744 Hz"\n', "").replace("@", (out / "tail.toml").read_text())
    again.write_text(text)
    V, W = (ms.Swimmer.from_toml(one).gait().mean_velocity for one in (spec, again))
    np.testing.assert_allclose(V, W, rtol=1e-9, atol=1e-12 * np.abs(V).max())


def test_modes_out_of_the_plane_are_a_table():
    with pytest.raises(ms.SpecError, match=r"tail\.modes_out"):
        ms.WaveformTail(modes=[[0.1, 0.2, 0.0]], modes_out=[[0.1, 0.2]], length=2.0, radius=0.02)
