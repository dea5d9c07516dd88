"""The stepper against `trajectory`, against laws, and against Jeffery's and Adler's answers."""

from functools import cache

import numpy as np
import pytest

import microswim as ms
from microswim.control.motion import INPUTS
from microswim.gait.held import HeldWarning
from microswim.numerics.rigid_motion import multiply, rotation_matrix
from microswim.path import strain

SHEAR = [[0.0, 0.3, 0.0], [0.0, 0.0, -0.2], [0.1, 0.0, 0.0]]
TURN = np.array([0.5, -0.3, 0.6, 0.55]) / np.linalg.norm([0.5, -0.3, 0.6, 0.55])
ALL = {
    "motor_rate": 4.0,
    "force": [3.0, -20.0, 10.0],
    "torque": [5.0, 30.0, -20.0],
    "field": [0.0, 50.0, 20.0],
    "field_rate": [2.0, 0.5, 0.0],
    "flow": [0.1, 0.2, -0.3],
    "gradient": SHEAR,
}


@cache
def swimmer(name="tabak/helix"):
    return ms.Swimmer.preset(name)


def stepper(name="tabak/helix", **options):
    return ms.Stepper.of(swimmer(name), **{"moment": (0.0, 1.0, 0.5), **options})


def run(stepper_, state, n, dt, **inputs):
    for _ in range(n):
        state = stepper_.step(state, dt=dt, **inputs)
    return state


@pytest.mark.parametrize("name", ["tabak/helix", "tabak/plane_wave"])
def test_agrees_with_trajectory(name):
    """Which solves R V = W - F rate at every stage; the same method, so equal to rounding."""
    gait = swimmer(name).gait()
    loads = {k: ALL[k] for k in ("force", "torque", "field", "flow")}
    path = ms.trajectory(gait, [0.0, 2.0], rate=5.0, moment=(0.0, 1.0, 0.5), max_step=0.02, **loads)
    one = ms.Stepper(gait, moment=(0.0, 1.0, 0.5), steps=5)
    end = run(one, ms.State.at(), 20, 0.1, motor_rate=5.0, **loads)
    assert end.position == pytest.approx(path.position[-1].values, abs=1e-12)
    assert end.quaternion == pytest.approx(path.quaternion[-1].values, abs=1e-12)
    assert end.phase == pytest.approx(10.0)


def test_a_rate_that_changes_and_reverses_agrees_with_trajectory():
    gait = swimmer().gait()
    rates = [5.0, -3.0, 0.0, 8.0]
    one, state = ms.Stepper(gait, steps=20), ms.State.at()
    pose = {"position": (0, 0, 0), "quaternion": (1, 0, 0, 0), "phase": 0.0}
    for rate in rates:
        state = one.step(state, dt=0.5, motor_rate=rate)
        path = ms.trajectory(gait, [0.0, 0.5], rate=rate, force=(0, 0, 0), max_step=0.025, **pose)
        last = path.isel(time=-1)
        pose = {k: last[k].values for k in pose}
    assert state.position == pytest.approx(pose["position"], abs=1e-13)


def test_reversing_the_motor_retraces_the_way():
    one = ms.Stepper(swimmer().gait(), resolution=256)
    start = ms.State.at([1, 2, 3], TURN, 0.4)
    there = run(one, start, 10, 0.1, motor_rate=5.0)
    back = run(one, there, 10, 0.1, motor_rate=-5.0)
    assert np.abs(there.values - start.values).max() > 0.1
    assert back.values == pytest.approx(start.values, abs=1e-9)


def test_is_of_order_four_under_all_inputs():
    start = ms.State.at([0.2, -0.1, 0.3], TURN, 0.4)
    ends = [stepper(steps=n).step(start, dt=1.0, **ALL).values for n in (16, 32, 64, 512)]
    errors = [np.abs(e - ends[-1]).max() for e in ends[:-1]]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert ((orders > 3.6) & (orders < 4.4)).all(), orders


def test_internal_steps_follow_what_turns_fastest():
    """A long sample is divided so that the result is good whatever the sampling."""
    start = ms.State.at(quaternion=TURN)
    fine = stepper(resolution=512).step(start, dt=2.0, **ALL)
    coarse = stepper().step(start, dt=2.0, **ALL)
    assert coarse.values == pytest.approx(fine.values, abs=1e-5)


@pytest.mark.parametrize("n", [3, 300])
def test_many_swimmers_are_each_alone(n):
    """Bit by bit, on one core or on all."""
    rng = np.random.default_rng(1)
    q = rng.normal(size=(n, 4))
    many = ms.State.at(rng.normal(size=(n, 3)), q / np.linalg.norm(q, axis=1)[:, None])
    rates = rng.normal(size=n) * 5
    one = stepper()
    together = one.step(many, dt=0.1, **{**ALL, "motor_rate": rates})
    for i in (0, n // 2, n - 1):
        alone = one.step(ms.State(many.values[i]), dt=0.1, **{**ALL, "motor_rate": rates[i]})
        assert (together.values[i] == alone.values).all()


def test_does_not_depend_on_the_frame_of_the_lab():
    Q, shift = rotation_matrix(TURN), np.array([0.3, -2.0, 1.0])
    start = ms.State.at([0.2, -0.1, 0.3], (1, 0, 0, 0), 0.4)
    end = run(stepper(), start, 5, 0.2, **ALL)
    A = Q @ np.array(SHEAR) @ Q.T
    seen = {k: Q @ np.array(v) for k, v in ALL.items() if k not in ("motor_rate", "gradient")}
    seen |= {"motor_rate": 4.0, "gradient": A, "flow": seen["flow"] - A @ shift}
    moved = ms.State.at(Q @ start.position + shift, multiply(TURN, start.quaternion), 0.4)
    end2 = run(stepper(), moved, 5, 0.2, **seen)
    assert end2.position == pytest.approx(Q @ end.position + shift, abs=1e-11)
    assert end2.quaternion == pytest.approx(multiply(TURN, end.quaternion), abs=1e-11)


def test_a_swimmer_at_rest_goes_with_a_rotating_fluid():
    w = np.array([0.3, -0.2, 0.5])
    spin = np.cross(w, np.eye(3)).T  # spin @ x = w x x
    start = ms.State.at([1.0, 0.5, -0.5])
    end = run(stepper(resolution=256), start, 10, 0.2, motor_rate=0.0, gradient=spin)
    angle = np.linalg.norm(w) * 2.0
    q = np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * w / np.linalg.norm(w)])
    assert end.position == pytest.approx(rotation_matrix(q) @ start.position, abs=1e-9)
    assert end.quaternion == pytest.approx(q, abs=1e-9)


def test_a_flow_that_turns_resists_as_the_turning_tail():
    """The tail held in the flows ``e_k x X`` feels the columns of its resistance to rotation."""
    bare = swimmer("tabak/helix-sbt").with_({"coefficients.spin": False})
    phases = np.array([0.0, 0.7])
    turns = np.array([np.cross(e, np.eye(3)).T for e in np.eye(3)])
    S, g = strain.tail_coupling(bare, phases, turns)
    gait = bare.gait()
    tail = gait.resistance(phases) - gait.body_resistance_series[0]
    rounding = 1e-10 * np.abs(tail).max()
    assert np.abs(S - tail[:, :, 3:]).max() < rounding
    assert np.abs(g - gait.propulsion(phases)[:, 3:]).max() < rounding


def test_a_spheroid_follows_the_orbit_of_jeffery():
    """Period ``2 pi (r + 1/r) / rate of shear`` [Jeffery 1922]; the tail offers no resistance.

    Along the flow at first, the axis has turned by ``tan = tan(2 pi t / period) / r`` at time t: a
    long body lingers there (18.4 degrees after an eighth), where a flat one would hurry (71.6).
    """
    ratio, shear = 3.0, 0.7
    body = ms.Spheroid(semi_axes=(ratio, 1.0))
    tail = ms.HelicalTail(length=1.0, amplitude=0.1, waves=1, radius=0.01)
    nothing = ms.Constant(normal=1e-12, tangential=1e-12, spin=False)
    lone = ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0), coefficients=nothing)
    flow = [[0, shear, 0], [0, 0, 0], [0, 0, 0]]
    one = ms.Stepper.of(lone, resolution=400)
    period = 2 * np.pi * (ratio + 1 / ratio) / shear
    eighth, quarter, whole = (
        one.step(ms.State.at(), dt=t, motor_rate=0.0, gradient=flow)
        for t in (period / 8, period / 4, period)
    )
    axis = np.array([ratio, -1.0, 0.0]) / np.hypot(ratio, 1.0)
    assert rotation_matrix(eighth.quaternion)[:, 0] == pytest.approx(axis, abs=1e-6)
    assert rotation_matrix(whole.quaternion) == pytest.approx(np.eye(3), abs=1e-6)
    assert rotation_matrix(quarter.quaternion)[:, 0] == pytest.approx([0, -1, 0], abs=1e-6)


@pytest.mark.parametrize("over", [0.8, 1.25, 3.0])
def test_step_out_is_that_of_adler(over):
    """About a fixed axis: in step up to w_c = m B / R, then behind by sqrt(w^2 - w_c^2)."""
    held = swimmer().with_({"motion.free": ("us", "os")})
    moment, field = 2.0, 30.0
    with pytest.warns(HeldWarning, match="holds oq, or"):
        one = ms.Stepper(held.gait(), moment=(0.0, moment, 0.0), locked=True)
    R = held.gait().resistance(0.0)[np.ix_([0, 3], [0, 3])]
    critical = moment * field * np.linalg.inv(R)[1, 1]
    w = over * critical
    mean = w if over < 1 else w - np.sqrt(w**2 - critical**2)
    beat = 2 * np.pi / critical if over < 1 else 2 * np.pi / np.sqrt(w**2 - critical**2)
    lag = np.arcsin(min(over, 1.0))
    field_now = field * np.array([0.0, np.cos(lag), np.sin(lag)])
    total, n = 0.0, 200
    state, t = ms.State.at(), 0.0
    for _ in range(n):
        a = w * t
        B = [0, field_now[1] * np.cos(a) - field_now[2] * np.sin(a)]
        B += [field_now[1] * np.sin(a) + field_now[2] * np.cos(a)]
        q0 = state.quaternion
        state = one.step(state, dt=beat / n, field=B, field_rate=[w, 0, 0])
        turned = multiply(q0 * [1, -1, -1, -1], state.quaternion)
        total += 2 * np.arctan2(turned[1], turned[0])
        t += beat / n
    assert total / t == pytest.approx(mean, rel=1e-5)


def test_the_quick_way_gives_what_the_gait_gives():
    gait = swimmer("tabak/plane_wave").gait()
    one = ms.Stepper(gait)
    W = np.array([3.0, -20.0, 10.0, 5.0, 30.0, -20.0])
    for phase in (0.0, 0.7, 4.0):
        assert one.velocity(phase, 5.0) == pytest.approx(gait.velocity(phase, 5.0), abs=1e-12)
        wanted = gait.velocity(phase, 5.0, W)
        assert one.velocity(phase, 5.0, W) == pytest.approx(wanted, abs=1e-12)


def test_outputs_are_the_rate_of_change_and_the_torque_of_the_motor():
    one, state = stepper(), ms.State.at([0.2, -0.1, 0.3], TURN, 0.4)
    V, _ = one.outputs(state, **ALL)
    h = 1e-6
    ahead = one.step(state, dt=h, **ALL)
    Q = rotation_matrix(TURN)
    assert Q.T @ (ahead.position - state.position) / h == pytest.approx(V[:3], abs=1e-4)
    turned = multiply(state.quaternion * [1, -1, -1, -1], ahead.quaternion)
    assert 2 * turned[1:] / h == pytest.approx(V[3:], abs=1e-3)
    gait = swimmer().gait().at_rate(4.0)
    _, torque = one.outputs(state, motor_rate=4.0)
    assert torque == pytest.approx(gait.power(0.4) / 4.0, rel=1e-12)


def test_torque_of_the_motor_is_linear_in_rate_and_strain():
    """And reverses with all of it."""
    one, state = stepper(), ms.State.at(phase=0.4)
    E = np.diag([0.3, -0.1, -0.2])
    _, plus = one.outputs(state, motor_rate=4.0, gradient=E)
    _, minus = one.outputs(state, motor_rate=-4.0, gradient=-E)
    _, rate = one.outputs(state, motor_rate=4.0)
    _, flow = one.outputs(state, motor_rate=0.0, gradient=E)
    assert plus == pytest.approx(-minus, rel=1e-12)
    assert plus == pytest.approx(rate + flow, rel=1e-12)
    assert abs(flow) > 1e-3 * abs(rate)


def test_derivatives_are_those_of_the_step():
    one, state = stepper(steps=8), ms.State.at([0.2, -0.1, 0.3], TURN, 0.4)
    A, B = one.derivatives(state, dt=0.2, **ALL)
    flat = one.held(1, ALL)[0]

    def ends(values, u):
        inputs = {k: u[part] for k, part in INPUTS.items()}
        inputs |= {"motor_rate": u[0]}
        inputs |= {k: inputs[k].reshape(3, 3) for k in ("gradient", "field_gradient")}
        return one.step(ms.State(values), dt=0.2, **inputs).values

    h = 1e-5
    some = one.derivatives(state, dt=0.2, wrt=("field",), **ALL)[1]
    assert (some == B[:, INPUTS["field"]]).all()
    for k in range(8):
        d = h * np.eye(8)[k]
        slope = (ends(state.values + d, flat) - ends(state.values - d, flat)) / (2 * h)
        assert A[:, k] == pytest.approx(slope, abs=1e-8)
    for k in (*range(16), *range(25, 37)):
        d = h * np.eye(37)[k]
        slope = (ends(state.values, flat + d) - ends(state.values, flat - d)) / (2 * h)
        assert B[:, k] == pytest.approx(slope, abs=1e-7)


def test_derivatives_hold_where_an_input_is_zero():
    one, state = stepper(steps=8), ms.State.at(phase=0.4)
    _, B = one.derivatives(state, dt=0.2, field=[0, 50.0, 0])
    h = 1e-4
    up, down = (
        one.step(state, dt=0.2, field=[0, 50.0, 0], field_rate=[s * h, 0, 0]) for s in (1, -1)
    )
    slope = (up.values - down.values) / (2 * h)
    assert B[:, INPUTS["field_rate"]][:, 0] == pytest.approx(slope, abs=1e-7)
    assert np.abs(slope).max() > 1e-3


BAD = {
    "dt": ({"dt": 0.0}, "dt = 0.0"),
    "no number": ({"dt": None}, "dt"),
    "unknown": ({"dt": 1.0, "wind": 3}, "motor_rate"),
    "shape": ({"dt": 1.0, "force": [1, 2]}, "force"),
    "words": ({"dt": 1.0, "force": "strong"}, "force"),
    "nan": ({"dt": 1.0, "field": [1, np.nan, 0]}, "field"),
    "divergent": ({"dt": 1.0, "gradient": np.eye(3)}, "incompressible"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_inputs_are_one_sentence(name):
    inputs, word = BAD[name]
    with pytest.raises(ms.SpecError, match=word):
        stepper().step(ms.State.at(), **inputs)


def test_bad_states_and_steppers_are_one_sentence():
    for bad in ({"quaternion": [1, 1, 0, 0]}, {"position": [1, 2]}, {"phase": np.inf}):
        with pytest.raises(ms.SpecError, match=next(iter(bad))):
            ms.State.at(**bad)
    with pytest.raises(ms.SpecError, match="as many rows"):
        ms.State.at(np.zeros((2, 3)), np.tile([1.0, 0, 0, 0], (3, 1)))
    for bad in ({"moment": (1, 2)}, {"resolution": 1}, {"steps": 0.5}):
        with pytest.raises(ms.SpecError, match=next(iter(bad))):
            stepper(**bad)
    with pytest.raises(ms.SpecError, match="locked"):
        stepper(locked=True).step(ms.State.at(), dt=0.1, motor_rate=1.0)
    with pytest.raises(ms.SpecError, match="one swimmer"):
        stepper().derivatives(ms.State.at(np.zeros((2, 3))), dt=0.1)


def test_a_camera_is_late_seldom_and_never_early():
    camera = ms.Sensor(interval=0.1, latency=0.25)
    seen = {}
    for i in range(100):
        t = i * 0.02
        reading = camera.read(t, ms.State.at([t, 0, 0]))
        seen[i] = reading.time if reading else None
    assert seen[12] is None
    taken = sorted({t for t in seen.values() if t is not None})
    assert np.diff(taken) == pytest.approx(0.1)
    for i in range(13, 100):
        late = i * 0.02 - seen[i]
        assert 0.25 - 1e-9 <= late < 0.25 + 0.1 + 1e-9
        reading = camera.read(i * 0.02 + 2.0, ms.State.at())
    assert np.isnan(reading.state.phase)


def test_the_noise_of_a_camera_is_as_told_and_repeats():
    many = ms.State.at(np.zeros((4000, 3)))
    options = {"position_noise": 0.3, "angle_noise": 0.02}
    a, b = (ms.Sensor(seed=5, **options).read(0.0, many).state.values for _ in range(2))
    assert (a == b)[:, :7].all()
    assert a[:, :3].std() == pytest.approx(0.3, rel=0.03)  # 12,000 draws: 0.65 %
    assert 2 * a[:, 4:7].std() == pytest.approx(0.02, rel=0.03)
    assert np.linalg.norm(a[:, 3:7], axis=1) == pytest.approx(1.0)
    with pytest.raises(ms.SpecError, match="latency"):
        ms.Sensor(latency=-1.0)
