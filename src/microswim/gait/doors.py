"""The doors: the only places where a gait, a swimmer or a solution reaches up to what is built
on it.

``swimmer.gait()`` and ``gait.plot()`` are shortcuts for people: what is behind them is imported on
call, by the name in this one table, so that nothing here depends on models or pictures.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from inspect import Parameter, signature
from typing import TYPE_CHECKING, Any, Literal, TypedDict

from microswim import checks
from microswim.errors import SpecError

if TYPE_CHECKING:
    from microswim.swimmer.geometry.surroundings import Channel

Model = Literal["rft", "auto", "atlas", "elastic", "bem", "fem"]
Level = Literal["coarse", "standard", "fine", "paper"]
Told = Callable[[int, int], None]


LEVELS = ("coarse", "standard", "fine")  #: of every solver that has levels


class ModelOptions(TypedDict, total=False):
    """What the models take, each some of these; `check_options` refuses what one does not take."""

    nodes: int | None
    phases: int | None
    accuracy: float | None
    level: Level | Any
    order: int | None
    estimate_error: bool
    channel: Channel | None


class GaitOptions(ModelOptions, total=False):
    """The same for one gait, which may tell how far it is."""

    progress: Told | None


MODELS: dict[str, str] = {
    "auto": "microswim.calibration.atlas.choice:auto",
    "rft": "microswim.models.rft.gait:gait",
    "atlas": "microswim.calibration.atlas.gait:gait",
    "elastic": "microswim.models.elastic.gait:gait",
    "bem": "microswim.models.bem.gait:gait",
    "fem": "microswim.models.fem:channel_gait",
}
SETTLED = "microswim.models.elastic.gait:settled_swimmer"
AT_POSES = "microswim.calibration.poses.around:around"
OUTLINE = "microswim.calibration.poses.around:outline"
START_BESIDE_WALL = "microswim.calibration.poses.wall:start_of"
ISOLATED = "microswim.models.bem.isolated:resistance"
GROUP_BLOCKS = "microswim.models.group.blocks:prepare"
GROUP_ESTIMATE = "microswim.models.group.estimate:estimate"
GROUP_POSES = "microswim.jobs.group_poses:at_poses"
GROUP_SWIM = "microswim.models.group.mean:swim"
GROUP_SOLVE = "microswim.models.group.solution:solve"
MOTOR_PHASES = "microswim.jobs.motor_phases:motor_phases"
READ = "microswim.spec.file:read"
READ_SCENE = "microswim.spec.readers.scene:read_scene"
WRITE = "microswim.spec.describe:to_text"
READ_COILS = "microswim.spec.readers.coils:read_coils"
READ_SERIES = "microswim.spec.readers.magnetic:read_series"
READ_POSES = "microswim.spec.readers.magnetic:read_poses"
IN_UNITS = "microswim.spec.writing:in_units"
READ_VALUE = "microswim.spec.values:from_python"
READ_PRESET = "microswim.spec.file:read_preset"
POLY_DATA = "microswim.output.io.vtk:poly_data"
IMAGE_DATA = "microswim.output.io.vtk:image_data"
COLLECTION = "microswim.output.io.vtk:collection"
CUT = "microswim.output.plots.flow:cut"
PLOT_GAIT = "microswim.output.plots.shortcuts:of_gait"
PLOT_SWIMMER = "microswim.output.plots.shortcuts:of_swimmer"
VIEW = "microswim.studio.view:of_swimmer"
PLOT_REGIMES = "microswim.output.plots.regimes:regimes"
PORTRAIT = "microswim.output.report.portrait:of_swimmer"
WARM_UP_ATLAS = "microswim.calibration.atlas.everywhere:warm_up"
PACK_REGION = "microswim.calibration.region.text:pack"
UNPACK_REGION = "microswim.calibration.region.text:unpack"


def go(door: str, *args: Any, **options: Any) -> Any:
    """Import the function behind a door, ``"package.module:function"``, and call it."""
    return _behind(door)(*args, **options)


def _behind(door: str) -> Any:
    name, _, function = door.partition(":")
    module = sys.modules.get(name) or import_module(name)
    return getattr(module, function)


def check_options(model: str, options: Mapping[str, Any]) -> None:
    """Refuse a model that does not exist, and an option that it does not take.

    Raises
    ------
    SpecError
        With the models, or the options of this one.
    """
    checks.choice("model", model, MODELS)
    if not options:
        return
    if isinstance(options.get("level"), str):  # before a thousand designs fail of it
        checks.choice("level", options["level"], (*LEVELS, *(("paper",) if model == "fem" else ())))
    takes = signature(_behind(MODELS[model])).parameters
    if any(p.kind is Parameter.VAR_KEYWORD for p in takes.values()):
        return  # it passes them on, and asks here again
    known = [name for name, p in takes.items() if p.kind is Parameter.KEYWORD_ONLY]
    for name, value in options.items():
        if name not in known:
            raise SpecError(f"option {name}", value, f"an option of {model}: {', '.join(known)}")
