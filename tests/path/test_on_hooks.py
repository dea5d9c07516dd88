"""Tails on hooks: forces and moments of moving points, energy, stiff hooks, relaxation."""

from dataclasses import replace

import numpy as np
import pytest

import microswim as ms
from microswim.path.by_torque import at_phases
from microswim.path.motors import motors_of

WAVE = {"length": 2.0, "amplitude": 0.1, "waves": 3, "radius": 0.05}
LAW = ms.Constant(normal=4.0, tangential=2.3, spin=False)


def robot(count=2, hook=None, **more):
    tails = [
        ms.HelicalTail(
            **WAVE,
            position=(-0.1, 0.3 * np.cos(a), 0.3 * np.sin(a)),
            direction=(1.0, 0.3 * np.cos(a), 0.3 * np.sin(a)),
            handedness="right" if n == 1 else "left",
            phase=0.7 * n,
        )
        for n, a in enumerate(2.0 * np.pi * np.arange(count) / count)
    ]
    return ms.Swimmer(
        body=ms.Sphere(radius=0.5), tail=tails if count > 1 else tails[0],
        fluid=ms.Fluid(viscosity=1.0), coefficients=LAW, hook=hook, **more,
    )  # fmt: skip


def somewhere(motors, count, bend=0.5):
    rng = np.random.default_rng(5)
    axes = motors.axes + bend * rng.normal(size=(count, 3))
    return rng.uniform(0.0, 6.0, count), axes / np.linalg.norm(axes, axis=1)[:, None]


POINTS = 2000


def pieces(swimmer, n, phases, axes):
    """Points along a tail, in the body, tangents there and lengths."""
    s = (np.arange(POINTS) + 0.5) / POINTS * WAVE["length"]
    place, slope, _ = at_phases(swimmer, phases, axes).tail.each[n].centreline(s, 0.0)
    arc = np.linalg.norm(slope, axis=1)
    return place, slope / arc[:, None], arc * WAVE["length"] / POINTS


def forces(swimmer, n, state, moved):
    """Points from the body's centre, their velocities by differences, and the fluid's forces."""
    (phases, axes), (V, rate, swings), h = state, moved, 1e-6
    ahead, behind = (pieces(swimmer, n, phases + k * rate, axes + k * swings)[0] for k in (h, -h))
    X, t, length = pieces(swimmer, n, phases, axes)
    X = X - np.asarray(swimmer.body.centre)
    v = (ahead - behind) / (2.0 * h) + V[:3] + np.cross(V[3:], X)
    along = np.sum(v * t, axis=1)[:, None] * t
    return X, v, -(4.0 * (v - along) + 2.3 * along) * length[:, None]


def test_forces_and_moments_of_moving_points_vanish():
    """Of each tail about its hook, and of the swimmer: points of the tails moved by differences."""
    one = robot(3, ms.Hook(stiffness=(0.4, 0.9, 0.2), length=(0.1, 0.2, 0.1)))
    motors = motors_of(one, (1.3, -0.8, 1.0))
    phases, axes = state = somewhere(motors, 3)
    V, _, swings = moved = motors.moving(phases, axes)
    assert np.allclose(np.sum(swings * axes, axis=1), 0.0, atol=1e-12)
    total = -np.array(one.body.diagonal(1.0)) * V
    for n, tail in enumerate(one.tail.each):
        X, _, force = forces(one, n, state, moved)
        total += np.concatenate([force.sum(axis=0), np.cross(X, force).sum(axis=0)])
        d, e, theta = motors.axes[n], axes[n], np.arccos(motors.axes[n] @ axes[n])
        moment = np.cross(X - motors.roots[n], force).sum(axis=0)
        moment += motors.turning_back[n] * theta * np.cross(e, d) / np.sin(theta)
        moment += tail.sign * motors.law.torque[n] * (d + e) / (1.0 + d @ e)  # as a bent shaft does
        assert moment == pytest.approx(np.zeros(3), abs=2e-5)
    assert total == pytest.approx(np.zeros(6), abs=2e-5)


def test_the_work_of_the_motors_goes_into_fluid_and_hooks():
    one = robot(hook=ms.Hook(stiffness=0.05, length=0.1))
    motors = motors_of(one, 1.2)
    phases, axes = state = somewhere(motors, 2)
    V, rate, swings = moved = motors.moving(phases, axes)
    spent = float(np.array(one.body.diagonal(1.0)) @ V**2)
    for n in range(2):
        _, v, force = forces(one, n, state, moved)
        spent -= float(np.sum(v * force))
    more, less = (motors.stored(_unit(axes + k * swings)) for k in (1e-6, -1e-6))
    assert 1.2 * rate.sum() == pytest.approx(spent + (more - less) / 2e-6, rel=1e-5)


def test_stiff_hooks_are_none():
    """What they change falls with their stiffness."""

    def ends(**hook):
        one = robot(hook=ms.Hook(**hook, length=0.1) if hook else None)
        found = ms.own_motors(one, [0.0, 0.4], torque=(1.2, -1.0), tolerance=1e-6)
        return np.concatenate([found[name][-1] for name in ("phase", "position", "quaternion")])

    still = ends()
    off = [np.linalg.norm(ends(stiffness=B) - still) for B in (10.0, 20.0)]
    assert off[0] / off[1] == pytest.approx(2.0, rel=0.1)


def _unit(axes):
    return axes / np.linalg.norm(axes, axis=1)[:, None]


def test_a_bent_hook_straightens_as_its_stiffness_and_the_drag_say():
    """A thin, straight tail on a held body: ``theta' = - K theta / D``, D about its root."""
    straight = ms.HelicalTail(length=2.0, amplitude=1e-4, waves=3, radius=0.05)
    one = ms.Swimmer(
        body=ms.Sphere(radius=0.5), tail=straight, fluid=ms.Fluid(viscosity=1.0),
        coefficients=LAW, hook=ms.Hook(stiffness=0.3, length=0.1), motion=ms.Motion(free="none"),
    )  # fmt: skip
    times = np.linspace(0.0, 4.0, 5)
    found = ms.own_motors(one, times, torque=1e-12, axes=[(1.0, 0.5, 0.0)])
    bend = found.hook_bend.values[:, 0]
    drag = 4.0 * 2.0**3 / 3.0
    assert bend == pytest.approx(np.arctan(0.5) * np.exp(-3.0 * times / drag), rel=1e-4)
    assert found.hook_energy.values == pytest.approx(1.5 * bend**2)


@pytest.mark.parametrize(
    ("hook", "says"),
    [
        ({"stiffness": (1.0, 2.0, 3.0), "length": 0.1}, "one number, or 2"),
        ({"stiffness": (1.0, -2.0), "length": 0.1}, "hook.stiffness[1]"),
        ({"stiffness": 1.0, "length": (0.1, 0.7)}, "hook.length[1]"),
    ],
)
def test_a_hook_that_fits_no_tail_is_refused(hook, says):
    with pytest.raises(ms.SpecError, match=says.replace("[", r"\[")):
        robot(hook=ms.Hook(**hook))


def test_a_waving_tail_has_no_hook():
    wave = ms.PlaneWaveTail(**WAVE)
    with pytest.raises(ms.SpecError, match="rigid helices"):
        replace(robot(1), tail=wave, hook=ms.Hook(stiffness=1.0, length=0.1))


def test_boundary_elements_know_no_hooks():
    one = robot(hook=ms.Hook(stiffness=1.0, length=0.1))
    with pytest.raises(ms.SpecError, match=r"remove \[hook\]"):
        ms.own_motors(one, [0.0, 1.0], torque=1.0, model="bem")
    assert any("[hook] bends" in said for said in one.remarks)
