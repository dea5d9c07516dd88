"""How wrong the atlas is: makes docs/accuracy-atlas.md on designs that it has not seen.

    python benchmarks/atlas.py --folder solves      # draws designs and solves them
    python benchmarks/atlas.py --helices A --waves B --helices-alone C --waves-alone D  # solved

The designs are drawn afterwards, uniform in the logarithms of their numbers over the range that the
atlas says it covers, with a seed of their own; none of them is ever fitted.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

import microswim as ms
from microswim.calibration.atlas import coordinates, solves
from microswim.calibration.atlas.atlas import shipped
from microswim.calibration.atlas.campaign import ALONE, LEVEL, design
from microswim.calibration.atlas.expected import doubt, expected_error
from microswim.calibration.atlas.fit import held as turned
from microswim.calibration.region.fit import Solved
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.jobs import references
from microswim.numerics.sobol import points
from microswim.studies.world.page import table

PAGE = Path(__file__).parents[1] / "docs" / "accuracy-atlas.md"
#: Draws of each kind: seed and number.
DRAWN = {
    "helix": ((101, 720), (131, 420), (557, 170), (571, 400)),
    "plane_wave": ((201, 300),),
    "helix_alone": ((103, 220),),
    "plane_wave_alone": ((203, 400),),
}
LOW, HIGH = (np.array([n[i] for n in coordinates.NUMBERS]) for i in (1, 2))
EDGE = 0.1  #: a corner: two or more of the six numbers within this share of an end
SURE = 0.01  #: doubt of the reference in u_s below which a design counts as known
SMALL = 0.7  #: radius of a body over the amplitude below which u_s nearly cancels
QUANTILES = (0.5, 0.9, 0.95, 0.99, 1.0)


def drawn(kind, folder):
    """Designs of the range, solved."""
    u = np.concatenate([points(number, 6, seed) for seed, number in DRAWN[kind]])
    x = LOW * (HIGH / LOW) ** u
    x[:, 3] /= x[:, 1]  # `design` takes the body's radius over the filament's
    if kind.endswith(ALONE):  # a quarter without a ramp, the others from 0.05 to 0.5
        x[:, 3:5] = 0.0, 1.0
        x[::4, 5] = 0.0
    every = map(partial(design, kind=kind), x)
    return solved_by_bem([s for s in every if s and not coordinates.outside(s)], folder)


def solved_by_bem(made, folder):
    """Designs and their gaits, where there is one."""
    gaits = references.gaits(made, "bem", folder=folder, level=LEVEL)
    return [Solved(s, g) for s, g in zip(made, gaits) if isinstance(g, Gait)]


def is_corner(swimmer):
    """Whether two of its numbers are near an end of the range."""
    t = np.log(coordinates.numbers(swimmer) / LOW) / np.log(HIGH / LOW)
    return np.sum((t < EDGE) | (t > 1.0 - EDGE)) >= 2


def is_small(swimmer):
    """Whether its body is small for its helix."""
    bk, _, _, head, *_ = coordinates.numbers(swimmer)
    return head / bk < SMALL


#: What is compared of a kind: names of means and of amplitudes, and their places.
COMPARED = {
    "helix": (("u_s", "Omega_s"), ("u_q", "Omega_q"), [0, 3], [1, 5]),
    "plane_wave": (("u_s",), ("u_q", "Omega_r"), [0], [1, 5]),
}


def errors(solved, kind="helix"):
    """Errors of means and amplitudes, and whether what was stated held, (n, quantities) each.

    Of the means relative to themselves, of the amplitudes to their scale: the transverse speed of
    the tail, b times the motor's rate, and that rate.
    """
    _, _, means, sizes = COMPARED[kind]
    off, held = [], []
    for s in solved:
        ours = s.swimmer.gait("atlas")
        stated = expected_error(s.swimmer, ours)
        truth, rate = s.gait, abs(ours.rate)
        mean = np.abs(ours.mean_velocity - truth.mean_velocity)[means]
        size = np.abs(ours.velocity_amplitude - truth.velocity_amplitude)[sizes]
        off.append([*mean / np.abs(truth.mean_velocity[means]),
                    *size / [s.swimmer.tail.amplitude * rate, rate]])  # fmt: skip
        own = np.abs([*ours.mean_velocity[means], *ours.velocity_amplitude[sizes]])
        asked = [stated[DEGREES_OF_FREEDOM[i]] for i in (*means, *sizes)]
        held.append([*mean, *size] <= own * asked)
    return np.array(off), np.array(held)


def lighthill(solved):
    """How far plain resistive force theory is off in u_s: of the truth, and of its own answer."""
    out = []
    for s in solved:
        plain = replace(s.swimmer, coefficients=ms.Lighthill())
        try:
            ours = plain.gait("rft").mean_velocity[0]
        except ms.SpecError:
            continue
        miss = abs(ours - s.gait.mean_velocity[0])
        out.append([miss / abs(s.gait.mean_velocity[0]), miss / abs(ours)])
    return np.median(out, axis=0)


def per_cent(share):
    """A share to two digits."""
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def rows(off, held, some, kind="helix"):
    """A row for each quantity over some of the designs."""
    means, (across, turning), *_ = COMPARED[kind]
    names = *means, f"amplitude of {across}, of b rate", f"amplitude of {turning}, of the rate"
    out = []
    for i, name in enumerate(names):
        shares = [per_cent(q) for q in np.quantile(off[some, i], QUANTILES)]
        row = dict(zip(("median", "90 %", "95 %", "99 %", "worst"), shares))
        stated = f"{100 * held[some, i].mean():.1f} %"
        out.append({"error of": name, **row, "stated 95 % held": stated})
    return out


TEXT = """# How wrong the atlas is

Made by `python benchmarks/atlas.py`; do not edit.

## Helices

The atlas of helices was fitted to {solves} boundary-element solves (level `{level}`). Here are
{count} designs that were drawn afterwards, uniform in the logarithms of their numbers over the
whole range it covers, with seeds of their own. None of them was fitted.

Mean velocities are off relative to themselves. Lateral velocities have no mean: the errors of their
amplitudes are relative to their **scale**, the transverse speed of the helix, its amplitude b times
the motor's rate (and that rate itself for Omega_q). An amplitude itself may be a small share of
that scale, and its own relative error then larger: the output states that one. The last column
says how many of the designs lie within the error that the output stated.

{whole}

Outside the range plain resistive force theory answers: for bodies below 0.15 of the amplitude
(radius of the sphere of their volume), which turn against the tail so fast that u_s is a small
difference of large parts, for tails that stand up beside the body (amplitude over twice the
ramp), and for tails that lean so much that their root comes out of the far side of the body's end
([open roots](accuracy-bem.md)), where level `{level}` itself is up to 17 % off.

What the resistance lacks in symmetry at level `{level}` says that the boundary elements
themselves know u_s of some to some per cent only. Over the {sure} designs known to 1 %:

{known}

{small} have a body (radius of the sphere of its volume) below 0.7 of the amplitude; without them:

{large}

The {corners} corners among them, designs with two or more of the six numbers within a tenth of an
end of the range:

{corner}

**Plain resistive force theory** (Lighthill's law) over the same designs is off in u_s by
{of_truth:.0f} % of the truth in the median, or {of_own:.0f} % of its own, too large answer.
How much depends on where one looks: for robots of the paper's proportions (helix 1 to 3 long,
amplitude 0.04 to 0.25, 0.8 to 4 waves, filament radius 0.02 to 0.06, sphere of radius 0.5)
it is 81 % of the truth in the median of 14 random designs and 204 % at worst, and
the same 14 give 45 % when counted by its own answer.
"""


WAVES = """## Plane waves

The atlas of plane waves was fitted to {solves} solves; filaments are at most {longest:.0f} radii
long. Here are {count} designs drawn afterwards, none of them fitted, as above: the mean forward
velocity relative to itself, the amplitudes of the beat's u_q and Omega_r to b times the motor's
rate, and to that rate.

{whole}

The {sure} designs of which boundary elements know u_s to 1 %:

{known}

The {corners} corners, two or more of the six numbers within a tenth of an end of the range:

{corner}

{plain}"""

WAVES_ALONE = """## Plane waves without a body

A beating filament alone, with a ramp or (a quarter of the designs) without; fitted to {solves}
solves, {count} designs drawn afterwards:

{whole}

The {sure} designs of which boundary elements know u_s to 1 %:

{known}

{plain}"""
LIGHTHILL = """Plain resistive force theory (Lighthill's law) over the same designs is off in u_s by
{of_truth:.0f} % of the truth in the median, {of_own:.0f} % of its own answer.
"""


ALONE_TEXT = """## Helices without a body

Free in all, a helix alone rests: what its motor turns, turns back. A field that turns it drives it
by its resistance, which the atlas holds from {solves} solves. Here are {count} designs drawn
afterwards, a quarter of them without a ramp, turned at a given rate against the lab (`motion.free`
without `os`): forward velocity and torque relative to themselves, lateral velocities as above.

{whole}

Plain resistive force theory (Lighthill's law) over the same designs is off in u_s by
{plain:.0f} % in the median, {most:.0f} % in one of twenty.
"""
TURNED = ("us", "uq", "ur", "oq", "or")


def of_alone(solved):
    """The page's part on helices without a body."""
    off, kept, plain = [], [], []
    for s in solved:
        driven = s.swimmer.with_({"motion.free": TURNED})
        ours = driven.gait("atlas")
        stated, rate = expected_error(driven, ours), abs(ours.rate)
        truth, mine = (turned(np.real(g.resistance(0.0))) for g in (s.gait, ours))
        miss = np.abs(mine - truth)
        size = [abs(truth[0]), s.swimmer.tail.amplitude, abs(truth[2]), 1.0]
        off.append(miss / size)
        told = [stated["us"] * abs(mine[0]), np.inf]
        told += [stated[n] * ours.velocity_amplitude[i] / rate for n, i in (("uq", 1), ("oq", 4))]
        kept.append(miss[[0, 2, 1, 3]] <= told)
        law = replace(driven, coefficients=ms.Lighthill()).gait("rft")
        plain.append(abs(law.mean_velocity[0] / rate / truth[0]) - 1.0)
    off, kept = np.array(off)[:, [0, 2, 1, 3]], np.array(kept)
    names = "u_s", "torque", "lateral u, of b rate", "lateral Omega, of the rate"
    lines = []
    for i, name in enumerate(names):
        shares = [per_cent(q) for q in np.quantile(off[:, i], QUANTILES)]
        held = "not stated" if i == 1 else f"{100 * kept[:, i].mean():.1f} %"
        row = dict(zip(("median", "90 %", "95 %", "99 %", "worst"), shares))
        lines.append({"error of": name, **row, "stated 95 % held": held})
    plain = 100.0 * np.quantile(np.abs(plain), [0.5, 0.95])
    return ALONE_TEXT.format(
        solves=f"{shipped('helix_alone').about['solves']:,}",
        count=len(solved),
        whole=table(lines),
        plain=plain[0],
        most=plain[1],
    )


def of_helices(solved):
    """The page's part on helices."""
    off, held = errors(solved)
    corner = np.array([is_corner(s.swimmer) for s in solved])
    sure = np.array([0.0 < doubt(s.gait)[0] < SURE for s in solved])
    small = np.array([is_small(s.swimmer) for s in solved])
    of_truth, of_own = 100.0 * lighthill(solved)
    return TEXT.format(
        solves=f"{shipped().about['solves']:,}",
        level=LEVEL,
        count=len(solved),
        corners=corner.sum(),
        small=small.sum(),
        sure=sure.sum(),
        known=table(rows(off, held, sure)),
        large=table(rows(off, held, ~small)),
        whole=table(rows(off, held, np.ones(len(solved), bool))),
        corner=table(rows(off, held, corner)),
        of_truth=of_truth,
        of_own=of_own,
    )


def of_waves(solved, kind="plane_wave", text=WAVES):
    """The page's part on plane waves, on a body or alone."""
    off, held = errors(solved, "plane_wave")
    sure = np.array([0.0 < doubt(s.gait)[0] < SURE for s in solved])
    corner = np.array([is_corner(s.swimmer) for s in solved])
    of_truth, of_own = 100.0 * lighthill(solved)
    parts = {
        "whole": np.ones(len(solved), bool),
        "known": sure,
        "corner": corner,
    }
    tables = {n: table(rows(off, held, some, "plane_wave")) for n, some in parts.items()}
    return text.format(
        solves=f"{shipped(kind).about['solves']:,}",
        longest=coordinates.WAVES["length along the filament / its radius"][2],
        count=len(solved),
        corners=corner.sum(),
        sure=sure.sum(),
        plain=LIGHTHILL.format(of_truth=of_truth, of_own=of_own),
        **tables,
    )


waves_alone = partial(of_waves, kind="plane_wave_alone", text=WAVES_ALONE)


def main():
    """Solve or read, then write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, help="where solves are kept")
    parser.add_argument("--helices", type=Path, help="a file of solves in place of new ones")
    parser.add_argument("--waves", type=Path, help="the same of plane waves")
    parser.add_argument("--helices-alone", type=Path, help="the same of helices without a body")
    parser.add_argument("--waves-alone", type=Path, help="the same of plane waves without one")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    parts = []
    for kind, path, part in (
        ("helix", asked.helices, of_helices),
        ("plane_wave", asked.waves, of_waves),
        ("helix_alone", asked.helices_alone, of_alone),
        ("plane_wave_alone", asked.waves_alone, waves_alone),
    ):
        own = partial(design, kind=kind)
        solved = solves.read(path, own) if path else drawn(kind, asked.folder)
        parts.append(part([s for s in solved if not coordinates.outside(s.swimmer)]))
    PAGE.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
