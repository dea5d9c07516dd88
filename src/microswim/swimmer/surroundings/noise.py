"""Noise: the energy k_B T that drives Brownian motion, and the tumbles that end a bacterium's runs.

A run lasts for an exponential time; a tumble turns the swimmer on the spot, at once, by an angle
about a random axis across s. Its heading is then forgotten at the rate ``(1 - cos a) / run_time``
beside that of rotational diffusion [Lovely and Dahlquist 1975].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from microswim import checks
from microswim.errors import SpecError

BOLTZMANN = 1.380649e-23  #: J/K, exact
TUMBLE = np.radians(68.0)  #: rad [Berg and Brown 1972]


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Noise:
    """Thermal noise of the fluid on a swimmer.

    Parameters
    ----------
    temperature
        Of the fluid, K; of a swimmer without units the thermal energy k_B T.
    run_time
        Mean time of a run, which a tumble ends; None: it does not tumble.
    tumble_angle
        By which a tumble turns its axis (rad); 68 degrees by default, E. coli's [Berg and Brown
        1972].

    Raises
    ------
    SpecError
        If the temperature or the run time is not positive, or there is an angle without runs.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Noise(temperature=298.0).energy("SI") < 5e-21
    True
    """

    temperature: float
    run_time: float | None = None
    tumble_angle: float | None = None

    def __post_init__(self) -> None:
        checks.positive("noise.temperature", self.temperature, "temperature")
        if self.run_time is not None:
            checks.positive("noise.run_time", self.run_time, "time")
        if self.tumble_angle is not None:
            allowed = "an angle from 0 to pi"
            checks.number("noise.tumble_angle", self.tumble_angle, allowed, least=0.0, most=np.pi)
            if self.run_time is None:
                raise SpecError("noise.run_time: missing; a tumble ends a run, add its mean time")

    @property
    def tumbles(self) -> tuple[float, float] | None:
        """Mean time of a run and angle of a tumble, None if it does not tumble."""
        if self.run_time is None:
            return None
        return self.run_time, TUMBLE if self.tumble_angle is None else self.tumble_angle

    def energy(self, units: str) -> float:
        """Return k_B T, in J or in the swimmer's own units."""
        return self.temperature * (BOLTZMANN if units == "SI" else 1.0)
