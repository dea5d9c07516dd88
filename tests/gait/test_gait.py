"""Gaits as such: series, extremes, frames, efficiency."""

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.series import fourier as g
from microswim.numerics.series.extremes import extremes


def test_series_passes_through_its_samples_and_differentiates():
    phase = 2 * np.pi * np.arange(9) / 9
    values = np.exp(np.sin(phase))[:, None] * [1.0, 2.0]
    series = g.series_of(values)
    assert g.evaluate(series, phase) == pytest.approx(values, abs=1e-12)
    x = 0.3
    exact = -3 * np.sin(3 * x) + 2 * np.cos(2 * x)
    series = np.array([1.0, 0, 0, 0, 1.0, 1.0, 0])  # 1 + sin 2x + cos 3x
    assert g.evaluate(g.derivative(series), x) == pytest.approx(exact)


def test_extremes_of_a_series():
    series = np.array([2.0, 3.0, 4.0])  # 2 + 5 cos(x - a)
    assert extremes(series) == pytest.approx((-3.0, 7.0), abs=1e-12)
    assert extremes(np.array([1.5])) == (1.5, 1.5)


def test_samples_and_rotation_give_the_same_gait():
    swimmer = ms.Swimmer.preset("tabak/helix")
    one = swimmer.gait()
    phase = 2 * np.pi * np.arange(8) / 8
    body = np.broadcast_to(one.body_resistance_series[0], (8, 6, 6))
    made = ms.Gait.from_samples(
        *(f(phase) for f in (one.resistance, one.propulsion, one.activity)),
        body_R=body,
        rate=one.rate,
    )
    assert made.mean_velocity == pytest.approx(one.mean_velocity, abs=1e-13)
    assert made.efficiency == pytest.approx(one.efficiency, rel=1e-10)
    exact = ms.Gait.from_rotation(
        one.resistance(0.0), one.propulsion(0.0), one.activity(0.0), sign=1.0, rate=one.rate
    )
    assert exact.velocity(1.1) == pytest.approx(one.velocity(1.1), abs=1e-13)
    with pytest.raises(ms.MicroswimError, match="body"):
        exact.body_wrench(0.0)


def test_rate_in_the_lab_frame():
    """With frequency_frame = "lab" tail and body rates add up to the given one."""
    swimmer = ms.Swimmer.preset("tabak/helix")
    gait = swimmer.with_({"motion.frequency_frame": "lab"}).gait()
    assert gait.rate + gait.mean_velocity[3] == pytest.approx(swimmer.tail.rate, rel=1e-12)
    with pytest.raises(ms.SpecError, match="frequency_frame"):
        ms.Swimmer.preset("tabak/plane_wave").with_({"motion.frequency_frame": "lab"})


def test_efficiency_is_body_drag_power_over_motor_power():
    """Eq. (24) from the pieces: F_s u_s of the body, torque times rate of the motor."""
    gait = ms.Swimmer.preset("tabak/helix-constant").gait()
    drag = 2.24 * 942.478 * abs(gait.mean_velocity[0])
    assert gait.body_wrench(0.0)[0] == pytest.approx(drag, rel=1e-5)
    work = drag * abs(gait.mean_velocity[0])
    assert gait.efficiency == pytest.approx(work / (gait.mean_torque * gait.rate), rel=1e-5)
    assert gait.at_rate(0.0).efficiency == 0.0


def test_motor_torque_of_a_helix_is_the_torque_on_its_body():
    """Torque-free: what the motor gives the tail about s, the fluid takes from the body."""
    gait = ms.Swimmer.preset("tabak/helix").gait()
    assert gait.mean_torque == pytest.approx(gait.body_wrench(0.2)[3], rel=1e-9)


def test_plane_wave_moves_in_its_plane():
    V = ms.Swimmer.preset("tabak/plane_wave").gait().velocity(np.linspace(0, 6, 20))
    assert np.abs(V[:, 2:5]).max() < 1e-12 * np.abs(V).max()
    assert V[:, 0].mean() < 0
