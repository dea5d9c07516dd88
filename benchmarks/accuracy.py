"""How wrong the surrogate is: makes docs/accuracy.md, and the README's table of it.

    python benchmarks/accuracy.py --folder solves            # everything, then the page
    python benchmarks/accuracy.py --folder solves helix      # some parts, then the page
    python benchmarks/accuracy.py --folder solves --calibrated specs helix   # fitted already
    python benchmarks/accuracy.py page                       # the page from what is stored

Parts: one (one-design calibration over the base case's neighbourhood), rotation (the plane wave's
negative coefficient), helix and plane_wave (region calibration, errors on designs drawn
afterwards). Each goes to benchmarks/results/accuracy.json as soon as it is there; solves are kept
in the folder. With --calibrated, the regions are those of DIR/helix.toml and DIR/plane_wave.toml,
made by `microswim calibrate --region`.
"""

from __future__ import annotations

import argparse
import json
import warnings
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
import readme

import microswim as ms
from microswim.calibration import observations as observe
from microswim.jobs import references
from microswim.studies.paper import plane_wave_rotation as rotation
from microswim.studies.world.page import table

HERE = Path(__file__).parent
RESULTS = HERE / "results" / "accuracy.json"
PAGE = HERE.parent / "docs" / "accuracy.md"
REGION = {
    "tail.amplitude": (0.03, 0.2),
    "tail.waves": (0.8, 4.5),
    "tail.length": (1.2, 3.0),
    "body.radius": (0.3, 0.7),
}
DESIGNS, SEED, RESOLVED = 60, 20261122, 2e-3
LAWS = {
    "Lighthill, no spin (the paper's)": ms.Lighthill(spin=False),
    "Lighthill, with spin": ms.Lighthill(),
    "constant pair 995.5, 775.2": ms.Constant(normal=995.5, tangential=775.2, spin=False),
    "Gray-Hancock, with spin": ms.GrayHancock(),
}
CROSS = [(b, 3.0) for b in np.linspace(0.01, 0.15, 15)] + [(0.1, n) for n in np.linspace(1, 5, 9)]
GRID = [(b, n) for b in (0.01, 0.03, 0.05, 0.07, 0.09, 0.11, 0.13, 0.15) for n in (1, 2, 3, 4, 5)]


def solved(swimmers, folder):
    """Reference gaits of swimmers, kept in the folder."""
    return references.gaits(swimmers, "bem", folder=folder)


def spread(errors):
    """Median, 90 % quantile and worst, in per cent."""
    e = 100.0 * np.asarray(errors)
    numbers = {"median": np.median(e), "p90": np.quantile(e, 0.9), "worst": e.max()}
    return {k: round(float(v), 3) for k, v in numbers.items()}


def one(folder, _=None):
    """Coefficients from the base case alone; errors along two axes through it, and on a grid."""
    base = ms.Swimmer.preset("tabak/helix")
    points = [(float(b), float(n)) for b, n in CROSS + GRID]
    designs = [base.with_({"tail.amplitude": b, "tail.waves": n}) for b, n in points]
    truth = references.gaits(designs, "bem", folder=folder, level="standard")
    reference = references.gaits([base], "bem", folder=folder, level="standard")[0]
    rows = []
    velocities = observe.usual_quantities(base)
    for (name, law), (agrees, wanted) in product(
        LAWS.items(), {"velocities, as in the paper": velocities, "loads too": ()}.items()
    ):
        fit = ms.calibrate(replace(base, coefficients=law), reference, quantities=wanted)
        errors = []
        for (b, n), gait in zip(points, truth):
            own = fit.swimmer.with_({"tail.amplitude": b, "tail.waves": n}).gait()
            errors.append(np.abs(own.mean_velocity / gait.mean_velocity - 1.0)[[0, 3]])
        for where, part in (
            ("one at a time", slice(0, len(CROSS))),
            ("grid", slice(len(CROSS), None)),
        ):
            e = np.array(errors[part])
            row = {"coefficients": name, "made to agree": agrees, "designs": where}
            row["gamma"] = ", ".join(f"{v:.2f}" for v in fit.values)
            for j, what in enumerate(("u_s", "Omega_s")):
                s = spread(e[:, j])
                row |= {f"{what} median": s["median"], f"{what} worst": s["worst"]}
            rows.append(row)
    return rows


def negative(folder, _=None):
    """Rotation coefficient of the plane wave under each variant, for two laws."""
    swimmer = ms.Swimmer.preset("tabak/plane_wave")
    reference = references.gaits([swimmer], "bem", folder=folder, level="standard")[0]
    out = {}
    for law in (ms.Lighthill(spin=False), ms.GrayHancock()):
        out[law.law] = rotation.study(replace(swimmer, coefficients=law), reference)
    return out


def region(kind, folder, calibrated):
    """Region calibration with 100 solves, and its errors on designs drawn afterwards."""
    base = ms.Swimmer.preset(f"tabak/{kind}")
    if calibrated is None:
        fitted = ms.calibrate_region(base, REGION, "bem", solves=100, folder=folder).swimmer
    else:
        fitted = ms.Swimmer.from_toml(Path(calibrated) / f"{kind}.toml")
    rng = np.random.default_rng(SEED)
    designs = [
        base.with_({k: float(rng.uniform(*v)) for k, v in REGION.items()}) for _ in range(DESIGNS)
    ]
    names = observe.usual_quantities(base)
    kept = [(s, g) for s, g in zip(designs, solved(designs, folder)) if not isinstance(g, str)]
    truth = np.array([[observe.observed(g, q) for q in names] for _, g in kept])
    answers = [replace(s, region=fitted.region).gait() for s, _ in kept]
    guess = np.array([[observe.observed(g, q) for q in names] for g in answers])
    scale = [np.abs(t) if q.startswith("mean") else np.abs(t).max() for q, t in zip(names, truth.T)]
    error = np.abs(guess - truth) / np.stack(np.broadcast_arrays(*scale), axis=-1)
    expected = np.array([[g.info["expected_errors"][q] for q in names] for g in answers])
    fine = np.array([g.info["asymmetry"] < RESOLVED for _, g in kept])
    rows = []
    masks = {"all": fine | True}
    if not fine.all():
        masks["resolved by the reference"] = fine
    for what, mask in masks.items():
        for j, q in enumerate(names):
            z = round(float(np.sqrt(np.mean((error[mask, j] / expected[mask, j]) ** 2))), 2)
            row = {"tail": kind, "quantity": q, "designs": f"{what} ({int(mask.sum())})"}
            rows.append(row | spread(error[mask, j]) | {"error / expected, rms": z})
    about = fitted.region.about
    notes = {k: len(about.get(k, [])) for k in ("set_aside", "refused")}
    return {
        "rows": rows,
        "refused when drawn": DESIGNS - len(kept),
    } | notes


PARTS = {
    "one": one,
    "rotation": negative,
    "helix": partial(region, "helix"),
    "plane_wave": partial(region, "plane_wave"),
}


def page(results):
    """The page as Markdown."""
    text = (HERE / "accuracy.md.in").read_text(encoding="utf-8")
    rotations = []
    for law, rows in results.get("rotation", {}).items():
        for row in rows:
            numbers = {n: row[n] for n in rotation.UNKNOWNS}
            numbers |= {k: f"{100 * row[k]:.1f} %" for k in row if k.endswith("error")}
            blank = {k: "" if v is None else v for k, v in numbers.items()}
            rotations.append({"law": law, "variant": row["variant"]} | blank)
    regions = [r for k in ("helix", "plane_wave") for r in results.get(k, {}).get("rows", [])]
    notes = [
        f"{kind}: {r['set_aside']} designs set aside, {r['refused']} refused or not resolved by "
        f"the reference and replaced; of the designs drawn {r['refused when drawn']} were refused."
        for kind in ("helix", "plane_wave")
        if (r := results.get(kind))
    ]
    parts = {"one": results.get("one", []), "rotation": rotations, "region": regions}
    for name, rows in parts.items():
        text = text.replace(f"@{name}@", table(rows) if rows else "(not measured)")
    return text.replace("@notes@", "\n\n".join(notes))


def main():
    """Measure the parts asked for, store them, write the page."""
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", default=[], metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--folder", default="solves", help="where solves are kept")
    parser.add_argument("--calibrated", help="folder of helix.toml and plane_wave.toml")
    asked = parser.parse_args()
    results = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
    for name in asked.parts or list(PARTS):
        if name != "page":
            results[name] = PARTS[name](asked.folder, asked.calibrated)
            RESULTS.write_text(json.dumps(results, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(results), encoding="utf-8")
    readme.main()


if __name__ == "__main__":
    main()
