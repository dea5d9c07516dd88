"""How often the 95 % intervals of `identify_swimmer` hold the truth, over random designs.

    python benchmarks/intervals.py wave helix path --count 200 --first 1000 --out intervals.csv

Every design, its pose, its noise and its sampling are drawn anew; the fit starts from nothing, with
the preset as all that is known. A line for each fit goes to the file, and what is there already is
not done again. Kinds: ``wave``, a planar beat in the image; ``helix``, with its attitude; ``path``,
a helix from its path alone; ``off``, a planar beat whose model is off by its stated error;
``curved``, a planar beat with a mean curvature; ``law``, a planar beat made by another law of drag
than the fit's, whose stated error is the difference of the two over 200 other designs. Of tracks
made by boundary elements, the model's own stated error in the intervals: ``wave-bem``,
``helix-bem``, ``path-bem``, fitted by the atlas, and ``calibrated``, a planar beat fitted by a
surrogate that is calibrated at one design; ``flagellum``, a sperm of random head, wave and bend
that circles, fitted by a law of drag drawn at random. Of planar beats whose tail and body are made
of beads (`beaded`): ``beads``, fitted by a surrogate that is calibrated at one design of them, and
``beads-law``, by a law whose stated error is the difference of the two over 60 other designs.

Where several designs are listed the one that a value is asked of is chosen by the *other* values:
that whose other values lie nearest to the truth. Choosing by the value itself would be kind. Where
the others do not tell designs apart, as where the model is off, that choice is chance: an interval
holds *if this design it is*. So ``own_low`` and ``own_high`` are those of the design that *is* that
of the truth, where least squares lead from it; a list without it holds nothing. Column ``inside``
is whether one listed design holds *all* values, which needs no choice.
"""

from __future__ import annotations

import argparse
import csv
import time
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from accuracy_flagella import design as flagellum
from beaded import beaded
from scipy.stats import beta, norm

import microswim as ms
from microswim.numerics.rigid_motion import multiply
from microswim.studies.identification.fitting import first_guesses, honesty, outcome, within_errors
from microswim.studies.identification.paths import path_of
from microswim.swimmer.drag.coefficients import Unchosen

SAME = 1e-3  #: relative, within which two fits are one design
NAMES = ("tail.amplitude", "tail.waves", "tail.frequency")
OFF = np.array([0.1, 0.1, 0.0, 0.0, 0.0, 0.1])  #: stated relative errors of ``off``
COLUMNS: tuple[str, ...] = (
    "kind",
    "seed",
    "name",
    "truth",
    "value",
    "low",
    "high",
    "listed",
    "why",
    "seconds",
    "inside",
    "own_low",
    "own_high",
)


def drawn(rng: np.random.Generator, kind: str, seed: int = 0) -> dict[str, float]:
    """Return a design out of the range of cells and robots; a flagellum is that of its seed."""
    if kind == "flagellum":
        own = flagellum(np.random.default_rng(seed)).numbers
        return {name: own[name] for name in (*NAMES, "tail.mean_curvature")}
    values = {
        "tail.amplitude": float(np.exp(rng.uniform(np.log(0.05), np.log(0.25)))),
        "tail.waves": float(rng.uniform(1.0, 4.0)),
        "tail.frequency": float(rng.uniform(0.7, 1.5)),
    }
    if kind == "curved":
        values["tail.mean_curvature"] = float(rng.uniform(-0.4, 0.4))
    return values


@cache
def known_of(kind: str, seed: int = 0) -> ms.Swimmer:
    """Return the swimmer as far as it is known; of a flagellum its head and a usual wave."""
    if kind == "flagellum":
        usual = {"tail.amplitude": 1.1 / (2.0 * np.pi * 1.1), "tail.waves": 1.1}
        rng = np.random.default_rng([seed, *b"law"])
        law = (ms.Lighthill(), ms.GrayHancock(), ms.Cox())[int(rng.integers(3))]
        return replace(flagellum(np.random.default_rng(seed)), coefficients=law).with_(
            usual | {"tail.mean_curvature": 0.0}
        )
    helical = kind.startswith(("helix", "path"))
    known = ms.Swimmer.preset("tabak/helix" if helical else "tabak/plane_wave")
    if kind == "curved":
        return known.with_({"tail.mean_curvature": 0.0})
    if kind == "calibrated":
        return ms.calibrate(known, known.gait("bem", level="standard")).swimmer
    if kind == "beads":
        return ms.calibrate(known, replace(beaded(known), model="bem")).swimmer
    return replace(known, coefficients=Unchosen()) if kind in ELEMENTS else known


def made_by(kind: str, swimmer: ms.Swimmer) -> ms.Gait:
    """Return the gait that makes the track: of the fit's own law, another law, elements, beads."""
    if kind.startswith("beads"):
        return beaded(swimmer)
    if kind == "flagellum":
        return swimmer.gait("bem", level="coarse")
    if kind in (*ELEMENTS, "calibrated"):
        return swimmer.gait("bem", level="standard")
    return (replace(swimmer, coefficients=ms.Cox()) if kind == "law" else swimmer).gait("rft")


@cache
def off_by(kind: str = "law", count: int = 200) -> np.ndarray:
    """Return how far what makes the tracks is off the fit's law: in 19 of 20 designs."""
    rng, rows = np.random.default_rng(2300), []
    known = known_of(kind)
    while len(rows) < count:
        try:
            one = known.with_(drawn(rng, kind))
            fitted, made = one.gait("rft"), made_by(kind, one)
        except ms.MicroswimError:
            continue
        sizes = [np.r_[g.mean_velocity[0], g.velocity_amplitude[[1, 5]]] for g in (fitted, made)]
        rows.append(np.abs(sizes[1] / sizes[0] - 1.0))
    us, uq, turn = np.quantile(rows, 0.95, axis=0)
    return np.array([us, uq, 0.0, 0.0, 0.0, turn])


def turned(rng: np.random.Generator, n: int, size: float) -> np.ndarray:
    """Return n small random turns, quaternions."""
    half = 0.5 * size * rng.normal(size=(n, 3))
    q = np.concatenate([np.ones((n, 1)), half], axis=1)
    return q / np.linalg.norm(q, axis=1, keepdims=True)


def planted(kind: str, seed: int) -> tuple[ms.Swimmer, ms.Track, dict[str, float]]:
    """Return what is known of a swimmer, its track, and the truth."""
    rng = np.random.default_rng([seed, *kind.encode()])
    known = known_of(kind, seed if kind == "flagellum" else 0)
    spatial = known.tail.is_rigid
    while True:
        values = drawn(rng, kind, seed)
        try:
            swimmer = known.with_(values)
            gait = made_by(kind, swimmer)
            break
        except ms.MicroswimError:
            continue
    if kind == "off":
        for k in np.flatnonzero(OFF):
            gait = honesty.scaled(gait, int(k), OFF[k] / 2.0 * rng.normal())
    beats, frames = rng.uniform(6.0, 20.0), rng.uniform(8.0, 20.0)
    n = int(beats * frames)
    t = np.arange(n) / (frames * values["tail.frequency"])
    x, q = path_of(swimmer, gait, t, float(rng.uniform(0.0, 2.0 * np.pi)))
    wobble = float(np.std(x - ms.Track(time=t, position=x).smooth))
    noise = wobble * float(np.exp(rng.uniform(np.log(0.02), np.log(0.3))))
    if spatial:
        pose = rng.normal(size=4)
        pose /= np.linalg.norm(pose)
        from scipy.spatial.transform import Rotation

        x = Rotation.from_quat(pose, scalar_first=True).apply(x)
        q = multiply(multiply(np.tile(pose, (n, 1)), q), turned(rng, n, 0.02))
    else:
        z = (x[:, 0] + 1j * x[:, 1]) * np.exp(2j * np.pi * rng.uniform())
        x = np.stack([z.real, z.imag], axis=-1)
    x = x + noise * rng.normal(size=x.shape)
    return (
        known,
        ms.Track(time=t, position=x, quaternion=q if kind.startswith("helix") else None),
        values,
    )


def tried(kind: str, seed: int) -> list[dict[str, Any]]:
    """Return what a fit says of each unknown."""
    known, track, truth = planted(kind, seed)
    begun = time.process_time()
    line: dict[str, Any] = {"kind": kind, "seed": seed, "listed": "", "why": ""}
    try:
        outcome.model_errors = within_errors.model_errors = STATED.get(kind, none)
        found = ms.identify_swimmer(known, track, tuple(truth), model_error=kind in STATED)
    except ms.MicroswimError as error:
        line |= {"why": str(error), "seconds": round(time.process_time() - begun, 2)}
        return [line | {"name": name, "truth": value} for name, value in truth.items()]
    line |= {"seconds": round(time.process_time() - begun, 2), "why": found.withheld[:60]}
    line["listed"] = len(found.branches)
    wanted = np.array(list(truth.values()))
    if not found.branches:
        return [line | {"name": name, "truth": value} for name, value in truth.items()]
    line["inside"] = int(any(holds(b.interval(), wanted) for b in found.branches))
    own = truths_own(known, track, truth, found.branches)
    ends = np.full((len(truth), 2), np.nan) if own is None else own.interval()
    lines = []
    for i, name in enumerate(truth):
        one = min(found.branches, key=lambda b, i=i: elsewhere(b.values, wanted, i))
        low, high = one.interval()[i]
        value = one.values[i]
        of_own = {"own_low": ends[i, 0], "own_high": ends[i, 1]}
        lines.append(
            line | of_own
            | {"name": name, "truth": wanted[i], "value": value, "low": low, "high": high}
        )  # fmt: skip
    return lines


def truths_own(
    known: ms.Swimmer, track: ms.Track, truth: dict[str, float], listed: tuple[Any, ...]
) -> Any:
    """Return the listed design to which least squares lead from the truth, None if none is it."""
    reached = ms.identify_swimmer(known, track, tuple(truth), start=truth, model_error=False).values
    same = [b for b in listed if np.allclose(b.values, reached, rtol=SAME, atol=0.0)]
    around = [b for b in listed if within(b.interval(), reached)]
    return min(same or around, key=lambda b: elsewhere(b.values, reached, None), default=None)


def within(ends: np.ndarray, values: np.ndarray) -> bool:
    """Return whether all values lie in their intervals."""
    return bool(((ends[:, 0] <= values) & (values <= ends[:, 1])).all())


def holds(ends: np.ndarray, wanted: np.ndarray) -> bool:
    """Return whether intervals of all values, 95 % each, hold the truth, or come near to it.

    Three intervals of 95 % hold all at once less often; so each end is asked at 98.3 %.
    """
    low, high = np.asarray(ends).T
    middle, wide = (low + high) / 2.0, norm.ppf(1 - 0.05 / 6) / norm.ppf(0.975)
    return bool((abs(wanted - middle) <= wide * (high - low) / 2.0).all())


def elsewhere(values: np.ndarray, wanted: np.ndarray, i: int | None) -> float:
    """Return how far the values other than number i are from those wanted; all without i."""
    off = (values - wanted) / wanted
    return float(np.sum((off if i is None else np.delete(off, i)) ** 2))


def none(own: Any) -> None:
    """Return no error of the model."""


ELEMENTS = ("wave-bem", "helix-bem", "path-bem")
#: Stated errors of the models that are off: as planted, as counted, or the model's own.
STATED: dict[str, Any] = {
    "off": lambda own: OFF, "law": lambda own: off_by(),
    "beads-law": lambda own: off_by("beads-law", 60),
    **dict.fromkeys((*ELEMENTS, "calibrated", "beads", "flagellum"), honesty.model_errors),
}  # fmt: skip


def told(path: Path) -> None:
    """Print how often the intervals hold, each rate with its own 95 % interval [Clopper 1934]."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    for kind in dict.fromkeys(row["kind"] for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        tracks = len({row["seed"] for row in own})
        given = [row for row in own if row["low"]]
        count = len({row["seed"] for row in given})
        several = len({row["seed"] for row in given if int(row["listed"]) > 1})
        print(f"{kind}: {tracks} tracks, {count} with intervals, {several} of them a list")
        if given and given[0].get("inside"):
            whole = {row["seed"]: int(row["inside"]) for row in given}
            print(f"  one design holds all values   {sum(whole.values())}/{len(whole)}")
        for name, only in ((n, o) for n in dict.fromkeys(r["name"] for r in given) for o in (0, 1)):
            some = [row for row in given if row["name"] == name]
            some = [row for row in some if not only or int(row["listed"]) == 1]
            if not some:
                continue
            said = f"{name} (one design)" if only else name
            print(f"  {said:34s} {rate(some, 'low', 'high')}   {deviation(some)}")
            own = [row for row in some if row.get("own_low") and not only]
            if own:
                print(f"  {'  the design of the truth':34s} {rate(own, 'own_low', 'own_high')}")


def rate(rows: list[dict[str, str]], low: str, high: str) -> str:
    """Return how many of the intervals in two columns hold the truth, with the rate's own."""
    hits = sum(float(r[low]) <= float(r["truth"]) <= float(r[high]) for r in rows)
    n = len(rows)
    least = beta.ppf(0.025, hits, n - hits + 1) if hits else 0.0
    most = beta.ppf(0.975, hits + 1, n - hits) if hits < n else 1.0
    return f"{hits}/{n} = {hits / n:.3f}   ({least:.3f} to {most:.3f})"


def deviation(rows: list[dict[str, str]]) -> str:
    """Return the deviation of the values in those that the intervals state: 1 where they are right.

    Values more than two half widths away are of another design and are counted apart.
    """
    truth, value, low, high = (
        np.array([float(row[name]) for row in rows]) for name in ("truth", "value", "low", "high")
    )
    off = (truth - value) / np.where(truth > value, high - value, value - low)
    near = np.abs(off) < 2.0
    size = norm.ppf(0.975) * np.sqrt(np.mean(off[near] ** 2))
    return f"deviation {size:.2f}, {np.count_nonzero(~near)} far away"


def main() -> None:
    """Run what is not there yet, then tell the rates."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("kinds", nargs="+")
    options.add_argument("--count", type=int, default=200)
    options.add_argument("--first", type=int, default=0, help="the first seed")
    options.add_argument("--out", type=Path, default=Path("intervals.csv"))
    given = options.parse_args()
    done = set()
    if given.out.is_file():
        with given.out.open(newline="") as file:
            done = {(row["kind"], int(row["seed"])) for row in csv.DictReader(file)}
    for seed in range(given.first, given.first + given.count):
        for kind in given.kinds:
            if (kind, seed) in done:
                continue
            lines = tried(kind, seed)
            new = not given.out.is_file()
            with given.out.open("a", newline="") as file:
                writer = csv.DictWriter(file, COLUMNS, restval="")
                if new:
                    writer.writeheader()
                writer.writerows(lines)
    told(given.out)


def once(function: Any) -> Any:
    """Return a function that works out the grid of the two presets once, not for every track."""
    kept: dict[Any, Any] = {}

    def called(swimmer: ms.Swimmer, grid: dict[str, np.ndarray], **options: Any) -> Any:
        sizes = [v.size for v in grid.values()]
        law = repr((swimmer.coefficients, swimmer.interaction, swimmer.body, swimmer.numbers))
        key = (swimmer.tail.kind, law, "tail.mean_curvature" in swimmer.numbers, *grid, *sizes)
        if max(sizes) < 50:
            return function(swimmer, grid, **options)
        if key not in kept:
            kept[key] = function(swimmer, grid, **options)
        return kept[key]

    return called


def alike(function: Any) -> Any:
    """Return a function that works out the errors over a grid once for what states them."""
    kept: dict[Any, Any] = {}

    def called(grid: Any) -> Any:
        key = (outcome.model_errors, repr(grid.swimmer))
        if key not in kept:
            kept[key] = function(grid)
        return kept[key]

    return called


if __name__ == "__main__":
    first_guesses.shown = once(first_guesses.shown)
    within_errors.finely = alike(within_errors.finely)
    main()
