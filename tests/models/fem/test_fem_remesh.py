"""Meshes filled in anew about a wave: laws, the two constructions against each other, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.errors import MicroswimError
from microswim.swimmer.geometry.surroundings import Channel

pytest.importorskip("ngsolve", reason="needs the extra fem")

import ngsolve as ngs

from microswim.models import fem
from microswim.models.fem import remesh
from microswim.models.fem.displacement import Wave
from microswim.models.fem.gait import meshes, snapshot, solved, wave_in
from microswim.models.fem.mesh import Level, straight_mesh
from microswim.models.fem.remesh import Laid, filled
from microswim.models.fem.stokes import FOLDED, Stokes

pytestmark = pytest.mark.fem

FOUR = ms.Motion(free=("us", "uq", "ur", "os"))
LEVEL = Level(order=2, tail=1.6, body=0.4, far=0.4, grading=0.8, curvature=2.0)
CHANNEL = Channel(diameter=6.0, length=6.0, shape="box")


def swimmer(kind=ms.HelicalTail, **fields) -> ms.Swimmer:
    fields = {"length": 0.8, "amplitude": 0.1, "waves": 1, "radius": 0.05, **fields}
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5),
        tail=kind(**{"sections": "sheared", **fields}),
        fluid=ms.Fluid(viscosity=2.0),
        motion=FOUR,
    )


GENTLE = swimmer()
STEEP = swimmer(amplitude=0.15, waves=2)  # folds the straight mesh


@pytest.fixture(scope="module")
def gentle() -> tuple[Wave, Laid]:
    wave = wave_in(CHANNEL, GENTLE)
    return wave, filled(wave, CHANNEL, LEVEL, 0.0)


def twist(design, shot) -> np.ndarray:
    """u_s, u_q, u_r, Omega_s of the free swimmer at one phase."""
    return -design.tail.rate * np.linalg.solve(shot.resistance[:4, :4], shot.propulsion[:4])


def volume(flow: Stokes, places: np.ndarray) -> float:
    flow.move(places)
    return float(ngs.Integrate(ngs.CF(1.0), flow.mesh, order=6))


def test_both_constructions_give_the_same_motion(gentle):
    """Same wave, other meshes, both coarse: apart by no more than either is from finer ones."""
    wave, laid = gentle
    flow = Stokes(straight_mesh(wave.outline, CHANNEL, replace(LEVEL, curvature=1.8)), 2)
    anew = twist(GENTLE, solved(wave, laid, 0.0, 2.0))
    carried = twist(GENTLE, snapshot(wave, flow, 0.0, 2.0))
    assert anew[0] == pytest.approx(carried[0], rel=0.02)
    assert anew[3] == pytest.approx(carried[3], rel=0.02)


@pytest.mark.slow
def test_only_the_new_mesh_carries_a_steep_wave():
    """Beside the boundary elements in free space: apart by mesh (2 % at this size) and walls."""
    wave = wave_in(CHANNEL, STEEP)
    anew, mesh_at = meshes(wave, CHANNEL, LEVEL)
    assert anew
    shot = solved(wave, mesh_at(0.0), 0.0, 2.0)
    assert np.all(np.linalg.eigvalsh(shot.resistance) > 0)
    free = STEEP.gait("bem", level="coarse")
    known = -STEEP.tail.rate * np.linalg.solve(
        free.resistance(0.0)[:4, :4], free.propulsion(0.0)[:4]
    )
    found = twist(STEEP, shot)
    assert found[0] == pytest.approx(known[0], rel=0.04)
    assert found[3] == pytest.approx(known[3], rel=0.03)


@pytest.mark.parametrize("order", [2, pytest.param(3, marks=pytest.mark.slow)])
def test_sheared_tail_keeps_its_volume(order, gentle):
    """Sections of the same area in planes s = const: the fluid's volume knows no wave (Cavalieri).

    The flat triangles alone miss 6 % of the swimmer's volume.
    """
    wave, laid = gentle
    if order == 3:
        laid = filled(wave, CHANNEL, replace(LEVEL, order=3), 0.0)
    unit, tail = wave.outline.unit, GENTLE.tail
    joint = wave.outline.joint * unit
    sphere = 4 / 3 * np.pi * 0.5**3
    lens = np.pi * joint**2 * (3 * 0.5 + joint) / 3  # the cap of the sphere beyond the joint, < 0
    tube = np.pi * tail.radius**2 * (tail.apparent_length - joint) + 2 / 3 * np.pi * tail.radius**3
    whole = 6.0**3
    swum = whole - volume(laid.flow, laid.places) * unit**3
    flat = whole - volume(laid.flow, laid.flow.nodes.points) * unit**3
    known = sphere + tube - lens
    assert swum == pytest.approx(known, rel=1e-3)
    assert flat < 0.95 * known


def test_surface_lies_on_the_wave(gentle):
    """Tail's nodes at r_t from the centreline in planes of constant s; body's on the sphere."""
    wave, laid = gentle
    on, unit = laid.flow.on["tail"], wave.outline.unit
    x, X = laid.places[on] * unit, laid.straight[on] * unit
    middle = (X[:, 0] > 0.3) & (X[:, 0] < 0.75)  # behind where the body's surface slides
    P = GENTLE.tail.centreline(x[middle, 0], 0.0)[0]
    off = np.abs(np.linalg.norm(x[middle] - P, axis=1) / 0.05 - 1.0)
    assert np.median(off) < 1e-3
    assert np.quantile(off, 0.95) < 0.01
    assert off.max() < 0.05  # a few are eased so that no element folds
    body = laid.places[laid.flow.on["body"]] * unit + [0.5, 0.0, 0.0]
    assert np.linalg.norm(body, axis=1) == pytest.approx(np.full(len(body), 0.5), rel=2e-3)
    assert laid.flow.smallest_jacobian(laid.places) > 2 * FOLDED


class Doubling(Wave):
    """Folds the tail's end back through the tail."""

    def displacement(self, X, phase):
        moved = np.zeros_like(X)
        end = (X[:, 0] > 0.4) & (np.hypot(X[:, 1], X[:, 2]) < 0.2)
        moved[end, 0] = -3.0 * (X[end, 0] - 0.4)
        return moved


def test_surface_through_itself_is_refused_in_one_sentence(gentle, capfd, monkeypatch):
    wave = gentle[0]
    monkeypatch.setattr(remesh, "_FINER", (1.0,))
    with pytest.raises(MicroswimError, match="comes too close to itself") as refusal:
        filled(Doubling(GENTLE, wave.outline, wave.room), CHANNEL, LEVEL, 0.0)
    assert "\n" not in str(refusal.value)
    assert capfd.readouterr() == ("", "")  # Netgen has much to say about it


@pytest.mark.slow
def test_steep_helix_against_the_boundary_elements():
    """b = 0.15, N = 5, refused before; the channel's walls take 0.9 % of u_s."""
    design = swimmer(length=2.0, amplitude=0.15, waves=5, sections="perpendicular")
    gait = fem.channel_gait(design, channel=Channel(), level="coarse")
    known = design.gait("bem").mean_velocity
    assert gait.info["mesh"].startswith("filled")
    assert gait.mean_velocity[0] == pytest.approx(known[0], rel=0.02)
    assert gait.mean_velocity[3] == pytest.approx(known[3], rel=0.02)
