"""The state space of a step: what small differences do, and what SciPy makes of it."""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import solve_discrete_are
from scipy.signal import StateSpace

import microswim as ms
from microswim.numerics.rigid_motion import multiply

TURN = np.array([0.5, -0.3, 0.6, 0.55]) / np.linalg.norm([0.5, -0.3, 0.6, 0.55])
INPUTS = {"motor_rate": 4.0, "force": [3.0, -20.0, 10.0], "torque": [5.0, 30.0, -20.0]}


@cache
def stepper():
    return ms.Stepper.of(ms.Swimmer.preset("tabak/helix"), steps=8)


def moved(state, d):
    """A state changed by a small difference (7,)."""
    half = np.concatenate([[1.0], d[3:6] / 2.0])
    q = multiply(state.quaternion, half / np.linalg.norm(half))
    return ms.State.at(state.position + d[:3], q, state.phase + d[6])


def difference(state, other):
    """Small difference (7,) of another state from one."""
    turn = multiply(state.quaternion * [1, -1, -1, -1], other.quaternion)
    return np.array(
        [*(other.position - state.position), *(2 * turn[1:]), other.phase - state.phase]
    )


def test_small_differences_go_on_as_it_says():
    start = ms.State.at([0.2, -0.1, 0.3], TURN, 0.4)
    system = stepper().state_space(start, dt=0.2, wrt=("motor_rate", "torque"), **INPUTS)
    end, h = stepper().step(start, dt=0.2, **INPUTS), 1e-5
    for k in range(7):
        d = h * np.eye(7)[k]
        ends = [stepper().step(moved(start, s * d), dt=0.2, **INPUTS) for s in (1, -1)]
        slope = (difference(end, ends[0]) - difference(end, ends[1])) / (2 * h)
        assert system.A[:, k] == pytest.approx(slope, abs=1e-7)
    for k in range(3):
        ends = []
        for s in (1, -1):
            torque = np.array(INPUTS["torque"]) + s * h * np.eye(3)[k]
            ends.append(stepper().step(start, dt=0.2, **{**INPUTS, "torque": torque}))
        slope = (difference(end, ends[0]) - difference(end, ends[1])) / (2 * h)
        assert system.B[:, 1 + k] == pytest.approx(slope, abs=1e-7)


def test_scipy_takes_it_and_a_regulator_holds_it():
    """Controllable by motor, force and torque; the loop that LQR closes is stable."""
    start = ms.State.at([0.2, -0.1, 0.3], TURN, 0.4)
    A, B, C, D = stepper().state_space(start, dt=0.2, wrt=tuple(INPUTS), **INPUTS)
    system = StateSpace(A, B, C, D, dt=0.2)
    assert system.A.shape == (7, 7)
    P = solve_discrete_are(A, B, np.eye(7), 1e-2 * np.eye(B.shape[1]))
    gain = np.linalg.solve(1e-2 * np.eye(B.shape[1]) + B.T @ P @ B, B.T @ P @ A)
    assert np.abs(np.linalg.eigvals(A - B @ gain)).max() < 1.0
    assert np.abs(np.linalg.eigvals(A)).max() >= 1.0 - 1e-9


def test_printing_a_stepper_takes_few_lines():
    text = repr(stepper())
    assert len(text.splitlines()) <= 5
    assert len(text) < 400
    for word in ("rft", "dimensionless", "8 internal steps"):
        assert word in text
    cell = ms.Swimmer.preset("goto/C").with_({"motion.free": "all"}).gait()
    text = repr(ms.Stepper(cell, moment=(0.0, 3e-6, 0.0)))
    assert "rad/s; magnetic moment (0 A m^2, 3.000 µA m^2, 0 A m^2)" in text


def test_continuous_in_time_is_the_limit_of_short_steps():
    """``A_d = 1 + A h``, ``B_d = B h``, off by the square of h; in a field with a gradient too."""
    one, start = stepper(), ms.State.at([0.2, -0.1, 0.3], TURN, 0.4)
    bent = {
        "field": [0.0, 50.0, 20.0],
        "gradient": [[0.1, 0.3, 0.0], [0.0, 0.0, -0.2], [0.1, 0.0, -0.1]],
        "field_gradient": [[5.0, 3.0, 0.0], [3.0, 0.0, -2.0], [0.0, -2.0, -5.0]],
    }
    magnetic = ms.Stepper(one.gait, one.swimmer, moment=(0.3, 1.0, 0.5), steps=2)
    wrt = ("motor_rate", "force", "field", "flow")
    system = magnetic.state_space(start, dt=None, wrt=wrt, **INPUTS, **bent)
    missed = []
    for h in (1e-3, 5e-4):
        A, B, _, _ = magnetic.state_space(start, dt=h, wrt=wrt, **INPUTS, **bent)
        missed.append(
            [np.abs((A - np.eye(7)) / h - system.A).max(), np.abs(B / h - system.B).max()]
        )
    size = np.abs(system.A).max(), np.abs(system.B).max()
    assert (np.array(missed[0]) < 0.02 * np.array(size)).all()
    assert np.array(missed[0]) / np.array(missed[1]) == pytest.approx(2.0, rel=0.02)
    assert StateSpace(*system).dt is None
