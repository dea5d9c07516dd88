"""Swimming in time: constraint, rest state, resume after a kill, the held swimmer, output."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import microswim as ms
from microswim.errors import MicroswimError, SpecError
from microswim.swimmer.geometry.surroundings import Channel

pytest.importorskip("ngsolve", reason="needs the extra fem")

from microswim.models import fem
from microswim.models.fem.gait import problem, snapshot
from microswim.models.fem.mesh import Level
from microswim.models.fem.record import load_march

pytestmark = pytest.mark.fem

ROUGH = Level(order=2, tail=1.6, body=0.8, far=0.5, grading=0.9)
CHANNEL = Channel(diameter=6.0, length=6.0)


def swimmer(kind=ms.HelicalTail, density=1.0, **fields) -> ms.Swimmer:
    fields = {"radius": 0.08, "ramp": 0.3, "sections": "sheared", **fields}
    tail = kind(length=0.6, amplitude=0.08, waves=1, **fields)
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=2.0, density=density)
    )


def swim(design, steps, **options):
    options = {"channel": CHANNEL, "level": ROUGH, "steps_per_period": 8, **options}
    return fem.swim(design, periods=steps / 8, **options)


@pytest.fixture(scope="module")
def four_steps(tmp_path_factory) -> tuple[xr.Dataset, object]:
    folder = tmp_path_factory.mktemp("flow")
    return swim(swimmer(), 4, vtk=folder, checkpoint_every=2), folder


def test_no_force_and_no_torque_at_any_step(four_steps):
    data, _ = four_steps
    total = (data.wrench_body + data.wrench_tail).values
    assert np.abs(total).max() < 1e-8 * np.abs(data.wrench_tail.values).max()


def test_body_leads_and_turns_against_the_tail(four_steps):
    velocity = four_steps[0].velocity.values
    assert np.all(velocity[:, 0] < 0)
    assert np.all(velocity[:, 3] < 0)


def test_pose_follows_the_velocity(four_steps):
    """Position is the integral of the body's velocity turned into the lab (second order)."""
    data, _ = four_steps
    dt = float(data.time[1] - data.time[0])
    along = data.position.values[:, 0]
    lab = data.velocity.values[:, 0]  # the axis hardly tilts in half a period
    path = along[0] + np.concatenate([[0.0], np.cumsum(0.5 * dt * (lab[1:] + lab[:-1]))])
    assert along[-1] == pytest.approx(path[-1], rel=0.1)
    norm = np.linalg.norm(data.quaternion.values, axis=1)
    assert norm == pytest.approx(np.ones(4), abs=1e-12)


def test_killed_run_resumes_to_the_same_numbers(four_steps, tmp_path):
    whole, _ = four_steps
    kept = tmp_path / "run.npz"

    def killed(done, of):
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        swim(swimmer(), 4, checkpoint=kept, checkpoint_every=2, progress=killed)
    resumed = swim(swimmer(), 4, checkpoint=kept, checkpoint_every=2)
    for name in ("velocity", "wrench_body", "wrench_tail", "position", "quaternion"):
        scale = np.abs(whole[name].values).max()
        assert np.abs(resumed[name].values - whole[name].values).max() <= 1e-10 * scale, name
    with pytest.raises(MicroswimError, match="another swimmer"):
        swim(swimmer(density=2.0), 4, checkpoint=kept)
    raw = kept.read_bytes()
    for damaged in (b"", raw[:-30], raw[:200] + b"x" + raw[201:], raw[: len(raw) // 2]):
        kept.write_bytes(damaged)
        with pytest.raises(MicroswimError, match="damaged, or not a checkpoint"):
            load_march(kept, None)


def test_without_density_it_is_the_quasi_steady_gait():
    """Same mesh, same equations: the first step of a massless fluid is the gait's velocity."""
    design = swimmer(density=0.0)
    first = swim(design, 1).velocity.values[0]
    shot = snapshot(*problem(design, CHANNEL, ROUGH), 2 * np.pi / 8, viscosity=2.0)
    steady = -design.tail.rate * np.linalg.solve(shot.resistance, shot.propulsion)
    for part in (slice(0, 3), slice(3, 6)):
        assert first[part] == pytest.approx(steady[part], abs=1e-6 * np.abs(steady[part]).max())


def test_plane_wave_stays_in_its_plane():
    design = swimmer(ms.PlaneWaveTail)
    data = swim(design, 2, free=(True, True, False, False, False, True))
    velocity = data.velocity.values
    assert np.all(velocity[:, [2, 3, 4]] == 0)  # held
    lateral_torque = (data.wrench_body + data.wrench_tail).values[:, [2, 3, 4]]
    assert np.abs(lateral_torque).max() < 0.05 * np.abs(data.wrench_tail.values).max()


def test_held_swimmer_feels_thrust_and_torque():
    held = swim(swimmer(density=0.0), 1, free=(False,) * 6)
    assert np.all(held.velocity.values == 0)
    tail = held.wrench_tail.values[0]
    assert tail[0] < 0  # pushed towards the body
    assert tail[3] < 0  # braked


def test_flow_is_written_for_viewers(four_steps):
    pyvista = pytest.importorskip("pyvista", reason="needs the extra viz")
    from microswim.models.fem.picture import flow_files, render

    files = flow_files(four_steps[1])
    assert [f.name for f in files] == ["flow-00002.vtu", "flow-00004.vtu"]
    grid = pyvista.read(files[-1])
    assert np.isfinite(grid["velocity"]).all()
    assert np.linalg.norm(grid["velocity"], axis=1).max() < 0.5  # below the tip's speed
    skin = pyvista.read(files[-1].with_suffix(".skin.vtu"))
    assert skin.bounds[1] - skin.bounds[0] == pytest.approx(1.68, rel=0.01)  # nose to tip
    picture = render(files[-1], four_steps[1] / "flow.png")
    assert picture.stat().st_size > 10_000


def test_too_long_a_step_is_refused():
    with pytest.raises(SpecError, match="steps_per_period"):
        swim(replace(swimmer(), fluid=ms.Fluid(viscosity=1e-3, density=1.0)), 1)
