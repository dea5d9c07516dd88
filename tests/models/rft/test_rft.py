"""Laws that any resistive force theory must obey, whatever the numbers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microswim as ms
from microswim.models.rft import gait as rft_gait
from microswim.numerics.series.fourier import rotate
from microswim.swimmer.fields import lifted


def number(lo, hi):
    return st.floats(lo, hi, allow_nan=False)


waves = st.fixed_dictionaries(
    {
        "length": number(0.5, 4.0),
        "amplitude": number(0.0, 0.2),
        "waves": number(0.3, 4.0),
        "radius": number(1e-4, 0.01),
        "ramp": st.sampled_from([0.0, 0.1, 0.5, 1.0]),
        "frequency": number(-3.0, 3.0).filter(lambda f: abs(f) > 0.1),
    }
)
bodies = st.one_of(
    st.builds(ms.Sphere, radius=number(0.1, 1.0)),
    st.builds(ms.Spheroid, semi_axes=st.tuples(number(0.1, 1.0), number(0.1, 1.0))),
    st.builds(
        ms.Ellipsoid, semi_axes=st.tuples(number(0.1, 1.0), number(0.1, 1.0), number(0.1, 1.0))
    ),
)
HANDS = st.sampled_from(["left", "right"])
tails = st.one_of(
    st.builds(
        lambda w, h: ms.HelicalTail(**w, handedness=h), waves, st.sampled_from(["left", "right"])
    ),
    st.builds(lambda w: ms.PlaneWaveTail(**w), waves),
)
swimmers = st.builds(
    ms.Swimmer,
    body=bodies,
    tail=tails,
    fluid=st.builds(ms.Fluid, viscosity=number(0.1, 10.0)),
    coefficients=st.sampled_from([ms.GrayHancock(tip=True), ms.Cox(spin=False)]),
)
laws = settings(max_examples=40, deadline=None)
PHASE = np.linspace(0.0, 2.0 * np.pi, 9)


def slender_enough(swimmer):
    wavelength = 2 * np.pi / swimmer.tail.wavenumber
    return min(wavelength, swimmer.tail.length) > 20 * swimmer.tail.radius


@laws
@given(swimmers.filter(slender_enough))
def test_resistance_is_symmetric_and_positive_definite(swimmer):
    R = swimmer.gait().resistance(PHASE)
    assert np.abs(R - np.swapaxes(R, 1, 2)).max() <= 1e-13 * np.abs(R).max()
    assert np.linalg.eigvalsh(R).min() > 0


@laws
@given(swimmers.filter(slender_enough))
def test_no_motion_of_body_and_tail_gains_energy_from_the_fluid(swimmer):
    """``[V; rate]' [[R, F], [F', G]] [V; rate]`` is dissipated: no V whatever makes it negative."""
    gait = swimmer.gait()
    R, F, G = gait.resistance(PHASE), gait.propulsion(PHASE), gait.activity(PHASE)
    least = G - np.einsum("ni,ni->n", F, np.linalg.solve(R, F[..., None])[..., 0])
    assert (least >= -1e-12 * np.abs(G).max()).all()


@laws
@given(swimmers.filter(slender_enough), number(-5.0, 5.0))
def test_velocity_is_linear_in_the_rate_and_free_of_viscosity(swimmer, factor):
    gait = swimmer.gait()
    V = gait.velocity(PHASE)
    assert gait.at_rate(factor * gait.rate).velocity(PHASE) == pytest.approx(factor * V, abs=1e-12)
    thick = swimmer.with_({"fluid.viscosity": 7.0 * swimmer.fluid.viscosity}).gait()
    assert thick.velocity(PHASE) == pytest.approx(V, rel=1e-9, abs=1e-10)
    assert thick.mean_power == pytest.approx(7.0 * gait.mean_power, rel=1e-9)


@laws
@given(swimmers.filter(slender_enough), number(0.1, 10.0))
def test_scaling_all_lengths_scales_the_speed(swimmer, size):
    lengths = [k for k in swimmer.numbers if k.startswith("body.") or k in LENGTHS]
    big = lifted(swimmer, {k: size * swimmer.numbers[k] for k in lengths})
    V, W = swimmer.gait().velocity(PHASE), big.gait().velocity(PHASE)
    assert W[:, :3] == pytest.approx(size * V[:, :3], rel=1e-8, abs=1e-10)
    assert W[:, 3:] == pytest.approx(V[:, 3:], rel=1e-8, abs=1e-10)


LENGTHS = ("tail.length", "tail.amplitude", "tail.radius")


@laws
@given(waves, bodies)
def test_mirror_image_swims_the_mirrored_path(wave, body):
    gaits = [
        ms.Swimmer(
            body=body,
            tail=ms.HelicalTail(**wave, handedness=h),
            fluid=ms.Fluid(viscosity=1.0),
            coefficients=ms.Constant(normal=2.0, tangential=1.2),
        ).gait()
        for h in ("left", "right")
    ]
    left, right = (g.velocity(PHASE) for g in gaits)
    # reflection r -> -r: a velocity turns its r over, a rotation its s and q
    assert right == pytest.approx(left * [1, 1, -1, -1, -1, 1], rel=1e-9, abs=1e-11)


def swimmer_of(tail, body=None, **fields):
    fields = {"coefficients": ms.Constant(normal=2.0, tangential=1.2)} | fields
    return ms.Swimmer(
        body=body or ms.Sphere(radius=0.4), tail=tail, fluid=ms.Fluid(viscosity=1.0), **fields
    )


WAVE = {"length": 2.0, "amplitude": 0.15, "waves": 1.7, "radius": 0.02}


def test_change_of_reference_point():
    """About a point moved by c: R' = T R T', with the force's moment arm in T."""
    tail = ms.PlaneWaveTail(**WAVE)
    about_joint, about_body = swimmer_of(tail, ms.NoBody()).gait(), swimmer_of(tail).gait()
    T = np.eye(6)
    T[3:, :3] = np.array([[0, 0, 0], [0, 0, -0.4], [0, 0.4, 0]])  # c x F, c = (0.4, 0, 0)
    body = swimmer_of(tail).body.resistance(1.0)
    for phase in (0.0, 1.0):
        moved = T @ about_joint.resistance(phase) @ T.T + body
        assert moved == pytest.approx(about_body.resistance(phase), abs=1e-12)
        push = T @ about_joint.propulsion(phase)
        assert push == pytest.approx(about_body.propulsion(phase), abs=1e-12)


@pytest.mark.parametrize("law", [ms.GrayHancock(), ms.GrayHancock(tip=True)])
def test_covariance_under_rotation_of_the_frame(law):
    """The same beat in a plane turned about s: everything turns with it, a tip with drag too."""
    angle = 0.7
    c, s_ = np.cos(angle), np.sin(angle)
    plane = ms.PlaneWaveTail(**WAVE, ramp=0.0)

    def turned(s, phase):
        P = plane.centreline(s, phase)[0]
        return np.stack([P[..., 0], c * P[..., 1], s_ * P[..., 1]], axis=-1)

    Q = np.kron(np.eye(2), [[1, 0, 0], [0, c, -s_], [0, s_, c]])
    tail = ms.CustomTail(shape=turned, length=2.0, radius=0.02, wavelength=2.0 / WAVE["waves"])
    one, other = (replace(swimmer_of(t), coefficients=law).gait() for t in (plane, tail))
    for phase in (0.0, 2.0):
        R = Q @ one.resistance(phase) @ Q.T
        assert other.resistance(phase) == pytest.approx(R, abs=1e-10)
        assert other.velocity(phase) == pytest.approx(Q @ one.velocity(phase), abs=1e-11)


def test_a_quarter_turn_of_the_helix_is_a_quarter_of_its_phase():
    """The closed series of the rotating helix against the quadrature at another phase."""
    from microswim.models.rft import gait as rft
    from microswim.models.rft import segment as kernels

    swimmer = swimmer_of(ms.HelicalTail(**WAVE, handedness="right"))
    gait, p = swimmer.gait(), rft.parameters(swimmer)
    phase = 1.234
    R, F, _ = kernels.wave_tail(kernels.HELIX, True, p, phase, *rft.rules(swimmer))
    body = swimmer.body.resistance(1.0)
    assert gait.resistance(phase) == pytest.approx(R + body, abs=1e-12)
    assert gait.propulsion(phase) == pytest.approx(F, abs=1e-12)
    assert rotate(F, 1.0).shape == (3, 6)


def test_scallop_goes_nowhere():
    """A beat that is its own reverse: standing instead of travelling (Purcell 1977)."""

    def standing(s, phase):
        q = 0.2 * s * np.cos(3 * s) * np.cos(phase)
        return np.stack([s + 0 * q, q, 0 * q], axis=-1)

    gait = swimmer_of(ms.CustomTail(shape=standing, length=1.5, radius=0.02)).gait()
    moves = np.abs(gait.velocity(PHASE)).max()
    screw = ms.screw(gait)
    assert np.abs(screw.displacement).max() < 1e-9 * moves
    assert screw.angle < 1e-9 * moves
    # and a travelling wave of the same size does go somewhere
    assert ms.screw(swimmer_of(ms.PlaneWaveTail(**WAVE)).gait()).speed > 1e-3


def test_small_amplitude_speed_is_gray_and_hancocks():
    """Long plane wave without body: u = -(c_n/c_t - 1) omega k b^2 / 2, error of order b^2.

    With whole waves, no ramp and only u_s free nothing else moves (Gray & Hancock 1955).
    """
    errors = []
    for b in (0.02, 0.01, 0.005):
        tail = ms.PlaneWaveTail(length=4.0, amplitude=b, waves=4, radius=1e-3, ramp=0.0)
        gait = swimmer_of(tail, ms.NoBody(), motion=ms.Motion(free=("us",))).gait()
        expected = -(2.0 / 1.2 - 1) * tail.rate * tail.wavenumber * b**2 / 2
        errors.append(abs(gait.mean_velocity[0] / expected - 1))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)


@pytest.mark.parametrize(("tail", "last"), [(ms.HelicalTail, 1e-13), (ms.PlaneWaveTail, 1e-11)])
def test_quadrature_converges_spectrally(tail, last):
    """Each eight nodes more divide the error by more than the eight before; then rounding."""
    swimmer = swimmer_of(tail(**WAVE))
    exact = swimmer.gait(nodes=160).resistance(0.4)
    errors = [
        np.abs(swimmer.gait(nodes=n).resistance(0.4) - exact).max() / np.abs(exact).max()
        for n in (4, 12, 20, 28)
    ]
    assert errors[1] < errors[0] / 10
    assert errors[2] < errors[1] / 30
    chosen = np.abs(swimmer.gait().resistance(0.4) - exact).max() / np.abs(exact).max()
    assert chosen < last


def test_held_degrees_of_freedom_do_not_move():
    swimmer = swimmer_of(ms.HelicalTail(**WAVE), motion=ms.Motion(free=("us", "os")))
    V = swimmer.gait().velocity(PHASE)
    assert (V[:, [1, 2, 4, 5]] == 0).all()
    assert (V[:, [0, 3]] != 0).all()


def test_a_body_of_no_resistance_and_no_tail_is_refused():
    line = ms.HelicalTail(length=1.0, amplitude=0.0, waves=1, radius=0.01)
    nothing = swimmer_of(
        line, ms.NoBody(), coefficients=ms.Constant(normal=1, tangential=1, spin=False)
    )
    with pytest.raises(ms.MicroswimError, match="singular"):
        nothing.gait().velocity(0.0)


def test_a_helix_of_many_turns_costs_no_more_than_its_turns():
    """One long Gauss rule took memory by the square of the turns; the answers agree across."""
    helix = ms.Swimmer.preset("tabak/helix")
    long = helix.with_({"tail.length": 400.0, "tail.waves": 200.0})
    few, many = (rft_gait._helix(True, rft_gait.parameters(long), n, long) for n in (None, 4000))
    for a, b in zip(few, many):
        assert np.allclose(a, b, rtol=1e-8, atol=1e-8 * np.abs(b).max())
    for waves in (1e5, 3e22):
        changes = {"tail.length": waves, "tail.waves": waves}
        with pytest.raises(ms.SpecError, match="at most"):
            helix.with_(changes).gait()
        batch = ms.evaluate(helix, {name: [value, 3.0] for name, value in changes.items()})
        assert np.isnan(batch["swimming_speed"][0])
        assert np.isfinite(batch["swimming_speed"][1])
