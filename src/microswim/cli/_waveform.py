"""``microswim identify`` of a beat: a filament traced frame by frame."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from microswim.cli import _files
from microswim.cli._options import print_json
from microswim.numerics.files import fresh, write

PICTURE, MODES = "beat.png", "tail.toml"


def identify(
    path: Path, pixel: str | None, fps: str | None, out: Path | None, force: bool, as_json: bool
) -> None:
    """Fit the beat, tell what was found, draw it and write it as the tail of a spec."""
    from microswim.cli._progress import bar
    from microswim.spec.readers.beat import read_waveform

    if out is not None:
        _files.check_files("--out", out, [PICTURE, MODES], force)
    with bar(f"identify {path.name}"):
        found = read_waveform(path, pixel=pixel, fps=fps)
    result = {"units": "SI", "waveform": found.as_dict()}
    if out is not None:
        with _files.or_else(lambda: _show(found, result, as_json)):
            _write(path, found, out)
        result["picture"] = str(out / PICTURE)
    _show(found, result, as_json)


def _write(path: Path, found: Any, out: Path) -> None:
    """Draw the beat and write it as the tail of a spec."""
    from microswim.output.plots.cells import beat
    from microswim.spec.toml import to_toml

    figure = beat(found, "m")
    with fresh(out / PICTURE) as scratch:
        figure.savefig(scratch, dpi=150)
    tail = {
        "kind": "waveform", "modes": found.modes.tolist(), "length": f"{found.length!r} m",
        "frequency": f"{found.frequency!r} Hz",
    }  # fmt: skip
    if found.modes_out is not None:
        tail["modes_out"] = found.modes_out.tolist()
    write(out / MODES, to_toml({"tail": tail}, f"the beat of {path.name}; add a radius"))


def _show(found: Any, result: dict[str, Any], as_json: bool) -> None:
    from microswim.gait.readable import quantity, with_error

    if as_json:
        return print_json(result)
    numbers = result["waveform"]
    relative = 1.96 * found.frequency_error / abs(found.frequency)
    rows, harmonics = found.modes.shape[0], found.modes.shape[1] // 2
    plane = "" if found.modes_out is not None else " and in a plane"
    unit = "rad" if found.beat.angle is not None else "m"
    for name, text in (
        ("frequency", with_error(found.frequency, relative, "Hz") + "   (95 %)"),
        ("beats filmed", f"{numbers['beats']:.3g} in {numbers['frames']} frames"),
        ("length", quantity(found.length, "m")),
        ("wavelength", quantity(numbers["wavelength"], "m")),
        ("mean curvature", f"{found.mean_curvature / 1e3:.4g} rad/mm"),
        ("modes", f"{rows} along the filament, {harmonics} harmonics, by cross-validation"),
        ("misfit", quantity(found.misfit, unit) + ", per coordinate"),
        ("noise", quantity(found.noise, unit) + ", if the beat is periodic" + plane),
    ):
        click.echo(f"{name:16s} {text}")
    return None
