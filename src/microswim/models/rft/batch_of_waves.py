"""Many plane waves at once: as many nodes and phases as each takes, over half a period."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim.models.rft.batch_numbers import of_plane_waves
from microswim.models.rft.gait import MOST_PHASES
from microswim.models.rft.plane_wave import SEGMENT
from microswim.models.rft.segment import (
    AMPLITUDE,
    LENGTH,
    PLANE_WAVE,
    RAMP,
    WAVENUMBER,
    node_numbers,
)
from microswim.numerics.compiling.compiled import pays
from microswim.numerics.quadrature import panels
from microswim.swimmer.swimmer import Swimmer

CHUNK = 2048  #: designs whose twists at all phases stay in the processor's cache
PHASES = 16  #: over half a period of a gentle wave
#: Amplitude times wavenumber from which on more phases are likely to resolve the beat at once.
STEEPER = ((0.45, 24), (1.1, 32))
MARGIN = 1.0  #: digits of the quadrature beyond the tolerance


def of_waves(
    out: dict[str, Any],
    solved: Any,
    bk: np.ndarray,
    good: np.ndarray,
    drag: Any,
    rate: Any,
    seconds: float,
) -> None:
    """Fill in results of plane waves, at as many phases as each takes.

    They stay NaN where even the most do not do. ``solved(rows, phase)`` gives twists, tail powers
    and, without `drag`, the body's drag times speed; `bk` is amplitude times wavenumber.
    """
    loops = loops_for(seconds)
    for some, phases in _chunks(bk, good):
        found = solved(some, np.pi * np.arange(phases) / phases)
        while len(some):
            fine, *beats = loops.half_beats(found[0])
            V, power, *work = (x[fine] for x in found)
            done = some[fine]
            own = None if drag is None else drag[done]
            results = of_plane_waves(V, [x[fine] for x in beats], power, rate[done], own, *work)
            for name, value in results.items():
                out[name][done] = value
            again = ~fine & np.isfinite(found[0][:, 0, 0])  # more phases do not answer a NaN
            some = some[again]
            if not len(some) or 2 * phases > MOST_PHASES:
                break
            between = solved(some, np.pi * (np.arange(phases) + 0.5) / phases)
            found = [_interleaved(a[again], b) for a, b in zip(found, between)]
            phases *= 2


def _chunks(bk: np.ndarray, good: np.ndarray) -> Any:
    """Rows of designs that are good, with the number of phases at which to begin."""
    first = np.select(
        [bk > least for least, _ in STEEPER[::-1]], [m for _, m in STEEPER[::-1]], PHASES
    )
    for phases in np.unique(first[good]).tolist():
        rows = np.flatnonzero(good & (first == phases))
        for some in np.array_split(rows, -(-len(rows) // CHUNK)):
            yield some, phases


def _interleaved(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return what was found at phases (n, m, ...) and in between, in order."""
    return np.stack([a, b], axis=2).reshape(len(a), -1, *a.shape[2:])


def solved_waves(
    swimmer: Swimmer, p: Any, drag: Any, phase: np.ndarray, tolerance: float, seconds: float
) -> tuple[Any, Any]:
    """Return twists (n, m, 6) and tail powers (n, m) of plane waves at m phases."""
    V, power = np.empty((len(p), phase.size, 6)), np.empty((len(p), phase.size))
    arc, free = swimmer.motion.line_element == "arc", np.array(swimmer.motion.mask)
    loops = loops_for(max(seconds, phase.size * wave_nodes(p).sum() * SEGMENT))
    for rules, group in _groups(p, tolerance):
        own = p[group], drag[group]
        V[group], power[group] = loops.solve_waves(arc, *own, phase, free, *rules)
    return V, power


def _groups(p: np.ndarray, tolerance: float) -> Any:
    """Quadrature rules with the designs that need them."""
    digits = min(1.0, (MARGIN - np.log10(tolerance)) / 12.0)
    need = wave_nodes(p)
    need = np.where(need > 0, np.ceil(6 + (need - 6) * digits), 0).astype(np.int64)
    rung = np.where(need > 64, 32, 8)  # few distinct rules: making one takes longer than a design
    need = rung * -(-need // rung)
    keys = need[:, 0] << 32 | need[:, 1]
    for key in np.unique(keys):
        rules = panels(int(key >> 32)), panels(int(key & 0xFFFFFFFF))
        yield rules, np.flatnonzero(keys == key)


def shapes(p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return waves, amplitude times wavenumber and ramp of designs p (n, 11)."""
    k = p[:, WAVENUMBER]
    return p[:, LENGTH] * k / (2.0 * np.pi), p[:, AMPLITUDE] * k, p[:, RAMP]


def wave_nodes(p: np.ndarray) -> np.ndarray:
    """Return nodes on ramp and rest (n, 2) of plane waves that reach rounding."""
    return np.stack(node_numbers.written(PLANE_WAVE, *shapes(p)), axis=-1)


def loops_for(seconds: float) -> Any:
    """Return the module whose loops serve work that takes so long as Python."""
    if pays(seconds):
        from microswim.models.rft import loops_compiled as loops
    else:
        from microswim.models.rft import loops_python as loops
    return loops
