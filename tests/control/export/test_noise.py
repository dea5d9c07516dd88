"""Thermal noise in what is exported: the displacements of Python, a stream of chance of its own."""

import ctypes

import fmpy
import numpy as np
import pytest

import microswim as ms
from microswim.control.environments.jostle import tumble
from microswim.control.environments.random_streams import normals
from microswim.control.export import compiler
from microswim.control.thermal import moved

KINDS = ["tabak/helix", "tabak/plane_wave"]
ENERGY, DT = 0.05, 0.02


def stepper(name="tabak/helix", **values):
    swimmer = ms.Swimmer.preset(name, {"noise.temperature": ENERGY, **values})
    return ms.Stepper.of(swimmer)


@pytest.fixture(scope="module")
def build(tmp_path_factory):
    def built(one):
        folder = tmp_path_factory.mktemp("noise")
        _, source = compiler.write(ms.c_model(one, "robot"), folder)
        compiler.shared_library([source], folder / "model.so")
        library = ctypes.CDLL(str(folder / "model.so"))
        real = ctypes.c_double
        library.robot_scatter.argtypes = [ctypes.c_void_p, real, real, *[ctypes.c_void_p] * 2]
        return library

    return built


def scattered(library, state, n, energy=ENERGY, dt=DT, viscosity=None):
    y, u, p = (ctypes.c_double * 8)(), (ctypes.c_double * 64)(), (ctypes.c_double * 16)()
    library.robot_defaults(y, u, p)
    p[0] = p[0] if viscosity is None else viscosity
    y[:] = list(state)
    status = library.robot_scatter(p, energy, dt, (ctypes.c_double * 6)(*n), y)
    return status, np.array(y)


START = np.concatenate([[0.2, -0.1, 0.3], np.array([0.5, -0.5, 0.7, 0.1]), [0.4]])


@pytest.mark.parametrize("name", KINDS)
def test_the_displacement_of_the_c_is_that_of_its_mobility(build, name):
    """Against the inverse of the gait's resistance, its Cholesky factor and the exponential."""
    one = stepper(name)
    n = np.random.default_rng(3).normal(size=6)
    M = np.linalg.inv(one.gait.resistance(0.4))
    z = np.sqrt(2.0 * ENERGY * DT) * np.linalg.cholesky(M) @ n
    status, found = scattered(build(one), START, n)
    assert status == 0
    assert found == pytest.approx(moved(START[None], z[None])[0], abs=1e-12)
    thick = build(one)
    halved = scattered(thick, START, n, viscosity=2.0 * one.swimmer.fluid.viscosity)[1]
    assert halved == pytest.approx(moved(START[None], z[None] / np.sqrt(2.0))[0], abs=1e-12)


def test_what_is_held_does_not_move_in_c(build):
    library = build(stepper(**{"motion.free": ["us", "os"]}))
    state = np.array([0, 0, 0, 1.0, 0, 0, 0, 0])
    found = scattered(library, state, np.ones(6))[1]
    assert np.all(found[[1, 2, 5, 6]] == 0.0)
    assert abs(found[0]) > 0


def test_its_normal_numbers_are_those_of_the_environments(build):
    library, own = build(stepper()), np.array([77], dtype=np.uint64)
    key, six = ctypes.c_uint64(77), (ctypes.c_double * 6)()
    for _ in range(3):
        library.robot_normals(ctypes.byref(key), six)
        wanted = [x for _ in range(3) for x in normals(own, 0)]
        assert np.array(six) == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize("bad", [{"energy": -1.0}, {"energy": np.nan}, {"n": [np.inf] * 6}])
def test_noise_that_makes_no_sense_is_an_error(build, bad):
    given = {"n": np.ones(6), **bad}
    status, found = scattered(build(stepper()), START, **given)
    assert status == 13
    assert np.array_equal(found, START)


def displacements(path, **start):
    found = fmpy.simulate_fmu(
        str(path), stop_time=40.0, step_size=DT, output_interval=DT, output=["x", "y", "z"],
        start_values={"motor_rate": 0.0, **start},
    )  # fmt: skip
    return np.diff(np.stack([found[c] for c in "xyz"], axis=-1), axis=0)


def test_a_unit_diffuses_as_its_mobility_says(tmp_path):
    one, path = stepper(), tmp_path / "robot.fmu"
    ms.export_fmu(one, path, name="robot")
    steps = displacements(path, noise_seed=5.0)
    M = np.linalg.inv(one.gait.resistance(0.0))
    wanted = 2.0 * ENERGY * DT * np.trace(M[:3, :3])
    n = len(steps)
    assert (steps**2).sum(axis=1).mean() == pytest.approx(wanted, rel=4.0 / np.sqrt(n))
    assert np.array_equal(steps, displacements(path, noise_seed=5.0))
    assert not np.array_equal(steps, displacements(path, noise_seed=6.0))
    assert np.all(displacements(path, thermal_energy=0.0) == 0.0)


def tumbled(library, expected, angle, key, state=START):
    y, seed = (ctypes.c_double * 8)(*state), ctypes.c_uint64(key)
    library.robot_tumble.argtypes = [*[ctypes.c_double] * 2, *[ctypes.c_void_p] * 2]
    status = library.robot_tumble(expected, angle, ctypes.byref(seed), y)
    return status, np.array(y)


def test_tumbles_in_c_forget_the_heading_as_runs_do(build):
    """The mean heading after a time falls to exp(-expected (1 - cos angle)) [Lovely 1975]."""
    library, expected, angle = build(stepper()), 0.7, np.radians(68.0)
    state = np.array([1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0, 0.4])
    ends = [tumbled(library, expected, angle, 1000 + k, state)[1] for k in range(4000)]
    w, x, y, z = np.array(ends)[:, 3:7].T
    along = w * w + x * x - y * y - z * z
    wanted = np.exp(-expected * (1.0 - np.cos(angle)))
    assert along.mean() == pytest.approx(wanted, abs=4.0 * along.std() / np.sqrt(4000))
    rested = np.mean(along > 1.0 - 1e-12)
    assert rested == pytest.approx(np.exp(-expected), abs=4.0 * 0.5 / np.sqrt(4000))
    assert np.all(np.array(ends)[:, [0, 1, 2, 7]] == [1.0, 2.0, 3.0, 0.4])  # on the spot
    own = state.copy()
    tumble(own, expected, angle, np.array([1003], dtype=np.uint64), 0)
    assert ends[3] == pytest.approx(own, abs=1e-14)


@pytest.mark.parametrize("bad", [(-1.0, 1.0), (np.nan, 1.0), (2000.0, 1.0), (1.0, 4.0)])
def test_tumbles_that_make_no_sense_are_an_error(build, bad):
    status, found = tumbled(build(stepper()), *bad, 3)
    assert status == 14
    assert np.array_equal(found, START)


def test_a_unit_runs_and_tumbles_as_its_spec_says(tmp_path):
    one, path = stepper(**{"noise.run_time": 0.05}), tmp_path / "robot.fmu"
    ms.export_fmu(one, path, name="robot")

    def cosines(**start):
        found = fmpy.simulate_fmu(
            str(path), stop_time=40.0, step_size=DT, output_interval=DT,
            output=["qw", "qx", "qy", "qz"], start_values={"motor_rate": 0.0, **start},
        )  # fmt: skip
        w, x, y, z = (found[c] for c in ("qw", "qx", "qy", "qz"))
        s = np.stack([w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)], -1)
        return (s[1:] * s[:-1]).sum(axis=1)

    still = cosines(thermal_energy=0.0, run_time=0.0)
    assert np.all(still > 1.0 - 1e-12)
    c = cosines(thermal_energy=0.0, noise_seed=4.0)
    wanted = np.exp(-DT / 0.05 * (1.0 - np.cos(np.radians(68.0))))
    assert c.mean() == pytest.approx(wanted, abs=4.0 * c.std() / np.sqrt(c.size))
