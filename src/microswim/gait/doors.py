"""The door through which a gait reaches up: the picture of it, imported on call by name."""

from __future__ import annotations

from importlib import import_module
from typing import Any

PLOT = "microswim.output.plots.shortcuts:of_gait"


def go(door: str, *args: Any, **options: Any) -> Any:
    """Import the function behind a door, ``"package.module:function"``, and call it."""
    module, _, function = door.partition(":")
    return getattr(import_module(module), function)(*args, **options)
