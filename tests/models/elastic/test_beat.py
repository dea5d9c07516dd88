"""Beats of elastic tails against closed forms, a chain of points, and laws."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import microswim as ms
from microswim.models.elastic.beat import drive, settled
from microswim.models.elastic.growth import growth
from microswim.models.elastic.plane import Loads, balance
from microswim.models.elastic.problem import problem
from microswim.numerics.series.fourier import MIRROR_Q
from oracles.chain_of_links import way_in_a_period
from oracles.elastic_filament import chain_thrust, moment_thrust, thrust

RATE = 2.0 * np.pi


#: A shape at rest that begins beside the joint and bends both ways, and a straight one.
AWRY = tuple((s, 0.1 + 0.1 * np.sin(4.0 * s), 0.0) for s in np.linspace(0.0, 1.0, 21))
STRAIGHT = tuple((s, 0.0, 0.0) for s in np.linspace(0.0, 1.0, 5))


def swimmer(sperm_number, size, *, ratio=0.5, drive="heave", base="clamped", rest=None, **parts):
    """A swimmer whose tail has c_n = 1 and length 1, held unless said otherwise."""
    own = {"base": base, "drive": drive, "amplitude" if drive == "heave" else "angle": size}
    own["rest"] = rest
    tail = ms.ElasticTail(length=1.0, radius=0.01, bending=RATE / sperm_number**4, **own)
    parts = {"body": ms.NoBody(), "motion": ms.Motion(free="none")} | parts
    law = ms.Constant(normal=1.0, tangential=ratio, spin=False)
    return ms.Swimmer(tail=tail, fluid=ms.Fluid(viscosity=1.0), coefficients=law, **parts)


def held_thrust(found, size, ratio=0.5):
    """Thrust towards the body in units of ``(c_n - c_t) w size^2``."""
    force = ms.summary(found.gait("elastic"))["held_wrench"][0]
    return -force / (RATE * (1.0 - ratio) * size**2)


COLUMNS = [("clamped", "heave"), ("hinged", "heave"), ("clamped", "pivot")]


@pytest.mark.parametrize(("base", "drive"), COLUMNS)
@pytest.mark.parametrize("sperm_number", [1.0, 2.0, 3.0, 4.0, 5.0, 8.0])
def test_thrust_of_small_amplitude_is_the_closed_form(base, drive, sperm_number):
    size = 0.002
    found = held_thrust(swimmer(sperm_number, size, drive=drive, base=base), size)
    assert found == pytest.approx(thrust(sperm_number, base, drive), rel=3e-4)


@pytest.mark.parametrize("ratio", [0.3, 0.5, 0.8])
def test_small_amplitude_does_not_know_the_tangential_drag(ratio):
    found = held_thrust(swimmer(4.0, 0.002, ratio=ratio), 0.002, ratio)
    assert found == pytest.approx(thrust(4.0), rel=3e-4)


def bent_from_within(sperm_number, moment, waves, **parts):
    """A clamped filament of length 1 that waves of inner moment bend, in units of B / L."""
    bending = RATE / sperm_number**4
    tail = ms.ElasticTail(length=1.0, radius=0.01, bending=bending, drive="moment",
                          moment=moment * bending, wavelength=1.0 / waves)  # fmt: skip
    parts = {"body": ms.NoBody(), "motion": ms.Motion(free="none")} | parts
    law = ms.Constant(normal=1.0, tangential=0.5, spin=False)
    return ms.Swimmer(tail=tail, fluid=ms.Fluid(viscosity=1.0), coefficients=law, **parts)


@pytest.mark.parametrize("waves", [0.7, 2.0])
@pytest.mark.parametrize("sperm_number", [1.5, 4.0])
def test_waves_of_inner_moment_push_as_the_closed_form_says(sperm_number, waves):
    found = held_thrust(bent_from_within(sperm_number, 0.01, waves), 0.01)
    assert found == pytest.approx(moment_thrust(sperm_number, waves), rel=1e-3)


def test_inner_moments_give_what_the_fluid_takes():
    """Their work ``int M theta_st ds`` over a period, on a free body."""
    one = bent_from_within(3.0, 4.0, 1.3, body=ms.Sphere(radius=0.1), motion=ms.Motion())
    beat, gait = settled(problem(one)), one.gait()
    wave = 4.0 * np.cos(beat.phases[:, None] - RATE * 1.3 * beat.rod.s)
    bent = (beat.velocities[:, -beat.rod.count :] @ beat.rod.curvatures.T * wave) @ beat.rod.weight
    unit = one.numbers["tail.bending"] * RATE  # B / L per unit phase
    assert bent.mean() * unit == pytest.approx(gait.mean_power, rel=1e-6)


def test_inner_moments_run_towards_the_tip_or_back():
    """With the motor backwards the wave runs towards the body, and pulls."""
    parts = {"body": ms.Sphere(radius=0.1), "motion": ms.Motion()}
    ahead = bent_from_within(3.0, 4.0, 1.3, **parts)
    back = ahead.with_({"tail.frequency": -1.0})
    assert ahead.gait().mean_velocity[0] < 0.0 < back.gait().mean_velocity[0]


@pytest.mark.parametrize("drive", ["heave", "pivot"])
@pytest.mark.parametrize("turning", [0.1, 1.0, 30.0])
def test_a_hook_gives_way_as_its_stiffness_says(drive, turning):
    one = swimmer(3.0, 0.002, drive=drive)
    hook = ms.Hook(stiffness=turning * one.numbers["tail.bending"] * 0.05, length=0.05)
    found = held_thrust(replace(one, hook=hook), 0.002)
    assert found == pytest.approx(thrust(3.0, drive=drive, hook=turning), rel=3e-4, abs=1e-5)


def test_the_closed_form_is_left_with_the_square_of_the_amplitude():
    truth = thrust(8.0, "hinged")
    off = [held_thrust(swimmer(8.0, y, base="hinged"), y) - truth for y in (0.02, 0.01)]
    assert off[0] / off[1] == pytest.approx(4.0, rel=0.02)
    assert off[0] / truth == pytest.approx(-0.0116, rel=0.03)  # beyond half a per cent, truly
    assert held_thrust(swimmer(8.0, 0.013, base="hinged"), 0.013) == pytest.approx(truth, rel=5e-3)
    assert held_thrust(swimmer(8.0, 1e-5, base="hinged"), 1e-5) == pytest.approx(truth, rel=1e-7)


def test_a_beat_that_is_left_is_told():
    about = swimmer(2.4, 0.7, base="hinged").gait().info
    assert not about["settles"]
    assert about["settling_periods"] is None
    assert any("does not settle to this motion" in r for r in about["remarks"])


@pytest.mark.slow
def test_large_amplitude_is_that_of_a_chain_of_points():
    rough, fine = (chain_thrust(2.0, 0.3, 0.5, points) for points in (12, 24))
    truth = (fine + (fine - rough) / 3.0) / (0.5 * 0.3**2)
    assert held_thrust(swimmer(2.0, 0.3), 0.3) == pytest.approx(truth, rel=1e-3)


def test_without_stiffness_thrust_is_that_of_the_wave_that_dies_out():
    assert held_thrust(swimmer(25.0, 0.001), 0.001) == pytest.approx(0.25, rel=2e-3)


def test_a_stiff_tail_goes_nowhere_with_the_fourth_power():
    slow, fast = (held_thrust(swimmer(sp, 0.05), 0.05) for sp in (0.25, 0.5))
    assert fast / slow == pytest.approx(16.0, rel=0.01)


def test_a_stiff_tail_moves_as_one():
    stiff = swimmer(0.02, 0.3, drive="pivot", body=ms.Sphere(radius=0.3), motion=ms.Motion())
    tail: Any = stiff.tail
    rigid = ms.CustomTail(shape=lambda s, phase: tail.stiff(s, phase)[0], length=1.0, radius=0.01)
    phases = np.linspace(0.0, RATE, 9)
    one, other = stiff.gait("elastic"), replace(stiff, tail=rigid).gait("rft")
    np.testing.assert_allclose(one.velocity(phases), other.velocity(phases), atol=1e-5)
    np.testing.assert_allclose(one.resistance(phases), other.resistance(phases), atol=1e-5)


@pytest.mark.parametrize("drive", ["heave", "pivot"])
def test_a_whole_period_finds_the_beat_of_half_of_it(drive):
    """A straight shape at rest that is said by points asks for no mirror image."""
    parts = {"drive": drive, "body": ms.Sphere(radius=0.2), "motion": ms.Motion()}
    half, whole = (swimmer(3.0, 0.4, rest=rest, **parts).gait() for rest in (None, STRAIGHT))
    np.testing.assert_allclose(whole.mean_velocity, half.mean_velocity, atol=1e-9)
    for name in ("growth", "tip_amplitude"):
        assert whole.info[name] == pytest.approx(half.info[name], rel=1e-4)
    assert whole.mean_power == pytest.approx(half.mean_power, rel=1e-7)


def test_a_stiff_bent_tail_moves_as_one():
    """Against the same arc as a given motion, turned about the joint."""

    def arc(s, phase):
        angle, turn = s / 0.6, 0.3 * np.cos(phase)
        x, y, c, d = 0.6 * np.sin(angle), 0.6 * (1 - np.cos(angle)), np.cos(turn), np.sin(turn)
        return np.stack([c * x - d * y, d * x + c * y, 0.0 * (x + c)], axis=-1)

    stiff = swimmer(0.02, 0.3, drive="pivot", body=ms.Sphere(radius=0.3), motion=ms.Motion())
    bent: Any = replace(stiff.tail, rest_radius=0.6)  # type: ignore[call-arg]
    rigid = ms.CustomTail(shape=arc, length=1.0, radius=0.01)
    phases = np.linspace(0.0, RATE, 9)
    one, other = (replace(stiff, tail=t).gait(m) for t, m in ((bent, "elastic"), (rigid, "rft")))
    np.testing.assert_allclose(one.velocity(phases), other.velocity(phases), atol=1e-5)
    np.testing.assert_allclose(one.resistance(phases), other.resistance(phases), atol=1e-5)


def test_the_mirror_image_of_a_bent_tail_swims_as_the_mirror_image():
    image = [(s, -q, r) for s, q, r in AWRY]
    parts = {"body": ms.Sphere(radius=0.2), "motion": ms.Motion()}
    one, other = (swimmer(3.0, 0.3, rest=rest, **parts).gait() for rest in (AWRY, image))
    # sampled half a step apart, so to what the phases resolve (1e-5), not to rounding
    np.testing.assert_allclose(other.velocity(np.pi), one.velocity(0.0) * MIRROR_Q, atol=1e-6)
    assert abs(one.mean_velocity[5]) > 1e-3  # it swims in circles


def test_a_body_that_drifts_aside_leaves_no_mirror_image():
    """It turns as it goes along s: what marching in time settles to."""
    entries = ((0.0, 0.0, 0.4), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    one = swimmer(2.0, 0.3, body=ms.Sphere(radius=0.2), motion=ms.Motion(),
                  interaction=ms.Interaction(coupling=entries))  # fmt: skip
    beat = settled(problem(one))
    assert not beat.problem.mirrors
    (end,) = marched(beat, 0.0 * beat.shape[0], [8.0 * np.pi])
    np.testing.assert_allclose(end, beat.shape[0], atol=5e-5)


@pytest.mark.parametrize("free", ["none", "all"])
@pytest.mark.parametrize(("base", "drive", "size", "rest"), [
    ("clamped", "heave", 0.2, None), ("hinged", "heave", 0.2, None),
    ("clamped", "pivot", 0.6, None),
    ("clamped", "heave", 0.2, AWRY), ("clamped", "pivot", 0.6, AWRY),
])  # fmt: skip
def test_the_drive_gives_what_the_fluid_takes(free, base, drive, size, rest):
    """Elastic energy comes back after a period, so the means are equal."""
    body = ms.Sphere(radius=0.2)
    motion = ms.Motion(free=free)
    one = swimmer(3.0, size, drive=drive, base=base, rest=rest, body=body, motion=motion)
    gait = one.gait("elastic")
    phase = RATE * np.arange(256) / 256
    place = gait.velocity(phase)
    on_tail = -np.einsum("tij,tj->ti", gait.resistance(phase), place)
    on_tail -= gait.propulsion(phase) * gait.rate + gait.body_wrench(phase)
    at_joint = on_tail[:, 5] - 0.2 * on_tail[:, 1]
    base_y = size * np.cos(phase) if drive == "heave" else 0.0 * phase
    at_base = at_joint + base_y * on_tail[:, 0]
    rate = -size * np.sin(phase) * gait.rate
    given = -(rate * (on_tail[:, 1] if drive == "heave" else at_base)).mean()
    assert given == pytest.approx(gait.mean_power, rel=1e-6)


def test_the_filament_does_not_stretch():
    tail = swimmer(4.0, 0.4).settled.tail
    s, phase = np.meshgrid(np.linspace(0.0, 1.0, 33), np.linspace(0.0, RATE, 17))
    _, slope, _ = tail.centreline(s, phase)
    np.testing.assert_allclose(np.linalg.norm(slope, axis=-1), 1.0, atol=1e-9)
    assert tail.arc_length == pytest.approx(1.0, abs=1e-10)


def test_half_a_period_on_the_tail_is_its_mirror_image():
    tail = swimmer(3.0, 0.3).settled.tail
    s = np.linspace(0.0, 1.0, 7)
    now, later = (tail.centreline(s, phase)[0] for phase in (0.4, 0.4 + np.pi))
    np.testing.assert_allclose(later, now * [1.0, -1.0, 1.0], atol=1e-12)


def marched(beat, start, times):
    """Coordinates at the times, by SciPy's integrator, from a start at phase 0."""
    made = beat.problem
    n, f = beat.rod.count, len(made.drag.free)

    def rate(phase, q):
        base = drive(made, np.array([phase]))
        nought = np.zeros((1, f + n))
        at = balance(beat.rod, made.drag, base, q[None], nought, Loads(), 0.0 * q)
        return -np.linalg.solve(at.resistance[0], at.residual[0])[f:]

    found = solve_ivp(rate, (0.0, times[-1]), start, "BDF", times, rtol=1e-7, atol=1e-10)
    return found.y.T


@pytest.mark.parametrize("free", ["none", "all"])
def test_marching_in_time_settles_to_the_beat(free):
    one = swimmer(2.0, 0.3, body=ms.Sphere(radius=0.2), motion=ms.Motion(free=free))
    beat = settled(problem(one))
    (end,) = marched(beat, 0.0 * beat.shape[0], [7.0 * np.pi])
    np.testing.assert_allclose(end, -beat.shape[0], atol=5e-5)


def test_a_disturbance_grows_as_foretold():
    """A hinged filament moved far across turns away from its beat: marched, and by its growth."""
    beat = settled(problem(swimmer(2.4, 0.7, base="hinged")))
    start = beat.shape[0].copy()
    start[0] += 1e-4
    after = marched(beat, start, RATE * np.array([1.0, 2.0])) - beat.shape[0]
    assert after[1, 0] / after[0, 0] == pytest.approx(growth(beat), rel=5e-3)
    assert growth(beat) > 1.1


def test_disturbances_die_as_the_slowest_mode_of_a_cantilever():
    """``exp(-2 pi beta^4 / Sp^4)`` in a period, ``1 + cos(beta) cosh(beta) = 0``."""
    beta = 1.8751040687119611
    assert 1.0 + np.cos(beta) * np.cosh(beta) == pytest.approx(0.0, abs=1e-12)
    for sperm_number in (2.0, 4.0):
        found = growth(settled(problem(swimmer(sperm_number, 1e-4))))
        truth = np.exp(-2.0 * np.pi * beta**4 / sperm_number**4)
        assert found == pytest.approx(truth, rel=1e-4)


def test_a_hinged_tail_hardly_turns_back():
    about = swimmer(2.0, 0.01, base="hinged").gait("elastic").info
    assert about["growth"] == pytest.approx(1.0, abs=1e-2)


def test_backwards_the_drive_gives_the_same_beat():
    one, other = (
        swimmer(3.0, 0.2, body=ms.Sphere(radius=0.2), motion=ms.Motion()).with_(
            {"tail.frequency": f}
        ).gait("elastic")
        for f in (1.0, -1.0)
    )  # fmt: skip
    np.testing.assert_allclose(one.mean_velocity, other.mean_velocity, atol=1e-12)
    assert other.mean_power == pytest.approx(one.mean_power)
    assert one.mean_power > 0.0


def test_curvatures_converge_faster_than_any_power():
    from microswim.models.elastic import beat

    made = problem(swimmer(4.0, 0.2))
    fine = beat.found(made, 16, 24)
    off = []
    for n in (4, 6, 8, 10):
        rough = beat.found(made, 16, n)
        off.append(np.abs(rough.shape[:, 0] - fine.shape[:, 0]).max())
    order = np.log(np.divide(off[:-1], off[1:])) / np.log([6 / 4, 8 / 6, 10 / 8])
    assert (order > 4.0).all()
    assert order[-1] > order[0]


def test_a_swimmer_without_drive_stands_still():
    tail = ms.ElasticTail(length=1.0, radius=0.01, bending=1.0, drive="none")
    one = swimmer(2.0, 0.1, body=ms.Sphere(radius=0.2), motion=ms.Motion())
    gait = replace(one, tail=tail).gait("elastic")
    np.testing.assert_allclose(gait.mean_velocity, 0.0, atol=1e-14)
    assert any(r.endswith("which is at rest here") for r in gait.info["remarks"])
    field = ms.UniformField(strength=1.0)
    driven = replace(one, tail=tail, field=field, magnet=ms.Magnet(moment=(1.0, 0.0, 0.0)))
    said = driven.gait("elastic").info["remarks"]
    assert any("microswim path follows it under its field" in r for r in said)


def test_a_limp_tail_is_refused_in_a_sentence():
    with pytest.raises(ms.MicroswimError, match="too sharply to be resolved"):
        swimmer(300.0, 0.01).gait("elastic")


def test_units_do_not_matter():
    hook = ms.Hook(stiffness=0.03, length=0.05)
    one = swimmer(3.0, 0.2, body=ms.Sphere(radius=0.2), motion=ms.Motion(), hook=hook)
    bare, um, mu, f = one.gait("elastic"), 1e-6, 1e-3, 50.0
    tail = ms.ElasticTail(
        length=um, radius=0.01 * um, bending=mu * f * um**4 * RATE / 81.0, frequency=f,
        amplitude=0.2 * um,
    )  # fmt: skip
    law = ms.Constant(normal=mu, tangential=0.5 * mu, spin=False)
    si = ms.Swimmer(
        body=ms.Sphere(radius=0.2 * um), tail=tail, fluid=ms.Fluid(viscosity=mu), units="SI",
        coefficients=law, hook=ms.Hook(stiffness=0.03 * mu * f * um**4, length=0.05 * um),
    ).gait("elastic")  # fmt: skip
    assert si.mean_velocity[0] == pytest.approx(um * f * bare.mean_velocity[0], rel=1e-9)
    assert si.mean_power == pytest.approx(mu * f**2 * um**3 * bare.mean_power, rel=1e-9)


@pytest.mark.parametrize("rest", [None, AWRY])
def test_the_gait_is_that_of_the_settled_tail(rest):
    """Sums at the rod's own nodes, and those of any tail with that centreline."""
    hook = ms.Hook(stiffness=0.5, length=0.05)
    one = swimmer(3.0, 0.2, rest=rest, body=ms.Sphere(radius=0.2), motion=ms.Motion(), hook=hook)
    ours, other = one.gait("elastic"), one.settled.gait("rft")
    phases = np.linspace(0.0, RATE, 9)
    np.testing.assert_allclose(ours.velocity(phases), other.velocity(phases), atol=1e-9)
    assert ours.mean_power == pytest.approx(other.mean_power, rel=1e-9)


def test_the_body_moves_as_the_beat_says():
    """The velocities that Newton's method found, and those of R and F_p."""
    one = swimmer(3.0, 0.2, body=ms.Sphere(radius=0.2), motion=ms.Motion())
    beat, gait = settled(problem(one)), one.gait("elastic")
    found = gait.velocity(beat.phases)[:, [0, 1, 5]] / gait.rate
    np.testing.assert_allclose(beat.velocity, found, atol=1e-9)


@pytest.mark.parametrize(
    "name", ["tail.bending", "tail.amplitude", "tail.frequency", "body.radius"]
)
def test_derivatives_are_exact(name):
    one = swimmer(3.0, 0.2, body=ms.Sphere(radius=0.2), motion=ms.Motion())
    slope = one.gradient("mean_power", name)[name]
    value, h = one.numbers[name], 1e-4
    ends = [one.with_({name: value * (1.0 + d)}).gait().mean_power for d in (-h, h)]
    assert slope == pytest.approx((ends[1] - ends[0]) / (2.0 * h * value), rel=1e-5)


@pytest.mark.parametrize(("sperm_number", "drive", "name", "size"), [
    (3.0, "heave", "amplitude", 0.2),
    pytest.param(2.0, "pivot", "angle", 0.6, marks=pytest.mark.slow),
])  # fmt: skip
def test_a_free_swimmer_comes_as_far_as_a_chain_of_links(sperm_number, drive, name, size):
    """At large amplitude; links of half the length are four times as near."""
    bending, size_of = 2.0 * RATE / sperm_number**4, {name: size}
    tail: Any = {"length": 1.0, "radius": 0.02, "bending": bending, "drive": drive, **size_of}
    one = ms.Swimmer(
        body=ms.Sphere(radius=0.2), tail=ms.ElasticTail(**tail), fluid=ms.Fluid(viscosity=1.0),
        coefficients=ms.Constant(normal=2.0, tangential=1.2, spin=False),
    )  # fmt: skip
    x = ms.trajectory(one.gait(), [0.0, 1.0]).position.values
    coarse, fine = (
        way_in_a_period(n, drive=drive, size=size, bending=bending, normal=2.0, tangential=1.2,
                        radius=0.2, periods=6)
        for n in (12, 24)
    )  # fmt: skip
    way = float(np.linalg.norm(x[1] - x[0]))
    assert way == pytest.approx(fine + (fine - coarse) / 3.0, rel=2e-4)
