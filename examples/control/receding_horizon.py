"""Model predictive control of a motor-driven robot at 100 Hz, on exact derivatives.

    python examples/control/receding_horizon.py            # docs/receding-horizon.png

A robot with a motor (up to 8 Hz) and a magnet along its axis follows a figure in space by choosing
motor rate and direction of the field. Each 10 ms the controller linearises its model along the
coming second by complex steps through the compiled stepper, and takes one Gauss-Newton step for

    sum |x_k - path(t_k)|^2 / LENGTH^2 + sum |u_k - u_(k-1)|^2 WEIGHT        (u: motor, field)

with u_k held for a tenth of the horizon. A background shear carries the robot; the model does not
know it, but estimates a uniform flow from what it predicted wrongly.
"""

import sys
import time
from pathlib import Path

import numpy as np

import microswim as ms
from microswim.control.reach import MOMENT, robot

KNOTS, HOLD, DT = 10, 0.1, 0.01
TOP, FIELD = 16 * np.pi, 4e-3
LENGTH, WEIGHT = 5e-5, np.diag([0.3, 2.0, 2.0, 2.0])
SHEAR = np.array([[0.0, 0.06, 0.0], [0.0, 0.0, 0.05], [0.0, 0.0, 0.0]])  # 1/s
FLOW = np.array([0.1e-3, -0.05e-3, 0.08e-3])  # m/s


def path(t):
    """A knot-like figure of 3 mm, passed at 0.5 to 0.7 mm/s; metres, shape (..., 3)."""
    a = 0.24 * np.asarray(t)[..., None]
    wave = np.concatenate([np.sin(a), np.sin(2 * a) / 2, 1 - np.cos(a)], axis=-1)
    return 2e-3 * wave @ np.array([[0.9, 0.2, 0.4], [-0.3, 0.9, 0.1], [0.1, -0.2, 0.8]])


def inputs(u):
    """Stepper's inputs from (motor, direction of the field)."""
    return {"motor_rate": TOP * u[0], "field": FIELD * u[1:] / np.linalg.norm(u[1:])}


def chain(u):
    """Derivative of (motor rate, field) with respect to u, (4, 4)."""
    size = np.linalg.norm(u[1:])
    n = u[1:] / size
    J = np.zeros((4, 4))
    J[0, 0], J[1:, 1:] = TOP, FIELD * (np.eye(3) - np.outer(n, n)) / size
    return J


def sensitivities(model, state, controls, flow):
    """Positions at the knots (K, 3) and their derivatives with respect to all controls."""
    n, reach = len(controls), np.zeros((8, 4 * len(controls)))
    x, S = np.empty((n, 3)), np.empty((n, 3, 4 * n))
    for k, u in enumerate(controls):
        now = {"flow": flow, **inputs(u)}
        A, B = model.derivatives(state, dt=HOLD, wrt=("motor_rate", "field"), **now)
        reach = A @ reach
        reach[:, 4 * k : 4 * k + 4] += B @ chain(u)
        state = model.step(state, dt=HOLD, **now)
        x[k], S[k] = state.position, reach[:3]
    return x, S


def improved(model, state, controls, last, t, flow):
    """One Gauss-Newton step for the controls of the horizon."""
    n = len(controls)
    x, S = sensitivities(model, state, controls, flow)
    J = S.reshape(3 * n, 4 * n) / LENGTH
    miss = (x - path(t + HOLD * np.arange(1, n + 1))).ravel() / LENGTH
    D = np.kron(np.eye(n) - np.eye(n, k=-1), np.eye(4))
    change = np.diff(np.vstack([last, controls]), axis=0).ravel()
    W = np.kron(np.eye(n), WEIGHT)
    H = J.T @ J + D.T @ W @ D + 1e-3 * np.eye(4 * n)
    moved = -np.linalg.solve(H, J.T @ miss + D.T @ W @ change)
    new = controls + np.clip(moved, -0.3, 0.3).reshape(n, 4)
    new[:, 0] = np.clip(new[:, 0], -1, 1)
    new[:, 1:] /= np.linalg.norm(new[:, 1:], axis=1, keepdims=True)
    return new


def main(seconds=30.0, picture=None):
    """Tracking error (m, root mean square after two seconds) and control rate (1/s)."""
    gait, moment = robot().gait(), (-MOMENT, 0.0, 0.0)
    plant = ms.Stepper(gait, robot(), moment=moment, resolution=48)
    model = ms.Stepper(gait, moment=moment, resolution=8)  # coarse and quick
    forward = path(0.1) - path(0.0)
    forward /= np.linalg.norm(forward)
    half = np.array([1.0 - forward[0], 0.0, forward[2], -forward[1]])
    state = ms.State.at(quaternion=half / np.linalg.norm(half))
    controls = np.tile([0.6, *forward], (KNOTS, 1))
    last, flow, spent, rows = controls[0], np.zeros(3), [], []
    for i in range(int(seconds / DT)):
        t = i * DT
        start = time.process_time()
        controls = improved(model, state, controls, last, t, flow)
        now = inputs(controls[0])
        predicted = model.step(state, dt=DT, flow=flow, **now)
        spent.append(time.process_time() - start)
        state = plant.step(state, dt=DT, flow=FLOW, gradient=SHEAR, **now)
        flow = flow + 0.1 * (state.position - predicted.position) / DT
        last = controls[0]
        slide = DT / HOLD  # the horizon moves on by a tenth of a knot
        controls[:-1] = (1 - slide) * controls[:-1] + slide * controls[1:]
        rows.append((t + DT, *state.position, *path(t + DT), controls[0, 0]))
    rows = np.array(rows)
    miss = np.linalg.norm(rows[:, 1:4] - rows[:, 4:7], axis=1)
    error, rate = float(np.sqrt(np.mean(miss[200:] ** 2))), float(1 / np.median(spent))
    print(f"{1e6 * error:.1f} um off the path (rms); the controller could run at {rate:.0f} Hz")
    if picture is not None:
        plot(rows, miss, picture)
    return {"error": error, "rate": rate}


def plot(rows, miss, target):
    """Path and error as a picture."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 3.8))
    figure.subplots_adjust(left=0.02, right=0.98, top=0.97, bottom=0.14, wspace=0.35)
    a = figure.add_subplot(1, 2, 1, projection="3d")
    a.plot(*(1e3 * rows[:, 4:7].T), "--", color="0.5", label="wanted")
    a.plot(*(1e3 * rows[:, 1:4].T), label="swum")
    a.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="z (mm)")
    a.legend(loc="upper left")
    b = figure.add_subplot(2, 2, 2)
    b.plot(rows[:, 0], 1e6 * miss, linewidth=0.7)
    b.set(ylabel="off path (µm)", xticklabels=[], ylim=(0, None))
    c = figure.add_subplot(2, 2, 4)
    c.plot(rows[:, 0], 8.0 * rows[:, 7])
    c.set(xlabel="time (s)", ylabel="motor (Hz)")
    figure.savefig(target, dpi=150)
    print(f"path and error: {target}")


if __name__ == "__main__":
    docs = Path(__file__).parents[2] / "docs"
    main(picture=sys.argv[1] if len(sys.argv) > 1 else docs / "receding-horizon.png")
