"""Where a swimmer goes: stepping a gait in time, trajectories, the screw of one period.

Called, ``microswim.path(swimmer, time)`` is `microswim.path.following.path`
(docs/decisions/0018-path-is-called.md).
"""

import sys
from types import ModuleType
from typing import Any


class _Called(ModuleType):
    """The package, which is a function of the public face as well."""

    @property
    def __signature__(self) -> Any:
        """That of the function, for who inspects it."""
        from inspect import signature

        from microswim.path.following import path

        return signature(path)

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Follow a swimmer in time, see `microswim.path.following.path`."""
        from microswim.path.following import path

        return path(*args, **options)


sys.modules[__name__].__class__ = _Called
