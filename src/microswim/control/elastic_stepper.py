"""A swimmer with an elastic tail sample by sample: its state holds the shape, which remembers.

Inputs are held over a step, but for the spec's own field, which goes on in time. Each step is one
run of implicit steps, adaptive inside; a step that is refused leaves the state as it was.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any, Unpack

import numpy as np

from microswim import checks
from microswim.control.inputs import ElasticInputs
from microswim.errors import SpecError
from microswim.models.elastic.unsteady.march import Shape, at_rest, drawn, marched
from microswim.numerics.array import kept, still_read_only
from microswim.swimmer.magnetism.applied_field import UniformField
from microswim.swimmer.surroundings.flow import UniformFlow
from microswim.swimmer.swimmer import Swimmer

INPUTS = tuple(ElasticInputs.__annotations__)


@checks.by_name
@still_read_only
@dataclass(frozen=True, eq=False, repr=False)
class ElasticState:
    """Pose and shape of a swimmer with an elastic tail; `ElasticStepper.start` makes the first.

    Parameters
    ----------
    shape
        Pose, phase, strains and works, as the model has them.
    filament
        Evenly spaced points along the filament, lab frame, (points, 3).
    time
        Since the start.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.ElasticTail(length=1.0, radius=0.02, bending=0.2, drive="pivot", angle=0.3)
    >>> swimmer = ms.Swimmer(
    ...     body=ms.Sphere(radius=0.2), tail=tail, fluid=ms.Fluid(viscosity=1.0)
    ... )
    >>> ms.ElasticStepper(swimmer).start().filament[-1].round(2)  # its base leans by 0.3 rad
    array([1.16, 0.3 , 0.  ])
    """

    shape: Shape
    filament: np.ndarray
    time: float = 0.0

    @property
    def position(self) -> np.ndarray:
        """Position of the body's centre, lab frame, (3,)."""
        return self.shape.position

    @property
    def quaternion(self) -> np.ndarray:
        """Attitude, ``wxyz``, body to lab, (4,)."""
        return self.shape.quaternion

    @property
    def phase(self) -> float:
        """Phase of the drive (rad)."""
        return self.shape.phase

    @property
    def work(self) -> np.ndarray:
        """Work of the drive since the start, and what was dissipated, (2,)."""
        return self.shape.work

    def __repr__(self) -> str:
        """Time, place and phase, in a line."""
        x, y, z = self.position
        return (
            f"ElasticState at {self.time:.4g}: ({x:.4g}, {y:.4g}, {z:.4g}), phase {self.phase:.4g}"
        )


@checks.by_name
@dataclass(frozen=True, eq=False)
class ElasticStepper:
    """Steps a swimmer with an elastic tail from sample to sample; the tail remembers.

    What the spec says of field, gravity, flow and wall acts; inputs take the place of its field
    and flow.

    Parameters
    ----------
    swimmer
        With an `ElasticTail`.
    tolerance
        Of the steps inside, relative.

    Raises
    ------
    SpecError
        If the tail is not elastic.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.ElasticTail(length=1.0, radius=0.02, bending=0.2, drive="pivot", angle=0.3)
    >>> swimmer = ms.Swimmer(
    ...     body=ms.Sphere(radius=0.2), tail=tail, fluid=ms.Fluid(viscosity=1.0)
    ... )
    >>> stepper = ms.ElasticStepper(swimmer)
    >>> state = stepper.start()
    >>> for _ in range(3):
    ...     state = stepper.step(state, dt=0.1)
    >>> round(state.time, 6)
    0.3
    """

    swimmer: Swimmer
    _: KW_ONLY
    tolerance: float = 1e-5

    def __post_init__(self) -> None:
        checks.instance("swimmer", self.swimmer, "Swimmer")
        checks.number("tolerance", self.tolerance, "from 1e-12 to 0.01", least=1e-12, most=1e-2)
        if not self.swimmer.tail.settles:
            raise SpecError("tail.kind", self.swimmer.tail.kind, '"elastic"', "or use Stepper")
        at_rest(
            self.swimmer, np.zeros(3), [1.0, 0.0, 0.0, 0.0], 0.0
        )  # refuses what is not followed

    @checks.given(position=checks.series, quaternion=checks.series)
    def start(
        self, position: Any = (0, 0, 0), quaternion: Any = (1, 0, 0, 0), phase: float = 0.0
    ) -> ElasticState:
        """Return the state at a pose with the tail as it is at rest.

        Raises
        ------
        SpecError
            If a part has the wrong shape or is not finite.
        """
        checks.numbers("position", np.ravel(position).tolist(), 3, "three finite numbers")
        checks.numbers("quaternion", np.ravel(quaternion).tolist(), 4, "four numbers wxyz")
        checks.number("phase", phase, "a finite number")
        q = np.array(quaternion, float)
        if not 0.99 < np.linalg.norm(q) < 1.01:
            raise SpecError("quaternion", quaternion, "a unit quaternion wxyz")
        shape = at_rest(self.swimmer, position, q / np.linalg.norm(q), float(phase))
        return ElasticState(shape=shape, filament=kept(drawn(self.swimmer, shape), float))

    @checks.given()
    def step(
        self, state: ElasticState, *, dt: float, **inputs: Unpack[ElasticInputs]
    ) -> ElasticState:
        """Return the state after a time dt.

        Parameters
        ----------
        state
            The last one; it is left as it was.
        dt
            Duration, positive.
        **inputs
            Held over the step: ``motor_rate`` (rad per time, negative = reversed; the spec's own by
            default), ``force`` and ``torque`` on the body about its centre, ``field`` B and
            ``flow``, vectors in the lab frame.

        Raises
        ------
        SpecError
            If an input is unknown, of the wrong shape or not finite.
        MicroswimError
            If the step cannot be followed.
        """
        checks.instance("state", state, "ElasticState")
        checks.positive("dt", dt, "time")
        one, more = self._with(inputs)
        found = marched(
            one, state.shape, np.array([0.0, float(dt)]), self.tolerance, state.time, **more
        )
        return ElasticState(
            shape=found.shapes[-1], filament=kept(found.places[-1], float), time=state.time + dt
        )

    def _with(self, inputs: Mapping[str, Any]) -> tuple[Swimmer, dict[str, Any]]:
        """The swimmer in the field and flow that are given, and further loads."""
        one, more = self.swimmer, {}
        for name, value in inputs.items():
            checks.choice("input", name, INPUTS)
            if name == "motor_rate":
                checks.number(name, value, "a finite number")
                tail: Any = replace(one.tail, frequency=float(value) / (2.0 * np.pi))  # type: ignore[call-arg]
                one = replace(one, tail=tail)
                continue
            checks.numbers(name, np.ravel(value).tolist(), 3, "three finite numbers, lab frame")
            vector = np.array(value, float).ravel()
            size = float(np.linalg.norm(vector))
            line: Any = tuple(vector) if size else (1.0, 0.0, 0.0)
            if name in ("force", "torque"):
                more[name] = vector
            elif name == "field":
                one = replace(
                    one, field=UniformField(strength=size, direction=line) if size else None
                )
            else:
                one = replace(one, flow=UniformFlow(speed=size, direction=line) if size else None)
        return one, more
