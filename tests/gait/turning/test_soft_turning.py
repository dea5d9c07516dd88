"""Soft magnets in a turning field: closed forms, traced curves, an integration of its own."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import microswim as ms
from microswim.gait.turning.slipping import drift
from microswim.gait.turning.soft_turning import SoftTurning
from microswim.gait.turning.traced import curves_of
from microswim.gait.turning.wobbling import closest_soft
from microswim.swimmer.magnetism.drive import drive_of

ALONG, ACROSS, B = 1.3, 6.1, 0.7


def round_robot(angle, values=(2.0, 0.6, 0.6), turned=0.3):
    """A robot of revolution whose piece has its first axis at an angle to the long axis."""
    M = np.zeros((6, 3))
    M[3:] = np.diag([1 / ALONG, 1 / ACROSS, 1 / ACROSS])
    turn = Rotation.from_rotvec([turned, 0, 0]) * Rotation.from_rotvec([0, 0, angle])
    C = turn.as_matrix() @ np.diag(values) @ turn.as_matrix().T
    return SoftTurning.of(M, C, B)


def any_robot(seed):
    """A robot of no symmetry with a piece of three different axes."""
    rng = np.random.default_rng(seed)
    A, S = rng.standard_normal((6, 6)), rng.standard_normal((3, 3))
    mobility = A @ A.T + np.diag([1.0, 1.0, 1.0, 6.0, 2.0, 2.0])
    return SoftTurning.of(mobility[:, 3:], S @ S.T, 0.8)


@pytest.mark.parametrize("angle", [57.0, 70.0, 85.0])
@pytest.mark.parametrize("values", [(2.0, 0.6, 0.6), (2.0, 0.6, 0.6 - 1e-4)])
def test_a_robot_of_revolution_tumbles_wobbles_and_steps_out_as_the_closed_forms_say(angle, values):
    """By formula, and with the second piece along curves that are traced."""
    phi, pull = np.radians(angle), 1.4 * B**2
    robot = round_robot(phi, values)
    p, r = (np.sin(phi) / ALONG) ** 2, (np.cos(phi) / ACROSS) ** 2
    onset = pull * np.sin(phi) * np.cos(phi) / ACROSS
    step_out = pull * np.sin(phi) * (p + r) / (2.0 * np.sqrt(p))
    close = 1e-6 if values[1] == values[2] else 1e-3
    assert robot.step_out == pytest.approx(step_out, rel=close)
    assert robot.wobbling_onset == pytest.approx(onset, rel=close)
    exact = closest_soft(robot.mobility, round_robot(phi).softness, B)
    assert exact is not None
    for share in (0.3, 0.9):
        angles = [s.precession_angle for s in robot.states(share * onset)]
        assert angles
        assert np.degrees(angles) == pytest.approx(90.0, abs=1.0)
    for c in (0.98, 0.9, 0.8):
        root = np.sqrt(p * (1.0 - c * c) + r)
        rate, theta = pull * np.sin(phi) * c * root, np.arcsin(np.sqrt(r) / root)
        assert rate < step_out
        angles = [s.precession_angle for s in robot.states(rate)]
        assert min(abs(np.array(angles) - theta)) < 10.0 * close
        assert float(exact.precession_angle(rate)) == pytest.approx(theta, abs=1e-9)
    assert robot.states(1.001 * step_out) == []


def test_a_long_soft_head_tumbles_until_its_step_out():
    """Its axis along the robot's: ``w = D sin(2 a)/(2 kappa_perp)``, held up to a = 45 degrees."""
    robot = round_robot(0.0)
    most = 1.4 * B**2 / (2.0 * ACROSS)
    assert robot.step_out == pytest.approx(most, rel=1e-6)
    for state in robot.states(0.5 * most):
        assert state.precession_angle == pytest.approx(np.pi / 2.0, abs=1e-6)
    exact = closest_soft(robot.mobility, robot.softness, B)
    assert exact is not None
    assert exact.step_out == pytest.approx(most)


def turning(robot, rate, start, turns):
    """Axis and field seen from the body after so many turns, by SciPy; and the way along n."""
    W, C, square = robot.mobility, robot.softness, robot.strength**2

    def change(_, y):
        n, b = y[:3], y[3:6]
        V = square * W @ np.cross(C @ b, b)
        return [*np.cross(n, V[3:]), *np.cross(b, V[3:]) + rate * np.cross(n, b), V[:3] @ n]

    span = 2.0 * np.pi / rate * turns
    found = solve_ivp(change, (0.0, span), [*start, 0.0], rtol=1e-9, atol=1e-10)
    return found.y[:, -1], span


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_robot_of_no_symmetry_ends_in_a_state_that_is_told(seed):
    robot = any_robot(seed)
    rate = 0.4 * robot.step_out
    y, _ = turning(robot, rate, [1, 0, 0, 0, 1, 0], 40)
    n, b = y[:3], y[3:6]
    states = robot.states(rate)
    assert states
    off = [min(np.linalg.norm(s.field - b), np.linalg.norm(s.field + b)) for s in states]
    nearest = states[int(np.argmin(off))]
    assert min(off) < 1e-4
    assert abs(n @ nearest.axis) == pytest.approx(1.0, abs=1e-6)
    assert nearest.rate == pytest.approx(rate, rel=1e-9)


def test_on_a_rail_it_slips_as_adler_says():
    """About s alone: ``a' = w - w_c sin(2 a)``, mean rate ``w - sqrt(w^2 - w_c^2)``."""
    M = np.zeros((6, 3))
    M[3, 0], M[0, 0] = 1.0 / ALONG, 0.2
    robot = SoftTurning.of(M, np.diag([0.6, 2.0, 0.6]), B)
    critical = 1.4 * B**2 / (2.0 * ALONG)
    for ratio in (1.05, 2.0):
        mean, spread = drift(robot, ratio * critical)
        slips = critical * (ratio - np.sqrt(ratio**2 - 1.0))
        assert mean == pytest.approx(0.2 * ALONG * slips, rel=2e-4)
        assert spread < 1e-3 * abs(mean)


def test_where_it_begins_to_swing_before_the_closed_form_s_step_out_that_is_not_told():
    """At 50 degrees the state of the largest rate is not held: an integration leaves it."""
    robot = round_robot(np.radians(50.0), turned=0.0)
    assert closest_soft(robot.mobility, robot.softness, B) is None
    for c, held in ((0.95, True), (0.8, False)):
        state = robot.at(np.array([0.0, c, np.sqrt(1.0 - c * c)]))
        assert bool(state.held) == held
        b = state.field + 1e-2 * np.array([0.3, -0.5, 0.8])
        n = np.cross(np.cross(b, state.axis), b)
        start = [*n / np.linalg.norm(n), *b / np.linalg.norm(b)]
        y, _ = turning(robot, float(state.rate), start, 20)
        off = min(np.linalg.norm(s * y[3:6] - state.field) for s in (1, -1))
        assert (off < 0.01) == held


def test_curves_that_cross_are_traced_straight_on():
    """``b1 b2 b3`` is zero on three great circles, which meet at right angles."""

    def product(b):
        x, y, z = np.moveaxis(b, -1, 0)
        return x * y * z, np.stack([y * z, x * z, x * y], axis=-1)

    turn = Rotation.from_rotvec([0.3, -0.5, 0.2]).as_matrix()

    def turned(b):
        value, slope = product(b @ turn)
        return value, slope @ turn.T

    curves = curves_of(turned)
    u = np.linspace(0.0, 2.0 * np.pi, 50)
    axes = sorted(int(np.argmin(np.abs(c(u) @ turn).max(axis=0))) for c in curves)
    assert axes == [0, 1, 2]
    assert max(np.abs(c(u) @ turn).min(axis=1).max() for c in curves) < 1e-9


def test_the_regimes_of_a_soft_helix_scale_with_the_square_of_the_field():
    robot = ms.Swimmer.preset("tabak/helix-constant").with_({"tail.frequency": 0.0})
    soft = ms.Swimmer(
        body=ms.Sphere(radius=0.5e-3),
        tail=ms.HelicalTail(length=1.5e-3, amplitude=2e-4, waves=2, radius=1e-4, frequency=0.0),
        fluid=ms.Fluid(viscosity=0.34),
        coefficients=ms.GrayHancock(),
        magnet=ms.Magnet(susceptibility=(1.0, 2.5, 1.0), volume=1e-10),
        field=ms.RotatingField(strength=5e-3, frequency=1.0),
        units="SI",
    )
    assert robot.magnet is None
    one = ms.regimes(soft, [0.01], model="rft")
    assert one.step_out > 0
    two = ms.regimes(soft.with_({"field.strength": 1e-2}), [0.04], model="rft")
    assert two.step_out == pytest.approx(4.0 * one.step_out, rel=1e-6)
    assert two.velocity[0] == pytest.approx(4.0 * one.velocity[0], rel=1e-6)


@pytest.mark.parametrize(("seed", "cone"), [(0, 0.03), (1, 0.2), (2, -0.2)])
def test_in_a_cone_it_ends_in_a_state_that_is_told(seed, cone):
    robot = replace(any_robot(seed), cone=cone)
    rate = 0.5 * robot.step_out
    y, _ = turning(robot, rate, [1, 0, 0, np.sin(cone), np.cos(cone), 0], 60)
    off = [np.linalg.norm(s.field - y[3:6]) + np.linalg.norm(s.axis - y[:3])
           for s in robot.states(rate)]  # fmt: skip
    assert min(off) < 1e-6


@pytest.mark.parametrize("cone", [0.1, 0.5])
def test_a_piece_of_one_axis_in_a_cone_is_the_limit_of_three(cone):
    """By the curves of permanent magnets, and by curves that are traced."""
    limit = replace(round_robot(1.2), cone=cone)
    robot = replace(round_robot(1.2, (2.0, 0.6, 0.6 - 1e-4)), cone=cone)
    assert robot.step_out == pytest.approx(limit.step_out, rel=1e-3)
    for share in (0.4, 0.9):
        rate = share * limit.step_out
        angles, known = ([s.precession_angle for s in r.states(rate)] for r in (robot, limit))
        assert known
        assert max(min(abs(a - k) for k in known) for a in angles) < 1e-3
        assert max(min(abs(a - k) for a in angles) for k in known) < 1e-3


def test_quantities_in_a_cone_are_those_of_its_regimes():
    robot = soft_helix().with_({"field.cone": 0.2})
    gait = robot.gait("rft")
    told = ms.regimes(robot, [0.01], gait=gait)
    assert np.isnan(told.wobbling_onset)
    assert ms.observed(gait, "step_out", drive=drive_of(robot)) == pytest.approx(told.step_out)
    flat = ms.regimes(soft_helix(), [0.01], gait=gait)
    assert abs(told.step_out / flat.step_out - 1.0) > 0.01


def test_a_cone_too_narrow_to_trace_is_refused_in_one_sentence():
    with pytest.raises(ms.SpecError, match=r"field.cone = 0.01: must be zero, or between 1 and 89"):
        ms.regimes(soft_helix().with_({"field.cone": 0.01}), [1.0], model="rft")


def soft_helix(strength=5e-3, chi=2.5, frequency=0.1):
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5e-3),
        tail=ms.HelicalTail(length=1.5e-3, amplitude=2e-4, waves=2, radius=1e-4, frequency=0.0),
        fluid=ms.Fluid(viscosity=0.34),
        coefficients=ms.GrayHancock(),
        magnet=ms.Magnet(susceptibility=(1.0, chi, 1.0), volume=1e-10),
        field=ms.RotatingField(strength=strength, frequency=frequency),
        units="SI",
    )


@pytest.mark.parametrize("name", ["step_out", "wobbling_onset", "speed_at_step_out"])
def test_its_quantities_are_those_of_the_regimes_and_know_their_slopes(name):
    robot = soft_helix()
    gait = robot.gait("rft")
    told = ms.regimes(robot, [0.01], gait=gait)
    wanted = {"speed_at_step_out": abs(told.velocity_at_step_out)}
    value = ms.observed(gait, name, drive=drive_of(robot))
    assert value == pytest.approx(wanted.get(name, getattr(told, name, None)), rel=1e-9)
    # the square of the field: d log / d log B = 2; and D goes with chi - 1
    up = ms.observed(gait, name, drive=drive_of(soft_helix(chi=2.5 + 1e-3)))
    assert (up - value) / value == pytest.approx(1e-3 / 1.5, rel=1e-2)
    drive = drive_of(robot)
    assert drive is not None
    both = {"strength": drive.strength * (1 + 1e-20j)}
    slope = np.imag(ms.observed(gait, name, drive=drive._replace(**both))) / 1e-20
    assert slope == pytest.approx(2.0 * value, rel=1e-4)


def test_its_driven_speed_is_that_of_the_regimes():
    for frequency in (0.05, 5.0):
        robot = soft_helix(frequency=frequency)
        gait = robot.gait("rft")
        told = abs(ms.regimes(robot, [frequency], gait=gait).velocity[0])
        assert ms.observed(gait, "driven_speed", drive=drive_of(robot)) == pytest.approx(told)
