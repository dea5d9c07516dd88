"""Finite elements in a channel: quasi-steady Stokes gait, and swimming with inertia in time.

Needs the extra ``fem`` (NGSolve, MKL). Depends on channel; the rest is imported on call.
"""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from microswim.errors import MicroswimError
from microswim.reference.channel import Channel

if TYPE_CHECKING:
    import xarray as xr

    from microswim.gait import Gait

__all__ = ["Channel", "body_resistance", "gait", "swim"]


def _require() -> None:
    if find_spec("ngsolve") is None:
        raise MicroswimError(
            "model = fem: finite elements need NGSolve; pip install microswim[fem]"
        )


def gait(swimmer: Any, **options: Any) -> Gait:
    """Gait in a channel by finite elements; see `quasi_steady.gait` for the options."""
    _require()
    from .quasi_steady import gait as solve

    return solve(swimmer, **options)


def swim(swimmer: Any, **options: Any) -> xr.Dataset:
    """Swimming in time from rest, inertia included; see `swimming.swim` for the options."""
    _require()
    from .swimming import swim as march

    return march(swimmer, **options)


def body_resistance(body: Any, **options: Any) -> Any:
    """6x6 resistance of a body alone in a channel; see `quasi_steady.body_resistance`."""
    _require()
    from .quasi_steady import body_resistance as solve

    return solve(body, **options)
