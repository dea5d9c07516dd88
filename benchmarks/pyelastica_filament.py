"""The filament of bench_elastic.py by PyElastica: explicit steps of a rod with little mass.

    PYTHON_WITH_PYELASTICA benchmarks/pyelastica_filament.py ELEMENTS

Length 1, c_n = 1 = 2 c_t, sperm number 2, a clamped base that moves across by 0.02 cos(w t), w = 2
pi. Inertia is a fiftieth of drag at w. Thrust is the mean of the drag along x over the last period,
in units of (c_n - c_t) w y0^2; of the closed form's 0.3835.
"""

import sys
import time

import elastica as ea
import numpy as np

RATE, SIZE, NORMAL, TANGENTIAL = 2.0 * np.pi, 0.02, 1.0, 0.5
RADIUS, INERTIA, PERIODS = 0.05, 0.02, 3
BENDING = RATE * NORMAL / 2.0**4


class Simulator(ea.BaseSystemCollection, ea.Constraints, ea.Forcing):
    """A rod with a moved base and local drag."""


class Heave(ea.ConstraintBase):
    """The base moves across x and keeps its direction."""

    def constrain_values(self, system, time):
        """Place of the base."""
        system.position_collection[..., 0] = [0.0, SIZE * np.cos(RATE * time), 0.0]
        system.director_collection[..., 0] = self.first

    def constrain_rates(self, system, time):
        """Velocity of the base."""
        system.velocity_collection[..., 0] = [0.0, -RATE * SIZE * np.sin(RATE * time), 0.0]
        system.omega_collection[..., 0] = 0.0

    def __init__(self, *fixed, **options):
        super().__init__(**options)
        self.first = fixed[1]


class LocalDrag(ea.NoForces):
    """Drag of each element by its own velocity; its sum along x is kept."""

    pushed = 0.0

    def apply_forces(self, system, time=0.0):
        """Half of an element's drag on each of its ends."""
        v = (system.velocity_collection[:, 1:] + system.velocity_collection[:, :-1]) / 2.0
        t = system.tangents
        along = (v * t).sum(axis=0) * t
        force = -(TANGENTIAL * along + NORMAL * (v - along)) * system.lengths
        system.external_forces[:, 1:] += force / 2.0
        system.external_forces[:, :-1] += force / 2.0
        LocalDrag.pushed = force[0].sum()


def main():
    elements = int(sys.argv[1])
    area, second = np.pi * RADIUS**2, np.pi * RADIUS**4 / 4.0
    density, modulus = INERTIA * NORMAL / RATE / area, BENDING / second
    rod = ea.CosseratRod.straight_rod(
        elements, np.array([0.0, SIZE, 0.0]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]),
        1.0, RADIUS, density, youngs_modulus=modulus, shear_modulus=modulus / 2.0,
    )  # fmt: skip
    simulator = Simulator()
    simulator.append(rod)
    simulator.constrain(rod).using(
        Heave, constrained_position_idx=(0,), constrained_director_idx=(0,)
    )
    simulator.add_forcing_to(rod).using(LocalDrag)
    simulator.finalize()
    stepper, now = ea.PositionVerlet(), np.float64(0.0)
    finest = max(elements, 1.0 / RADIUS)  # a quarter of what stretching and turning waves allow
    steps = int(np.ceil(4.0 * finest * np.sqrt(modulus / density)))
    total, begun = 0.0, 0.0
    for _ in range(PERIODS):
        total, begun = 0.0, time.process_time()
        for _step in range(steps):
            now = stepper.step(simulator, now, np.float64(1.0 / steps))
            total += LocalDrag.pushed
    seconds = time.process_time() - begun
    thrust = -total / steps / ((NORMAL - TANGENTIAL) * RATE * SIZE**2)
    print(f"PyElastica, {elements} elements, {steps} steps: {1e3 * seconds:9.0f} ms a period, "
          f"thrust {thrust / 0.3835 - 1:+.2%}")  # fmt: skip


if __name__ == "__main__":
    main()
