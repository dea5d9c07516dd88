"""Beats as they are filmed: the beat behind the points, whatever the film lacks."""

import numpy as np
import pytest
from click.testing import CliRunner

import microswim as ms
from microswim.cli import main
from microswim.swimmer.geometry.tails.waveforms.waveform import Beat
from microswim.swimmer.geometry.tails.waveforms.waveform_fit import fit

# Bull sperm of Friedrich et al. (2010): psi = K0 s + 2 A0 s cos(w t - 2 pi s / lambda); um, s
K0, A0, LAMBDA, LENGTH, RATE = 0.0191, 0.0152, 71.6, 58.3, 31.0


def angle(s, phase):
    return K0 * s + 2 * A0 * s * np.cos(phase - 2 * np.pi * s / LAMBDA)


def place(s, phase):
    """The filament by quadrature of its own, (…, 3)."""
    s, phase = np.broadcast_arrays(s, phase)
    xi, w = np.polynomial.legendre.leggauss(40)
    inner = s[..., None] * (xi + 1) / 2
    psi = angle(inner, phase[..., None])
    return np.stack([s / 2 * (np.cos(psi) @ w), s / 2 * (np.sin(psi) @ w), 0 * s], axis=-1)


def film(times, points=30, noise=0.05, seed=0, lost=0.0):
    """Times, arc lengths and noisy positions of what a camera sees."""
    rng = np.random.default_rng(seed)
    t, s = (x.ravel() for x in np.meshgrid(times, np.linspace(0, LENGTH, points), indexing="ij"))
    x = place(s, 2 * np.pi * RATE * t)[:, :2]
    x = x + noise * rng.normal(size=x.shape)
    kept = rng.random(t.size) >= lost
    return t[kept], s[kept], x[kept]


def swimmer(tail):
    body = ms.Ellipsoid(semi_axes=(5, 2.5, 0.5))
    return ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=0.7), coefficients=ms.Cox())


def off(tail):
    """Largest difference of the mean velocities from those of the smooth beat, over the speed."""
    smooth = ms.CustomTail(
        shape=place, length=LENGTH, radius=0.2, wavelength=LAMBDA, frequency=tail.frequency
    )
    V, W = (swimmer(t).gait().mean_velocity[[0, 1, 5]] for t in (tail, smooth))
    return np.abs(V - W) / [np.hypot(*W[:2]), np.hypot(*W[:2]), abs(W[2])]


FILMS = {
    "one beat": np.arange(24) / 24 / RATE,
    "several beats, uneven": np.sort(np.random.default_rng(5).uniform(0, 4 / RATE, 60)),
    "slow camera": np.arange(80) / 500.0,
}


@pytest.mark.parametrize("name", FILMS)
def test_velocities_are_those_of_the_smooth_beat(name):
    t, s, x = film(FILMS[name], lost=0.0 if name == "one beat" else 0.1)
    found = fit(Beat(t, s, position=x))
    assert off(found.tail(radius=0.2)).max() < 0.01
    assert found.frequency == pytest.approx(RATE, abs=5 * found.frequency_error)
    assert found.frequency_error < 0.02
    assert found.noise == pytest.approx(0.05, rel=0.1)
    assert found.mean_curvature == pytest.approx(K0, rel=0.01)
    assert found.tail(radius=0.2).wavelength == pytest.approx(LAMBDA, rel=0.02)


def test_the_filament_keeps_its_length():
    t, s, x = film(FILMS["one beat"])
    tail = fit(Beat(t, s, position=x)).tail(radius=0.2)
    _, slope, _ = tail.centreline(np.linspace(0, LENGTH, 50)[:, None], np.arange(7.0))
    assert np.linalg.norm(slope, axis=-1) == pytest.approx(
        np.ones((50, 7)), abs=1e-4
    )  # a tolerance of 1e-7 on positions


def test_angles_say_the_same_as_positions():
    t, s, _ = film(FILMS["one beat"])
    rng = np.random.default_rng(2)
    found = fit(Beat(t, s, angle=angle(s, 2 * np.pi * RATE * t) + 0.02 * rng.normal(size=t.size)))
    assert off(found.tail(radius=0.2)).max() < 0.01
    assert found.noise == pytest.approx(0.02, rel=0.1)


def test_modes_and_harmonics_are_those_that_are_there():
    """Two modes and two harmonics in noise: neither more nor less."""
    rng = np.random.default_rng(3)
    t, s = (x.ravel() for x in np.meshgrid(np.arange(0, 3, 0.03), np.linspace(0, 1, 25)))
    phase = 2 * np.pi * 1.1 * t
    psi = 0.4 * s * np.cos(phase) + 0.3 * s * np.sin(2 * phase)
    found = fit(Beat(t, s, angle=psi + 0.05 * rng.normal(size=t.size)))
    assert found.modes.shape == (2, 5)
    assert found.frequency == pytest.approx(1.1, abs=1e-3)


def written(folder, table, header="frame,s (um),x (um),y (um)"):
    np.savetxt(folder / "beat.csv", table, delimiter=",", header=header, comments="")
    spec = folder / "bull.toml"
    spec.write_text(
        '[fluid]\nviscosity = "0.7 mPa s"\n[body]\nshape = "sphere"\nradius = "3 um"\n'
        '[tail]\nkind = "waveform"\nfile = "beat.csv"\nradius = "0.2 um"\nfps = "744 Hz"\n'
        '[coefficients]\nlaw = "cox"\n'
    )
    return spec


def test_a_spec_names_a_film_that_stands_beside_it(tmp_path, monkeypatch):
    t, s, x = film(FILMS["one beat"], points=15)
    spec = written(tmp_path, np.column_stack([np.round(t * 744), s, x]))
    tail = ms.Swimmer.from_toml(spec).tail
    assert tail.kind == "waveform"
    assert tail.frequency == pytest.approx(RATE, rel=2e-3)
    assert tail.length == pytest.approx(LENGTH * 1e-6)
    monkeypatch.chdir(tmp_path.parent)
    out = tmp_path / "out"
    run = CliRunner().invoke(main, ["run", str(spec), "--json"])
    assert run.exit_code == 0, run.stderr
    again = tmp_path / "again.toml"
    again.write_text(ms.Swimmer.from_toml(spec).to_toml())
    assert ms.Swimmer.from_toml(again).tail.modes == tail.modes
    call = ["identify", str(tmp_path / "beat.csv"), "--fps", "744", "--out", str(out)]
    told = CliRunner().invoke(main, call)
    assert told.exit_code == 0, told.stderr
    assert "31.0" in told.stdout
    assert sorted(p.name for p in out.iterdir()) == ["beat.png", "tail.toml"]


def test_a_film_of_the_lab_is_brought_to_the_head(tmp_path):
    t, s, x = film(FILMS["one beat"], points=15)
    turn, head = 0.7 + 3.0 * t, np.column_stack([100.0 + 500 * t, -200 * t])
    z = x @ np.array([1, 1j]) * np.exp(1j * turn) + head @ np.array([1, 1j])
    frames = np.round(t * 744)
    table = np.column_stack([frames, s, z.real, z.imag, head, turn])
    header = "frame,s (um),x (um),y (um),head_x (um),head_y (um),head_angle (rad)"
    own = ms.Swimmer.from_toml(written(tmp_path, table, header)).tail
    plain = ms.Swimmer.from_toml(written(tmp_path, np.column_stack([frames, s, x]))).tail
    assert np.array(own.modes) == pytest.approx(np.array(plain.modes), abs=1e-8)
    spec = written(tmp_path, table[:, :4])
    with pytest.raises(ms.SpecError, match="the base moves"):
        ms.Swimmer.from_toml(spec)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"tail.file": "other.csv"}, "no such file"),
        ({"tail.mode_count": 2.5}, "a whole number"),
        ({"tail.modes": [[0.1]]}, "give one of the two"),
        ({"tail.surface_motion": "rigid"}, "it bends"),
    ],
)
def test_what_is_no_beat_is_one_sentence(tmp_path, change, words):
    t, s, x = film(FILMS["one beat"], points=15)
    spec = written(tmp_path, np.column_stack([np.round(t * 744), s, x]))
    with pytest.raises(ms.SpecError, match=words):
        ms.Swimmer.from_toml(spec, overrides=change)


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (lambda t, s, x: np.column_stack([t, s, -x]), "towards negative x"),
        (lambda t, s, x: np.column_stack([t, s, x])[:60], "frames of"),
        (lambda t, s, x: np.column_stack([t, s - 1, x]), "arc length from the head"),
    ],
)
def test_a_film_that_shows_no_beat(tmp_path, rows, words):
    t, s, x = film(FILMS["one beat"], points=15)
    with pytest.raises(ms.SpecError, match=words):
        ms.Swimmer.from_toml(written(tmp_path, rows(np.round(t * 744), s, x)))


def test_a_custom_tail_of_splines_is_followed_to_its_tolerance():
    """Finite smoothness: a cubic spline has jumps of its third derivative."""
    from scipy.interpolate import CubicSpline

    knots = np.linspace(0, 2, 9)
    spline = CubicSpline(knots, 0.1 * np.sin(3 * knots))

    def shape(s, phase):
        q = spline(s) * np.cos(phase)
        return np.stack([s + 0 * q, q, 0 * q], axis=-1)

    tail = ms.CustomTail(shape=shape, length=2.0, radius=0.02, wavelength=2.0, tolerance=1e-5)
    s = np.linspace(0, 2, 41)
    assert tail.centreline(s, 0.3)[0] == pytest.approx(shape(s, 0.3), abs=2e-4)


@pytest.mark.parametrize(("column", "words"), [(0, "is a time wrong"), (2, "is a number wrong")])
def test_one_number_that_is_wrong_by_far_is_named(column, words):
    t, s, x = film(FILMS["one beat"], points=15)
    table = np.column_stack([t, s, x])
    table[t == t.max(), column] = 1e15
    with pytest.raises(ms.SpecError, match=words):
        fit(Beat(table[:, 0], table[:, 1], position=table[:, 2:]))
