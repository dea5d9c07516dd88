"""The swimmer: body, tail, fluid, local coefficients and interaction; what every model is given."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"fluid": ["Fluid"], "motion": ["Motion"], "swimmer": ["Swimmer"]}
)
