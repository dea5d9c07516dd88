"""The gallery: every script says what its picture shows, and its numbers are the known ones."""

import ast
import importlib.util
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[1] / "examples"
SCRIPTS = sorted(ROOT.rglob("*.py"))
SLOW = {"cells_in_noise": pytest.mark.slow}


def module(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


GALLERY = module(ROOT.parent / "docs" / "hooks" / "gallery.py")


def first_swim(r):
    """Independent quadrature of the paper's model: data set `base-case`."""
    free = r["swimmer"].with_({"motion.free": ("us", "uq", "ur", "os")}).gait()
    assert free.mean_velocity[0] == pytest.approx(-0.036987, abs=1e-6)
    assert r["forward velocity"] == pytest.approx(-0.036987, abs=2e-4)
    assert r["body rate"] == pytest.approx(-0.39020, abs=1e-3)
    assert 0 < r["swimming speed"] <= abs(r["forward velocity"]) * (1 + 1e-9)


def one_period(r):
    """The wave moves in the plane s, q: nothing happens across it."""
    velocity = r["run"].velocity.values
    assert np.abs(velocity[:, [2, 3, 4]]).max() < 1e-12
    assert r["amplitude of the sway"] > abs(r["mean forward velocity"])


def two_swimmers(r):
    """Force dipoles: far away the change falls off as 1/d^2, and point forces see it all."""
    assert r["slope far away"] == pytest.approx(-2.0, abs=0.15)
    assert r["quick"][np.abs(r["line"] - 8.0).argmin()] == pytest.approx(r["solved"][-1], rel=0.15)
    assert 0.1 < r["change at a distance of 2"] < 0.4


def run_and_tumble(r):
    """Reversing all motors reverses the motion; a tumble turns the cell, a run does not."""
    assert r["forwards"] == pytest.approx(-r["forwards"][::-1], abs=1e-9)
    assert r["end over end"] == pytest.approx(r["end over end"][::-1], abs=1e-9)
    assert r["end over end"][0] < 1e-9
    assert r["end over end"][2] == r["end over end"].max()
    assert (r["turned by tumbles"] > 20.0).all()
    assert r["running speed (um/s)"] == pytest.approx(1e6 * r["forwards"][0])


def two_tails(r):
    """What the mirror between the tails forbids does not happen."""
    assert np.abs(r["means"][:, [1, 3, 5]]).max() < 1e-12
    assert (np.diff(r["radius"]) < 0).all()
    assert r["rolling over turning"] < 1e-9


def traced_beat(r):
    """What was planted comes back: rate, and noise as misfit; the speed is the tutorial's."""
    assert r["beats per second"] == pytest.approx(30.0, abs=0.02)
    assert r["misfit (nm)"] == pytest.approx(80.0, rel=0.05)
    assert r["forward velocity (um/s)"] == pytest.approx(144.6, rel=0.005)


def scallop(r):
    """Time reversal: half a turn forth and back ends where it began, at any pace."""
    assert r["displacement after three cycles"] < 1e-9
    assert r["largest displacement on the way"] > 0.01
    assert r["turning on"][-1] == pytest.approx(1.5 * 0.037, rel=0.05)


def tail_that_bends(r):
    """Closed forms of small amplitude to half a per cent; their largest thrust is at 1.89."""
    known = module(ROOT / "tail_that_bends.py").KNOWN
    for found, truth in zip(r["at known"].values(), zip(*known.values())):
        np.testing.assert_allclose(found, truth, rtol=5e-3, atol=6e-5)  # as many digits as told
    assert r["best"] == pytest.approx(1.89, rel=0.03)


def sperm_like(r):
    """Slack tails swim as the square of a small moment; stiff ones are bent as they are told."""
    small, middle, _ = r["speed"].values()
    assert small[-1] / 0.25 == pytest.approx(middle[-1] / 4.0, rel=0.05)
    assert (small > 0.0).all()
    assert small[0] > 5.0 * small[-1]


def hook_flick(r):
    """A soft hook gives way in proportion to its stiffness, and sooner when the helix pushes."""
    pushes, pulls = r["torque"].values()
    assert pushes[1] / pushes[0] == pytest.approx(2.0, rel=0.05)
    assert (pulls > 1.5 * pushes).all()


def flexible_nanowire(r):
    """Of the size that was measured; softer and stiffer tails are slower, faster fields help."""
    wide, narrow = r["over_frequency"].values()
    assert (np.diff(wide) > 0.0).all()
    assert (wide > narrow).all()
    best = r["over_stiffness"].argmax()
    assert 0 < best < len(r["over_stiffness"]) - 1
    assert 7e-6 < r["over_stiffness"][best] < 42e-6  # within a factor of two to three of 21 um/s


def laws_of_resistance(r):
    """Lighthill's pair of the base case, computed apart: c_n 780.37, c_t 537.58."""
    assert r["ratio of Lighthill at 0.1"] == pytest.approx(780.37 / 537.58, rel=1e-4)
    assert r["constant pair"] == pytest.approx(1.284, abs=1e-3)


def best_helix(r):
    """No design of the map that the motor can drive is faster than the optimum."""
    allowed = r["speed"][r["torque"] <= 150.0]
    assert r["best speed"] >= allowed.max() * (1 - 1e-6)
    assert r["torque of the best"] == pytest.approx(150.0, rel=1e-6)


def seven_cells(r):
    """The paper's Gamma_N = 2.37, Gamma_R = 1.49, and its 8.2 % at G."""
    assert r["Gamma_N"] == pytest.approx(2.37, abs=0.005)
    assert r["Gamma_R"] == pytest.approx(1.49, abs=0.005)
    assert r["fitted on C"][6] / 30.5 - 1.0 == pytest.approx(0.082, abs=0.005)


def one_point_calibration(r):
    """Exact at its point, off elsewhere; the reference is known to 0.1 %, coarse to 0.5 %."""
    assert abs(r["error at the point"]) < 1e-6
    assert r["reference"][2] == pytest.approx(-0.03070, rel=0.006)
    assert 0.1 < abs(r["error at 0.04"]) < 0.4
    assert r["plain over reference"] == pytest.approx(2.2, abs=0.05)


def error_of_a_number(r):
    """What is told bounds what is wrong, and local drag alone is off by a factor."""
    at = [np.abs(r["radius"] - a).argmin() for a in module(ROOT / "error_of_a_number.py").SOLVED]
    assert r["radius"][at] == pytest.approx([0.2, 0.35, 0.5, 0.65])
    assert (np.abs(r["speed"][at] - r["solved"]) < r["band"][at]).all()
    assert r["largest stated error (%)"] == pytest.approx(3.3, abs=0.05)  # as the text says
    assert r["local drag over the truth"] > 2.0


def beside_a_wall(r):
    """Slower and turning near the wall, undisturbed far from it; the turning decays quickly."""
    assert 0.5 < r["speed ratio at 0.7"] < 0.95
    assert r["speed ratio"][-1] == pytest.approx(1.0, abs=0.02)
    assert (np.diff(r["speed ratio"]) > 0).all()
    assert abs(r["turning at 2.5"]) < 0.05 * abs(r["turning at 0.7"])


def step_out(r):
    """Steps in time find what is solved; moment across the axis: Adler's law, nearly."""
    w, k, wc = r["rate"], r["rail velocity per rate"], r["rail step-out"]
    assert r["velocity"] == pytest.approx(r["told"].velocity, rel=0.005)
    assert 2 * np.pi * r["told"].step_out == pytest.approx(wc, rel=1e-3)
    law = k * np.where(w < wc, w, w - np.sqrt(np.maximum(w**2 - wc**2, 0.0)))
    assert r["velocity"] == pytest.approx(law, rel=0.03)


def screws_from_a_formula(r):
    """Right-handed threads go ahead along s, their mirror image back by as much; all slip."""
    assert (r["chirality"] > 0.0).all()
    assert r["advance of the mirror image"] == pytest.approx(-r["advance"][1], rel=0.02)
    assert (r["advance"] < 0.06 * 2.0).all()
    assert r["advance"][1] == r["advance"].max()


def cells_in_noise(r):
    """The theorem of Einstein and the active particle, within what forty cells allow."""
    _, square, active = module(ROOT / "cells_in_noise.py").displacement(r)
    assert square[10:] == pytest.approx(active[10:], rel=0.15)
    assert r["persistence time"] > 10.0


def made_robots_differ(r):
    """The mean of many is near the drawing; more than half are good as it lies above the limit."""
    speed = r["made"].swimming_speed.values
    assert np.nanmean(speed) == pytest.approx(r["nominal speed"], rel=0.02)
    assert 0.5 < r["yield"] < 0.95
    assert r["yield"] == pytest.approx(np.mean(speed >= 0.035), abs=1e-9)


def follow_path(r):
    """Every robot arrives; off the path by less than a third of the head's diameter, 0.6 mm."""
    assert r["arrived"] == 1.0
    assert r["distance off the path after a second (mm, rms)"] < 0.2


def follow_with_coils(r):
    """It arrives, off by less than the head's half width with its wobble, on currents of coils."""
    assert r["arrived"]
    assert r["off the path (mm, rms)"] < 0.3
    assert r["largest current (A)"] < 1.0
    assert np.abs(r["rows"][:, 5:]).max(axis=0).min() > 0.01  # every coil has its part


def learn_to_steer(r):
    """It goes along paths that it has not seen, five millimetres and more further."""
    assert r["return on new paths after"] > r["return on new paths before"] + 5.0
    assert np.median(r["curve"][-5:, 2]) > np.median(r["curve"][:5, 2])


def receding_horizon(r):
    """A robot of 3.6 mm keeps within 50 um, though a shear it does not know carries it."""
    assert r["off the path after two seconds (um, rms)"] < 50.0
    assert np.ptp(r["rows"][:, 1:4], axis=0).max() > 1e-3  # and it has gone somewhere


KNOWN = {
    f.__name__: f
    for f in (
        *(
            first_swim,
            one_period,
            scallop,
            two_swimmers,
            two_tails,
            traced_beat,
            run_and_tumble,
            tail_that_bends,
            sperm_like,
            hook_flick,
            flexible_nanowire,
            laws_of_resistance,
            best_helix,
            seven_cells,
        ),
        *(
            one_point_calibration,
            error_of_a_number,
            beside_a_wall,
            step_out,
            made_robots_differ,
            cells_in_noise,
        ),
        screws_from_a_formula,
        *(follow_path, follow_with_coils, learn_to_steer, receding_horizon),
    )
}


def test_every_script_of_the_gallery_has_its_test():
    assert {p.stem for p in SCRIPTS} == set(KNOWN)


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda p: p.stem)
def test_scripts_have_a_title_and_a_caption(path):
    title, _, caption = ast.get_docstring(ast.parse(path.read_text())).partition("\n\n")
    assert "\n" not in title
    assert len(caption) > 80


@pytest.mark.parametrize(
    "path", [pytest.param(p, marks=SLOW.get(p.stem, ()), id=p.stem) for p in SCRIPTS]
)
def test_numbers_and_axes(path):
    script = module(path)
    results = script.main()
    KNOWN[path.stem](results)
    figure = script.figure(results)
    GALLERY.keep(path, results, figure)
    framed = [a for a in figure.axes if a.axison and a.get_label() != "<colorbar>"]
    assert framed
    for axes in framed:
        twin = any(
            a is not axes and a.get_position().bounds == axes.get_position().bounds for a in framed
        )
        assert axes.get_xlabel() or twin
        assert axes.get_ylabel()
