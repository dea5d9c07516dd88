"""What was aimed at, what was reached, and where it was not, which limit stands in the way."""

from __future__ import annotations

from typing import Any

DISTANCES = (
    "a kernel of 100 solves takes a root and an exponential for each of four groups, 1.6 ns each, "
    "and sums as long; plain helices have become four times as fast since the aim was set"
)
KERNELS = (
    "{count:,} kernels, 4 ns each for distance, root, exponential and sum; of one gait they are a "
    "tenth, the others are calls of Python"
)
FACTORS = (
    "every third step makes new factors, {again:.0f} s of MKL at its best on one core; the others "
    "take ten solves by GMRES with the former ones"
)
EVALUATE = (
    "C has the twist alone; `evaluate` also has the law, whether a design can be built, "
    "velocities, powers and efficiency: array operations of 0.4 ns a number and design each; of "
    "the 2 us of a design on disk that takes a quarter, expected errors, checksums, compression "
    "and reading back an eighth each (profiled)"
)
LU = "the factorisation runs at two thirds of what a matrix product reaches here"


def aims(kept: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """Rows of the table, from the results of all benchmarks."""
    surrogate, start = kept["surrogate"], kept["startup"]["processor seconds"]
    region, growth, studio = kept["region"], kept["growth"], kept["studio"]["milliseconds"]
    bem, sweep, fem = kept["bem"], kept["sweep"], kept["fem"]["seconds by part"]
    atlas = region["by the atlas"]["helix"]
    narrow = surrogate["AVX2 alone"]
    each = surrogate["microseconds per design, 32 nodes"]
    waves = growth["designs, plane wave"]
    through = surrogate["microseconds per design through evaluate"]
    alone = surrogate["microseconds per plane wave, 6 phases x 32 nodes"]
    step = next(row for row in fem if row["level"] == "paper")
    extra = bem["cost"]["estimate of the error, over the solve"]
    swept = 1e6 * sweep["surrogate"]["cpu_seconds"] / sweep["surrogate"]["designs"]
    took = step["a step in time"]
    solve = bem["peers"]["rows"][1]
    fitted = region["seconds of 100 solves and the fit, all cores"]
    return [
        (
            "helix in a batch, over C with lanes",
            "0.9",
            f"{surrogate['C over microswim']:.2f}; {narrow['C over microswim']:.2f} for AVX2 alone",
            "",
        ),
        (
            "the same through `evaluate`; through a sweep to disk",
            "0.9",
            ", ".join(f"{each['C'] / us:.2f} ({law})" for law, us in through.items())
            + f"; {each['C'] / swept:.2f}",
            EVALUATE,
        ),
        (
            "gait with its mean velocity; `ms.summary`",
            "100 us; 0.5 ms",
            f"{surrogate['microseconds with mean velocity']:.0f} us; "
            f"{surrogate['milliseconds with summary']:.2f} ms",
            "calls of Python, a microsecond each",
        ),
        (
            "plane wave in a batch",
            "12 us",
            f"{1e6 * waves['seconds'][-1] / waves['x'][-1]:.1f} us",
            f"twists at six phases alone: {alone['microswim']:.2f} us, in C {alone['C']:.2f}",
        ),
        (
            "helix calibrated over a region, in a batch, over plain",
            "2.0",
            f"{region['helix']['batch']['ratio']:.1f}; over Gray and Hancock's law "
            f"{region['helix']['batch']['ratio to Gray and Hancock']:.1f}",
            DISTANCES,
        ),
        (
            "helix by the atlas in a batch; one gait over plain",
            "30 us; 3",
            f"{atlas['batch']:.0f} us on one core; {atlas['gait over plain']:.1f}",
            KERNELS.format(count=2 * atlas["solves"]),
        ),
        (
            "helix by boundary elements to 0.1 %",
            "0.12 s",
            f"{solve[2]:.2f} s, off by {solve[3]:.2g} %",
            LU,
        ),
        (
            "plane wave by boundary elements",
            "0.8 s",
            f"{bem['cost']['seconds of a plane wave']:.2f} s",
            "",
        ),
        (
            "error estimate of `run --model bem`, over the solve",
            "0.5",
            f"{extra['helix']:.2f}; plane wave {extra['plane wave']:.2f}",
            "a helix has one phase to solve, and two thirds of its unknowns at the coarser level",
        ),
        (
            "calibration by 100 solves on two cores: helix; plane wave",
            "15; 60 s",
            f"{fitted['helix']:.0f}; {fitted['plane_wave']:.0f} s",
            "",
        ),
        (
            "100 boundary-element designs in a sweep on two cores",
            "6 s",
            f"{sweep['reference']['wall_seconds']:.1f} s (level {sweep['reference']['level']})",
            "",
        ),
        (
            "finite elements, a step at 310,000 unknowns",
            "30 s",
            f"{took:.0f} s",
            FACTORS.format(again=step["again"]),
        ),
        (
            "first map of plane waves in a fresh process",
            "2 s",
            f"{start['import, and a map of 20 x 20, plane wave']['seconds']:.1f} s",
            "",
        ),
        (
            "`microswim run`",
            "0.35 s",
            f"{start['microswim run, helix']['seconds']:.2f} s",
            f"import of NumPy and SciPy: {start['import numpy, scipy.linalg']['seconds']:.2f} s",
        ),
        (
            "studio: numbers; map of plane waves",
            "5; 40 ms",
            f"{studio['tabak/helix']['numbers']['least']:.1f}; "
            f"{studio['tabak/plane_wave']['map']['least']:.0f} ms",
            "",
        ),
    ]
