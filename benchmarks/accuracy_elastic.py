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
    return made(rng, sperm_number, radius=radius, drive=drive, angle=angle)


def made(rng, sperm_number, **tail):
    """The swimmer, its bending by the sperm number."""
    tail = ms.ElasticTail(length=1.0, bending=1.0, **tail)
    body = ms.Sphere(radius=float(rng.uniform(0.08, 0.3)))
    swimmer = ms.Swimmer(body=body, tail=tail, fluid=ms.Fluid(viscosity=1.0))
    c_n = swimmer.coefficients.local(tail, 1.0)[1]
    return stiffened(swimmer, float(tail.rate * c_n / sperm_number**4))


def stiffened(swimmer, bending):
    """The same with a bending stiffness, and inner moments that bend it as much."""
    moment = {"tail.moment": bending * swimmer.tail.moment} if swimmer.tail.moment else {}
    return swimmer.with_({"tail.bending": bending, **moment})


def heaved(rng):
    """The same moved across by a part of its head's radius."""
    radius = float(np.exp(rng.uniform(np.log(0.005), np.log(0.03))))
    share, sperm_number = float(rng.uniform(0.1, 0.4)), float(rng.uniform(1.5, 5.0))
    swimmer = made(rng, sperm_number, radius=radius, drive="heave", amplitude=1.0)
    return swimmer.with_({"tail.amplitude": share * swimmer.body.radius})


def bent_from_within(rng):
    """The same with a wave of inner moment."""
    radius = float(np.exp(rng.uniform(np.log(0.005), np.log(0.03))))
    moment, waves = float(rng.uniform(2.0, 8.0)), float(rng.uniform(0.7, 1.5))
    drive = {"drive": "moment", "moment": moment, "wavelength": 1.0 / waves}
    return made(rng, float(rng.uniform(1.5, 5.0)), radius=radius, **drive)


def in_space(rng):
    """A helix at rest, turned to and fro, moved across or bent from within."""
    radius = float(np.exp(rng.uniform(np.log(0.005), np.log(0.03))))
    drive = [
        {"drive": "pivot", "angle": float(rng.uniform(0.2, 0.6))},
        {"drive": "heave", "amplitude": float(rng.uniform(0.005, 0.03))},
        {"drive": "moment", "moment": float(rng.uniform(2.0, 6.0)), "wavelength": 1.0},
    ][rng.integers(3)]
    rest = {
        "rest_radius": float(rng.uniform(0.02, 0.05)),
        "rest_pitch": float(rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.2)),
    }
    return made(rng, float(rng.uniform(1.5, 5.0)), radius=radius, **drive, **rest)


def turned(rng, kind):
    """One that a field turns, at a random sperm number of its rate: a straight tail behind a
    head magnetised along it, a helix behind one magnetised across, a tail magnetised at its root.
    """
    radius = float(np.exp(rng.uniform(np.log(0.005), np.log(0.03))))
    head, sperm_number = float(rng.uniform(0.08, 0.3)), float(rng.uniform(1.0, 3.5))
    pull, cone = float(rng.uniform(2.0, 8.0)), float(rng.uniform(0.3, 1.3))
    given = {"length": 1.0, "radius": radius, "bending": 1.0, "drive": "none"}
    if kind == "helix":
        given |= {"rest_radius": float(rng.uniform(0.02, 0.05)),
                  "rest_pitch": float(rng.uniform(0.4, 0.9))}  # fmt: skip
        cone = 0.0
    size = pull * (8.0 * np.pi * head**3 + 1.0)  # of the moment, so that most are held
    along = {"wire": (size, 0.0, 0.0), "helix": (0.1 * size, size, 0.0), "root": None}[kind]
    if kind == "root":
        given |= {"magnet": (0.6 * size, 0.8 * size, 0.0), "magnet_span": (0.0, 0.3)}
    swimmer = ms.Swimmer(
        body=ms.Sphere(radius=head), tail=ms.ElasticTail(**given), fluid=ms.Fluid(viscosity=1.0),
        magnet=along and ms.Magnet(moment=along),
        field=ms.RotatingField(strength=6.0, frequency=1.0, cone=cone),
    )  # fmt: skip
    c_n = swimmer.coefficients.local(swimmer.tail, 1.0)[1]
    return swimmer.with_({"tail.bending": float(2.0 * np.pi * c_n / sperm_number**4)})


def in_a_field():
    """Rows of the kind, the regime, the error of the velocity and the share of the torque."""
    rng, rows = np.random.default_rng(SEED), []
    for i in range(2 * EACH):
        kind = ("wire", "helix", "root")[i % 3]
        one = turned(rng, kind)
        ours = ms.regimes(one, [1.0])
        truth = ms.regimes(one, [1.0], model="bem", level="coarse")
        off, share = ours.velocity[0] / truth.velocity[0] - 1.0, truth.expected_error["step_out"]
        rows.append((kind, ours.regime[0], abs(off), share))
        print(*rows[-1], flush=True)
    return rows


MORE = {"heave": heaved, "moment": bent_from_within, "in space": in_space}
EACH = 12  #: designs


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
    for name, drawn in MORE.items():
        rng = np.random.default_rng(SEED)
        found[name] = [misses(drawn(rng)) for _ in range(EACH)]
    print("drive: u_s, power, Omega_s, thrust; median and worst")
    for drive, rows in found.items():
        columns = zip(*rows)
        print(drive, ", ".join(f"{median(c):.0%} {max(c):.0%}" for c in columns))
    in_a_field()


if __name__ == "__main__":
    main()
