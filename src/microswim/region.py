"""Region calibration: designs chosen, solved by the reference, and a smooth correction fitted.

First designs fill the region (scrambled Sobol points), then each batch goes where it lowers the doubt over
the region most. What is fitted, in which coordinates and why: docs/decisions/region-
calibration.md. Depends on correction, references.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.stats import qmc

from . import blocks, kriging, references, shaded
from .correction import (
    HALF,
    SAMPLES,
    Correction,
    features,
    fixed_numbers,
    helices,
    scales,
    twists,
    wave_base,
    waves,
    words,
)
from .errors import MicroswimError, SpecError
from .gait import Gait
from .kriging import Kriging, Surfaces
from .swimmer import Swimmer

POOL = 512  #: Sobol points of a region
CANDIDATES = 300  #: of them, those among which the next designs are chosen
FLOOR = 0.03  #: variance, relative to the mean one, below which nothing is to be gained
ASYMMETRY = 2e-3  #: of the reference's R, relative; beyond, its mesh does not resolve the design
CONTRADICTED = 12.0
FIRST = 0.7  #: share of the solves that fill the region
Region = dict[str, tuple[float, float]]


@dataclass(frozen=True, eq=False)
class Solved:
    """A design with its reference gait."""

    swimmer: Swimmer
    gait: Gait


def calibrate_region(
    swimmer: Swimmer,
    region: Region,
    reference: str = "bem",
    *,
    solves: int = 100,
    folder: Any = None,
    workers: int | None = None,
    seed: int = 1,
    progress: Callable[[int, int], None] | None = None,
    **options: Any,
) -> Swimmer:
    """Calibrate the surrogate over a region of designs.

    Parameters
    ----------
    swimmer
        What the designs have in common; a wave tail and a body.
    region
        Dotted name of a number of the spec to its bounds.
    reference
        ``"bem"`` or ``"fem"`` (or ``"rft"``).
    solves
        Designs to solve.
    folder
        Where solves are kept, so that a killed run goes on where it was.
    workers
        Processes, each with one thread; all cores by default.
    seed
        Of the choice of designs.
    progress
        Called with (solved, all).
    options
        What the reference takes, such as ``level``.

    Returns
    -------
    Swimmer
        The same swimmer with a `Correction`: its surrogate gaits hold over the region.

    Raises
    ------
    SpecError
        If the region makes no sense.
    MicroswimError
        If too few designs could be solved.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> region = {"tail.amplitude": (0.08, 0.12)}
    >>> fitted = ms.calibrate_region(swimmer, region, "rft", solves=8, workers=0)
    >>> fitted.gait().info["outside"]
    []
    """
    _check(swimmer, region, solves)
    pool = _pool(swimmer, region, seed)
    chosen = list(range(min(max(8, round(FIRST * solves)), solves, len(pool))))
    solved: list[Solved] = []
    tried: set[int] = set()
    options = _phases(swimmer, reference, options)
    fitted: tuple[Kriging, ...] = ()
    while True:
        found = references.gaits(
            [pool[i] for i in chosen],
            reference,
            folder=folder,
            workers=workers,
            progress=_shifted(progress, len(solved), solves),
            **options,
        )
        solved += [Solved(pool[i], g) for i, g in zip(chosen, found) if _trusted(g)]
        tried |= set(chosen)
        left = solves - len(solved)
        if left <= 0 or len(tried) >= min(2 * solves, len(pool)):
            break
        fitted = _fit(solved, fitted)
        chosen = _least_sure(pool, fitted, solved, tried, min(left, max(4, solves // 8)))
    if len(solved) < max(6, len(region) + 2):
        raise MicroswimError(f"only {len(solved)} designs could be solved: {found[0]}")
    about = {"reference": reference, "solves": len(solved), "seed": seed}
    solved, doubtful = set_aside(solved, fitted)
    about["set_aside"] = [_values_of(s.swimmer, region) for s in doubtful]
    about["options"] = {k: getattr(v, "name", v) for k, v in options.items()}
    return replace(swimmer, region=_correction(swimmer, region, solved, fitted, about))


def _trusted(gait: Gait | str) -> bool:
    """Whether a reference gait is one, and resolved: its R must come out symmetric."""
    return isinstance(gait, Gait) and float(gait.info.get("asymmetry") or 0.0) < ASYMMETRY


def _check(swimmer: Swimmer, region: Region, solves: int) -> None:
    if swimmer.tail.kind not in ("helix", "plane_wave") or swimmer.body.shape == "none":
        raise SpecError("region: a body and a helix or a plane wave are needed")
    if swimmer.tail.kind == "helix" and not swimmer.body.is_axisymmetric:
        raise SpecError("body.shape", "ellipsoid", "a body of revolution for a helix's region")
    if swimmer.motion.line_element != "arc":
        raise SpecError("motion.line_element", "apparent", '"arc" for a region')
    if solves < max(6, len(region) + 2):
        raise SpecError("solves", solves, f"at least {max(6, len(region) + 2)}")
    for name, bounds in region.items():
        low, high = bounds if len(bounds) == 2 else (np.nan, np.nan)
        if not (np.isfinite([low, high]).all() and 0 < low < high):
            raise SpecError(f"region {name}", bounds, "two positive numbers, the lower one first")
        if not name.startswith(("tail.", "body.")) or name == "tail.frequency":
            raise SpecError("region", name, "a number of tail or body that decides the flow")
        swimmer.with_({name: low})


def _phases(swimmer: Swimmer, reference: str, options: dict[str, Any]) -> dict[str, Any]:
    """Boundary elements sample a plane wave at as few phases as the corrections need."""
    if reference != "bem" or swimmer.tail.kind == "helix":
        return options
    from .reference.bem.levels import get_level

    level = options.get("level", "standard")
    chosen = get_level(level) if isinstance(level, str) else level
    return options | {"level": replace(chosen, phases=SAMPLES)}


def _shifted(progress: Any, before: int, all_: int) -> Any:
    return None if progress is None else lambda done, _: progress(min(before + done, all_), all_)


def _pool(swimmer: Swimmer, region: Region, seed: int) -> list[Swimmer]:
    """Scrambled Sobol points of the region that make sense, in their order."""
    low, high = np.array(list(region.values()), dtype=float).T
    out = []
    for x in low + (high - low) * qmc.Sobol(len(region), seed=seed).random(POOL):
        try:
            out.append(swimmer.with_(dict(zip(region, map(float, x)))))
        except SpecError:
            continue
    if len(out) < 6:
        raise SpecError("region", region, "a region with designs that make sense")
    return out


def _columns(x: np.ndarray) -> np.ndarray:
    """Features that vary over the designs, their means and spreads, (3, f)."""
    spread = x.std(axis=0)
    used = np.flatnonzero(spread > 1e-9)
    return np.array([used.astype(float), x[:, used].mean(axis=0), spread[used]])


def _scaled(swimmers: list[Swimmer], columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = np.array([features(s) for s in swimmers], dtype=float)[:, columns[0].astype(int)]
    return (x - columns[1]) / columns[2], np.array([s.tail.number_of_waves for s in swimmers], float)


def _least_sure(
    pool: list[Swimmer], fitted: tuple[Kriging, ...], solved: list[Solved], tried: set, count: int
) -> list[int]:
    """Designs that lower the doubt over the whole region most, one after the other as if solved.

    With C the covariance given what is solved, a design c takes ``|C_xc|^2 / C_cc`` off the variance
    at x; the mean over the region counts, for thrust, invariant parts and lateral vectors alike.
    """
    columns = _columns(np.array([features(s.swimmer) for s in solved], dtype=float))
    open_ = [i for i in range(len(pool)) if i not in tried][:CANDIDATES]
    Z, N = _scaled([pool[i] for i in open_], columns)
    At, Nt = _scaled([s.swimmer for s in solved], columns)
    posteriors = []
    for g in fitted[:3]:
        kernel = (g.lengths, g.phasors, g.real)
        K = kriging.covariance(At, Nt, At, Nt, *kernel) + g.noise * np.eye(len(At))
        half = np.linalg.solve(np.linalg.cholesky(K), kriging.covariance(At, Nt, Z, N, *kernel))
        C = kriging.covariance(Z, N, Z, N, *kernel) - half.conj().T @ half
        posteriors.append(C / np.diag(C).real.mean())
    chosen: list[int] = []
    for _ in range(min(count, len(open_))):
        gain = np.zeros(len(open_))
        for C in posteriors:
            gain += np.mean(np.abs(C) ** 2, axis=0) / (np.diag(C).real + FLOOR)
        gain[chosen] = -1.0
        c = int(np.argmax(gain))
        chosen.append(c)
        posteriors = [C - np.outer(C[:, c], C[c]) / (C[c, c].real + FLOOR) for C in posteriors]
    return [open_[c] for c in chosen]


def _base(s: Swimmer) -> tuple[Any, ...]:
    """Parameters, isolated drags, viscosity and rules of a design."""
    D = np.array(s.body.diagonal(s.fluid.viscosity), dtype=float)
    return shaded.parameters(s), D, float(s.fluid.viscosity), shaded.nodes(0, s.tail.number_of_waves)


def targets(solved: list[Solved]) -> np.ndarray:
    """Corrections (n, columns) of all designs, in the order of `Surfaces`."""
    helix = solved[0].swimmer.tail.kind == "helix"
    return np.array([(_helix_targets if helix else _wave_targets)(s) for s in solved])


def _helix_targets(s: Solved) -> np.ndarray:
    from .correction import MIRROR_R

    p, D, mu, rules = _base(s.swimmer)
    R0, F0, G0 = shaded.shaded_tail(0, p, 0.0, *rules)
    g, a = s.gait, p[8]
    R, F = g.resistance(0.0), g.propulsion(0.0)
    if s.swimmer.tail.sign < 0:
        R, F = R * np.outer(MIRROR_R, MIRROR_R), F * MIRROR_R
    y = blocks.encode_helix(R, F, g.activity(0.0), R0 + np.diag(D), F0, G0, a, mu, D[3])
    share = np.zeros(3)
    if g.body_resistance_series is not None:
        body = g.body_resistance_series[0]
        held = g.body_propulsion_series[0][0] if g.body_propulsion_series is not None else 0.0
        share[0] = np.log(max(body[0, 0], 1e-3 * D[0]) / D[0])
        share[1:] = s.swimmer.tail.sign * body[0, 3] / (mu * a**2), held / (mu * a**2)
    return np.concatenate([y[: blocks.REAL], share, y[blocks.REAL :]])


def _wave_targets(s: Solved) -> np.ndarray:
    p, D, mu, rules = _base(s.swimmer)
    base = wave_base(p, D, *rules)
    scale = scales(*base)
    phase = np.pi * np.arange(HALF) / HALF
    R, F, G = s.gait.resistance(phase), s.gait.propulsion(phase), s.gait.activity(phase)
    y = np.array(
        [
            blocks.encode_wave(R[j], F[j], G[j], *(b[j] for b in base), p[8], scale)
            for j in range(HALF)
        ]
    )
    even, odd = y[:, list(blocks.EVEN)], y[:, list(blocks.ODD)]
    turn = np.exp(-1j * np.outer([1, 2, 3], phase))
    h2 = 2.0 / HALF * turn[1] @ even
    h1, h3 = 2.0 / HALF * turn[0] @ odd, 2.0 / HALF * turn[2] @ odd
    pairs = [np.stack([h.real, h.imag], axis=-1).ravel() for h in (h2, h1, h3)]
    return np.concatenate([even.mean(axis=0), *pairs])


def _groups(helix: bool) -> list[tuple[slice, bool, int]]:
    """Columns of each group, whether they are complex pairs, and phasors of the tip."""
    if helix:
        r = blocks.REAL + 3
        return [(slice(0, 1), False, 1), (slice(1, r), False, 1), (slice(r, r + 12), True, 1)]
    return [
        (slice(0, 1), False, 2),
        (slice(1, 10), False, 2),
        (slice(30, 42), True, 1),
        (slice(10, 30), True, 2),
        (slice(42, 54), True, 3),
    ]


def _fit(
    solved: list[Solved], former: tuple[Kriging, ...] = (), groups: int | None = None
) -> tuple[Kriging, ...]:
    """Gaussian processes of all groups, or of the first ones."""
    swimmers = [s.swimmer for s in solved]
    columns = _columns(np.array([features(s) for s in swimmers], dtype=float))
    Z, N = _scaled(swimmers, columns)
    Y = targets(solved)
    out = []
    for i, (part, pairs, phasors) in enumerate(_groups(swimmers[0].tail.kind == "helix")[:groups]):
        y = Y[:, part]
        y = y[:, ::2] + 1j * y[:, 1::2] if pairs else y
        out.append(kriging.fit(Z, N, y, phasors, former[i] if former else None))
    return tuple(out)


def _values_of(swimmer: Swimmer, region: Region) -> dict[str, float]:
    return {name: float(swimmer.numbers[name]) for name in region}


def set_aside(solved: list[Solved], former: Any = ()) -> tuple[list[Solved], list[Solved]]:
    """Designs to keep, and those that all the others contradict.

    Near the edge of what its mesh resolves a reference is a few per cent off; one such solve spoils
    the fit around it. A design counts as contradicted when its left-out residual of the thrust, in
    units of its own doubt, is more than `CONTRADICTED` times the median; at most one in twenty.
    """
    keep, out = list(solved), []
    for _ in range(max(1, len(solved) // 20) if len(solved) >= 40 else 0):
        group = _fit(keep, former, groups=1)[0]
        residual, doubt = group.left_out()
        z = np.abs(residual[:, 0]) / np.sqrt(doubt)
        worst = int(np.argmax(z))
        if z[worst] <= CONTRADICTED * np.median(z):
            break
        out.append(keep.pop(worst))
    return keep, out


def _correction(
    swimmer: Swimmer, region: Region, solved: list[Solved], former: Any, about: dict[str, Any]
) -> Correction:
    groups = _fit(solved, former)
    columns = _columns(np.array([features(s.swimmer) for s in solved], dtype=float))
    order = sorted(range(len(groups)), key=lambda i: _groups(len(groups) == 3)[i][0].start)
    made = Correction(
        low={name: float(b[0]) for name, b in region.items()},
        high={name: float(b[1]) for name, b in region.items()},
        fixed=fixed_numbers(swimmer, region),
        choices=words(swimmer),
        surfaces=Surfaces(tuple(groups[i] for i in order)),
        columns=columns,
        errors={},
        about=about,
    )
    return replace(made, errors=left_out_errors(made, solved))


def left_out_errors(made: Correction, solved: list[Solved]) -> dict[str, dict[str, float]]:
    """Errors of the velocities when each design in turn is left out of the fit.

    Forward speed and body rate of a helix relative to themselves, lateral amplitudes relative to
    their largest value.
    """
    helix = len(made.surfaces.groups) == 3
    residual = [g.left_out()[0] for g in made.surfaces.groups]
    flat = [np.stack([r.real, r.imag], -1).reshape(len(r), -1) if np.iscomplexobj(r) else r for r in residual]
    y = targets(solved) - np.concatenate(flat, axis=1)
    doubt = np.sqrt(made.surfaces.groups[0].left_out()[1])
    names = ("mean.us", "amplitude.uq", "mean.os" if helix else "amplitude.or")
    truth, guess = np.empty((2, len(solved), 3))
    for i, s in enumerate(solved):
        truth[i] = _velocities(s.gait.resistance, s.gait.propulsion, s.swimmer, helix)
        guess[i] = _velocities(*_rebuilt(s.swimmer, y[i]), s.swimmer, helix)
    out = {}
    for j, name in enumerate(names):
        if not np.any(np.abs(truth[:, j]) > 0):
            continue
        scale = np.abs(truth[:, j]) if name.startswith("mean") else np.abs(truth[:, j]).max()
        error = np.abs(guess[:, j] - truth[:, j]) / scale
        out[name] = {
            "factor": float(np.sqrt(np.mean((error / doubt) ** 2))),
            "median": float(np.median(error)),
            "p90": float(np.quantile(error, 0.9)),
            "worst": float(error.max()),
        }
    return out


def _velocities(R: Any, F: Any, swimmer: Swimmer, helix: bool) -> list[float]:
    phase = np.zeros(1) if helix else np.pi * np.arange(SAMPLES) / HALF
    V = twists(R(phase)[None], F(phase)[None], np.array(swimmer.motion.mask))[0]
    if helix:
        return [V[0, 0], float(np.hypot(V[0, 1], V[0, 2])), V[0, 3]]
    return [V[:, 0].mean(), np.ptp(V[:, 1]) / 2.0, np.ptp(V[:, 5]) / 2.0]


def _rebuilt(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, Any]:
    """R and F_p of a design from given corrections."""
    p, D, mu, rules = _base(swimmer)
    none = np.zeros((0, 1)), np.zeros((0, 2)), np.zeros((1, 1)), np.zeros((1, 4)), np.array([0, 0])
    run = helices if swimmer.tail.kind == "helix" else waves
    args = (p[None], D[None], np.array([mu]), np.zeros((1, 1)), np.zeros(1), *rules, *none)
    R, F, _, _ = run(*args, np.zeros((0, len(y))), y)
    if swimmer.tail.sign < 0:
        from .correction import MIRROR_R

        R, F = R * np.outer(MIRROR_R, MIRROR_R), F * MIRROR_R
    return (lambda phase: R[0]), (lambda phase: F[0])
