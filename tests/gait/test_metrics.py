"""Exact derivatives against central differences, designs in batches against one by one."""

import numpy as np
import pytest

import microswim as ms
from microswim.gait.observed import output
from microswim.swimmer.fields import lifted

OUTPUTS = ["mean_velocity", "swimming_speed", "efficiency", "mean_power", "path_radius"]


def central_difference(swimmer, name, path):
    """Of order 4, with the step that balances truncation and rounding."""
    x = swimmer.numbers[path]
    h = 1e-3 * max(abs(x), 0.05)

    def at(n):
        return output(lifted(swimmer, {path: x + n * h}).gait(), name)

    return (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h)


CASES = {
    "helix": ms.Swimmer.preset("tabak/helix"),
    "arc": ms.Swimmer.preset("tabak/helix", {"tail.length_measure": "arc", "tail.length": 3.0}),
    "ellipsoid": ms.Swimmer.preset(
        "tabak/helix",
        {
            "body": {"shape": "ellipsoid", "semi_axes": [0.6, 0.4, 0.3]},
            "coefficients.law": "cox",
            "tail.frequency": -2.0,
            "interaction.coupling": [[0, 0, 0], [0, 0, 0.1], [0, -0.1, 0]],
        },
    ),
    "plane_wave": ms.Swimmer.preset("tabak/plane_wave"),
}


@pytest.mark.parametrize("case", ["helix", "arc", "ellipsoid"])
@pytest.mark.parametrize("name", OUTPUTS)
def test_gradient_of_everything(case, name):
    swimmer = CASES[case]
    check_gradient(swimmer, name, list(swimmer.numbers))


@pytest.mark.parametrize("name", OUTPUTS[:-1])
def test_gradient_of_a_plane_wave(name):
    """In the plane; a coupling that turns it out of the plane makes the speed jump (a screw)."""
    paths = ["tail.amplitude", "tail.waves", "tail.ramp", "body.radius", "interaction.rotation[2]"]
    check_gradient(CASES["plane_wave"], name, paths)


def check_gradient(swimmer, name, paths):
    scale = np.abs(output(swimmer.gait(), name)).max()
    for path, exact in swimmer.gradient(name, paths).items():
        approximate = central_difference(swimmer, name, path)
        size = max(np.abs(exact).max(), scale)
        assert exact == pytest.approx(approximate, abs=3e-8 * size), path


def test_gradient_of_the_lateral_amplitude():
    swimmer = CASES["plane_wave"]
    for path in ("tail.amplitude", "tail.waves", "body.radius"):
        exact = swimmer.gradient("velocity_amplitude", path)[path][[0, 1, 5]]
        approximate = central_difference(swimmer, "velocity_amplitude", path)[[0, 1, 5]]
        assert exact == pytest.approx(approximate, rel=1e-6)


def test_gradient_of_what_is_not_there():
    with pytest.raises(ms.SpecError, match="did you mean"):
        CASES["helix"].gradient("mean_velocity", "tail.amplitud")
    with pytest.raises(ms.SpecError, match="output"):
        CASES["helix"].gradient("colour", "tail.amplitude")


def test_summary_knows_what_one_asks_for():
    made = ms.summary(CASES["helix"].gait())
    assert made["swimming_speed"] <= np.linalg.norm(made["mean_velocity"][:3]) * 1.01


DESIGNS = {
    "tail.amplitude": np.array([0.05, 0.1, 0.14, 0.08]),
    "tail.waves": np.array([1.0, 2.5, 3.1, 0.7]),
    "body.radius": np.array([0.5, 0.3, 0.6, 0.4]),
}


@pytest.mark.parametrize(
    ("preset", "overrides"),
    [
        ("tabak/helix", {}),
        ("tabak/helix", {"tail.handedness": "right", "tail.frequency": -2.0}),
        ("tabak/helix-constant", {"motion.frequency_frame": "lab"}),
        ("tabak/plane_wave", {}),
        ("tabak/plane_wave-constant", {}),
        ("tabak/helix", {"coefficients.tip": True}),
        ("tabak/plane_wave", {"coefficients.tip": True}),
    ],
)
def test_batch_equals_one_by_one(preset, overrides):
    swimmer = ms.Swimmer.preset(preset, overrides)
    many = ms.evaluate(swimmer, DESIGNS)
    for i in range(4):
        one = ms.summary(swimmer.with_({k: v[i] for k, v in DESIGNS.items()}).gait())
        for name, values in many.items():
            scale = np.abs(one[name]).max()
            # amplitudes of plane waves are read off interpolated samples
            tolerance = 1e-6 if name == "velocity_amplitude" else 1e-8
            assert values[i] == pytest.approx(one[name], abs=tolerance * scale), name


def test_batch_without_symmetry_and_of_lists():
    swimmer = ms.Swimmer.preset("tabak/helix")
    values = {"interaction.translation[1]": np.array([1.0, 2.0])}
    many = ms.evaluate(swimmer, values)
    one = swimmer.with_({"interaction.translation": (1.0, 2.0, 1.0)}).gait()
    assert many["mean_velocity"][1] == pytest.approx(one.mean_velocity, abs=1e-12)


def test_batch_marks_what_cannot_be_built():
    swimmer = ms.Swimmer.preset("tabak/helix")
    many = ms.evaluate(
        swimmer,
        {
            "tail.radius": np.array([0.05, -0.05, 0.3, 0.05, 0.05]),
            "tail.waves": np.array([3.0, 3.0, 3.0, 8.0, 2.0]),
            "tail.amplitude": np.array([0.1, 0.1, 0.1, 0.01, 0.1]),
        },
    )
    for name, values in many.items():
        bad = np.isnan(values).reshape(5, -1).any(axis=1)
        assert bad.tolist() == [False, True, True, True, False], name


def test_batch_of_more_than_a_chunk():
    swimmer = ms.Swimmer.preset("tabak/helix")
    b = np.linspace(0.02, 0.15, 9001)
    u = ms.evaluate(swimmer, {"tail.amplitude": b})["mean_velocity"][:, 0]
    few = ms.evaluate(swimmer, {"tail.amplitude": b[[0, 8191, 8192, 9000]]})["mean_velocity"][:, 0]
    assert u[[0, 8191, 8192, 9000]] == pytest.approx(few, rel=1e-13)
    assert (np.diff(u) < 0).all()
