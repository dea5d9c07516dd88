"""Finite elements in a channel: quasi-steady Stokes gait, and swimming with inertia in time.

Needs the extra ``fem`` (NGSolve, MKL).
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from microswim.errors import MachineError
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.geometry.surroundings import Channel
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

    from microswim.gait.gait import Gait

__all__ = ["Channel", "body_resistance", "channel_gait", "last_period", "require_viewer", "swim"]


def _require() -> None:
    if find_spec("ngsolve") is None:
        raise MachineError('model = "fem" needs NGSolve: pip install "microswim[fem]"')


def channel_gait(
    swimmer: Swimmer,
    *,
    channel: Channel | None = None,
    level: Any = "standard",
    phases: int = 8,
    progress: Callable[[int, int], None] | None = None,
) -> Gait:
    """Return the gait in a channel by finite elements, as `fem.gait.gait` says."""
    _require()
    from microswim.models.fem.gait import gait as solve

    return solve(swimmer, channel=channel, level=level, phases=phases, progress=progress)


def swim(swimmer: Swimmer, **options: Any) -> xr.Dataset:
    """Return swimming in time from rest, inertia included; see `swimming.swim` for the options."""
    _require()
    from microswim.models.fem.swimming import swim as march

    return march(swimmer, **options)


def body_resistance(body: Body, **options: Any) -> Any:
    """Return 6x6 resistance of a body alone in a channel; see `fem.gait.body_resistance`."""
    _require()
    from microswim.models.fem.gait import body_resistance as solve

    return solve(body, **options)


def last_period(data: xr.Dataset) -> dict[str, Any]:
    """Return means and amplitudes over the last period of what `swim` returned; see `record`."""
    _require()
    from microswim.models.fem.record import last_period as summary

    return summary(data)


def require_viewer() -> None:
    """Refuse pictures where the extra ``viz`` is not installed, in one sentence."""
    _require()
    from microswim.models.fem.picture import require_viewer as require

    require()
