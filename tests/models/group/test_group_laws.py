"""Laws of a group: what it must do whatever the swimmers are."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.models.bem.levels import get_level
from microswim.models.bem.solution import solve as alone
from microswim.models.group.mean import generator, sampled_phases
from microswim.models.group.quick import solve_quickly

LEFT = ms.Swimmer.preset("tabak/helix")
RIGHT = LEFT.with_({"tail.handedness": "right"})
WAVE = ms.Swimmer.preset("tabak/plane_wave")
AWAY = {"position": (0.4, 2.4, 0.3), "direction": (1.0, 0.3, 0.2), "phase": 1.0}
PAIR = ms.Group((ms.Member(swimmer=LEFT), ms.Member(swimmer=LEFT, **AWAY)))


@pytest.fixture(scope="module")
def blocks():
    return PAIR.prepared("coarse")


@pytest.fixture(scope="module")
def pair(blocks):
    return PAIR.solve(blocks=blocks)


def scaled(R):
    root = np.sqrt(R.diagonal())
    return R / np.outer(root, root)


@pytest.mark.parametrize("swimmer", [LEFT, WAVE])
def test_one_swimmer_swims_as_it_does_alone(swimmer):
    """Whatever its pose: the helix' block is turned from phase zero, the wave's made anew."""
    member = ms.Member(swimmer=swimmer, phase=0.7, direction=(-0.2, 0.5, 1.0), roll=0.4)
    found, known = ms.Group((member,)).solve(level="coarse"), alone(swimmer, 0.7, level="coarse")
    for name in ("resistance", "propulsion"):
        ours, theirs = getattr(found, name), getattr(known, name)
        assert np.abs(ours.reshape(theirs.shape) - theirs).max() < 3e-3 * np.abs(theirs).max()
    assert found.velocity[0] == pytest.approx(known.twist, abs=3e-3 * np.abs(known.twist).max())


def test_resistance_is_symmetric_positive_definite_and_reciprocal(pair):
    assert pair.asymmetry < 1e-3
    assert pair.reciprocity < 1e-3
    assert np.linalg.eigvalsh(scaled(pair.resistance)).min() > 0.0
    assert np.abs(scaled(pair.resistance)[:6, 6:]).max() > 0.05  # they do feel each other


def test_order_and_scene_do_not_matter(pair, blocks):
    """Swapped, turned and moved as a whole, each swimmer moves the same in its own axes."""
    first, second = PAIR.members
    swapped = ms.Group((second, first)).solve(blocks=blocks)
    assert swapped.velocity[::-1] == pytest.approx(pair.velocity, rel=1e-4, abs=1e-6)
    Q = ms.Member(swimmer=LEFT, direction=(0.3, -0.5, 0.8), roll=0.9).rotation
    moved = []
    for m in PAIR.members:
        turned = Q @ m.rotation
        plain = ms.Member(swimmer=LEFT, direction=tuple(turned[:, 0])).rotation
        left = plain.T @ turned
        place = tuple(Q @ np.array(m.position) + (1.0, 2.0, 3.0))
        roll = float(np.arctan2(left[2, 1], left[1, 1]))
        moved.append((place, tuple(turned[:, 0]), roll))
    positions, directions, rolls = zip(*moved, strict=True)
    scene = PAIR.moved(positions=positions, directions=directions, rolls=rolls)
    assert scene.solve(blocks=blocks).velocity == pytest.approx(pair.velocity, rel=1e-4, abs=1e-6)


def test_prepared_blocks_change_nothing(pair):
    """The cheap second pose is the dear first one."""
    anew = PAIR.solve(level="coarse")
    assert anew.resistance == pytest.approx(pair.resistance, rel=1e-9, abs=1e-9)


def test_far_apart_the_swimmers_feel_each_other_by_oseens_tensor(blocks):
    """M_12 tends to G(d)/(8 pi mu); what is left over falls off as 1/d^2 at least."""
    line = np.array([0.6, 0.64, 0.48])
    G = np.eye(3) + np.outer(line, line)
    left = []
    for d in (20.0, 40.0):
        found = PAIR.moved(positions=[(0, 0, 0), tuple(d * line)]).solve(blocks=blocks)
        M = np.linalg.inv(found.resistance_scene)
        left.append(np.abs(M[:3, 6:9] * 8 * np.pi * LEFT.fluid.viscosity * d - G).max())
    assert left[1] < 0.1
    assert left[0] / left[1] == pytest.approx(2.0, rel=0.35)


def test_mirror_images_swim_as_mirror_images():
    """A left and a right helix, each the other's image in the plane half-way between them."""
    other = ms.Member(swimmer=RIGHT, position=(0.0, 0.0, 1.6), phase=0.4)
    found = ms.Group((ms.Member(swimmer=LEFT, phase=0.4), other)).solve(level="coarse")
    image = found.velocity[1] * [1, 1, -1, -1, -1, 1]
    # the patches of a left and a right helix are not each other's image: the level's difference
    assert found.velocity[0] == pytest.approx(image, abs=2e-3 * np.abs(image[3:]).max())
    assert found.velocity[0, 2] != pytest.approx(alone(LEFT, 0.4, level="coarse").twist[2], rel=0.1)


def test_velocities_are_linear_in_rate_and_load(pair, blocks):
    """Motors reversed the swimmers go back the way they came; loads add up."""
    back = LEFT.with_({"tail.frequency": 2.0})
    members = [ms.Member(swimmer=back, phase=m.phase, position=m.position, direction=m.direction)
               for m in PAIR.members]  # fmt: skip
    twice = ms.Group(tuple(members)).solve(level="coarse")
    assert twice.velocity == pytest.approx(2.0 * pair.velocity, rel=1e-4, abs=1e-6)
    load = {"force": (0.0, 0.0, 3.0), "torque": (1.0, 0.0, 0.0)}
    first = ms.Member(swimmer=LEFT, **load)
    loaded = ms.Group((first, PAIR.members[1])).solve(blocks=blocks)
    pushed = loaded.resistance @ (loaded.velocity - pair.velocity).reshape(-1)
    assert pushed[:6] == pytest.approx([0, 0, 3, 1, 0, 0], abs=1e-6)
    assert pushed[6:] == pytest.approx(np.zeros(6), abs=1e-6)
    assert loaded.wrench[0] == pytest.approx([0, 0, -3, -1, 0, 0], abs=1e-6)


def test_a_held_swimmer_stays_and_feels_a_force(pair):
    held = LEFT.with_({"motion.free": "none"})
    found = ms.Group((ms.Member(swimmer=held), PAIR.members[1])).solve(level="coarse")
    assert not found.velocity[0].any()
    assert abs(found.wrench[0, 0]) > 1.0
    assert found.wrench[1] == pytest.approx(np.zeros(6), abs=1e-8)
    assert found.velocity[1] != pytest.approx(pair.velocity[1], rel=1e-3)


def test_the_fluid_moves_with_the_surfaces(pair):
    """No slip on both: the flow at the nodes is the rigid motion and the tail's own."""
    for p, twist, rate in zip(pair.placed, pair.velocity_scene, pair.rates, strict=True):
        X, normal = p.surface.nodes[::9, 0], p.surface.normals[::9, 0]
        at = X + 1e-4 * normal
        u = twist[:3] + np.cross(twist[3:], X - p.position) + rate * p.surface.node_motion[::9, 0]
        assert np.abs(pair.flow(at) - u).max() < 0.02 * np.abs(u).max()


def test_near_swimmers_get_finer_patches_and_the_same_answer():
    """Bodies a quarter of a radius apart: patches are halved, and the level below agrees."""
    near = PAIR.moved(positions=[(0, 0, 0), (0, 1.12, 0)], directions=[(1, 0, 0), (1, 0, 0)])
    rough, fine = near.solve(level="coarse"), near.solve(level="standard")
    assert rough.unknowns > 2160
    assert rough.gap == pytest.approx(0.12, rel=0.05)
    assert scaled(rough.resistance) == pytest.approx(scaled(fine.resistance), abs=0.01)


def test_many_poses_at_a_time_are_the_same_one_by_one(blocks):
    """Also by several threads, which share the factorised blocks; a refused pose leaves a gap."""
    heights = (1.6, 0.4, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0)
    poses = [[(0, 0, 0), (0.1, y, 0)] for y in heights]
    told = []
    found = PAIR.at_poses(
        poses, blocks=blocks, workers=4, progress=lambda done, total: told.append((done, total))
    )
    assert told[-1] == (8, 8)
    assert "overlaps" in found.refused[1]
    assert np.isnan(found.velocity[1]).all()
    for k in (0, 2, 7):
        one = solve_quickly(PAIR.moved(positions=poses[k]), blocks)
        assert not found.refused[k]
        assert found.velocity[k] == pytest.approx(one.velocity, rel=1e-9, abs=1e-12)
        assert found.resistance[k] == pytest.approx(one.resistance, rel=1e-9, abs=1e-9)
        assert found.gap[k] == one.gap
    with pytest.raises(ms.SpecError, match="phases: 1 poses, positions has 8"):
        PAIR.at_poses(poses, phases=[[0.0, 1.0]], blocks=blocks)


@pytest.mark.parametrize("swimmer", [LEFT, pytest.param(WAVE, marks=pytest.mark.slow)])
def test_the_mean_of_one_is_that_of_its_gait(swimmer):
    found = ms.Group((ms.Member(swimmer=swimmer, phase=0.3),)).swim(level="coarse")
    mean = swimmer.gait("bem", level="coarse").mean_velocity
    assert found.mean_velocity[0] == pytest.approx(mean, abs=2e-3 * np.abs(mean).max())


def test_a_rate_in_the_lab_is_that_of_the_swimmer_alone():
    lab = LEFT.with_({"motion.frequency_frame": "lab"})
    found = ms.Group((ms.Member(swimmer=lab),)).swim(level="coarse")
    mean = lab.gait("bem", level="coarse").mean_velocity
    assert found.mean_velocity[0] == pytest.approx(mean, abs=2e-3 * np.abs(mean).max())


@pytest.mark.parametrize(("distance", "tilt"), [(0.8, 0.0), (0.7, -0.1)])
def test_one_beside_a_wall_is_the_swimmer_that_has_a_wall(distance, tilt):
    """The block in free fluid and the wall's image, by steps, against one matrix of both."""
    wall = ms.Wall(distance, tilt)
    normal = np.array(wall.normal)
    known = alone(replace(LEFT, wall=wall), 0.5, level="coarse")
    member = ms.Member(swimmer=LEFT, phase=0.5)
    plane = (tuple(-distance * normal), tuple(2.0 * normal))
    found = ms.Group((member,), plane).solve(level="coarse")
    assert scaled(found.resistance) == pytest.approx(scaled(known.resistance), abs=1e-5)
    assert found.velocity[0] == pytest.approx(known.twist, abs=1e-5)


def test_two_beside_a_wall_are_passive_and_stick_to_it(blocks):
    """Symmetric, positive definite; more drag than in free fluid; no flow on the wall."""
    beside = replace(PAIR, wall=((0.0, -0.9, 0.0), (0.0, 1.0, 0.0)))
    found, free = beside.solve(blocks=blocks), PAIR.solve(blocks=blocks)
    assert found.asymmetry < 2e-3
    assert found.reciprocity < 2e-3
    assert np.linalg.eigvalsh(scaled(found.resistance)).min() > 0.0
    more = found.resistance - free.resistance
    root = np.sqrt(free.resistance.diagonal())
    assert np.linalg.eigvalsh(more / np.outer(root, root)).min() > -1e-3
    on_wall = found.flow([[0.3, -0.9, 0.2], [2.0, -0.9, -0.5]])
    assert np.abs(on_wall).max() < 1e-4 * np.abs(found.velocity).max()
    with pytest.raises(ms.SpecError, match=r"swimmer\[0\].position: swimmer 0 reaches .* into"):
        replace(PAIR, wall=((0.0, -0.4, 0.0), (0.0, 1.0, 0.0))).solve(blocks=blocks)
    with pytest.raises(ms.SpecError, match="an estimate knows free fluid alone"):
        beside.estimate(blocks=blocks)


def test_lattices_integrate_what_they_promise():
    """Harmonics up to the third of two phases, and of three up to the second."""
    for dimension, highest in ((2, 3), (3, 2)):
        number = 34 * (dimension - 1)
        z = np.array(generator(dimension, number))
        phases = 2 * np.pi * np.arange(number)[:, None] * z / number
        sides = [np.arange(-highest, highest + 1)] * dimension
        h = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, dimension)
        low = h[(np.abs(h).sum(axis=1) <= highest) & h.any(axis=1)]
        assert np.abs(np.exp(1j * phases @ low.T).mean(axis=0)).max() < 1e-12


def test_phases_of_one_rate_go_together_and_of_two_apart():
    level = get_level("coarse")
    own = np.array([0.0, 1.0, 2.0])
    together = sampled_phases(own, np.array([2.0, -2.0, 0.0]), level)
    assert together.shape == (level.phases, 3)
    assert np.ptp(together[:, 0] + together[:, 1]) == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(together[:, 2]) == 0.0
    apart = sampled_phases(own, np.array([2.0, 3.0, 3.0]), level)
    assert apart.shape == (34, 3)
    assert np.ptp(apart[:, 1] - apart[:, 2]) == pytest.approx(0.0, abs=1e-12)
    assert len(np.unique(np.round(apart[:, :2], 9), axis=0)) == 34
    with pytest.raises(ms.SpecError, match="at most 3 may differ"):
        sampled_phases(np.zeros(4), np.array([1.0, 2.0, 3.0, 4.0]), level)
