"""Numbers of many gaits at once from their twists: what `summary` says of each, for arrays.

A rigid helix on a body of revolution is told by phase 0, a plane wave by half a period.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.numerics.fourier import MIRROR_Q, half_range, series_of
from microswim.swimmer.swimmer import Swimmer

RESOLVED = 1e-9  #: last harmonics of the velocity, relative to the largest
AT_ONCE = 1 << 14  #: entries of the series whose amplitudes are sought at once
OUTPUTS = (
    "mean_velocity",
    "velocity_amplitude",
    "swimming_speed",
    "mean_power",
    "mean_torque",
    "efficiency",
)


def of_helices(swimmer: Swimmer, V: Any, power: Any, body: Any, rate: Any) -> dict[str, Any]:
    """Return results of rigid helices from phase 0: the lateral parts turn with the tail.

    In the frame of the tail the twist is constant, so the axis of the screw motion is along
    ``W + sign rate e_s`` and the swimming speed ``U . (W + sign rate e_s) / |W + sign rate e_s|``.
    """
    V, power = V[:, 0], power[:, 0]
    sign = swimmer.tail.sign
    if swimmer.motion.frequency_frame == "lab":
        rate = rate / (1.0 + sign * V[:, 3])
    W = V * rate[:, None]
    mean, amplitude = np.zeros_like(W), np.zeros_like(W)
    mean[:, ::3] = W[:, ::3]
    for i in (1, 4):
        amplitude[:, i] = amplitude[:, i + 1] = np.hypot(W[:, i], W[:, i + 1])
    mean[np.isnan(W[:, 0])] = amplitude[np.isnan(W[:, 0])] = np.nan
    spin = W[:, 3:].copy()
    spin[:, 0] += sign * rate
    size = np.linalg.norm(spin, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        speed = np.abs(np.sum(W[:, :3] * spin, axis=1)) / size
    total = power * rate**2
    work = np.einsum("nj,nj,n->n", body[:, 0], W, W[:, 0])
    return _results(mean, amplitude, speed, total, work, rate)


def resolved(V: np.ndarray) -> np.ndarray:
    """Return whether the last harmonics of twists V (n, m, 6) over half a period are nothing."""
    hat = np.abs(np.fft.rfft(np.concatenate([V, V * MIRROR_Q], axis=1), axis=1))
    hat = hat.reshape(*hat.shape[:2], 2, 3).max(axis=3)  # velocities, rates
    return (hat[:, -4:].max(axis=1) <= RESOLVED * hat.max(axis=1)).all(axis=1)


def blank(n: int) -> dict[str, np.ndarray]:
    """Return results of n designs, all NaN."""
    return {name: np.full((n, 6) if "velocity" in name else n, np.nan) for name in OUTPUTS}


def of_plane_waves(V: Any, power: Any, rate: Any, body: Any, work: Any = None) -> dict[str, Any]:
    """Return results of plane waves from half a period, the other half mirrored in q.

    The motion is planar: heading ``int W_r dt``, displacement ``int R(heading) U dt``.
    """
    W = np.concatenate([V, V * MIRROR_Q], axis=1) * rate[:, None, None]
    m = W.shape[1]
    mean = W.mean(axis=1)
    amplitude = _amplitudes(W)
    h = np.fft.rfftfreq(m, 1.0 / m)
    hat = np.fft.rfft(W[:, :, 5], axis=1)
    hat[:, 1:] /= 1j * h[1:]
    hat[:, 0] = 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        heading = np.fft.irfft(hat, m, axis=1) / rate[:, None]
    c, s = np.cos(heading), np.sin(heading)
    ahead, aside = c * W[..., 0] - s * W[..., 1], s * W[..., 0] + c * W[..., 1]
    speed = np.hypot(ahead.mean(axis=1), aside.mean(axis=1))
    total = power.mean(axis=1) * rate**2
    if work is None:
        drag = np.einsum("nj,nmj,nm->n", body[:, 0], W, W[..., 0]) / m
    else:
        drag = work.mean(axis=1) * rate**2
    return _results(mean, amplitude, speed, total, drag, rate)


def _amplitudes(W: np.ndarray) -> np.ndarray:
    """Half of peak to peak over the period of each component, W (n, m, 6); as a gait's."""
    series = np.moveaxis(series_of(np.moveaxis(W, 1, 0)), 1, 0)
    each = max(1, AT_ONCE // series[0].size)
    parts = np.split(series, range(each, len(series), each))
    return np.concatenate([half_range(np.moveaxis(part, 0, 1)) for part in parts])


def _results(mean: Any, amplitude: Any, speed: Any, power: Any, work: Any, rate: Any) -> dict:
    with np.errstate(invalid="ignore", divide="ignore"):
        torque = np.where(rate != 0, power / rate, 0.0 * power)
    return dict(zip(OUTPUTS, (mean, amplitude, speed, power, torque, share_of(work, power))))


def share_of(work: Any, power: Any) -> Any:
    """Return the efficiency: zero without power, NaN where there is no answer."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(np.isnan(power), np.nan, np.where(power != 0, work / power, 0.0))
