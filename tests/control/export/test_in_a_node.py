"""The exported C in a node's timer, as ROS 2 calls it, and the FMU at a solver's fixed step.

ROS 2 itself is not there: a loop in C++ stands in for its executor, a structure for its messages;
callback and mapping are those of docs/control.md.
"""

import subprocess
from pathlib import Path

import fmpy
import numpy as np
import pytest

import microswim as ms
from microswim.control.export import compiler
from microswim.numerics.rigid_motion import multiply

SPEC = Path(__file__).parents[3] / "examples" / "control" / "coil_robot.toml"
CURRENTS = (0.3, -0.2, 0.1, 0.0, 0.25, -0.1, 0.05, 0.2)
PERIOD, TICKS = 2e-3, 250

NODE = r"""
#include "robot.h"
#include <cstdio>
#include <functional>

struct Pose { struct { double x, y, z; } position; struct { double x, y, z, w; } orientation; };

class Robot {
public:
    Robot() { robot_defaults(&state_, &inputs_, &parameters_); }
    void on_currents(const double *values) {
        for (int i = 0; i < ROBOT_ACTUATORS; ++i) currents_[i] = values[i];
    }
    int on_timer(double period) {
        int status = robot_actuate(currents_, &state_, &inputs_);
        if (!status) status = robot_step(&parameters_, &inputs_, period, &state_);
        return status;
    }
    /* body axes of ROS: x forwards, and this body leads along -s: half a turn about r */
    Pose pose() const {
        const double *q = state_.quaternion, *x = state_.position;
        return {{x[0], x[1], x[2]}, {q[2], -q[1], q[0], -q[3]}};
    }
private:
    robot_state state_;
    robot_inputs inputs_;
    robot_parameters parameters_;
    double currents_[ROBOT_ACTUATORS] = {};
};

int main() {
    Robot robot;
    const double currents[] = {%s};
    robot.on_currents(currents);
    std::function<int()> timer = [&] { return robot.on_timer(%r); };
    for (int tick = 0; tick < %d; ++tick)
        if (int status = timer()) {
            std::fprintf(stderr, "%%s\n", robot_message(status));
            return 1;
        }
    const Pose p = robot.pose();
    std::printf("%%.17g %%.17g %%.17g %%.17g %%.17g %%.17g %%.17g\n", p.position.x, p.position.y,
                p.position.z, p.orientation.x, p.orientation.y, p.orientation.z, p.orientation.w);
}
"""


@pytest.fixture(scope="module")
def stepper():
    return ms.Stepper.of(ms.Swimmer.from_toml(SPEC), locked=True)


@pytest.fixture(scope="module")
def last(stepper):
    """Where Python's own loop ends."""
    coils = stepper.swimmer.field.at_currents(CURRENTS)
    state = ms.State.at()
    for _ in range(TICKS):
        state = stepper.step(state, dt=PERIOD, **coils.felt(0.0, state.position))
    return state


def test_a_node_in_cpp_goes_where_python_goes(stepper, last, tmp_path):
    _, source = compiler.write(ms.c_model(stepper, "robot"), tmp_path)
    node, thing, program = tmp_path / "node.cpp", tmp_path / "robot.o", tmp_path / "node"
    node.write_text(NODE % (", ".join(map(repr, CURRENTS)), PERIOD, TICKS), encoding="utf-8")
    subprocess.run([*compiler.required(), "-O2", "-c", source, "-o", thing], check=True)
    subprocess.run(["g++", "-O2", "-Wall", "-Werror", node, thing, "-o", program], check=True)
    told = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    x, turn = np.array(told.split()[:3], float), np.array(told.split()[3:], float)
    assert x == pytest.approx(last.position, rel=1e-9)
    half = multiply(last.quaternion, np.array([0.0, 0.0, 0.0, 1.0]))  # a turn about r
    assert np.abs(np.roll(turn, 1) @ half) == pytest.approx(1.0, abs=1e-12)
    assert np.linalg.norm(last.position) > 1e-6


def test_a_solver_of_fixed_step_goes_where_python_goes(stepper, last, tmp_path):
    """As Simulink does it: FMI 2.0, currents as ports, one step of the solver a communication."""
    ms.export_fmu(stepper, tmp_path / "robot.fmu", name="robot", fmi="2.0")
    names = [f"current_Coil_{i + 1}" for i in range(8)]
    found = fmpy.simulate_fmu(
        str(tmp_path / "robot.fmu"), stop_time=TICKS * PERIOD, step_size=PERIOD,
        output_interval=PERIOD, start_values=dict(zip(names, CURRENTS)), output=["x", "y", "z"],
    )  # fmt: skip
    assert [found[-1][a] for a in "xyz"] == pytest.approx(last.position, rel=1e-9)
