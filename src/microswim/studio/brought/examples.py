"""Files of the menu, to see what becomes of a surface, a beat and tracks that are dropped.

Each is made up on the spot: a robot of the menu as it would be printed, a sperm's beat of the menu
as it would be traced, six cells as a tracker would follow them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.output.io.stl import write_stl
from microswim.swimmer.swimmer import Swimmer

ROBOT, SPERM = "shapes/magnet", "cells/sperm"
FRAMES, POINTS = 50, 26  #: of a traced beat
PER_PERIOD = 8.3  #: frames, so that they do not repeat
CELLS, SPOTS, FPS = 6, 75, 25.0
SEEING = 50e-9  #: m, error of a position


def names() -> list[str]:
    """Return the names of the menu's files, ``"files/name"``."""
    return list(_MADE)


def content(name: str) -> bytes:
    """Return a file of the menu.

    Raises
    ------
    SpecError
        If there is no such file.
    """
    if name not in _MADE:
        raise SpecError("file", name[:80], "one of " + ", ".join(_MADE))
    return _MADE[name]()


def _robot() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = write_stl(Path(folder) / "robot.stl", Swimmer.preset(ROBOT), fineness=0.6)
        return path.read_bytes()


def _beat() -> bytes:
    tail: Any = Swimmer.preset(SPERM).tail
    s = np.linspace(0.0, tail.length, POINTS)
    rows = ["t (s),s (um),angle"]
    for i in range(FRAMES):
        time = i / (PER_PERIOD * tail.frequency)
        angles = tail.angle(s, 2.0 * np.pi * tail.frequency * time)
        rows += [f"{time:.6f},{1e6 * a:.3f},{angle:.5f}" for a, angle in zip(s, angles)]
    return "\n".join(rows).encode()


def _tracks() -> bytes:
    random, time = np.random.default_rng(11), np.arange(SPOTS) / FPS
    rows = ["track,t (s),x (um),y (um)"]
    for cell in range(CELLS):
        speed, turn = 25e-6 * random.lognormal(0.0, 0.2), random.normal(0.0, 0.6)
        heading = random.uniform(0.0, 2.0 * np.pi) + turn * time
        step = speed / FPS * np.stack([np.cos(heading), np.sin(heading)], axis=1)
        at = np.cumsum(step, axis=0) + random.uniform(0.0, 6e-5, 2)
        seen = 1e6 * (at + random.normal(0.0, SEEING, at.shape))
        rows += [f"{cell},{t:.3f},{x:.4f},{y:.4f}" for t, (x, y) in zip(time, seen)]
    return "\n".join(rows).encode()


_MADE: dict[str, Callable[[], bytes]] = {
    "files/robot.stl": _robot,
    "files/beat.csv": _beat,
    "files/tracks.csv": _tracks,
}
