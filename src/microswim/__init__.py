"""How bio-inspired micro-robots and flagellated cells swim in viscous fluid.

The public names are listed once, in ``__init__.pyi``, and are imported on first use, so that
``import microswim`` stays cheap (docs/decisions/0002-lazy-public-face.md).
"""

from importlib import import_module
from typing import Any

import lazy_loader

__version__ = "0.1.0"

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
#: The package `path` is the function of its name as well (docs/decisions/0018-path-is-called.md):
#: lazy_loader, which would hide a package behind such a function, shall not.
globals().get("__lazy_shadowed__", set()).discard("path")


def __getattr__(name: str) -> Any:
    """Import a public name."""
    return import_module("microswim.path") if name == "path" else _public(name)
