"""The fluid: Newtonian, given by its viscosity and its density."""

from __future__ import annotations

from dataclasses import dataclass

from microswim import checks


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Fluid:
    """Newtonian fluid; what bounds it is a `Wall` or a `Channel` of the swimmer.

    Parameters
    ----------
    viscosity
        Dynamic viscosity mu, positive.
    density
        Density, zero or more; only finite elements with inertia use it. Zero is Stokes flow.

    Raises
    ------
    SpecError
        If a field is out of range.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Fluid(viscosity=100.0).density
    0.0
    """

    viscosity: float
    density: float = 0.0

    def __post_init__(self) -> None:
        checks.positive("fluid.viscosity", self.viscosity)
        checks.number("fluid.density", self.density, "a density of zero or more", least=0.0)
