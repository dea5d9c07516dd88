"""The camera of a compiled environment: a frame every so many steps, late and noisy.

The same model as sensor, for thousands of environments: a ring of frames, each position and heading
(the direction the body leads, ``-s``).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.control.environments.random_streams import normals
from microswim.errors import SpecError
from microswim.numerics.compiling.compiled import njit
from microswim.numerics.rigid_motion import to_lab
from microswim.swimmer.surroundings.noise import BOLTZMANN, TUMBLE

FRAME = 6  # position, heading
MM = 1e-3
SPREAD = 0.3  # of headings with which an episode begins, about that of its path


def conditions(
    *,
    disturbance: float = 0.1,
    position_noise: float = 0.02,
    angle_noise: float = 0.05,
    frame_interval: int = 2,
    latency: int = 2,
    temperature: float = 0.0,
    run_time: float = 0.0,
    tumble_angle: float = TUMBLE,
    field_gradient: float = 0.0,
    max_steps: int,
) -> dict[str, float]:
    """Return what the tasks have in common, in SI units: flow, camera and length of an episode.

    Lengths in mm, disturbance in mm/s, the camera's times in steps; the temperature (K) is that of
    the thermal noise, none at 0; the run time (s) is the mean time to a tumble, none at 0, which
    turns by the tumble's angle (rad); the field gradient (T/m) is the largest slope of the field
    about the origin.

    Raises
    ------
    SpecError
        If one is out of range.
    """
    sizes = {"disturbance": disturbance, "position_noise": position_noise}
    for name, value in (sizes | {"angle_noise": angle_noise}).items():
        checks.number(name, value, "a number from 0 to 1000", least=0.0, most=1e3)
    checks.number("temperature", temperature, "a number from 0 to 1e30 (K)", least=0.0, most=1e30)
    checks.number("run_time", run_time, "0, or from 0.001 to 1e9 (s)", least=0.0, most=1e9)
    if 0.0 < run_time < 1e-3:
        raise SpecError("run_time", run_time, "0, or from 0.001 to 1e9 (s)")
    checks.number("tumble_angle", tumble_angle, "an angle from 0 to pi", least=0.0, most=np.pi)
    checks.number("field_gradient", field_gradient, "from 0 to 1000 (T/m)", least=0.0, most=1e3)
    whole = {
        "frame_interval": (frame_interval, 1, 10**9),
        "latency": (latency, 0, 10**4),  # frames under way are kept
        "max_steps": (max_steps, 1, 10**9),
    }
    for name, (value, least, most) in whole.items():
        allowed = f"a whole number from {least} to {most}"
        checks.number(name, value, allowed, least=least, most=most)
        if int(value) != value:
            raise SpecError(name, value, allowed)
    return {
        "gust": disturbance * MM,
        "noise": position_noise * MM,
        "angle_noise": angle_noise,
        "energy": BOLTZMANN * temperature,
        "run_time": float(run_time),
        "tumble": float(tumble_angle),
        "slope": float(field_gradient),
        "ways": 3,  # fewer beside a boundary
        "interval": int(frame_interval),
        "latency": int(latency),
        "steps": int(max_steps),
    }


@njit(cache=True)
def expose(frame: Any, y: Any, noise: float, angle_noise: float, keys: Any, i: int) -> None:
    """Write what is seen of a state."""
    a, b = normals(keys, i)
    c, d = normals(keys, i)
    e, _ = normals(keys, i)
    frame[0], frame[1], frame[2] = y[0] + noise * a, y[1] + noise * b, y[2] + noise * c
    q = (y[3], y[4], y[5], y[6])
    h0, h1, h2 = to_lab(q, -1.0, angle_noise * d, angle_noise * e, 1.0)
    size = np.sqrt(h0 * h0 + h1 * h1 + h2 * h2)
    frame[3], frame[4], frame[5] = h0 / size, h1 / size, h2 / size


@njit(cache=True)
def fill(ring: Any, y: Any, noise: float, angle_noise: float, keys: Any, i: int) -> None:
    """Begin with every frame at the first pose."""
    expose(ring[0], y, noise, angle_noise, keys, i)
    for k in range(1, ring.shape[0]):
        for j in range(FRAME):
            ring[k, j] = ring[0, j]


@njit(cache=True)
def seen(ring: Any, step: int, interval: int, latency: int) -> int:
    """Return the row of the ring with the latest frame that has arrived by a step."""
    return (max(step - latency, 0) // interval) % ring.shape[0]


@njit(cache=True)
def attitude(y: Any, h: Any, roll: float) -> None:
    """Write the quaternion of a body that leads along the unit vector h, rolled about it."""
    # turn of +s = (1, 0, 0) onto -h: q = [1 + s . (-h), s x (-h)], then a roll about s
    w, x, y_, z = 1.0 - h[0], 0.0, h[2], -h[1]
    size = np.sqrt(w * w + x * x + y_ * y_ + z * z)
    if size < 1e-6:
        w, x, y_, z, size = 0.0, 0.0, 0.0, 1.0, 1.0
    w, y_, z = w / size, y_ / size, z / size
    c, s = np.cos(roll / 2.0), np.sin(roll / 2.0)
    y[3], y[4], y[5], y[6] = w * c, w * s, y_ * c + z * s, z * c - y_ * s
