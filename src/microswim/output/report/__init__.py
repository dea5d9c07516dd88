"""A run on one page."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={"html": ["Table", "derived", "numbers_table", "page", "png", "spec_table"]},
)
