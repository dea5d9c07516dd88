"""The campaign behind the atlas: designs, their solves, the fit (``make atlas``).

Scrambled Sobol points over the logarithms of the numbers, denser towards the edges and a tenth
beyond them, where no neighbour helps from outside: any first so many of them are a good design.
Solves are kept in a folder as they come; run again with more, the campaign goes on. Solves of
elsewhere are taken up from files (`solves`): ``make atlas ATLAS_ARGS="--designs 0 --solves FILE"``.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from microswim.calibration.atlas import coordinates, solves
from microswim.calibration.atlas.atlas import FILES, shipped
from microswim.calibration.atlas.fit import fit
from microswim.calibration.atlas.text import pack
from microswim.calibration.region.fit import Solved
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.jobs import references
from microswim.numerics.sobol import points
from microswim.swimmer.geometry.bodies import NoBody, Spheroid
from microswim.swimmer.geometry.tails.kinds import HelicalTail, PlaneWaveTail
from microswim.swimmer.surroundings.fluid import Fluid
from microswim.swimmer.swimmer import Swimmer

SEED = 17
#: Asymmetry of R from which on a solve is left out; the fit counts what is less as noise.
ASYMMETRY = 0.02
LEVEL = "standard"
#: Where designs are drawn: b k, k r_t, waves, body over filament radius, aspect ratio, ramp.
LOW = (0.045, 0.018, 0.45, 1.8, 0.46, 0.04)
HIGH = (2.7, 0.85, 8.5, 44.0, 5.4, 0.55)
#: Further bounds: k a, a / L and filament length over radius, of a helix and of a plane wave.
MOST = (8.0, 0.8)
LONGEST = {"helix": 1440.0, "plane_wave": 440.0}
TAILS: dict[str, Any] = {"helix": HelicalTail, "plane_wave": PlaneWaveTail}
ALONE = "_alone"  #: how the kinds of design without a body end
#: Boxes of the same numbers around robots and cells as people begin with them, and their designs.
FAMILIAR = (
    ((0.3, 0.12, 1.0, 5.0, 0.95, 0.08), (1.6, 0.6, 5.0, 16.0, 1.6, 0.15)),
    ((0.3, 0.025, 1.5, 12.0, 1.0, 0.08), (1.4, 0.1, 5.0, 40.0, 3.0, 0.3)),
)
EACH = 64
#: Boxes where u_s is a small difference of larger parts, and the answer needs more neighbours: a
#: body that is small for its helix, fourth its mean radius over the amplitude, a thick tail that is
#: nearly straight; and how many are drawn of them, of which fewer can be built.
CANCELLING = (
    (2048, (0.2, 0.018, 0.45, 0.1, 0.46, 0.04), (2.7, 0.4, 8.5, 0.4, 5.4, 0.55)),
    (128, (0.045, 0.3, 0.45, 6.0, 0.46, 0.04), (0.25, 0.85, 8.5, 40.0, 5.4, 0.55)),
)
#: The box of tails that leave their body steeply: third the amplitude over the length of the ramp.
STEEP = (2048, (0.2, 0.018, 0.9, 1.8, 0.46, 0.04), (2.7, 0.85, 6.0, 44.0, 5.4, 0.3))


def _within(count: int, low: Any, high: Any, seed: int) -> np.ndarray:
    """Return numbers (count, 6) within a box, logarithmic."""
    return np.array(low) * (np.array(high) / low) ** points(count, 6, seed)


def familiar(seed: int = SEED) -> np.ndarray:
    """Return numbers (2 EACH, 6) of designs such as people begin with."""
    return np.concatenate([_within(EACH, *box, seed + n) for n, box in enumerate(FAMILIAR)])


def cancelling(seed: int = SEED) -> np.ndarray:
    """Return numbers (n, 6) of designs whose u_s nearly cancels."""
    x = np.concatenate([_within(*box, seed + 5 + n) for n, box in enumerate(CANCELLING)])
    x[:, 3] *= x[:, 0] / x[:, 1]
    return x[(LOW[3] <= x[:, 3]) & (x[:, 3] <= HIGH[3])]


def steep(seed: int = SEED) -> np.ndarray:
    """Return numbers (n, 6) of designs whose tail leaves the body steeply."""
    x = _within(*STEEP, seed + 8)
    x[:, 2] = x[:, 0] / (2.0 * np.pi * x[:, 5] * x[:, 2])
    small = x[:, 3] * x[:, 1] < 0.1 * x[:, 0]
    return x[(LOW[2] <= x[:, 2]) & (x[:, 2] <= HIGH[2]) & ~small]


def drawn(count: int, seed: int = SEED, kind: str = "helix") -> np.ndarray:
    """Return numbers (count, 6) of designs, all logarithmic but the ramp.

    Without a body a quarter of them has no ramp, and the body's numbers are 0 and 1.
    """
    low, high = np.array(LOW), np.array(HIGH)
    u = points(count, 4 if kind.endswith(ALONE) else 6, seed)
    u = 0.5 * u + 0.25 * (1.0 - np.cos(np.pi * u))
    if kind.endswith(ALONE):
        ramp = 0.7 * u[:, 3] - 0.15
        first = low[:3] * (high[:3] / low[:3]) ** u[:, :3]
        still = np.zeros(count), np.ones(count)
        return np.column_stack([first, *still, np.where(ramp < low[5], 0.0, ramp)])
    x = low * (high / low) ** u
    x[:, 5] = low[5] + (high[5] - low[5]) * u[:, 5]
    return x


def design(x: Any, kind: str = "helix") -> Swimmer | None:
    """Return the swimmer of six numbers, in units of 1/k; None where it cannot be built.

    Parameters
    ----------
    x
        b k, k r_t, waves, body over filament radius, aspect ratio, ramp.
    kind
        Of design: ``"helix"``, ``"plane_wave"``, either with ``"_alone"`` if it has no body.
    """
    bk, thick, waves, head, aspect, ramp = map(float, x)
    a, length = head * thick, 2.0 * np.pi * waves
    slender = coordinates.ratios((bk, thick, waves, a, aspect, ramp), kind)[2]
    tail_kind = kind.removesuffix(ALONE)
    if a > MOST[0] or a > MOST[1] * length or slender > LONGEST[tail_kind]:
        return None
    body: Any = NoBody()
    if not kind.endswith(ALONE):
        body = Spheroid(semi_axes=(a * aspect ** (2.0 / 3.0), a * aspect ** (-1.0 / 3.0)))
    try:
        tail = TAILS[tail_kind](length=length, amplitude=bk, waves=waves, radius=thick, ramp=ramp)
    except SpecError:
        return None
    return Swimmer(body=body, tail=tail, fluid=Fluid(viscosity=1.0))


def solve(
    count: int, folder: Path, kind: str = "helix", seed: int = SEED, **options: Any
) -> list[Solved]:
    """Return the designs among `count`, and the familiar ones, that boundary elements resolve."""
    wanted = drawn(count, seed, kind)
    if not kind.endswith(ALONE):
        wanted = np.concatenate([wanted, familiar(seed)])
    if kind == "helix":
        wanted = np.concatenate([wanted, cancelling(seed), steep(seed)])
    designs = [s for s in map(partial(design, kind=kind), wanted) if s is not None]
    gaits = references.gaits(designs, "bem", folder=folder, level=LEVEL, **options)
    return [
        Solved(s, g)
        for s, g in zip(designs, gaits)
        if isinstance(g, Gait) and float(g.info.get("asymmetry") or 0.0) < ASYMMETRY
    ]


def main() -> None:
    """Solve the campaign and write the atlas that comes with the package."""
    parser = argparse.ArgumentParser(description="Solve and fit the atlas.")
    parser.add_argument("folder", type=Path, help="where solves are kept")
    parser.add_argument("--kind", choices=tuple(FILES), default="helix", help="of the tail")
    parser.add_argument("--designs", type=int, default=4096, help="how many are drawn; 0: none")
    parser.add_argument("--workers", type=int, default=None, help="processes; all cores by default")
    parser.add_argument("--solves", type=Path, nargs="*", help="files of solves to take up too")
    parser.add_argument("--kernels", action="store_true", help="find the kernels anew (minutes)")
    asked = parser.parse_args()
    kind = asked.kind
    own: Any = {"kind": kind, "workers": asked.workers}
    solved = solve(asked.designs, asked.folder, **own) if asked.designs else []
    for path in asked.solves or ():
        solved += solves.read(path, partial(design, kind=kind))
    # what lies outside helps where solves are few, and each answer pays for it
    most = 0 if kind == "helix" else 1
    missed = (coordinates.misses(coordinates.numbers(s.swimmer), kind) for s in solved)
    solved = [s for s, number in zip(solved, missed) if number <= most]
    former = None if asked.kernels else shipped(kind)
    made = fit(solved, {"reference": "bem", "level": LEVEL, "designs": asked.designs}, former)
    Path(__file__).with_name(FILES[kind]).write_bytes(pack(made))
    for i, name in enumerate(("u_s", "lateral u", "Omega_s", "lateral Omega")):
        median, most = np.quantile(made.misses.missed[:, i], [0.5, 0.99])
        print(f"{name}: left out, median {100 * median:.2g} %, 99 % {100 * most:.2g} %")
    print(f"{len(solved)} solves, range {coordinates.bounds(kind)}")


if __name__ == "__main__":
    main()
