"""The doors: the only places where a swimmer or a solution reaches up to what is built on it.

``swimmer.gait()`` is a shortcut for people: the model is imported on call, by the name in this
table, so that nothing here depends on the models.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

MODELS = {
    "auto": "microswim.calibration.atlas.choice:auto",
    "rft": "microswim.models.rft.gait:gait",
    "atlas": "microswim.calibration.atlas.choice:gait",
    "bem": "microswim.models.bem.gait:gait",
    "fem": "microswim.models.fem:channel_gait",
}
READ = "microswim.spec.file:read"
READ_VALUE = "microswim.spec.values:from_python"
READ_PRESET = "microswim.spec.file:read_preset"
POLY_DATA = "microswim.output.io.vtk:poly_data"
IMAGE_DATA = "microswim.output.io.vtk:image_data"
COLLECTION = "microswim.output.io.vtk:collection"
UNPACK_REGION = "microswim.calibration.region.text:unpack"


def go(door: str, *args: Any, **options: Any) -> Any:
    """Import the function behind a door, ``"package.module:function"``, and call it."""
    module, _, function = door.partition(":")
    return getattr(import_module(module), function)(*args, **options)
