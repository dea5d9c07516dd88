"""How far off step-out and the velocity there are: random helical robots against boundary elements.

    python benchmarks/step_out.py             # 14 robots with a head and 14 without, a minute

Prints for each model the median, the 90 % quantile and the largest error; the last stand in
`microswim.path.regime_errors.MEASURED` and in docs/magnets.md.
"""

from __future__ import annotations

import warnings

import numpy as np

import microswim as ms
from microswim.gait.turning.steady_turning import SteadyTurning
from microswim.gait.turning.step_out import mobility_of

ROBOTS, SEED = 14, 5


def told(gait: ms.Gait, moment: np.ndarray) -> np.ndarray:
    """Step-out, velocity there, onset of wobbling, for a field of one."""
    steady = SteadyTurning(mobility_of(gait), moment, 1.0)
    return np.array([steady.step_out, steady.at_step_out.velocity, steady.wobbling_onset])


def errors(body: ms.Body, ramps: tuple[float, ...]) -> dict[str, np.ndarray]:
    """Relative errors (robot, number) by model, of robots with ramps in turn."""
    draw, found = np.random.default_rng(SEED), {"atlas": [], "lighthill": [], "gray_hancock": []}
    while len(found["atlas"]) < ROBOTS:
        length, amplitude = draw.uniform(1, 3), np.exp(draw.uniform(np.log(0.06), np.log(0.25)))
        waves, radius = draw.uniform(0.8, 4), draw.uniform(0.02, 0.06)
        angle = np.radians(draw.uniform(45, 90))
        moment = np.array([np.cos(angle), np.sin(angle), 0.0])
        fluid, ramp = ms.Fluid(viscosity=1.0), ramps[len(found["atlas"]) % len(ramps)]
        try:
            tail = ms.HelicalTail(
                length=length, amplitude=amplitude, waves=waves, radius=radius, ramp=ramp
            )
            robot = ms.Swimmer(body=body, tail=tail, fluid=fluid)
            true = told(robot.gait("bem"), moment)
            gaits = {"atlas": robot.gait("atlas")}
        except ms.MicroswimError:
            continue
        for law in (ms.Lighthill(), ms.GrayHancock()):
            other = ms.Swimmer(body=body, tail=tail, fluid=fluid, coefficients=law)
            gaits[law.law] = other.gait()
        for name, gait in gaits.items():
            found[name].append(told(gait, moment) / true - 1.0)
    return {name: np.abs(rows) for name, rows in found.items()}


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    heads = (
        ("on a sphere", ms.Sphere(radius=0.5), (0.2,)),
        ("without a body", ms.NoBody(), (0.0, 0.2)),
    )
    every = [(what, *row) for what, *of in heads for row in errors(*of).items()]
    for what, model, off in every:
        for name, x in zip(("step-out", "velocity there", "wobbling onset"), off.T):
            three = np.median(x), np.quantile(x, 0.9), x.max()
            print(f"{what:14s} {model:13s} {name:15s}", *(f"{100 * v:8.2g} %" for v in three))
