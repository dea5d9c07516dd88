"""The moment of a robot from a measured step-out curve: planted, noisy, found again."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.stats import chi2

import microswim as ms
from microswim.cli import main
from microswim.swimmer.magnetism.drive import drive_of

UNKNOWN = ("magnet.moment", "magnet.direction")
STRENGTHS = (1e-3, 2e-3, 4e-3)
ROBOT = ms.Swimmer(
    body=ms.Sphere(radius=0.4e-3),
    tail=ms.HelicalTail(length=1.2e-3, amplitude=0.12e-3, waves=2, radius=0.05e-3),
    fluid=ms.Fluid(viscosity=0.34),
    coefficients=ms.GrayHancock(),
    magnet=ms.Magnet(moment=2e-6, direction=1.2),
    field=ms.RotatingField(strength=2e-3, frequency=1.0),
    units="SI",
)


def measured(robot, quantity):
    return float(ms.observed(robot.gait(), quantity, drive=drive_of(robot)))


def curve(noise, seed, quantities=("step_out", "wobbling_onset")):
    rng = np.random.default_rng(seed)
    found = []
    for strength in STRENGTHS:
        one = ROBOT.with_({"field.strength": strength})
        start = one.with_({"magnet.moment": 1e-6, "magnet.direction": 0.8})
        for quantity in quantities:
            true = measured(one, quantity)
            value = true * (1 + noise * rng.standard_normal())
            found.append(
                ms.Observation(swimmer=start, quantity=quantity, value=value, sigma=noise * true)
            )
    return found


def fitted(observations):
    start = ROBOT.with_({"magnet.moment": 1e-6, "magnet.direction": 0.8})
    return ms.calibrate(start, observations, unknowns=UNKNOWN)


def test_without_noise_the_moment_is_found_again():
    found = fitted(curve(1e-9, 0))
    assert found.swimmer.magnet.moment == pytest.approx(2e-6, rel=1e-7)
    assert found.swimmer.magnet.direction == pytest.approx(1.2, rel=1e-7)


@pytest.mark.slow
def test_the_stated_intervals_hold_at_their_rate():
    """Forty noisy curves: errors by their stated covariance are chi-squared with 80 freedoms."""
    true = np.array([2e-6, 1.2])
    total, inside, many = 0.0, 0, 40
    for seed in range(many):
        found = fitted(curve(0.03, seed))
        assert tuple(found.names) == UNKNOWN
        off = found.values - true
        C = found.covariance
        total += off @ np.linalg.solve(C, off)
        inside += int(np.sum(np.abs(off) < 1.96 * np.sqrt(np.diag(C))))
    assert chi2.ppf(1e-3, 2 * many) < total < chi2.ppf(1 - 1e-3, 2 * many)
    assert 0.86 < inside / (2 * many) <= 1.0  # 95 % of 80, four standard deviations below


def test_step_out_alone_does_not_tell_the_direction():
    found = fitted(curve(0.03, 1, quantities=("step_out",)))
    assert any("1 of 2" in warning for warning in found.warnings)


def test_the_command_reads_a_table_of_strengths(tmp_path):
    spec, table, out = (tmp_path / n for n in ("robot.toml", "curve.csv", "measured.toml"))
    spec.write_text(ROBOT.to_toml(), encoding="utf-8")
    lines = ["field.strength,step_out,step_out_sigma,wobbling_onset,wobbling_onset_sigma"]
    for strength in STRENGTHS:
        one = ROBOT.with_({"field.strength": strength, "magnet.moment": 3e-6})
        a, b = measured(one, "step_out"), measured(one, "wobbling_onset")
        lines.append(f"{1e3 * strength} mT,{a},{0.02 * a},{b},{0.02 * b}")
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    args = ["calibrate", str(spec), "--table", str(table), "--unknown", ",".join(UNKNOWN)]
    done = CliRunner().invoke(main, [*args, "-o", str(out), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["coefficients"]["magnet.moment"] == pytest.approx(3e-6, rel=1e-6)
    assert ms.Swimmer.from_toml(out).magnet.strength == pytest.approx(3e-6, rel=1e-6)
