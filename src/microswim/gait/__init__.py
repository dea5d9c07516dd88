"""Gait: all that a hydrodynamic model says about a swimmer, and every number of it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, submod_attrs={"gait": ["Gait"]})
