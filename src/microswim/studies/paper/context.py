"""What the modules of the paper share: its swimmers, sweeps, and our reference in place of its CFD.

A `Context` says how thorough a run is and where finished reference solutions are kept, so that an
interrupted run resumes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from microswim.gait.gait import Gait
from microswim.jobs import store
from microswim.models.rft.batch import evaluate
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.motion import Motion
from microswim.swimmer.swimmer import Swimmer

TAILS = ("helix", "plane_wave")
SETS = ("constant", "sbt")
AMPLITUDE, WAVES = "tail.amplitude", "tail.waves"
# Section 5: amplitude 0.01 to 0.15; wavelength 0.5 to 1, so 4 to 2 waves on a tail of length 2.
PAPER_RANGE = {AMPLITUDE: (0.01, 0.15), WAVES: (2.0, 4.0)}


def swimmer(tail: str, coefficients: str, changes: dict[str, Any] | None = None) -> Swimmer:
    """Return the paper's swimmer: base case of Table 1 with Table 3's interaction coefficients."""
    return Swimmer.preset(f"tabak/{tail}-{coefficients}").with_(changes or {})


def observed(gait: Gait) -> np.ndarray:
    """Return what the paper plots: mean u_s, amplitude of the lateral velocity, body rotation.

    The third is the mean rate about s (helix) or the amplitude of the rate about r (plane wave),
    in revolutions per period as in Table 4 and the figures.
    """
    V, A = gait.mean_velocity, gait.velocity_amplitude
    turn = A[5] if gait.free[5] else V[3]
    return np.array([V[0], A[1], turn / (2.0 * np.pi)])


@dataclass(frozen=True)
class Context:
    """How a reproduction runs.

    Parameters
    ----------
    quick
        Coarse level and half of the circles.
    store
        Folder for finished reference solutions; None keeps them in memory only.
    circles
        Whether to compute reference circles at all (the tests of the lines leave them out).
    progress
        Called with the number of reference solutions so far.
    """

    quick: bool = False
    store: Path | None = None
    circles: bool = True
    progress: Callable[[str], None] | None = None
    _memory: dict[str, Any] = field(default_factory=dict, repr=False)

    @property
    def level(self) -> str:
        """Level of the boundary elements."""
        return "coarse" if self.quick else "standard"

    @cached_property
    def sweeps(self) -> dict[str, np.ndarray]:
        """Designs of the reference circles, by the number that varies."""
        if not self.circles:
            return {AMPLITUDE: np.empty(0), WAVES: np.empty(0)}
        b = [0.01, 0.05, 0.1, 0.15] if self.quick else [0.01, *np.arange(1, 8) * 0.02, 0.15]
        n = np.arange(1.0, 5.01, 0.5 if self.quick else 0.25)
        return {AMPLITUDE: np.array(b), WAVES: n}

    def once(self, key: tuple, make: Callable[[], Any]) -> Any:
        """Return what `make` gives, computed once in this run."""
        name = repr(key)
        if name not in self._memory:
            self._memory[name] = make()
        return self._memory[name]

    def reference(self, who: Swimmer) -> Gait:
        """Return the gait by boundary elements, from the store if it was solved before.

        What the motion is free to do, and the surrogate's coefficients, do not matter to R and F_p.

        Raises
        ------
        MicroswimError
            If it cannot be solved.
        """
        plain = replace(who, motion=Motion())
        key = ("reference", who.body, who.tail, who.fluid, self.level)
        gait = self.once(key, lambda: self._recall(plain))
        return replace(gait, rate=who.tail.rate, free=who.motion.mask)

    def _recall(self, who: Swimmer) -> Gait:
        place = self.store and store.place(self.store, who, "bem", {"level": self.level})
        found = store.find(place) if place else None
        if isinstance(found, Gait):
            return found
        if self.progress:
            b, N = as_wave(who.tail).amplitude, who.tail.number_of_waves
            self.progress(f"{who.tail.kind} b = {b:g}, N = {N:g}")
        made = who.gait("bem", level=self.level)
        if place:
            store.keep(place, made)
        return made


def lines(who: Swimmer, values: dict[str, np.ndarray]) -> np.ndarray:
    """Return what `observed` gives, of the surrogate at many designs, shape (n, 3)."""
    result = evaluate(who, values)
    V, A = result["mean_velocity"], result["velocity_amplitude"]
    turn = A[:, 5] if who.motion.mask[5] else V[:, 3]
    return np.stack([V[:, 0], A[:, 1], turn / (2.0 * np.pi)], axis=-1)


def circles(context: Context, tail: str, parameter: str) -> np.ndarray:
    """Return `observed` of the reference along a sweep, shape (n, 3)."""
    points = context.sweeps[parameter]
    gaits = [context.reference(swimmer(tail, "constant", {parameter: float(x)})) for x in points]
    return np.array([observed(gait) for gait in gaits]).reshape(-1, 3)


def sweep(context: Context, tail: str) -> dict[str, Any]:
    """Return lines of both coefficient sets and reference circles of Figs. 4 and 5.

    Returns
    -------
    dict
        By parameter: ``x`` and one (n, 3) array per coefficient set, ``x_reference`` and
        ``reference``.
    """
    dense = {AMPLITUDE: np.linspace(0.01, 0.15, 57), WAVES: np.linspace(1.0, 5.0, 161)}
    out: dict[str, Any] = {"tail": tail}
    for parameter, x in dense.items():
        out[parameter] = {
            "x": x,
            **{c: lines(swimmer(tail, c), {parameter: x}) for c in SETS},
            "x_reference": context.sweeps[parameter],
            "reference": circles(context, tail, parameter),
        }
    return out
