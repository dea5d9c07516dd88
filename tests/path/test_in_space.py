"""Paths in fields that depend on place: drift, energy, and the limit of a uniform field."""

import numpy as np
import pytest

import microswim as ms
from microswim.numerics.rigid_motion import rotation_matrix
from microswim.swimmer.magnetism.applied_field import RotatingField

um = 1e-6


def robot(**changes):
    return ms.Swimmer(
        body=ms.Sphere(radius=500 * um),
        tail=ms.HelicalTail(
            length=2e-3, amplitude=200 * um, waves=2, radius=100 * um, frequency=0.0
        ),
        fluid=ms.Fluid(viscosity=0.34),
        coefficients=ms.GrayHancock(),
        units="SI",
        **changes,
    )


class Elsewhere(RotatingField):
    """A uniform field that is taken for one that depends on place."""

    is_periodic = False


def test_in_a_uniform_field_both_ways_agree():
    gait, times = robot().gait(), np.linspace(0.0, 2.0, 11)
    given = {"strength": 2e-3, "frequency": 1.5, "axis": (1, 0, 1), "cone": 0.3}
    loads = {"rate": 0.0, "moment": (1e-6, 3e-6, 0), "flow": (0, 1e-4, 0), "force": (0, 0, -1e-8)}
    one = ms.trajectory(gait, times, field=ms.RotatingField(**given), **loads)
    other = ms.trajectory(gait, times, field=Elsewhere(**given), **loads)
    assert other.position.values == pytest.approx(one.position.values, rel=1e-5, abs=1e-10)
    assert other.quaternion.values == pytest.approx(one.quaternion.values, abs=1e-6)


def test_a_sphere_in_a_gradient_drifts_at_mobility_times_force():
    """Stokes: a bead, moment along the field of a dipole on its axis, ``F = m dB/dz``."""
    radius, viscosity = 0.5e-3, 0.34
    bead = robot().with_({"tail.length": 1e-4, "tail.amplitude": 1e-9, "tail.radius": 1e-5})
    gait = bead.gait()
    field = ms.DipoleField(moment=(5.0, 0, 0), position=(-0.08, 0, 0))
    m = 1e-6
    path = ms.trajectory(gait, [0.0, 1e-3], rate=0.0, moment=(m, 0, 0), field=field)
    B = 4e-7 * np.pi * 5.0 / (2 * np.pi * 0.08**3)
    pull = -3.0 * m * B / 0.08
    drag = gait.resistance(0.0)[0, 0]
    assert path.position.values[-1, 0] / 1e-3 == pytest.approx(pull / drag, rel=1e-4)
    assert drag == pytest.approx(6 * np.pi * viscosity * radius, rel=0.05)
    assert np.abs(path.position.values[-1, 1:]).max() < 1e-6 * abs(path.position.values[-1, 0])


def test_what_the_field_gives_the_fluid_takes():
    """Steady field: ``-d(m . B)/dt`` along the path is the power ``V . R V`` that is dissipated."""
    gait = robot().gait()
    field = ms.DipoleField(moment=(0.4, -0.3, 0.6), position=(-0.05, 0.01, 0.02))
    m, times = np.array([1e-6, 2e-6, -1e-6]), np.linspace(0.0, 1.0, 2001)
    path = ms.trajectory(gait, times, rate=0.0, moment=m, field=field)
    x, Q = path.position.values, rotation_matrix(path.quaternion.values)
    lab = Q @ m
    energy = -np.sum(lab * field.at(times, x), axis=1)
    power = []
    for place, turn, dipole in zip(x, Q, lab):
        pull = field.gradient(0.0, place).T @ dipole
        torque = np.cross(dipole, field.at(0.0, place))
        wrench = np.concatenate([turn.T @ pull, turn.T @ torque])
        V = gait.velocity(0.0, 0.0, wrench)
        power.append(V @ gait.resistance(0.0) @ V)
    spent = np.trapezoid(power, times)
    assert energy[0] - energy[-1] == pytest.approx(spent, rel=1e-4)
    assert spent > 0


def test_a_field_in_space_needs_a_moment():
    field = ms.DipoleField(moment=(0.4, -0.3, 0.6), position=(-0.05, 0.01, 0.02))
    with pytest.raises(ms.SpecError, match="moment"):
        ms.trajectory(robot().gait(), [0.0, 1.0], rate=0.0, field=field)


def test_a_path_into_the_source_ends_in_a_sentence():
    field = ms.DipoleField(moment=(500.0, 0, 0), position=(-0.01, 0, 0))
    with pytest.raises(ms.MicroswimError, match="the source of the field"):
        ms.trajectory(
            robot().gait(), [0.0, 1e3], rate=0.0, moment=(1e-5, 0, 0), field=field, max_step=1.0
        )
