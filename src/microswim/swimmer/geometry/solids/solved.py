"""A body whose isolated resistance is solved by boundary elements, once for each shape.

R depends on the shape alone once lengths are measured by the body: ``R = mu L^n R*``, n = 1, 2, 3
for force by translation, force by rotation, torque by rotation. The door to the solver keeps R* in
the user's cache.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any, Self

import numpy as np

from microswim.gait import doors
from microswim.swimmer.fields import numbers_of, set_item
from microswim.swimmer.geometry.body import Body
from microswim.swimmer.parts import replaced

#: Relative step of the differences that carry a complex step through a solve.
STEP = 0.02


class SolvedBody(Body):
    """A body whose isolated resistance is solved by boundary elements and kept."""

    @property
    def unit(self) -> Any:
        """Length by which lengths are measured: the largest half length."""
        return max(self.semi_axes3, key=np.real)

    @abstractmethod
    def scaled(self, factor: float) -> Self:
        """Return the same shape with all lengths times a factor."""

    def diagonal(self, viscosity: Any) -> tuple[Any, ...]:
        R = self.resistance_per_viscosity()
        return tuple(viscosity * R[..., i, i] for i in range(6))

    def resistance(self, viscosity: float) -> np.ndarray:
        return viscosity * self.resistance_per_viscosity()

    def resistance_per_viscosity(self) -> np.ndarray:
        """Return R / mu, (..., 6, 6); fields may be complex numbers, or arrays of one shape."""
        numbers = dict(numbers_of(self, ""))
        many = {k: v for k, v in numbers.items() if np.ndim(v)}
        if many:
            shape = np.broadcast_shapes(*(np.shape(v) for v in many.values()))
            flat = {k: np.broadcast_to(v, shape).ravel() for k, v in many.items()}
            each = [
                self._with({k: v[n] for k, v in flat.items()}).resistance_per_viscosity()
                for n in range(int(np.prod(shape)))
            ]
            return np.array(each).reshape(*shape, 6, 6)
        steps: dict[str, Any] = {k: v for k, v in numbers.items() if np.iscomplexobj(v)}
        if steps:
            return self._complex(steps)
        return self._solved()

    def _complex(self, steps: dict[str, Any]) -> np.ndarray:
        """R(x + i h) = R(x) + i h R'(x), R' by central differences (to about one per cent)."""
        real = self._with({k: v.real for k, v in steps.items()})
        R = real._solved().astype(complex)
        for name, value in steps.items():
            if value.imag:
                x = value.real
                up, down = (real._with({name: x * (1 + sign * STEP)})._solved() for sign in (1, -1))
                R += 1j * value.imag * (up - down) / (2 * STEP * x)
        return R

    def _solved(self) -> np.ndarray:
        unit = float(self.unit)
        power = np.repeat([0.5, 1.5], 3)
        return doors.go(doors.ISOLATED, self.scaled(1.0 / unit)) * unit ** np.add.outer(
            power, power
        )

    def _with(self, values: dict[str, Any]) -> Self:
        """Copy with numbers replaced unchecked; those left out are real."""
        body = self
        for path, value in values.items():
            name, *index = path.replace("]", "").split("[")
            if index:
                value = set_item(getattr(body, name), [int(i) for i in index], value)
            body = replaced(body, name, value)
        return body
