"""Paths in time: exact motions, order, loads, and the magnetised helix."""

import numpy as np
import pytest
from scipy.linalg import expm

import microswim as ms
from microswim.gait.held import HeldWarning
from microswim.numerics.rigid_motion import multiply, rotation_matrix


@pytest.fixture(scope="module")
def helix():
    return ms.Swimmer.preset("tabak/helix").gait()


@pytest.fixture(scope="module")
def wave():
    return ms.Swimmer.preset("tabak/plane_wave").gait()


def screw_matrix(V):
    hat = np.zeros((4, 4))
    hat[:3, :3] = [[0, -V[5], V[4]], [V[5], 0, -V[3]], [-V[4], V[3], 0]]
    hat[:3, 3] = V[:3]
    return hat


def exact_pose(gait, phase):
    """A helix's twist is constant in the frame of its tail: two matrix exponentials do it."""
    turn = screw_matrix(np.array([0, 0, 0, 1.0, 0, 0]))
    V = screw_matrix(gait.velocity(0.0) / gait.rate)
    return expm(phase * (V + turn)) @ expm(-phase * turn)


def test_helical_swimmer_follows_the_exact_screw(helix):
    times = np.array([0.0, 0.3, 1.0, 7.77, 1000.2])
    path = ms.trajectory(helix, times)
    for i, t in enumerate(times):
        pose = exact_pose(helix, helix.rate * t)
        assert path.position[i].values == pytest.approx(pose[:3, 3], abs=1e-8)
        assert rotation_matrix(path.quaternion[i].values) == pytest.approx(pose[:3, :3], abs=1e-8)


def test_screw_motion_in_numbers(helix):
    screw = ms.screw(helix)
    axis = helix.velocity(0.0)[3:] + [helix.rate, 0, 0]
    speed = abs(helix.velocity(0.0)[:3] @ axis) / np.linalg.norm(axis)
    assert screw.speed == pytest.approx(speed, rel=1e-9)
    # the body's centre keeps its distance from the axis and advances by `pitch` a turn
    centre = -screw.arm
    for n in (1, 7):
        x, q = screw.power(n)
        along = x @ screw.axis
        assert along == pytest.approx(n * screw.advance, rel=1e-9)
        off = x - along * screw.axis - centre
        assert np.linalg.norm(off) == pytest.approx(screw.radius, rel=1e-7)
        assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-12)
    assert screw.pitch * screw.angle == pytest.approx(2 * np.pi * abs(screw.advance))


@pytest.mark.parametrize("quaternion", [[1, 0, 0, 0], [0.5, 0.5, -0.5, 0.5]])
def test_powers_of_the_screw_are_the_steps_one_by_one(wave, helix, quaternion):
    times = np.linspace(0.0, 4.3, 23)
    for gait in (wave, helix):
        pose = {"quaternion": quaternion, "position": [1, 2, 3], "phase": 0.4}
        quick = ms.trajectory(gait, times, **pose)
        slow = ms.trajectory(gait, times, max_step=1 / 256, **pose)
        for name in ("position", "quaternion", "phase"):
            assert quick[name].values == pytest.approx(slow[name].values, abs=1e-9)


def turning(t):
    return np.stack([np.cos(3 * t), np.sin(3 * t), 0.2 * t], axis=-1)


def test_order_four(helix):
    """Halving the step divides the error by 16, with every kind of load at work."""
    loads = {
        "rate": lambda t: 6.0 * np.sin(1.3 * t) + 2.0,
        "force": lambda t: 20.0 * turning(0.5 * t),
        "torque": (5.0, -3.0, 2.0),
        "moment": (0.0, 30.0, 0.0),
        "field": turning,
        "flow": lambda t: 0.1 * turning(t),
    }
    times = np.array([0.0, 2.0])
    ends = [ms.trajectory(helix, times, max_step=h, **loads) for h in (0.1, 0.05, 0.025, 0.1 / 32)]
    for name in ("position", "quaternion"):
        error = [np.abs(e[name][-1] - ends[-1][name][-1]).max().item() for e in ends[:-1]]
        orders = np.log2(np.array(error[:-1]) / error[1:])
        assert orders == pytest.approx([4.0, 4.0], abs=0.35)


def test_quaternion_keeps_its_norm(helix):
    path = ms.trajectory(helix, [0.0, 100.0], max_step=1e-3, torque=(3.0, 1.0, 0.0))
    assert np.linalg.norm(path.quaternion[-1]) == pytest.approx(1.0, abs=1e-12)


def test_settling_without_motor_is_the_mobility_at_work(helix):
    """A short while under gravity moves the centre by mobility x force."""
    force = np.array([0.0, 0.0, -2.0])
    path = ms.trajectory(helix, [0.0, 1e-4], rate=0.0, force=force)
    velocity = np.linalg.solve(helix.resistance(0.0), [*force, 0, 0, 0])[:3]
    assert path.position[-1].values == pytest.approx(1e-4 * velocity, rel=1e-3)


def test_flow_carries_and_turned_loads_turn_the_path(helix):
    times = np.linspace(0.0, 2.0, 5)
    still, carried = (ms.trajectory(helix, times, flow=f) for f in (None, (0.3, -0.2, 0.1)))
    drift = (carried.position - still.position).values
    assert drift == pytest.approx(times[:, None] * [0.3, -0.2, 0.1], abs=1e-12)
    slow = ms.trajectory(helix, times, flow=lambda t: np.tile([0.3, -0.2, 0.1], (t.size, 1)))
    assert slow.position.values == pytest.approx(carried.position.values, abs=1e-8)

    q = np.array([0.8, 0.0, 0.6, 0.0])
    Q = rotation_matrix(q)
    plain = ms.trajectory(helix, times, force=(5.0, 0, 2.0))
    turned = ms.trajectory(helix, times, force=Q @ [5.0, 0, 2.0], quaternion=q)
    assert turned.position.values == pytest.approx(plain.position.values @ Q.T, abs=1e-10)
    assert turned.quaternion.values == pytest.approx(
        multiply(q, plain.quaternion.values), abs=1e-10
    )


def test_running_the_motor_back_undoes_the_path(wave):
    """Reversibility: there and back with a rate that is odd about the middle."""
    path = ms.trajectory(
        wave, [0.0, 1.0, 2.0], rate=lambda t: 6.0 * np.sin(np.pi * t), quaternion=[0.6, 0, 0.8, 0]
    )
    assert np.abs(path.position[1]).max() > 1e-3
    assert path.position[-1].values == pytest.approx(np.zeros(3), abs=1e-8)
    assert path.phase[-1].item() == pytest.approx(0.0, abs=1e-9)


def magnetised():
    """A rigid helix without motor, free to advance and to turn about its axis."""
    swimmer = ms.Swimmer.preset("tabak/helix").with_({"motion.free": ("us", "os")})
    return swimmer.gait()


@pytest.mark.parametrize("factor", [0.5, 0.95, 1.05, 2.0])
def test_rotating_field_drives_in_step_below_step_out_and_slips_above(factor):
    """Step-out at ``m B / D``, D = 1/M_oo; above it the mean rate is w - sqrt(w^2 - w_c^2)."""
    gait = magnetised()
    f = [0, 3]
    mobility = np.linalg.inv(gait.resistance(0.0)[np.ix_(f, f)])
    m, B = 50.0, 2.0
    step_out = m * B * mobility[1, 1]
    w = factor * step_out

    def field(t):
        return B * np.stack([0 * t, np.cos(w * t), np.sin(w * t)], axis=-1)

    slip = w - np.sqrt(max(w**2 - step_out**2, 0.0))
    beat = 2 * np.pi / np.sqrt(w**2 - step_out**2) if factor > 1 else 20.0 / step_out
    times = np.linspace(0.0, 12 * beat, 4001)
    with pytest.warns(HeldWarning, match="holds oq, or"):
        path = ms.trajectory(gait, times, rate=0.0, moment=(0, m, 0), field=field)
    q = path.quaternion.values
    angle = np.unwrap(2 * np.arctan2(q[:, 1], q[:, 0]))
    first, last = np.searchsorted(times, [4 * beat, 12 * beat - 1e-9])
    rate = (angle[last] - angle[first]) / (times[last] - times[first])
    assert rate == pytest.approx(slip if factor > 1 else w, rel=2e-3)
    # and it advances by the pitch of its own mobility
    travelled = path.position[last, 0] - path.position[first, 0]
    coupling = mobility[0, 1] / mobility[1, 1]
    assert travelled.item() == pytest.approx(coupling * (angle[last] - angle[first]), rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"times": [0.0, 0.0]}, "increasing"),
        ({"force": (1.0, 2.0)}, "force"),
        ({"field": lambda t: t}, "field"),
        ({"moment": lambda t: t}, "moment"),
        ({"quaternion": (1, 1, 0, 0)}, "unit quaternion"),
        ({"rate": float("nan"), "force": (1, 0, 0)}, "rate"),
        ({"position": (1, 2, float("inf"))}, "position"),
    ],
)
def test_senseless_arguments_are_refused(helix, arguments, words):
    arguments = {"times": [0.0, 1.0], **arguments}
    with pytest.raises(ms.SpecError, match=words):
        ms.trajectory(helix, **arguments)


@pytest.mark.parametrize(
    ("loads", "says"),
    [
        ({"torque": (0.0, 1e29, 0.0)}, "steps are more"),
        ({"torque": (0.0, 1e31, 0.0)}, "torque"),
        ({"force": (1e300, 0.0, 0.0)}, "force"),
        ({"field": (1e308, 0, 0), "moment": (0, 1.0, 0)}, "field"),
        ({"rate": 1e25, "force": (0.0, 1.0, 0.0)}, "steps are more"),
        ({"rate": 1e308, "force": (0.0, 1.0, 0.0)}, "rate"),
        ({"force": lambda t: 1e40 * np.ones((t.size, 3))}, "force"),
        ({"max_step": 1e-12}, "steps are more"),
    ],
)
def test_a_path_that_would_never_end_is_refused_at_once(loads, says):
    gait = ms.Swimmer.preset("tabak/helix").gait()
    with pytest.raises(ms.SpecError, match=says):
        ms.trajectory(gait, np.linspace(0.0, 10.0, 11), **loads)
