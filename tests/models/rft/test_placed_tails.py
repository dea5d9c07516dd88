"""Tails that stand anywhere, one or several, by resistive force theory: laws, not numbers."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.series.fourier import MIRROR_Q
from microswim.path import strain
from microswim.swimmer.surroundings import weight

WAVE = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}
PHASES = np.linspace(0.0, 6.0, 7)
KINDS = [ms.HelicalTail, ms.PlaneWaveTail]


def swimmer(tail, body=None, **more):
    return ms.Swimmer(
        body=body or ms.Sphere(radius=0.5), tail=tail, fluid=ms.Fluid(viscosity=1.0), **more
    )


def alike(one, other, to=1e-12):
    R, S = one.resistance(PHASES), other.resistance(PHASES)
    F, H = one.propulsion(PHASES), other.propulsion(PHASES)
    assert np.abs(R - S).max() < to * np.abs(R).max()
    assert np.abs(F - H).max() < to * np.abs(F).max()
    G = one.activity(PHASES)
    assert np.abs(G - other.activity(PHASES)).max() < to * np.abs(G).max()


class Turned:
    """A gait seen from axes turned about the body's centre."""

    def __init__(self, gait, Q, ahead=0.0):
        self.gait, self.Q, self.ahead = gait, np.kron(np.eye(2), Q), ahead

    def resistance(self, phase):
        return self.Q @ self.gait.resistance(phase + self.ahead) @ self.Q.T

    def propulsion(self, phase):
        return self.gait.propulsion(phase + self.ahead) @ self.Q.T

    def activity(self, phase):
        return self.gait.activity(phase + self.ahead)


@pytest.mark.parametrize("kind", KINDS)
def test_a_phase_shifts_the_gait_by_that_angle(kind):
    ahead = swimmer(kind(**WAVE, phase=0.7)).gait()
    alike(ahead, Turned(swimmer(kind(**WAVE)).gait(), np.eye(3), 0.7))


@pytest.mark.parametrize("kind", KINDS)
def test_a_tail_turned_round_a_sphere_gives_the_turned_gait(kind):
    A = kind(**WAVE, direction=(0.3, 0.8, -0.5)).placement.rotation
    root = np.array([-0.5, 0.0, 0.0]) + A @ [0.5, 0.0, 0.0]
    tail = kind(**WAVE, direction=(0.3, 0.8, -0.5), position=tuple(root))
    alike(swimmer(tail).gait(), Turned(swimmer(kind(**WAVE)).gait(), A))


@pytest.mark.parametrize("kind", KINDS)
def test_a_moved_root_moves_the_wrench_alone(kind):
    """``T' = T + x x F`` about the same point; no rotation, no change of force."""
    x = np.array([0.2, -0.3, 0.4])
    alone = swimmer(kind(**WAVE), ms.NoBody()).gait()
    moved = swimmer(kind(**WAVE, position=tuple(x)), ms.NoBody()).gait()
    F, H = alone.propulsion(PHASES), moved.propulsion(PHASES)
    assert np.allclose(H[:, :3], F[:, :3], atol=1e-14)
    assert np.allclose(H[:, 3:], F[:, 3:] + np.cross(x, F[:, :3]), atol=1e-14)
    V = np.array([0.3, -0.2, 0.5, 0.1, 0.7, -0.4])
    at_root = np.concatenate([V[:3] + np.cross(V[3:], x), V[3:]])
    power = np.einsum("i,nij,j->n", V, moved.resistance(PHASES), V)
    assert np.allclose(power, np.einsum("i,nij,j->n", at_root, alone.resistance(PHASES), at_root))


def test_a_placed_wave_is_the_custom_tail_that_beats_where_it_stands():
    """The quadrature along the placed centreline, node by node, shares no frame with the other."""
    place = {"position": (-0.2, 0.3, 0.1), "direction": (1.0, 0.5, -0.4), "phase": 0.3}
    wave = ms.PlaneWaveTail(**WAVE, **place)
    law = {"coefficients": ms.Constant(normal=2.0, tangential=1.2)}
    same = ms.CustomTail(
        shape=lambda s, p: wave.centreline(s, p)[0], length=2.0, radius=0.05, breaks=(0.1,)
    )
    alike(swimmer(wave, **law).gait(), swimmer(same, **law).gait(), 1e-8)


def test_tails_add_up_and_two_at_one_place_drag_twice():
    one, other = ms.HelicalTail(**WAVE), ms.PlaneWaveTail(**WAVE, position=(0, 0.2, 0), phase=1.0)
    alone = [swimmer(t, ms.NoBody()).gait() for t in (one, other, [one, one], [one, other])]
    a, b, twice, both = (g.resistance(PHASES) for g in alone)
    assert np.allclose(twice, 2.0 * a, rtol=1e-13, atol=1e-13)
    assert np.allclose(both, a + b, rtol=1e-13, atol=1e-13)
    assert np.allclose(alone[3].propulsion(0.3), sum(g.propulsion(0.3) for g in alone[:2]))


def test_equal_tails_behind_one_another_in_phase_are_one_long_tail():
    """On one axis, a whole number of waves apart: to rounding."""
    each = WAVE | {"ramp": 0.0}
    row = [ms.HelicalTail(**each, position=(2.0 * k, 0.0, 0.0)) for k in range(3)]
    long = ms.HelicalTail(**each | {"length": 6.0, "waves": 9})
    alike(swimmer(row, ms.NoBody()).gait(), swimmer(long, ms.NoBody()).gait(), 1e-10)


@pytest.mark.parametrize("kind", KINDS)
def test_many_equal_tails_in_phase_approach_one_without_a_body(kind):
    """They swim as one does whose body weighs 1/n: what is missing halves as they double."""
    limit = swimmer(kind(**WAVE), ms.NoBody()).gait().mean_velocity
    missing = []
    for count in (25, 50, 100):
        found = swimmer([kind(**WAVE)] * count, ms.Sphere(radius=0.05)).gait().mean_velocity
        missing.append(np.abs(found - limit).max() / np.abs(limit).max())
    assert missing[0] / missing[1] == pytest.approx(2.0, rel=0.1)
    assert missing[1] / missing[2] == pytest.approx(2.0, rel=0.05)
    assert missing[2] < 0.05


def around(count, hand="left", tilt=0.4):
    """Helices alike but for a turn about s, which a helix's own phase takes part in."""
    sign = 1.0 if hand == "left" else -1.0
    return [
        ms.HelicalTail(
            **WAVE, handedness=hand, phase=sign * x, direction=(1.0, tilt * q, tilt * r),
            position=(-0.1, 0.3 * q, 0.3 * r),
        )
        for x in 2.0 * np.pi * np.arange(count) / count
        for q, r in [(np.cos(x), np.sin(x))]
    ]  # fmt: skip


@pytest.mark.parametrize("count", [2, 3, 4, 5])
def test_equal_tails_around_the_axis_push_along_it_alone(count):
    gait = swimmer(around(count)).gait()
    turn = 2.0 * np.pi / count
    Q = np.array([[1, 0, 0], [0, np.cos(turn), -np.sin(turn)], [0, np.sin(turn), np.cos(turn)]])
    alike(gait, Turned(gait, Q), 1e-11)
    lateral = gait.velocity(PHASES)[:, [1, 2, 4, 5]]
    assert np.abs(lateral).max() < 1e-12
    assert np.abs(gait.mean_velocity[[0, 3]]).min() > 1e-3


def test_a_pair_of_opposite_hands_turns_nothing():
    left = ms.HelicalTail(**WAVE, position=(0, 0.3, 0), direction=(1, 0.3, 0), phase=0.2)
    right = ms.HelicalTail(
        **WAVE, position=(0, -0.3, 0), direction=(1, -0.3, 0), handedness="right", phase=0.2 + np.pi
    )
    gait = swimmer([left, right]).gait()
    velocity = gait.velocity(PHASES)
    assert np.allclose(velocity, velocity * MIRROR_Q, atol=1e-14)
    assert gait.mean_velocity[0] < -0.01


def test_derivatives_by_the_complex_step_reach_the_place():
    tail = ms.HelicalTail(**WAVE, position=(0.0, 0.1, 0.0), direction=(1.0, 0.2, 0.1), phase=0.3)
    robot = swimmer([tail, ms.PlaneWaveTail(**WAVE, position=(0.0, -0.3, 0.0))])
    names = ["tail[0].position[1]", "tail[0].direction[2]", "tail[0].phase", "tail[1].amplitude"]
    slopes = robot.gradient("mean_velocity", names)
    for name in names:
        step, at = 1e-5, robot.numbers[name]
        up, down = (robot.with_({name: at + d}).gait().mean_velocity for d in (step, -step))
        assert slopes[name] == pytest.approx((up - down) / (2.0 * step), abs=1e-7)


def test_weight_and_strain_are_those_of_the_placed_tails():
    A = ms.HelicalTail(**WAVE, direction=(0, 1, 0)).placement.rotation
    root = np.array([-0.5, 0.0, 0.0]) + A @ [0.5, 0.0, 0.0]
    tail = ms.HelicalTail(**WAVE, direction=(0, 1, 0), position=tuple(root))
    heavy = {"gravity": ms.Gravity(density=2.0, acceleration=1.0)}
    plain, turned, both = (
        swimmer(t, **heavy) for t in (ms.HelicalTail(**WAVE), tail, [ms.HelicalTail(**WAVE), tail])
    )
    arms = [weight.arm(s, PHASES) for s in (plain, turned, both)]
    assert np.allclose(arms[1], arms[0] @ A.T)
    assert np.allclose(arms[2], arms[0] + arms[1])
    S, g = strain.coupling(plain, PHASES[:2])
    T, h = strain.coupling(turned, PHASES[:2])
    for k, E in enumerate(strain.unit_gradients()):
        seen = A.T @ E @ A  # the same flow, in the axes that turn with the tail
        e = np.array([seen[i, j] for i, j in strain.ENTRIES])
        assert np.allclose(T[:, :, k], (S @ e) @ np.kron(np.eye(2), A).T, atol=1e-12)
        assert np.allclose(h[:, k], g @ e, atol=1e-12)


def test_the_gait_says_that_tails_do_not_meet():
    remarks = swimmer(around(2)).gait().info["remarks"]
    assert any("bem knows better" in r for r in remarks)
    assert not any("bem knows better" in r for r in swimmer(around(1)).gait().info["remarks"])


def test_who_cannot_take_placed_tails_says_so_in_a_sentence():
    robot = swimmer(ms.HelicalTail(**WAVE, position=(0, 0.1, 0)))
    with pytest.raises(ms.SpecError, match="single tails at the joint"):
        robot.gait("atlas")
    assert robot.gait("auto").model == "rft"
    with pytest.raises(ms.SpecError, match="off the axis"):
        swimmer(robot.tail, motion=ms.Motion(frequency_frame="lab"))


def test_reversing_one_motor_is_that_tail_beating_backwards():
    """Tails of rates f and -f: at each phase the sum of what each does alone at its own phase."""
    one, other = around(2)
    both = swimmer([one, replace(other, frequency=-1.0)], ms.NoBody()).gait()
    each = [swimmer(t, ms.NoBody()).gait() for t in (one, other)]
    for phase in PHASES:
        R = each[0].resistance(phase) + each[1].resistance(-phase)
        assert np.allclose(both.resistance(phase), R, atol=1e-13)
        F = each[0].propulsion(phase) - each[1].propulsion(-phase)
        assert np.allclose(both.propulsion(phase), F, atol=1e-13)
    forth, back = (swimmer([one, replace(other, frequency=f)]).gait() for f in (1.0, -1.0))
    assert forth.mean_velocity[0] < -0.05
    assert abs(back.mean_velocity[0]) < 0.5 * abs(forth.mean_velocity[0])
    assert np.linalg.norm(back.mean_velocity[4:]) > np.linalg.norm(forth.mean_velocity[4:]) + 0.01


@pytest.mark.parametrize(
    ("rates", "shared", "beats"),
    [
        ((1.0, 1.0), 1.0, (1, 1)),
        ((2.0, -2.0), 2.0, (1, -1)),
        ((-2.0, -2.0), -2.0, (1, 1)),
        ((100.0, 150.0), 50.0, (2, 3)),
        ((0.3, 0.1), 0.1, (3, 1)),
        ((0.0, 4.0), 4.0, (0, 1)),
        ((0.0, 0.0), 0.0, (1, 1)),
        ((1e-3, 12e-3, -6e-3), 1e-3, (1, 12, -6)),
    ],
)
def test_tails_share_the_period_of_the_largest_common_frequency(rates, shared, beats):
    tails = [
        ms.HelicalTail(**WAVE, position=(0, 0.3 * n, 0), frequency=f) for n, f in enumerate(rates)
    ]
    tail = ms.SeveralTails(tails=tails)
    assert tail.frequency == pytest.approx(shared, rel=1e-12)
    assert tuple(t.beats for t in tail.each) == beats
    for t in tail.each:
        assert t.pace * tail.frequency == pytest.approx(t.frequency, rel=1e-12)
        _, _, velocity = t.centreline(1.0, 0.3)
        step = 1e-6
        up, down = (t.centreline(1.0, 0.3 + d)[0] for d in (step, -step))
        assert np.allclose(velocity, (up - down) / (2.0 * step), atol=1e-8)


@pytest.mark.parametrize("rates", [(1.0, np.sqrt(2.0)), (1.0, 13.0), (1.0, 1.01)])
def test_beats_that_share_no_period_are_refused(rates):
    with pytest.raises(ms.SpecError, match=r"tail\[1\]\.frequency.*whole multiples"):
        ms.SeveralTails(tails=[ms.HelicalTail(**WAVE, frequency=f) for f in rates])


def test_the_derivative_by_one_rate_is_what_that_motor_adds():
    """At held phases the velocity is linear in the rates: they add up to the velocity."""
    one, other = around(2)
    robot = swimmer([one, replace(other, frequency=-2.0)])
    slopes = robot.gradient("mean_velocity", ["tail[0].frequency", "tail[1].frequency"])
    total = slopes["tail[0].frequency"] - 2.0 * slopes["tail[1].frequency"]
    assert np.allclose(total, robot.gait().mean_velocity, atol=1e-12)
    still = swimmer([one, replace(other, frequency=0.0)])
    assert np.linalg.norm(still.gait().mean_velocity) > 0.01
