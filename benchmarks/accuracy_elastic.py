"""How far the model of elastic tails is from boundary elements on the motion it found.

    python benchmarks/accuracy_elastic.py      (two minutes on one core)

The figures of docs/elastic.md and of `microswim.calibration.atlas.expected`.
"""

from statistics import median

import numpy as np

import microswim as ms

DESIGNS, SEED = 24, 7


def design(rng, drive):
    """A sphere with a filament of length 1, of a random sperm number."""
    radius = float(np.exp(rng.uniform(np.log(0.005), np.log(0.03))))
    sperm_number, angle = float(rng.uniform(1.5, 5.0)), float(rng.uniform(0.2, 0.8))
    tail = ms.ElasticTail(length=1.0, radius=radius, bending=1.0, drive=drive, angle=angle)
    body = ms.Sphere(radius=float(rng.uniform(0.08, 0.3)))
    swimmer = ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0))
    c_n = swimmer.coefficients.local(tail, 1.0)[1]
    return swimmer.with_({"tail.bending": float(tail.rate * c_n / sperm_number**4)})


def misses(swimmer):
    """Relative differences of u_s, power, Omega_s and the thrust of the held motion."""
    numbers = []
    for model, options in (("elastic", {}), ("bem", {"level": "coarse"})):
        found = ms.summary(swimmer.gait(model, **options))
        mean = found["mean_velocity"]
        numbers.append([mean[0], found["mean_power"], mean[3], found["held_wrench"][0]])
    ours, truth = np.array(numbers)
    felt = np.abs(truth) > 1e-12 * np.abs(truth).max()  # Omega_s of a pivot averages out
    return np.where(felt, np.abs(ours / np.where(felt, truth, 1.0) - 1.0), 0.0)


def main():
    rng, found = np.random.default_rng(SEED), {"pivot": [], "rotate": []}
    for i in range(DESIGNS):
        drive = ("pivot", "rotate")[i % 2]
        found[drive].append(misses(design(rng, drive)))
    print("drive: u_s, power, Omega_s, thrust; median and worst")
    for drive, rows in found.items():
        columns = zip(*rows)
        print(drive, ", ".join(f"{median(c):.0%} {max(c):.0%}" for c in columns))


if __name__ == "__main__":
    main()
