"""A run as a Dataset and as files: netCDF, CSV, VTK, closed surfaces."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"run": ["dataset", "enough_periods", "load", "numbers", "save", "unit"]}
)
