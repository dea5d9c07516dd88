"""How wrong the atlas is: makes docs/accuracy-atlas.md on designs that it has not seen.

    python benchmarks/atlas.py --folder solves             # draws designs and solves them
    python benchmarks/atlas.py --solves held-out.jsonl     # from solves that are there already

The designs are drawn afterwards, uniform in the logarithms of their numbers over the range that the
atlas says it covers, with a seed of their own; none of them is ever fitted.
"""

from __future__ import annotations

import argparse
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

import microswim as ms
from microswim.calibration.atlas import coordinates, solves
from microswim.calibration.atlas.atlas import shipped
from microswim.calibration.atlas.campaign import LEVEL, design
from microswim.calibration.atlas.expected import doubt, expected_error
from microswim.calibration.region.fit import Solved
from microswim.gait.gait import Gait
from microswim.jobs import references
from microswim.numerics.sobol import points
from microswim.studies.world.page import table

PAGE = Path(__file__).parents[1] / "docs" / "accuracy-atlas.md"
SEED, DRAWN = 101, 620
LOW, HIGH = (np.array([n[i] for n in coordinates.NUMBERS]) for i in (1, 2))
EDGE = 0.1  #: a corner: two or more of the six numbers within this share of an end
SURE = 0.01  #: doubt of the reference in u_s below which a design counts as known
SMALL = 0.7  #: radius of a body over the amplitude below which u_s nearly cancels
QUANTILES = (0.5, 0.9, 0.95, 0.99, 1.0)


def drawn(folder):
    """Designs of the range, solved."""
    x = LOW * (HIGH / LOW) ** points(DRAWN, 6, SEED)
    made = [s for s in map(design, x) if s is not None and not coordinates.outside(s)]
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


def errors(solved):
    """Errors of u_s, Omega_s, u_q, Omega_q, and whether what was stated held, (n, 4) each.

    Of the means relative to themselves, of the amplitudes to their scale: the transverse speed of
    the helix, b times the motor's rate, and that rate.
    """
    off, held = [], []
    for s in solved:
        ours = s.swimmer.gait("atlas")
        stated = expected_error(s.swimmer, ours)
        truth, rate = s.gait, abs(ours.rate)
        mean = np.abs(ours.mean_velocity - truth.mean_velocity)[[0, 3]]
        size = np.abs(ours.velocity_amplitude - truth.velocity_amplitude)[[1, 5]]
        off.append([*mean / np.abs(truth.mean_velocity[[0, 3]]),
                    *size / [s.swimmer.tail.amplitude * rate, rate]])  # fmt: skip
        own = np.abs([*ours.mean_velocity[[0, 3]], *ours.velocity_amplitude[[1, 5]]])
        held.append([*mean, *size] <= own * [stated[n] for n in ("us", "os", "uq", "or")])
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


def rows(off, held, some):
    """A row for each quantity over some of the designs."""
    names = "u_s", "Omega_s", "amplitude of u_q, of b rate", "amplitude of Omega_q, of the rate"
    out = []
    for i, name in enumerate(names):
        shares = [per_cent(q) for q in np.quantile(off[some, i], QUANTILES)]
        row = dict(zip(("median", "90 %", "95 %", "99 %", "worst"), shares))
        stated = f"{100 * held[some, i].mean():.1f} %"
        out.append({"error of": name, **row, "stated 95 % held": stated})
    return out


TEXT = """# How wrong the atlas is

Made by `python benchmarks/atlas.py`; do not edit. The atlas was fitted to {solves} boundary-element
solves (level `{level}`). Here are {count} designs that were drawn afterwards, uniform in the
logarithms of their numbers over the whole range it covers, with a seed of their own. None of them
was fitted.

Mean velocities are off relative to themselves. Lateral velocities have no mean: the errors of their
amplitudes are relative to their **scale**, the transverse speed of the helix, its amplitude b times
the motor's rate (and that rate itself for Omega_q). An amplitude itself may be a small share of
that scale, and its own relative error then larger: the output states that one. The last column
says how many of the designs lie within the error that the output stated.

{whole}

**Where the truth is in doubt.** A body smaller than its helix turns against the tail so fast that
u_s is a small difference of large parts. What the resistance lacks in symmetry at level `{level}`
then says that the boundary elements themselves know u_s to some per cent only. Of the {count}
designs {sure} are known to 1 %, and over these the atlas is off by

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


def page(solved):
    """Write the page."""
    made = shipped()
    assert made is not None
    off, held = errors(solved)
    corner = np.array([is_corner(s.swimmer) for s in solved])
    sure = np.array([doubt(s.gait)[0] < SURE for s in solved])
    small = np.array([is_small(s.swimmer) for s in solved])
    of_truth, of_own = 100.0 * lighthill(solved)
    text = TEXT.format(
        solves=f"{made.about['solves']:,}",
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
    PAGE.write_text(text, encoding="utf-8")


def main():
    """Solve or read, then write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, help="where solves are kept")
    parser.add_argument("--solves", type=Path, help="a file of solves in place of new ones")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    solved = solves.read(asked.solves, design) if asked.solves else drawn(asked.folder)
    page([s for s in solved if not coordinates.outside(s.swimmer)])


if __name__ == "__main__":
    main()
