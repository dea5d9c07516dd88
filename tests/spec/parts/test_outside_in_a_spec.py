"""Gravity, flows and noise in a spec file: read, refused, written back."""

import numpy as np
import pytest

import microswim as ms
from microswim.spec.file import from_dict
from microswim.spec.readers.text import toml
from microswim.swimmer.surroundings.flow import FLOWS

SPEC = """
[fluid]
viscosity = "1 mPa s"
density = "1000 kg/m^3"
[body]
shape = "sphere"
radius = "1 um"
[tail]
kind = "helix"
length = "6 um"
amplitude = "0.25 um"
waves = 2
radius = "20 nm"
frequency = "100 Hz"
"""
FLOW = {
    "uniform": 'speed = "2 mm/s"\ndirection = [0, 1, 0]',
    "shear": 'rate = "10 1/s"\nacross = [0, 1, 0]',
    "strain": 'rate = "10 1/s"\ncompression = [0, 0, 1]',
    "rotation": 'rate = "10 1/s"\naxis = [1, 0, 0]',
    "poiseuille": 'speed = "2 mm/s"\ndiameter = "1 mm"\ncentre = ["1 um", "0 um", "0 um"]',
}


def swimmer(more):
    return from_dict(toml(SPEC + more, "spec"))


@pytest.mark.parametrize("kind", FLOWS)
def test_a_flow_is_read_written_and_read_again(kind):
    one = swimmer(f'[flow]\nkind = "{kind}"\n{FLOW[kind]}\n')
    assert one.flow.kind == kind
    assert from_dict(toml(one.to_toml(), "again")) == one


def test_a_shear_rate_is_no_frequency_of_turns():
    assert swimmer('[flow]\nkind = "shear"\nrate = "10 1/s"\n').flow.rate == 10.0


@pytest.mark.parametrize("kind", FLOWS)
def test_no_flow_has_a_source_and_its_gradient_is_its_change(kind):
    flow = swimmer(f'[flow]\nkind = "{kind}"\n{FLOW[kind]}\n').flow
    h = 1e-5
    x = np.array([2e-4, -1e-4, 3e-4])
    steps = h * np.eye(3)
    slope = (flow.at(x + steps) - flow.at(x - steps)).T / (2.0 * h)
    assert abs(np.trace(slope)) < 1e-6 * max(np.abs(slope).max(), 1.0)
    if not flow.bends:
        assert np.allclose(slope, flow.gradient, atol=1e-8)


def test_a_flow_in_a_tube_is_as_wide_as_the_channel():
    flow = '[flow]\nkind = "poiseuille"\nspeed = "1 mm/s"\n'
    with pytest.raises(ms.SpecError, match=r"flow.diameter: missing"):
        swimmer(flow)
    wide = swimmer(flow + '[channel]\ndiameter = "50 um"\nlength = "99 um"\n')
    assert wide.flow.diameter == pytest.approx(50e-6)
    assert np.allclose(wide.flow.at((0.0, 25e-6, 0.0)), 0.0)


def test_gravity_and_noise_are_read_written_and_read_again():
    one = swimmer('[gravity]\nbody_density = "1100 kg/m^3"\ntail_density = "1300 kg/m^3"\n'
                  '[noise]\ntemperature = "298 K"\n')  # fmt: skip
    assert one.gravity.densities == (1100.0, 1300.0)
    assert one.noise.energy("SI") == pytest.approx(298.0 * 1.380649e-23, rel=1e-12)
    assert from_dict(toml(one.to_toml(), "again")) == one


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("[gravity]\n", "gravity: give density"),
        ('[gravity]\nbody_density = "1 g/cm^3"\n', "both body_density and tail_density"),
        ("[gravity]\ndensity = 1200\n", "gravity.density: must have a unit"),
        ('[gravity]\ndensity = "1200 kg/m^3"\ndirection = [0, 0, 0]\n', "gravity.direction"),
        ('[flow]\nkind = "shear"\nrate = "1 m/s"\n', "flow.rate"),
        ('[flow]\nkind = "vortex"\n', "flow.kind"),
        ('[flow]\nkind = "shear"\nrate = "1 1/s"\nacross = [1, 0, 1]\n', "flow.across"),
        ('[flow]\nkind = "strain"\nrate = "1 1/s"\ncompression = [1, 0, 1]\n', "perpendicular"),
        ('[noise]\ntemperature = "-3 K"\n', "noise.temperature"),
        ('[noise]\ntemperature = "25"\n', "noise.temperature"),
        ("[noise]\n", "noise.temperature: missing"),
    ],
)
def test_what_is_wrong_is_said_in_a_sentence(more, said):
    with pytest.raises(ms.SpecError) as caught:
        swimmer(more)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_buoyancy_needs_the_fluids_density_and_a_spec_without_units_the_acceleration():
    bare = SPEC.replace('density = "1000 kg/m^3"\n', "")
    with pytest.raises(ms.SpecError, match=r"fluid.density: missing"):
        from_dict(toml(bare + '[gravity]\ndensity = "1200 kg/m^3"\n', "spec"))
    plain = ms.Swimmer.preset("tabak/helix").to_toml()
    with pytest.raises(ms.SpecError, match=r"gravity.acceleration: missing"):
        from_dict(toml(plain + "[gravity]\ndensity = 2.0\n", "spec"))
