"""The paper's model in numbers, against independent computations of it.

The reference numbers come from a separate plain implementation with converged quadrature, made
before this package; the paper's own figures are judged in test_paper.py.
"""

import numpy as np
import pytest

import microswim as ms

FOUR = ("us", "uq", "ur", "os")


@pytest.mark.parametrize(
    ("preset", "free", "u_s", "omega_s"),
    [
        ("tabak/helix-constant", FOUR, -0.036987, -0.39020),
        ("tabak/helix-sbt", FOUR, -0.037331, -0.37369),
        ("tabak/helix-constant", "all", -0.036872, None),
        ("tabak/helix-sbt", "all", -0.037186, None),
    ],
)
def test_helical_base_case(preset, free, u_s, omega_s):
    gait = ms.Swimmer.preset(preset, {"motion.free": free}).gait()
    assert gait.mean_velocity[0] == pytest.approx(u_s, rel=5e-3)
    if omega_s is not None:
        assert gait.mean_velocity[3] == pytest.approx(omega_s, rel=5e-3)


@pytest.mark.parametrize(("preset", "lateral"), [("constant", 0.01817), ("sbt", 0.01682)])
def test_lateral_amplitude_of_the_helical_base_case(preset, lateral):
    gait = ms.Swimmer.preset(f"tabak/helix-{preset}", {"motion.free": FOUR}).gait()
    assert gait.velocity_amplitude[1:3] == pytest.approx([lateral] * 2, rel=5e-3)


@pytest.mark.parametrize(
    ("line_element", "u_s", "v_q", "omega_r"),
    [("apparent", -0.02305, 0.01023, 0.0425), ("arc", -0.02664, 0.01186, 0.0445)],
)
def test_plane_wave_base_case(line_element, u_s, v_q, omega_r):
    gait = ms.Swimmer.preset(
        "tabak/plane_wave-constant", {"motion.line_element": line_element}
    ).gait()
    V = gait.velocity(np.linspace(0.0, 2.0 * np.pi, 721))
    ours = gait.mean_velocity[0], np.abs(V[:, 1]).max(), np.abs(V[:, 5]).max()
    assert ours == pytest.approx((u_s, v_q, omega_r), rel=5e-3)


VIBRIO = {  # um/s and Hz, Gamma = 1 and Gamma = 2.37, 1.49
    "A": (23.53, 11.76, 13.79, 8.00),
    "B": (16.93, 13.14, 10.31, 8.94),
    "C": (10.21, 7.10, 6.23, 4.83),
    "D": (31.63, 16.70, 18.77, 11.36),
    "E": (16.35, 9.01, 9.71, 6.13),
    "F": (27.61, 14.23, 16.19, 9.67),
    "G": (57.27, 25.26, 33.03, 17.17),
}


@pytest.mark.parametrize("specimen", VIBRIO)
def test_vibrio_specimens(specimen):
    corrected = {
        "interaction.translation": [2.37, 1.0, 1.0],
        "interaction.rotation": [1.49, 1.0, 1.0],
    }
    ours = []
    for overrides in ({}, corrected):
        V = ms.Swimmer.preset(f"goto/{specimen}", overrides).gait().mean_velocity
        ours += [-V[0] * 1e6, -V[3] / (2 * np.pi)]
    assert ours == pytest.approx(VIBRIO[specimen], rel=1e-2)


def test_fastest_helix_of_figure_6():
    """Closed form (20) without ramp, lab-frame rate, constant pair, at b = 0.5, N = 1: 0.209."""
    readings = {
        "tail.amplitude": 0.5,
        "tail.waves": 1.0,
        "tail.ramp": 0.0,
        "motion.frequency_frame": "lab",
        "motion.free": ["us", "os"],
    }
    swimmer = ms.Swimmer.preset("tabak/helix-constant", readings)
    assert swimmer.gait().mean_velocity[0] == pytest.approx(-0.209, rel=5e-3)
    ramped = swimmer.with_({"tail.ramp": 0.1}).gait()
    assert ramped.mean_velocity[0] == pytest.approx(-0.186, rel=5e-3)


def test_fastest_helix_with_the_rate_relative_to_the_body():
    """The motor's own rate does not gain from large amplitudes: the map's peak is 0.072."""
    swimmer = ms.Swimmer.preset("tabak/helix-constant")
    b, N = np.meshgrid(np.linspace(0.01, 0.5, 50), np.linspace(0.5, 5.0, 46))
    u = ms.evaluate(swimmer, {"tail.amplitude": b.ravel(), "tail.waves": N.ravel()})
    u_s = u["mean_velocity"][:, 0]
    assert u_s.min() == pytest.approx(-0.072, rel=5e-3)
    assert b.ravel()[u_s.argmin()] < 0.4


def test_fastest_plane_wave_of_figure_6():
    swimmer = ms.Swimmer.preset(
        "tabak/plane_wave-constant", {"tail.amplitude": 0.5, "tail.waves": 0.75}
    )
    assert swimmer.gait().mean_velocity[0] == pytest.approx(-0.119, rel=5e-3)
