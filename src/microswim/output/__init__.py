"""The only writers: files, reports, pictures, in one style."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["io", "plots", "report"])
