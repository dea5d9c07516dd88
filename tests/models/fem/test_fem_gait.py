"""Quasi-steady gait in a channel: laws, the boundary elements as oracle, robustness, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.errors import MachineError, SpecError
from microswim.swimmer.geometry.surroundings import Channel

pytest.importorskip("ngsolve", reason="needs the extra fem")

from microswim.models import fem
from microswim.models.fem.gait import mirror_image, problem, smallest_jacobian, snapshot, tail_data
from microswim.models.fem.mesh import LEVELS, Level, Outline, straight_mesh
from microswim.models.fem.stokes import Stokes, factorised

pytestmark = pytest.mark.fem

FOUR = ms.Motion(free=("us", "uq", "ur", "os"))
ROUGH = Level(order=2, tail=1.6, body=0.6, far=0.4, grading=0.9)


def swimmer(tail=ms.HelicalTail, waves=1, length=0.6, **fields) -> ms.Swimmer:
    """A short thick-tailed swimmer: cheap, and felt by every term."""
    fields = {"amplitude": 0.08, "radius": 0.08, "sections": "sheared", **fields}
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5),
        tail=tail(length=length, waves=waves, **fields),
        fluid=ms.Fluid(viscosity=2.0),
        motion=FOUR,
    )


@pytest.fixture(scope="module")
def short():
    channel = Channel(diameter=6.0, length=6.0)
    return problem(swimmer(), channel, ROUGH)


@pytest.fixture(scope="module")
def shots(short):
    return [snapshot(*short, phase, viscosity=2.0) for phase in (0.0, np.pi / 2)]


def test_resistance_is_symmetric_definite_and_feels_the_wall(shots):
    R = shots[0].resistance
    assert np.all(np.linalg.eigvalsh(R) > 0)
    free_sphere = 6 * np.pi * 2.0 * 0.5
    assert R[0, 0] > 1.2 * free_sphere


def test_reciprocity_of_the_discrete_forces(short):
    """w_i' K u_j = w_j' K u_i holds to rounding, not to mesh size."""
    wave, flow = short
    modes = flow.rigid_modes(wave.outline.centre)
    pull = [flow.apply(flow.solve(mode)) for mode in modes]
    total = np.array([flow.forces(p, modes, "body") + flow.forces(p, modes, "tail") for p in pull])
    assert np.abs(total - total.T).max() < 1e-9 * np.abs(total).max()


def test_without_mkl_the_fallback_gives_the_same_flow(short, monkeypatch):
    """UMFPACK, tried when PARDISO is not there, solves the same pinned saddle-point system."""
    wave, flow = short
    motion = tail_data(wave, flow, 0.0)
    flow.factorise(1.0)
    by_pardiso = flow.solve(motion)

    class WithoutMkl:
        def Inverse(self, free, inverse, **options):
            if inverse == "pardiso":
                raise RuntimeError("SparseMatrix::InverseMatrix: Pardiso not available")
            return flow.matrix.Inverse(free, inverse=inverse, **options)

    monkeypatch.setattr(flow, "inverse", factorised(WithoutMkl(), flow.free))
    by_fallback = flow.solve(motion)
    assert np.abs(by_fallback - by_pardiso).max() < 1e-8 * np.abs(by_pardiso).max()


def test_helix_turns_with_its_phase(shots):
    """R(pi/2) = Q R(0) Q', F(pi/2) = Q F(0) on the axis of a cylinder (mesh error only)."""
    turn = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], dtype=float)
    Q = np.kron(np.eye(2), turn)
    first, second = shots
    scale = np.sqrt(np.outer(np.diag(first.resistance), np.diag(first.resistance)))
    turned = Q @ first.resistance @ Q.T
    assert np.abs((second.resistance - turned) / scale).max() < 0.02
    difference = second.propulsion - Q @ first.propulsion
    assert np.linalg.norm(difference) < 0.04 * np.linalg.norm(first.propulsion)


def test_plane_wave_half_a_period_later_is_its_mirror_image():
    """What the gait takes for granted, against a solve of its own (mesh error only)."""
    channel = Channel(diameter=6.0, length=6.0)
    wave, flow = problem(swimmer(ms.PlaneWaveTail), channel, ROUGH)
    early, late = (snapshot(wave, flow, phase, 2.0) for phase in (0.4, 0.4 + np.pi))
    image = mirror_image(early)
    lateral = [1, 5]  # u_q and Omega_r change sign
    assert np.linalg.norm(late.propulsion[lateral]) > 0.3 * np.linalg.norm(late.propulsion)
    scale = np.sqrt(np.outer(np.diag(late.resistance), np.diag(late.resistance)))
    assert np.abs((image.resistance - late.resistance) / scale).max() < 0.02
    gap = np.linalg.norm(image.propulsion - late.propulsion)
    assert gap < 0.04 * np.linalg.norm(late.propulsion)


def test_translation_of_everything_is_no_motion_of_the_tail(short, shots):
    """The tail's own power is positive and more than its share of the rigid rotation allows."""
    shot = shots[0]
    V = -np.linalg.solve(shot.resistance, shot.propulsion)
    assert shot.activity + shot.propulsion @ V > 0  # dissipation of the free swimmer
    assert V[0] < 0 < -V[3]  # body leads, and turns against the tail


def test_wave_keeps_the_body_where_it_is(short):
    wave, flow = short
    X = flow.nodes.points
    d = wave.displacement(X, 1.0)
    on = flow.nodes.on("body")
    a = wave.outline.semi_axes
    place = (X + d - wave.outline.centre)[on] / a
    radius = np.linalg.norm(place, axis=1)
    assert np.abs(radius - np.linalg.norm((X - wave.outline.centre)[on] / a, axis=1)).max() < 1e-3
    assert np.all(d[flow.nodes.on("wall")] == 0)


@pytest.mark.parametrize("sections", ["sheared", "perpendicular"])
def test_tail_lies_on_its_centreline(sections, short):
    """Sheared: distance r_t from P in planes of constant s; perpendicular: r_t from the curve."""
    from microswim.models.swimmer_surface import smooth_centreline

    wave, flow = short
    wave = replace(wave, swimmer=swimmer(sections=sections))
    X = flow.nodes.points[flow.on["tail"]]
    on_tube = (X[:, 0] > 0.25) & (X[:, 0] < 0.5)
    x = (X + wave.displacement(X, 0.7))[on_tube]
    s = np.linspace(0.0, 0.65, 4001)
    P = smooth_centreline(wave.swimmer.tail, s, 0.7).P
    if sections == "sheared":
        at = np.stack([np.interp(x[:, 0], s, P[:, i]) for i in range(3)], axis=1)
        distance = np.linalg.norm(x - at, axis=1)
    else:
        distance = np.min(np.linalg.norm(x[:, None] - P[None], axis=-1), axis=1)
    assert distance == pytest.approx(0.08, rel=0.01)


def test_designs_keep_the_mesh_unfolded():
    """One straight mesh carries every design of the common range over its whole period."""
    outline = Outline.of(swimmer(length=2.0, amplitude=0.1, waves=3, radius=0.05))
    channel = Channel()
    flow = Stokes(straight_mesh(outline, channel, LEVELS["coarse"]), 2)
    for tail, sections in (
        (ms.HelicalTail, "perpendicular"),
        (ms.HelicalTail, "sheared"),
        (ms.PlaneWaveTail, "sheared"),
    ):
        for amplitude, waves in ((0.01, 5), (0.1, 3), (0.15, 2)):
            design = swimmer(tail, waves, 2.0, amplitude=amplitude, radius=0.05, sections=sections)
            wave = problem_wave(design, outline, channel)
            smallest = smallest_jacobian(wave, flow, phases=4)
            assert smallest > 0.1, (tail, sections, amplitude, waves)


def problem_wave(design, outline, channel):
    from microswim.models.fem.displacement import Wave
    from microswim.models.fem.gait import room_around

    return Wave(design, outline, room_around(outline, channel))


def test_swimmer_that_touches_the_wall_is_refused():
    with pytest.raises(SpecError, match=r"channel\.diameter"):
        fem.channel_gait(swimmer(), channel=Channel(diameter=0.9, length=6.0))
    aside = Channel(diameter=3.0, length=6.0, position=(0.0, 1.1, 0.0))
    with pytest.raises(SpecError, match=r"channel\.diameter"):
        fem.channel_gait(swimmer(), channel=aside)


def test_unknown_level_is_refused():
    with pytest.raises(SpecError, match="level"):
        fem.channel_gait(swimmer(), level="superb")


def test_without_ngsolve_one_sentence_says_what_to_install(monkeypatch):
    monkeypatch.setattr(fem, "find_spec", lambda name: None)
    with pytest.raises(MachineError, match=r'pip install "microswim\[fem\]"'):
        fem.channel_gait(swimmer())
    with pytest.raises(MachineError, match=r'pip install "microswim\[fem\]"'):
        fem.swim(swimmer())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sections", "motion"), [("perpendicular", "rigid"), ("sheared", "translating")]
)
def test_base_case_against_the_boundary_elements(sections, motion):
    """Free space from two channels: the wall's effect on a free swimmer falls as 1/D or faster."""
    base = ms.Swimmer(
        body=ms.Sphere(radius=0.5),
        tail=ms.HelicalTail(
            length=2.0, amplitude=0.1, waves=3, radius=0.05,
            sections=sections, surface_motion=motion,
        ),
        fluid=ms.Fluid(viscosity=100.0),
        motion=FOUR,
    )  # fmt: skip
    free = base.gait(model="bem").mean_velocity
    held = fem.channel_gait(base, channel=Channel(diameter=20.0, length=20.0)).mean_velocity
    assert held[0] == pytest.approx(free[0], rel=0.02)
    assert held[3] == pytest.approx(free[3], rel=0.01)


def test_a_tail_elsewhere_than_at_the_joint_is_refused_in_a_sentence():
    wave = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}
    placed = ms.HelicalTail(**wave, position=(0, 0.1, 0))
    for tail in (placed, [placed, ms.HelicalTail(**wave)]):
        robot = ms.Swimmer(body=ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0))
        with pytest.raises(ms.SpecError, match="one tail at the joint"):
            robot.gait("fem")
