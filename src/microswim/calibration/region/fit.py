"""Fit of a region calibration: targets of reference gaits, Gaussian processes, left-out errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region import kriging
from microswim.calibration.region import positive_definite as blocks
from microswim.calibration.region.beats import HALF, LOGARITHMS, PHASES, SAMPLES, scales
from microswim.calibration.region.correction import features
from microswim.calibration.region.evaluate import helices, twists, waves
from microswim.calibration.region.kriging import Kriging
from microswim.calibration.region.surfaces import Surfaces, interleaved
from microswim.gait.gait import Gait
from microswim.numerics.series.extremes import half_range
from microswim.numerics.series.fourier import MIRROR_R, series_of
from microswim.swimmer.swimmer import Swimmer

CONTRADICTED = 12.0
LEAST = 1e-3  #: of a mean thrust or power over the base's: less has no logarithm worth fitting


@dataclass(frozen=True, eq=False)
class Solved:
    """A design with its reference gait."""

    swimmer: Swimmer
    gait: Gait


def one_thread() -> Any:
    """Hold the algebra to one thread: it solves small matrices faster than several."""
    return threadpool_limits(1)


def columns_of(x: np.ndarray) -> np.ndarray:
    """Return features that vary over the designs, their means and spreads, (3, f)."""
    spread = x.std(axis=0)
    used = np.flatnonzero(spread > 1e-9)
    return np.array([used.astype(float), x[:, used].mean(axis=0), spread[used]])


def scaled(swimmers: list[Swimmer], columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return features of about unit spread (n, f) and numbers of waves (n,)."""
    x = np.array([features(s) for s in swimmers], dtype=float)[:, columns[0].astype(int)]
    return (x - columns[1]) / columns[2], np.array(
        [s.tail.number_of_waves for s in swimmers], float
    )


def targets(solved: list[Solved]) -> np.ndarray:
    """Return corrections (n, columns) of all designs, in the order of `Surfaces`."""
    helix = solved[0].swimmer.tail.is_rigid
    return np.array([(_helix_targets if helix else _wave_targets)(s) for s in solved])


def _helix_targets(s: Solved) -> np.ndarray:
    R0, F0, G0 = (x[0] for x in shaded.base_of(s.swimmer, np.zeros(1)))
    g, a, mu = s.gait, s.swimmer.body.semi_axes3[0], s.swimmer.fluid.viscosity
    D = s.swimmer.body.diagonal(mu)
    R, F = g.resistance(0.0), g.propulsion(0.0)
    if s.swimmer.tail.sign < 0:
        R, F = R * np.outer(MIRROR_R, MIRROR_R), F * MIRROR_R
    y = blocks.encode_helix(R, F, g.activity(0.0), R0, F0, G0, a, mu, D[3])
    share = np.zeros(3)
    if g.body_resistance_series is not None:
        body = g.body_resistance_series[0]
        held = g.body_propulsion_series[0][0] if g.body_propulsion_series is not None else 0.0
        share[0] = np.log(max(body[0, 0], 1e-3 * D[0]) / D[0])
        share[1:] = s.swimmer.tail.sign * body[0, 3] / (mu * a**2), held / (mu * a**2)
    return np.concatenate([y[: blocks.REAL], share, y[blocks.REAL :]])


def _wave_targets(s: Solved) -> np.ndarray:
    phase = np.array(PHASES)
    base = shaded.base_of(s.swimmer, phase)
    scale, a = scales(*base), shaded.unit(s.swimmer)
    R, F, G = s.gait.resistance(phase), s.gait.propulsion(phase), s.gait.activity(phase)
    y = np.array(
        [
            blocks.encode_wave(R[j], F[j], G[j], base[0][j], base[1][j], base[2][j], a, scale)
            for j in range(HALF)
        ]
    )
    even, odd = y[:, list(blocks.EVEN)], y[:, list(blocks.ODD)]
    turn = np.exp(-1j * np.outer([1, 2, 3], phase))
    h2 = 2.0 / HALF * turn[1] @ even
    h1, h3 = 2.0 / HALF * turn[0] @ odd, 2.0 / HALF * turn[2] @ odd
    pairs = [np.stack([h.real, h.imag], axis=-1).ravel() for h in (h2, h1, h3)]
    mean = even.mean(axis=0)
    for i in LOGARITHMS:
        mean[i] = np.log(max(1.0 + mean[i], LEAST))
    return np.concatenate([mean, *pairs])


def groups_of(helix: bool) -> list[tuple[slice, bool, int]]:
    """Return columns of each group, whether they are complex pairs, and phasors of the tip."""
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


def fit_groups(
    solved: list[Solved], former: tuple[Kriging, ...] = (), groups: int | None = None
) -> tuple[Kriging, ...]:
    """Return Gaussian processes of all groups, or of the first ones."""
    swimmers = [s.swimmer for s in solved]
    columns = columns_of(np.array([features(s) for s in swimmers], dtype=float))
    Z, N = scaled(swimmers, columns)
    Y = targets(solved)
    out = []
    for i, (part, pairs, phasors) in enumerate(groups_of(swimmers[0].tail.is_rigid)[:groups]):
        y = Y[:, part]
        y = y[:, ::2] + 1j * y[:, 1::2] if pairs else y
        out.append(kriging.fit(Z, N, y, phasors, former[i] if former else None))
    return tuple(out)


def set_aside(solved: list[Solved], former: Any = ()) -> tuple[list[Solved], list[Solved]]:
    """Return designs to keep, and those that all the others contradict.

    Near the edge of what its mesh resolves a reference is a few per cent off; one such solve spoils
    the fit around it. A design counts as contradicted when its left-out residual of the thrust, in
    units of its own doubt, is more than `CONTRADICTED` times the median; at most one in twenty.
    """
    keep, out = list(solved), []
    for _ in range(max(1, len(solved) // 20) if len(solved) >= 40 else 0):
        group = fit_groups(keep, former, groups=1)[0]
        residual, doubt = group.left_out()
        z = np.abs(residual[:, 0]) / np.sqrt(doubt)
        worst = int(np.argmax(z))
        if z[worst] <= CONTRADICTED * np.median(z):
            break
        out.append(keep.pop(worst))
    return keep, out


def left_out_errors(
    surfaces: Surfaces, columns: np.ndarray, solved: list[Solved], doubtful: list[Solved]
) -> tuple[dict[str, dict[str, float]], np.ndarray, np.ndarray]:
    """Return the errors of the velocities when each design in turn is left out.

    As `Correction` has them: errors, spots, ratios.

    Forward speed and body rate of a helix relative to themselves, lateral amplitudes relative to
    their largest value. Designs set aside or not resolved count in the expected error alone: there
    the reference itself is that much in doubt.
    """
    helix = solved[0].swimmer.tail.is_rigid
    residual = [g.left_out()[0] for g in surfaces.groups]
    y = targets(solved) - np.concatenate([interleaved(r) for r in residual], axis=1)
    doubt = surfaces.left_out_doubt()
    spots = surfaces.groups[0].Z
    if doubtful:
        Z, N = scaled([s.swimmer for s in doubtful], columns)
        y = np.concatenate([y, surfaces(Z, N)])
        doubt, spots = np.append(doubt, surfaces.doubt(Z, N)), np.append(spots, Z, axis=0)
    every = [*solved, *doubtful]
    truth, guess = np.empty((2, len(every), 3))
    for i, s in enumerate(every):
        truth[i] = _velocities(s.gait.resistance, s.gait.propulsion, s.swimmer, helix)
        guess[i] = _velocities(*_rebuilt(s.swimmer, y[i]), s.swimmer, helix)
    used = [j for j in range(3) if np.any(np.abs(truth[:, j]) > 0)]
    names = [("mean.us", "amplitude.uq", "mean.os" if helix else "amplitude.or")[j] for j in used]
    size = np.abs(truth)
    scale = [size[:, j] if n.startswith("mean") else size[:, j].max() for j, n in zip(used, names)]
    error = np.stack([np.abs(guess - truth)[:, j] / c for j, c in zip(used, scale)], axis=-1)
    kept = error[: len(solved)]
    numbers = {"median": np.median, "p90": lambda e: np.quantile(e, 0.9), "worst": np.max}
    errors = {
        name: {word: float(measure(kept[:, j])) for word, measure in numbers.items()}
        for j, name in enumerate(names)
    }
    return errors, spots, error**2 / doubt[:, None]


def _velocities(R: Any, F: Any, swimmer: Swimmer, helix: bool) -> list[float]:
    phase = np.zeros(1) if helix else np.pi * np.arange(SAMPLES) / HALF
    V = twists(R(phase)[None], F(phase)[None], np.array(swimmer.motion.mask))[0]
    if helix:
        return [V[0, 0], float(np.hypot(V[0, 1], V[0, 2])), V[0, 3]]
    return [V[:, 0].mean(), *half_range(series_of(V)[:, [1, 5]])]


def _rebuilt(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, Any]:
    """R and F_p of a design from given corrections."""
    most = shaded.sizes(np.array([swimmer.tail.number_of_waves]))
    D, mu = np.array(swimmer.body.diagonal(swimmer.fluid.viscosity)), swimmer.fluid.viscosity
    design = shaded.parameters(swimmer)[None], D[None], np.array([mu])
    nodes, tips = np.zeros((1, 5, 0)), np.zeros((2, 0))
    none = nodes, tips, np.zeros((1, 1)), np.zeros((1, 4)), np.array([0, 0])
    run = (helices if swimmer.tail.is_rigid else waves).alone
    rules = shaded.rules(int(most[0]))
    far = np.zeros((1, 1)), np.zeros(1), np.ones((1, len(y)))
    R, F, _, _ = run(*design, *far, most, *rules, *none, np.zeros((len(y), 0)), y)
    if swimmer.tail.sign < 0:
        R, F = R * np.outer(MIRROR_R, MIRROR_R), F * MIRROR_R
    return (lambda phase: R[0]), (lambda phase: F[0])
