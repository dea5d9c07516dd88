"""Model predictive control on exact derivatives, 100 times a second.

Left: the figure in space that a robot is to follow (dashed) and what it swam; right: how far it is
off, and what its motor does. It has a motor, up to 8 Hz, and a magnet along its axis, and chooses
the motor's rate and the direction of the field. Each 10 ms the controller linearises its model
along the coming second by complex steps through the compiled stepper, and takes one Gauss-Newton
step for the distance from the path and for small changes of the controls. A background shear
carries the robot; the model does not know it, but estimates a uniform flow from what it predicted
wrongly.
"""

# minimised: sum |x_k - path(t_k)|^2 / LENGTH^2 + sum |u_k - u_(k-1)|^2 WEIGHT    (u: motor, field)
# with u_k held for a tenth of the horizon

import time

import numpy as np
from matplotlib.figure import Figure

import microswim as ms
from microswim.control.environments.reach import MOMENT
from microswim.control.environments.world import robot

KNOTS, HOLD, DT = 10, 0.1, 0.01
TOP, FIELD = 16 * np.pi, 4e-3
LENGTH, WEIGHT = 5e-5, np.diag([0.3, 2.0, 2.0, 2.0])
PERIOD = 26.0  # s
SHEAR = np.array([[0.0, 0.06, 0.0], [0.0, 0.0, 0.05], [0.0, 0.0, 0.0]])  # 1/s
FLOW = np.array([0.1e-3, -0.05e-3, 0.08e-3])  # m/s


def path(t):
    """A knot-like figure of 3 mm, passed at 0.5 to 0.7 mm/s; metres, shape (..., 3)."""
    a = 2.0 * np.pi / PERIOD * np.asarray(t)[..., None]
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


def main(seconds=10.0):
    gait, moment = robot("reach").gait(), (-MOMENT, 0.0, 0.0)
    plant = ms.Stepper(gait, robot("reach"), moment=moment, resolution=48)
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
    return {
        "off the path after two seconds (um, rms)": float(1e6 * np.sqrt(np.mean(miss[200:] ** 2))),
        "controller could run at (Hz)": float(1 / np.median(spent)),
        "rows": rows,
        "miss": miss,
    }


def figure(results):
    fig = Figure(figsize=(7.2, 3.4))
    fig.subplots_adjust(left=0.02, right=0.98, top=0.97, bottom=0.14, wspace=0.35, hspace=0.45)
    rows = results["rows"]
    space = fig.add_subplot(1, 2, 1, projection="3d")
    whole = path(np.linspace(0.0, PERIOD, 200))
    space.plot(*(1e3 * whole.T), "--", color="#222222", lw=1, label="wanted")
    space.plot(*(1e3 * rows[:, 1:4].T), color="#D55E00", lw=1.2, label="swum")
    space.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="z (mm)")
    space.tick_params(labelsize=7)
    space.locator_params(nbins=4)
    space.legend(loc="upper left", frameon=False, fontsize=8)
    off, motor = fig.add_subplot(2, 2, 2), fig.add_subplot(2, 2, 4)
    off.plot(rows[:, 0], 1e6 * results["miss"], color="#0072B2", lw=0.8)
    off.set(xlabel="time (s)", ylabel="off the path (µm)", ylim=(0, None))
    motor.plot(rows[:, 0], 8.0 * rows[:, 7], color="#0072B2", lw=0.8)
    motor.set(xlabel="time (s)", ylabel="motor (Hz)")
    return fig


if __name__ == "__main__":
    results = main(seconds=30.0)
    print({k: v for k, v in results.items() if isinstance(v, float)})
    figure(results).savefig("receding_horizon.svg")
