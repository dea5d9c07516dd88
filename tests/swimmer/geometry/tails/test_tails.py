"""Centrelines: derivatives, hands, lengths, and tails of any function."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe, ellipk

import microswim as ms
from microswim.swimmer.fields import lifted

WAVE = {"length": 2.0, "amplitude": 0.1, "waves": 2.3, "radius": 0.03}
TAILS = [
    ms.HelicalTail(**WAVE),
    ms.HelicalTail(**WAVE, handedness="right", ramp=0.4),
    ms.PlaneWaveTail(**WAVE, ramp=0.0),
]


@pytest.mark.parametrize("tail", TAILS)
def test_slope_and_velocity_are_derivatives_of_the_position(tail):
    s, phase = np.array([0.05, 0.5, 1.9])[:, None], np.array([0.0, 1.0, 4.0])
    _, slope, velocity = tail.centreline(s, phase)
    assert np.imag(tail.centreline(s + 1e-30j, phase)[0]) / 1e-30 == pytest.approx(slope, abs=1e-12)
    step = np.imag(tail.centreline(s, phase + 1e-30j)[0]) / 1e-30
    assert step == pytest.approx(velocity, abs=1e-12)


def test_the_two_hands_are_mirror_images():
    left, right = (ms.HelicalTail(**WAVE, handedness=h) for h in ("left", "right"))
    for a, b in zip(left.centreline(1.3, 0.7), right.centreline(1.3, 0.7)):
        assert a * [1, 1, -1] == pytest.approx(b)


def test_left_handed_helix_turns_positively():
    """dP/dphase = e_s x P off the axis, as a rigid rotation about +s [Tabak, Fig. 1a]."""
    P, _, velocity = ms.HelicalTail(**WAVE).centreline(1.3, 0.7)
    assert np.cross([1, 0, 0], P) == pytest.approx(velocity)


@pytest.mark.parametrize("kind", [ms.HelicalTail, ms.PlaneWaveTail])
@pytest.mark.parametrize("wave", [{"waves": 3.0}, {"wavelength": 0.6}])
def test_arc_length_is_the_length_of_the_filament(kind, wave):
    fields = {"length": 2.0, "amplitude": 0.1, "radius": 0.01, "ramp": 0.0} | wave
    tail = kind(**fields, length_measure="arc", sections="sheared")
    k = tail.wavenumber

    def speed(s):
        return np.linalg.norm(tail.centreline(s, 0.0)[1])

    turn = 2 * np.pi / k  # the waves are alike, one of them will do
    per_length = quad(speed, 0.0, turn, epsabs=1e-11)[0] / turn
    assert per_length * tail.apparent_length == pytest.approx(2.0, rel=1e-9)


def beat_of(tail):
    """The tail as a function of s and phase, written out again on purpose."""
    b, k, sign = tail.amplitude, tail.wavenumber, tail.sign

    def shape(s, phase):
        b_s = b * np.minimum(1.0, s / (tail.ramp * tail.length))
        q = b_s * np.cos(k * s - phase)
        r = -sign * b_s * np.sin(k * s - phase) if tail.kind == "helix" else 0 * q
        return np.stack([s + 0 * q, q, r], axis=-1)

    return shape


@pytest.mark.parametrize("tail", TAILS[:2] + [ms.PlaneWaveTail(**WAVE)])
@pytest.mark.parametrize("body", [ms.Sphere(radius=0.4), ms.Ellipsoid(semi_axes=(0.6, 0.4, 0.2))])
def test_custom_tail_of_the_same_shape_gives_the_same_gait(tail, body):
    custom = ms.CustomTail(
        shape=beat_of(tail),
        length=tail.length,
        radius=tail.radius,
        breaks=(tail.ramp,),
        sign=tail.sign,
        surface_motion=tail.surface_motion,
    )
    fluid, law = ms.Fluid(viscosity=3.0), ms.Constant(normal=4.0, tangential=2.5)
    gaits = [
        ms.Swimmer(body=body, tail=t, fluid=fluid, coefficients=law).gait() for t in (tail, custom)
    ]
    phase = np.linspace(0.0, 6.0, 7)
    for name in ("resistance", "propulsion", "activity"):
        one, other = (getattr(g, name)(phase) for g in gaits)
        assert other == pytest.approx(one, abs=2e-11 * np.abs(one).max()), name


@pytest.mark.parametrize("hand", ["left", "right"])
@pytest.mark.parametrize("cone", [0.0, 0.8])
def test_the_sense_of_a_rigid_tail_is_that_of_its_motion(hand, cone):
    """Found where it is left out; said wrongly, such a tail swam backwards in one model."""
    plain = ms.HelicalTail(**WAVE, handedness=hand)
    beat, fields = beat_of(plain), {"length": 2.0, "radius": 0.03, "breaks": (0.1,)}

    def shape(s, phase):
        return beat(s, phase) * np.stack(np.broadcast_arrays(1.0, 1 + cone * s, 1 + cone * s), -1)

    found = ms.CustomTail(shape=shape, surface_motion="rigid", **fields)
    assert found.sign == plain.sign
    with pytest.raises(ms.SpecError, match=r"tail\.sign = .* itself turns"):
        ms.CustomTail(shape=shape, surface_motion="rigid", sign=-plain.sign, **fields)


def test_what_does_not_turn_as_a_whole_is_not_rigid():
    flat = beat_of(ms.PlaneWaveTail(**WAVE))
    fields = {"length": 2.0, "radius": 0.03, "breaks": (0.1,)}
    with pytest.raises(ms.SpecError, match="turns it as a whole"):
        ms.CustomTail(shape=flat, surface_motion="rigid", **fields)
    assert ms.CustomTail(shape=flat, **fields).sign == 1.0


def test_custom_tail_must_be_smooth_and_periodic():
    fields = {"length": 1.0, "radius": 0.01}

    def kinked(s, phase):
        q = 0.1 * np.abs(s - 0.3) * np.cos(phase)
        return np.stack([s + 0 * q, q, 0 * q], axis=-1)

    def drifting(s, phase):
        q = 0.1 * s * phase
        return np.stack([s + 0 * q, q, 0 * q], axis=-1)

    with pytest.raises(ms.SpecError, match=r"tail\.breaks"):
        ms.CustomTail(shape=kinked, **fields)
    ms.CustomTail(shape=kinked, breaks=(0.3,), **fields)
    with pytest.raises(ms.SpecError, match="periodic"):
        ms.CustomTail(shape=drifting, **fields)
    with pytest.raises(ms.SpecError, match="finite positions"):
        ms.CustomTail(shape=lambda s, phase: s * phase, **fields)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"radius": -0.1}, r"tail\.radius = -0\.1"),
        ({"wavelength": 1.0}, "one of the two"),
        ({"waves": None}, "one of the two"),
        ({"radius": 0.4}, "touches itself"),
        ({"waves": 30, "radius": 0.04}, "touches itself"),
        ({"length_measure": "arc", "waves": 4.0}, "windings"),
        ({"ramp": 1.5}, r"tail\.ramp"),
        ({"handedness": "up"}, r"tail\.handedness"),
        ({"frequency": float("inf")}, r"tail\.frequency"),
    ],
)
def test_senseless_tails_are_refused(changes, words):
    with pytest.raises(ms.SpecError, match=words):
        ms.HelicalTail(**({**WAVE, "waves": 3} | changes))


def test_turns_touch_when_their_centrelines_are_a_diameter_apart():
    """The room left by a coil, against the distance of sampled points of its centreline."""
    tail = ms.HelicalTail(length=1.0, amplitude=0.1, waves=10, radius=0.01, ramp=0.0)
    theta = np.linspace(0.5, 1.5, 20001) * 2 * np.pi / tail.wavenumber
    P = tail.centreline(theta, 0.0)[0] - tail.centreline(0.0, 0.0)[0]
    assert float(tail.room()) == pytest.approx(np.linalg.norm(P, axis=1).min() / 2, rel=1e-3)


@pytest.mark.parametrize("steepness", [0.0, 1e-6, 0.3, 2.0, 50.0, 1e4])
def test_a_plane_wave_is_as_long_as_the_elliptic_integral_says(steepness):
    tail = ms.PlaneWaveTail(length=2.0, amplitude=0.1, waves=3, radius=0.01)
    wanted = 2.0 / np.pi * ellipe(-(steepness**2))
    assert tail.stretch(steepness) == pytest.approx(wanted, rel=1e-14)
    h = 1e-30j
    if steepness > 1e-6:  # below it the closed form of the slope cancels, this one does not
        slope = 2.0 / np.pi / steepness
        slope *= ellipe(-(steepness**2)) - ellipk(-(steepness**2))
        assert tail.stretch(steepness + h).imag / h.imag == pytest.approx(slope, rel=1e-12)


def test_an_arc_length_is_met_and_what_it_cannot_hold_is_no_number():
    tail = ms.PlaneWaveTail(amplitude=0.1, waves=3, length=2.0, radius=0.01, length_measure="arc")
    assert tail.apparent_length * tail.stretch(tail.amplitude * tail.wavenumber) == pytest.approx(
        2.0, rel=1e-14
    )
    swimmer = ms.Swimmer.preset("tabak/plane_wave").with_({"tail.length_measure": "arc"})
    own = swimmer.tail
    most = own.length / 4.0 / own.number_of_waves
    many = lifted(swimmer, {"tail.amplitude": np.array([0.5, 0.999, 1.001]) * most}).tail
    assert list(np.isfinite(many.apparent_length)) == [True, True, False]
