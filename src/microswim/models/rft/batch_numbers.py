"""Numbers of many gaits at once from their twists: what `summary` says of each, for arrays.

A rigid helix on a body of revolution is told by phase 0, a plane wave by half a period.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.series.extremes import half_range
from microswim.numerics.series.fourier import MIRROR_Q, evaluate, series_of
from microswim.swimmer.swimmer import Swimmer

RESOLVED = 1e-9  #: last harmonics of the velocity, relative to the largest
OUTPUTS = (
    "mean_velocity",
    "velocity_amplitude",
    "swimming_speed",
    "mean_power",
    "mean_torque",
    "efficiency",
)


def of_helices(
    out: dict[str, Any], swimmer: Swimmer, V: Any, power: Any, drag: Any, rate: Any
) -> None:
    """Fill in results of rigid helices from phase 0: the lateral parts turn with the tail.

    In the frame of the tail the twist is constant, so the axis of the screw motion is along
    ``W + sign rate e_s`` and the swimming speed ``U . (W + sign rate e_s) / |W + sign rate e_s|``;
    ``|U|`` where nothing turns.
    """
    V, power = V[:, 0], power[:, 0]
    sign = swimmer.tail.sign
    if swimmer.motion.frequency_frame == "lab":
        rate = rate / (1.0 + sign * V[:, 3])
    us, uq, ur, os, oq, or_ = V.T * rate
    across, swing, spin = np.sqrt(uq * uq + ur * ur), np.sqrt(oq * oq + or_ * or_), os + sign * rate
    mean, amplitude, nothing = out["mean_velocity"], out["velocity_amplitude"], 0.0 * us
    for of, columns in ((mean, (us, nothing, nothing, os, nothing, nothing)),
                        (amplitude, (nothing, across, across, nothing, swing, swing))):  # fmt: skip
        for i, column in enumerate(columns):
            of[:, i] = column
    size = np.sqrt(spin * spin + swing * swing)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = np.abs(us * spin + uq * oq + ur * or_) / size
    out["swimming_speed"][:] = np.where(size == 0, np.sqrt(us * us + across * across), along)
    for name, values in _of_work(power * rate**2, drag[:, 0] * us * us, rate).items():
        out[name][:] = values


def beat_series(V: np.ndarray) -> np.ndarray:
    """Return series (2 m - 1, n, 6) of twists V (n, m, 6) over half a period of a plane wave."""
    n, m, _ = V.shape
    series = np.zeros((2 * m - 1, n, 6))
    moves = V.any(axis=(0, 1))
    half = np.moveaxis(V[..., moves], 1, 0)
    series[..., moves] = series_of(np.concatenate([half, half * MIRROR_Q[moves]]))
    return series


def resolved(series: np.ndarray) -> np.ndarray:
    """Return whether the last harmonics of the series (2 m - 1, n, 6) of twists are nothing."""
    size = np.abs(series).reshape(*series.shape[:2], 2, 3).max(axis=3)  # velocities, rates
    return (size[-6:].max(axis=0) <= RESOLVED * size.max(axis=0)).all(axis=1)


def blank(n: int) -> dict[str, np.ndarray]:
    """Return results of n designs, all NaN."""
    return {name: np.full((n, 6) if "velocity" in name else n, np.nan) for name in OUTPUTS}


def half_beats(V: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return what twists (n, m, 6) at m phases over half a period, per unit rate, say.

    The motion is planar: heading ``int W_r dphi``, displacement ``int R(heading) U dphi``, whose
    mean over the half period is along s, as the other half is its mirror image in q.

    Returns
    -------
    tuple
        Whether the beat is resolved (n,), mean and half of peak to peak of each velocity (n, 6),
        and the mean speed ahead (n,).
    """
    series = beat_series(V)
    heading = _integral_of(series[..., 5], V.shape[1])
    ahead = np.cos(heading) * V[..., 0] - np.sin(heading) * V[..., 1]
    return resolved(series), series[0], half_range(series), np.abs(ahead.mean(axis=1))


def of_plane_waves(
    V: Any, beats: Any, power: Any, rate: Any, drag: Any, work: Any = None
) -> dict[str, Any]:
    """Return results of plane waves from half a period, per unit rate, and its `half_beats`."""
    mean, amplitude, speed = beats
    size = np.abs(rate)
    total = power.mean(axis=1) * rate**2
    if work is None:
        work = drag[:, :1] * V[..., 0] ** 2
    return {
        "mean_velocity": mean * rate[:, None],
        "velocity_amplitude": amplitude * size[:, None],
        "swimming_speed": speed * size,
        **_of_work(total, work.mean(axis=1) * rate**2, rate),
    }


def _integral_of(series: np.ndarray, m: int) -> np.ndarray:
    """Return the integral over the phase of series (1 + 2 H, n) without their means, (n, m), at m
    phases over half a period.
    """
    h = np.arange(1, len(series) // 2 + 1)[:, None]
    whole = np.zeros_like(series)
    whole[1::2], whole[2::2] = -series[2::2] / h, series[1::2] / h
    return evaluate(whole, np.pi * np.arange(m) / m).T


def _of_work(power: Any, work: Any, rate: Any) -> dict[str, Any]:
    """Return what power and rate of the tail and the body's share of work tell."""
    with np.errstate(invalid="ignore", divide="ignore"):
        torque = np.where(rate != 0, power / rate, 0.0 * power)
    return {"mean_power": power, "mean_torque": torque, "efficiency": share_of(work, power)}


def share_of(work: Any, power: Any) -> Any:
    """Return the efficiency: zero without power, NaN where there is no answer."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(np.isnan(power), np.nan, np.where(power != 0, work / power, 0.0))
