"""Solves of poses are found again by whatever has the same R and F_p."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import microswim as ms
from microswim.calibration.poses import alike, around, scattered, solved, wall
from microswim.jobs import references, store

SPEC = """
[fluid]
viscosity = "{viscosity}"
density = "{density}"
[body]
shape = "spheroid"
semi_axes = ["{a}", "{b}"]
[tail]
kind = "{kind}"
length = "{length}"
amplitude = "{amplitude}"
waves = {waves}
radius = "{radius}"
frequency = "{frequency}"
[motion]
free = {free}
[{boundary}
"""
MICRONS = {
    "viscosity": "1 mPa s", "density": "1000 kg/m^3", "a": "1.25 um", "b": "0.45 um",
    "length": "6.5 um", "amplitude": "0.2 um", "waves": "3", "radius": "0.012 um",
    "frequency": "130 Hz", "free": '"all"',
}  # fmt: skip
METRES = {
    "viscosity": "1e-3 Pa s", "density": "1.1 g/cm^3", "a": "1.25e-6 m", "b": "450 nm",
    "length": "0.0065 mm", "amplitude": "200 nm", "waves": "3.0", "radius": "12 nm",
    "frequency": "20 Hz", "free": '["us", "uq", "ur", "os"]',
}  # fmt: skip
WALL = 'wall]\ndistance = "0.7 um"', 'wall]\ndistance = "900 nm"\ntilt = 0.2'
TUBE = (
    'channel]\ndiameter = "4.1 um"\nlength = "40 um"',
    'channel]\ndiameter = "4.1e-6 m"\nlength = "60 um"\nposition = [0, "0.2 um", 0]',
)


class Enough(Exception):
    """Raised when all poses were asked for."""


def asked_for(
    spec: str, boundary: str, kind: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> list[Path | None]:
    """Return the files of all solves that the poses of a spec ask for, without solving them."""
    file, found = tmp_path / "spec.toml", []
    values = MICRONS if spec == "microns" else METRES
    file.write_text(SPEC.format(kind=kind, boundary=boundary, **values), "utf-8")
    swimmer = ms.Swimmer.from_toml(file)

    def gaits(swimmers: Any, model: str, *, level: Any, **_: Any) -> Any:
        found.extend([store.place(tmp_path, s, model, {"level": level}) for s in swimmers])
        if len(swimmers) > 1:
            raise Enough
        return [s.gait("rft") for s in swimmers]

    monkeypatch.setattr(references, "gaits", gaits)
    options: dict[str, Any] = {"grid": wall.Grid(gaps=3, tilts=2, phases=4, left_out=0)}
    if kind == "plane_wave":
        options = {}
    elif swimmer.channel is not None:
        options = {"scatter": scattered.Scatter(poses=40, left_out=0)}
    with pytest.raises(Enough):
        around.around(swimmer, **options)
    return found


@pytest.mark.parametrize(
    ("boundary", "kind"),
    [(WALL, "helix"), (WALL, "plane_wave"), (TUBE, "helix")],
    ids=["wall", "any-shape", "tube"],
)
def test_other_units_frequency_density_and_axes_find_the_same_solves(
    boundary: tuple[str, str], kind: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("microswim.calibration.poses.any_shape.POSES", 40)
    monkeypatch.setattr("microswim.calibration.poses.lines.MOST_LOOKS", 1)
    one = asked_for("microns", boundary[0], kind, monkeypatch, tmp_path)
    other = asked_for("metres", boundary[1], kind, monkeypatch, tmp_path)
    assert len(one) >= 17
    assert None not in one
    assert one == other


def test_what_was_left_out_is_put_back() -> None:
    """Rate, free axes and frame are the swimmer's own, R and F_p those of the solve."""
    short = ms.Swimmer.preset("tabak/helix").with_(
        {
            "tail.length": 0.8, "tail.waves": 1.0, "tail.frequency": -2.5, "fluid.density": 1.1,
            "motion.frequency_frame": "lab", "motion.free": ("us", "os"),
        }
    )  # fmt: skip
    level = replace(solved.FEW, single=True)
    whole = short.gait("bem", level=level)
    found = alike.of(alike.as_solved(short).gait("bem", level=level), short)
    assert found.free == whole.free
    assert found.rate == pytest.approx(whole.rate, rel=1e-12)
    assert np.array_equal(found.resistance_series, whole.resistance_series)
    assert np.array_equal(found.propulsion_series, whole.propulsion_series)
    assert found.mean_velocity == pytest.approx(whole.mean_velocity, rel=1e-12)


@pytest.mark.parametrize(
    "body",
    [
        ms.Sphere(radius=0.1 + 0.2),
        ms.Capsule(length=1.5, radius=0.1 + 0.2),
        ms.Cylinder(length=1.5, radius=0.1 + 0.2),
        ms.Box(size=(0.1 + 0.2, 0.5, 0.7)),
        ms.Ellipsoid(semi_axes=(0.1 + 0.2, 0.5, 0.4)),
        ms.Revolution(profile=[[0, 0], [0.1 + 0.2, 0.3], [0.8, 0.5], [1.2, 0.3], [1.3, 0]]),
    ],
    ids=lambda body: type(body).__name__,
)
def test_every_body_loses_its_last_bit(body: Any) -> None:
    swimmer = replace(ms.Swimmer.preset("tabak/helix"), body=body)
    found = alike.to_digits(swimmer).body
    assert "0.30000000000000004" in repr(body)
    assert "0.30000000000000004" not in repr(found)
    assert alike.to_digits(replace(swimmer, body=found)).body is found
