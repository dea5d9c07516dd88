"""The doors: the only places where a swimmer or a solution reaches up to what is built on it.

``swimmer.gait()`` is a shortcut for people: the model is imported on call, by the name in this
table, so that nothing here depends on the models.
"""

from __future__ import annotations

from importlib import import_module
from inspect import Parameter, signature
from typing import Any

from microswim.errors import SpecError
from microswim.gait.doors import go as go

MODELS = {
    "auto": "microswim.calibration.atlas.choice:auto",
    "rft": "microswim.models.rft.gait:gait",
    "atlas": "microswim.calibration.atlas.choice:gait",
    "elastic": "microswim.models.elastic.gait:gait",
    "bem": "microswim.models.bem.gait:gait",
    "fem": "microswim.models.fem:channel_gait",
}
SETTLED = "microswim.models.elastic.gait:settled_swimmer"
ISOLATED = "microswim.models.bem.isolated:resistance"
READ = "microswim.spec.file:read"
READ_VALUE = "microswim.spec.values:from_python"
READ_PRESET = "microswim.spec.file:read_preset"
POLY_DATA = "microswim.output.io.vtk:poly_data"
IMAGE_DATA = "microswim.output.io.vtk:image_data"
COLLECTION = "microswim.output.io.vtk:collection"
CUT = "microswim.output.plots.flow:cut"
PLOT = "microswim.output.plots.shortcuts:of_swimmer"
PORTRAIT = "microswim.output.report.portrait:of_swimmer"
UNPACK_REGION = "microswim.calibration.region.text:unpack"


def check_options(model: str, options: dict[str, Any]) -> None:
    """Refuse a model that does not exist, and an option that it does not take.

    Raises
    ------
    SpecError
        With the models, or the options of this one.
    """
    if model not in MODELS:
        raise SpecError("model", model, "one of " + ", ".join(f'"{m}"' for m in MODELS))
    if not options:
        return
    module, _, function = MODELS[model].partition(":")
    takes = signature(getattr(import_module(module), function)).parameters
    if any(p.kind is Parameter.VAR_KEYWORD for p in takes.values()):
        return
    known = [name for name, p in takes.items() if p.kind is Parameter.KEYWORD_ONLY]
    for name, value in options.items():
        if name not in known:
            raise SpecError(f"option {name}", value, f"an option of {model}: {', '.join(known)}")
