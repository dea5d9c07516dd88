"""Pictures of a run, of a sweep over two numbers, of a front of designs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "design": ["design_map", "front"],
        "film": ["film"],
        "group": ["group"],
        "mobility": ["mobility"],
        "path": ["group_path", "path"],
        "run": ["trajectory", "velocity"],
        "starts": ["starts"],
    },
)
