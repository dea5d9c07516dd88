"""The velocity in the field as a quantity: that of the regimes, with derivatives, and the moment
that a table of speeds at frequencies tells.
"""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.stats import chi2

import microswim as ms
from microswim.cli import main
from microswim.gait.turning.driven_speed import driven_velocity
from microswim.gait.turning.step_out import Drive
from microswim.swimmer.magnetism.drive import drive_of

ROBOT = ms.Swimmer(
    body=ms.Sphere(radius=0.4e-3),
    tail=ms.HelicalTail(length=1.2e-3, amplitude=0.12e-3, waves=2, radius=0.05e-3),
    fluid=ms.Fluid(viscosity=0.34),
    coefficients=ms.GrayHancock(),
    magnet=ms.Magnet(moment=2e-6, direction=1.2),
    field=ms.RotatingField(strength=2e-3, frequency=1.0),
    units="SI",
)
GAIT = ROBOT.gait("rft")
STEP_OUT = float(ms.observed(GAIT, "step_out", drive=drive_of(ROBOT)))


def speed(robot):
    return float(ms.observed(robot.gait("rft"), "driven_speed", drive=drive_of(robot)))


@pytest.mark.parametrize("share", [0.05, 0.4, 0.98, 1.3, 3.0])
@pytest.mark.parametrize("cone", [0.0, 0.2])
def test_it_is_what_the_regimes_say(share, cone):
    robot = ROBOT.with_({"field.frequency": share * STEP_OUT, "field.cone": cone})
    told = ms.regimes(robot, [share * STEP_OUT], gait=GAIT)
    assert speed(robot) == pytest.approx(abs(told.velocity[0]), rel=1e-6)


@pytest.mark.parametrize("share", [0.05, 0.6, 1.6])
@pytest.mark.parametrize("which", ["moment", "strength", "rate"])
def test_its_derivatives_are_those_of_differences(share, which):
    drive = drive_of(ROBOT.with_({"field.frequency": share * STEP_OUT}))
    away = np.array([0.3, 1.0, -0.2]) if which == "moment" else 1.0

    def moved(h):
        value = getattr(drive, which)
        return drive._replace(**{which: value + h * away * np.abs(value).max()})

    exact = np.imag(driven_velocity(GAIT, moved(1e-20j))) / 1e-20
    h = 1e-3
    up, down = driven_velocity(GAIT, moved(h)), driven_velocity(GAIT, moved(-h))
    size = abs(driven_velocity(GAIT, drive))
    close = {"rel": 1e-3, "abs": 1e-4 * size} if share < 1 else {"rel": 0.03, "abs": 0.03 * size}
    assert exact == pytest.approx((up - down) / (2 * h), **close)


def test_at_equal_torque_and_rate_the_velocity_scales_with_the_rate():
    """Twice the field and twice the rate: the same states, twice as fast."""
    one = Drive((0.3e-6, 2e-6, 0.0), 2e-3, 0.0, 3.0)
    two = one._replace(strength=4e-3, rate=6.0)
    assert driven_velocity(GAIT, two) == pytest.approx(2.0 * driven_velocity(GAIT, one), rel=1e-9)


#: Shares of step-out at which a table has its rows: the knee tells the moment.
ROWS = (0.3, 0.7, 0.9, 1.3, 1.7)
MOST = max(speed(ROBOT.with_({"field.frequency": s * STEP_OUT})) for s in ROWS)


def table(noise, seed, start, rows=ROWS):
    rng, made = np.random.default_rng(seed), []
    for share in rows:
        one = {"field.frequency": share * STEP_OUT}
        value = speed(ROBOT.with_(one)) + noise * MOST * rng.standard_normal()
        swimmer = start.with_(one)
        made.append(
            ms.Observation(
                swimmer=swimmer, quantity="driven_speed", value=value, sigma=noise * MOST
            )
        )
    return made


@pytest.mark.slow
def test_a_table_of_speeds_tells_the_moment_at_the_stated_rate():
    """Twelve noisy tables: errors by the stated uncertainty are chi-squared; 95 % hold."""
    start = ROBOT.with_({"magnet.moment": 1.8e-6})
    off = []
    for seed in range(12):
        found = ms.calibrate(start, table(0.02, seed, start), unknowns=("magnet.moment",))
        off.append((found.values[0] - 2e-6) / np.sqrt(found.covariance[0, 0]))
    off = np.array(off)
    assert chi2.ppf(1e-3, 12) < (off**2).sum() < chi2.ppf(1 - 1e-3, 12)
    assert np.mean(np.abs(off) < 1.96) >= 0.75


def test_the_command_reads_speeds_at_frequencies(tmp_path):
    spec, rows, out = (tmp_path / n for n in ("robot.toml", "speeds.csv", "measured.toml"))
    start = ROBOT.with_({"magnet.moment": 1.95e-6})
    spec.write_text(start.to_toml(), encoding="utf-8")
    lines = ["field.frequency,driven_speed,driven_speed_sigma"]
    for one in table(1e-6, 0, start, rows=(0.7, 1.4)):
        f = one.swimmer.field.frequency
        lines.append(f"{f} Hz,{1e6 * one.value} um/s,{1e6 * 0.01 * MOST} um/s")
    rows.write_text("\n".join(lines) + "\n", encoding="utf-8")
    args = ["calibrate", str(spec), "--table", str(rows), "--unknown", "magnet.moment"]
    done = CliRunner().invoke(main, [*args, "-o", str(out), "--json"])
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["coefficients"]["magnet.moment"] == pytest.approx(2e-6, rel=1e-3)
