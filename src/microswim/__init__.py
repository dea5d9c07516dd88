"""How bio-inspired micro-robots and flagellated cells swim in viscous fluid.

The public names are listed once, in ``__init__.pyi``, and are imported on first use, so that
``import microswim`` stays cheap (docs/decisions/0002-lazy-public-face.md).
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
