"""What a swimmer writes of itself reads back as the same swimmer."""

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import microswim as ms
from microswim.calibration.region.text import pack
from microswim.errors import MicroswimError
from microswim.spec.file import from_dict

sizes = st.floats(1e-6, 1e3)  # within what a file may hold
shares = st.floats(0.01, 0.99)
factors = st.floats(0.5, 2.0)
angles = st.sampled_from([0.0, -0.3, 1.5, 1e-9, 0.1 + 0.2])
triples = st.tuples(factors, factors, factors)

bodies = st.one_of(
    st.builds(ms.Sphere, radius=sizes),
    st.builds(ms.Spheroid, semi_axes=st.tuples(sizes, sizes)),
    st.builds(ms.Ellipsoid, semi_axes=st.tuples(sizes, sizes, sizes)),
    st.just(ms.NoBody()),
)
laws = st.one_of(
    *(st.builds(law, spin=st.booleans(), tip=st.booleans()) for law in (ms.GrayHancock, ms.Cox)),
    st.builds(ms.Lighthill, tip=st.booleans()),
    st.builds(ms.Constant, normal=sizes, tangential=sizes),
)
motions = st.builds(
    ms.Motion,
    free=st.sampled_from(["all", ("us", "os"), ("us",)]),
    line_element=st.sampled_from(["arc", "apparent"]),
)


@st.composite
def tails(draw):
    length = draw(sizes)
    wave = {
        "length": length,
        "radius": draw(st.floats(1e-4, 1e-2)) * length,
        "amplitude": draw(st.just(0.0) | st.floats(1e-3, 0.05)) * length,
        "frequency": draw(st.floats(-1e3, -1e-3) | st.just(0.0) | st.floats(1e-3, 1e3)),
        "ramp": draw(shares),
    }
    waves = draw(st.floats(0.5, 3.0))
    wave |= {"waves": waves} if draw(st.booleans()) else {"wavelength": length / waves}
    if draw(st.booleans()):
        return ms.PlaneWaveTail(**wave)
    return ms.HelicalTail(**wave, handedness=draw(st.sampled_from(["left", "right"])))


@st.composite
def swimmers(draw):
    parts = {
        "body": draw(bodies),
        "tail": draw(tails()),
        "fluid": ms.Fluid(viscosity=draw(sizes), density=draw(st.just(0.0) | st.floats(1e-3, 1e4))),
        "motion": draw(motions),
        "interaction": ms.Interaction(
            translation=draw(triples), rotation=draw(triples), tail=draw(triples)
        ),
        "units": draw(st.sampled_from(["SI", "dimensionless"])),
    }
    if draw(st.booleans()):
        parts["coefficients"] = draw(laws)
    if draw(st.booleans()):
        parts["wall"] = ms.Wall(distance=draw(sizes), tilt=draw(angles), azimuth=draw(angles))
    elif draw(st.booleans()):
        parts["channel"] = ms.Channel(diameter=draw(sizes), length=draw(sizes), tilt=draw(angles))
    try:
        return ms.Swimmer(**parts)
    except MicroswimError:
        return ms.Swimmer.preset("tabak/helix")


@settings(max_examples=150, deadline=None)
@given(swimmers())
def test_every_swimmer_comes_back(swimmer):
    """To the last bit, and with a law chosen where one was chosen and nowhere else."""
    back = from_dict(tomllib.loads(swimmer.to_toml()))
    assert back == swimmer
    assert type(back.coefficients) is type(swimmer.coefficients)
    assert back.to_toml() == swimmer.to_toml()


@pytest.mark.parametrize("name", ["tabak/helix", "goto/C", "tabak/plane_wave"])
def test_a_preset_is_written_and_read_as_a_file(name, tmp_path):
    swimmer, path = ms.Swimmer.preset(name), tmp_path / "written.toml"
    path.write_text(swimmer.to_toml(), encoding="utf-8")
    back = ms.Swimmer.from_toml(path)
    assert back == swimmer
    assert back.gait().mean_velocity.tolist() == swimmer.gait().mean_velocity.tolist()


def test_a_region_calibration_goes_along():
    helix = ms.Swimmer.preset("tabak/helix")
    region = {"tail.amplitude": (0.08, 0.12)}
    fitted = ms.calibrate_region(helix, region, "rft", solves=8, workers=0).swimmer
    back = from_dict(tomllib.loads(fitted.to_toml()))
    assert pack(back.region) == pack(fitted.region)
