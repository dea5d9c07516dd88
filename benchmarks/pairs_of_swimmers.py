"""Pairs of swimmers at random poses: `solve` and `estimate` at standard against `solve` at fine.

    python benchmarks/pairs_of_swimmers.py KIND [poses a distance] [first draw]

KIND is helix, wave or cell. Distances are those of the middles of their lengths, in lengths; errors
are the largest of a velocity, of each swimmer's own speed, or of a rotation, of its rate.
"""

import sys
import time

import numpy as np

import microswim as ms

KINDS = {
    "helix": ("tabak/helix", {}),
    "wave": ("tabak/plane_wave", {}),
    "cell": ("goto/C", {"motion.free": "all"}),
}
DISTANCES = (0.6, 1.0, 1.5, 2.0, 3.0)
PHASES = (0.4, 2.9)


def drawn(swimmer, away, rng):
    """A pair whose middles are so many lengths apart, in random attitudes."""
    length = float(swimmer.tail.reach) + 2.0 * float(swimmer.body.semi_axes3[0])
    to_middle = 0.5 * length - float(swimmer.body.semi_axes3[0])
    direction = rng.normal(size=3)
    middles = [np.zeros(3), away * length * direction / np.linalg.norm(direction)]
    members = []
    for middle, phase in zip(middles, PHASES):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        place = middle - to_middle * axis
        roll = rng.uniform(0.0, 2.0 * np.pi)
        members.append(
            ms.Member(swimmer=swimmer, position=place, direction=axis, roll=roll, phase=phase)
        )
    return ms.Group(tuple(members)), length


def off(found, true):
    """Largest error of each swimmer, of its speed and its rate of turning."""
    d = np.abs(found - true).reshape(-1, 2, 3).max(axis=2)
    return float((d / np.linalg.norm(true.reshape(-1, 2, 3), axis=2)).max())


def main(kind, count=3, first=0):
    name, changes = KINDS[kind]
    swimmer = ms.Swimmer.preset(name, changes)
    rng = np.random.default_rng([19, first, len(kind)])
    pairs = [(away, *drawn(swimmer, away, rng)) for away in DISTANCES for _ in range(count)]
    blocks = {level: pairs[0][1].prepared(level) for level in ("standard", "fine")}
    print("blocks made", flush=True)
    for away, pair, length in pairs:
        begun = time.process_time()
        try:
            true = pair.solve(blocks=blocks["fine"])
        except ms.SpecError as error:
            print(f"{away} refused: {error}", flush=True)
            continue
        exact = time.process_time() - begun
        begun = time.process_time()
        same = off(pair.solve(blocks=blocks["standard"]).velocity, true.velocity)
        quick = pair.estimate(blocks=blocks["standard"])
        told = 100.0 * float(np.max(quick.expected_error))
        print(
            f"{away:4.1f} gap {true.gap / length:6.3f}  solve {100 * same:7.3f} %  estimate "
            f"{100 * off(quick.velocity, true.velocity):7.3f} % (told {told:.3g} %)  fine "
            f"{exact:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
