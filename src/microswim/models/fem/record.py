"""The march in time as plain arrays: checkpoint, resume, and the Dataset that comes out."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from microswim.errors import MicroswimError
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.models.fem.navier_stokes import Past
from microswim.numerics import archive
from microswim.numerics.files import write

CONTENT = "march 1"
MOST_BYTES = 1 << 36  # unpacked; of 10^8 unknowns
FORCES = ["fs", "fq", "fr", "ts", "tq", "tr"]


@dataclass(frozen=True)
class March:
    """State after `step` steps: the past flow, twist (lab axes), pose, and one row a step.

    A row: twist (6), wrench on body (6) and tail (6), displacement (3), quaternion xyzw (4).
    """

    step: int
    past: Past
    twist: np.ndarray
    twist_old: np.ndarray
    shift: np.ndarray
    turn: np.ndarray
    rows: np.ndarray

    @classmethod
    def at_rest(cls, past: Past) -> March:
        """Return the march before the first step."""
        zero, still = np.zeros(6), np.array([0.0, 0.0, 0.0, 1.0])
        return cls(0, past, zero, zero, np.zeros(3), still, np.zeros((0, 25)))

    def then(
        self, past: Past, twist: np.ndarray, shift: np.ndarray, turn: np.ndarray, row: np.ndarray
    ) -> March:
        """Return the march one step later."""
        rows = np.vstack([self.rows, row])
        return March(self.step + 1, past, twist, self.twist, shift, turn, rows)


def fingerprint(run: Any) -> str:
    """Return what must agree for a run to go on: swimmer, channel, time step and mesh."""
    digest = hashlib.sha256(run.flow.nodes.points.tobytes())
    named = repr((run.swimmer, run.channel, run.dt, run.free))
    digest.update(re.sub(r" at 0x[0-9a-f]+", "", named).encode())
    return digest.hexdigest()


def save_march(path: str | Path, march: March, run: Any) -> None:
    """Write a checkpoint; a kill in the middle leaves the one before.

    Raises
    ------
    MachineError
        If it cannot be written.
    """
    arrays = {n: getattr(march, n) for n in ("twist", "twist_old", "shift", "turn", "rows")}
    arrays |= {n: np.array(getattr(march.past, n)) for n in ("velocity", "position")}
    notes = {"content": CONTENT, "step": march.step, "fingerprint": fingerprint(run)}
    write(path, archive.pack(notes, arrays))


def load_march(path: str | Path | None, run: Any) -> March | None:
    """Read the march kept in a checkpoint; None if there is none yet.

    Raises
    ------
    MicroswimError
        If it is damaged, or of another run.
    """
    if path is None or not Path(path).exists():
        return None
    try:
        notes, kept = archive.unpack(Path(path).read_bytes(), MOST_BYTES)
    except archive.DamagedError as error:
        notes, kept = {"content": str(error)}, {}
    if notes.pop("content", None) != CONTENT:
        raise MicroswimError(
            f"checkpoint = {path}: damaged, or not a checkpoint of this version; "
            "name another file or delete it"
        )
    if notes["fingerprint"] != fingerprint(run):
        raise MicroswimError(
            f"checkpoint = {path}: it belongs to another swimmer, channel, mesh or time step; "
            "name another file or delete it"
        )
    past = Past(tuple(kept.pop("velocity")), tuple(kept.pop("position")))
    return March(step=int(notes["step"]), past=past, **kept)


def dataset(run: Any, march: March, info: dict[str, Any]) -> xr.Dataset:
    """Return rows in the swimmer's units: velocity ~ l rate, force ~ mu rate l^2, torque ~ mu rate
    l^3.
    """
    unit, rate = run.wave.outline.unit, run.rate
    lengths = np.repeat([unit, 1.0], 3)
    strengths = run.swimmer.fluid.viscosity * rate * np.repeat([unit**2, unit**3], 3)
    rows, phase = march.rows, run.direction * run.dt * (1 + np.arange(march.step))
    xyzw = rows[:, 21:25]
    return xr.Dataset(
        {
            "velocity": (("time", "component"), rows[:, :6] * lengths * rate),
            "wrench_body": (("time", "force"), rows[:, 6:12] * strengths),
            "wrench_tail": (("time", "force"), rows[:, 12:18] * strengths),
            "position": (("time", "axis"), rows[:, 18:21] * unit),
            "quaternion": (("time", "wxyz"), xyzw[:, [3, 0, 1, 2]]),
            "phase": ("time", phase),
        },
        coords={
            "time": np.abs(phase) / rate,
            "component": list(DEGREES_OF_FREEDOM),
            "force": FORCES,
            "axis": ["s", "q", "r"],
        },
        attrs={"model": "fem", "units": run.swimmer.units, "reynolds": run.reynolds, **info},
    )


def last_period(data: xr.Dataset) -> dict[str, Any]:
    """Return means and amplitudes over the last full period of a run, or over all of a shorter one.

    Parameters
    ----------
    data
        What `swim` returns.

    Returns
    -------
    dict
        ``mean_velocity``, ``velocity_amplitude`` (half of peak to peak), ``wrench_body`` and
        ``wrench_tail`` (means), and ``settling``: largest change of the mean velocity since the
        period before, over its own size (linear and angular apart); None in the first period.
    """
    n = round(2.0 * np.pi / abs(float(data.phase[0])))
    velocity = data.velocity.values
    now, before = velocity[-n:], velocity[-2 * n : -n]
    return {
        "mean_velocity": now.mean(axis=0).tolist(),
        "velocity_amplitude": (0.5 * np.ptp(now, axis=0)).tolist(),
        "wrench_body": data.wrench_body.values[-n:].mean(axis=0).tolist(),
        "wrench_tail": data.wrench_tail.values[-n:].mean(axis=0).tolist(),
        "settling": _change(before.mean(axis=0), now.mean(axis=0)) if len(before) == n else None,
    }


def _change(before: np.ndarray, now: np.ndarray) -> float:
    size = [np.linalg.norm(now[:3]), np.linalg.norm(now[3:])]
    gap = [np.linalg.norm((now - before)[:3]), np.linalg.norm((now - before)[3:])]
    return max(float(g / s) if s > 0 else 0.0 for g, s in zip(gap, size))
