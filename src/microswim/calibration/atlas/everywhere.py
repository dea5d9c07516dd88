"""The atlas in place of a region calibration: many designs side by side, for sweeps."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.atlas import Atlas, of
from microswim.calibration.atlas.expected import as_it_comes
from microswim.calibration.atlas.gait import gait as atlas_gait
from microswim.calibration.atlas.side_by_side import twists
from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region.beats import finer
from microswim.gait.gait import Gait
from microswim.models.rft.batch import evaluate
from microswim.numerics.compiling.cores import MANY
from microswim.swimmer.fields import in_terms_of, lifted
from microswim.swimmer.parts import replaced
from microswim.swimmer.swimmer import Swimmer

#: How the names of numbers begin that the atlas does not know: they are the user's own.
OWN = ("interaction.", "coefficients.")


@dataclass(frozen=True, eq=False)
class Everywhere:
    """What a swimmer asks of a region (`swimmer.region.Region`), answered by the atlas.

    Its range is that of `coordinates`; a design outside is NaN.
    """

    atlas: Atlas = field(repr=False)
    low: dict[str, float] = field(default_factory=dict)
    high: dict[str, float] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)

    def gait(self, swimmer: Swimmer) -> Gait:
        """Return the gait of a design by the atlas."""
        return atlas_gait(replaced(swimmer, "region", None))

    @staticmethod
    def parameters(swimmer: Swimmer) -> np.ndarray:
        """Return the kernel parameters of one or many designs."""
        return shaded.parameters(swimmer)

    def solve(self, many: Swimmer, free: np.ndarray, phases: int) -> tuple[np.ndarray, ...]:
        """Return twists (n, m, 6), tail powers and drag times speed (n, m), per unit rate.

        A helix at phase 0, m = 1; a plane wave at m = `phases` over half a period.
        """
        R, F, G, extra = self.atlas.matrices(many)
        if many.tail.is_planar:
            R, F, G = (finer(x, 2 * phases)[:, :phases] for x in (R, F, G))
        V = twists(R, F, free)
        V[~coordinates.inside(coordinates.numbers(many), coordinates.kind_of(many))] = np.nan
        power = G + np.einsum("nmi,nmi->nm", F, V)
        drag = extra[:, None, 0] * V[..., 0] + extra[:, None, 1] * V[..., 3] + extra[:, None, 2]
        return V, power, drag * V[..., 0]

    def expected_of_many(self, many: Swimmer, count: int) -> np.ndarray:
        """Return the expected relative error of u_s (count,), NaN outside the range."""
        x, z = _spread(self.atlas, many, count)
        out, rows = np.full(count, np.nan), coordinates.inside(x, coordinates.kind_of(many))
        out[rows] = self.atlas.misses.of_many(z[rows])
        return out


def everywhere(swimmer: Swimmer) -> Swimmer | None:
    """Return a swimmer whose batches the atlas answers; None where `auto` would not take it.

    Also for a motor whose rate is that in the lab, which batches do not know.
    """
    atlas = of(swimmer)
    serves = swimmer.region is None and swimmer.is_open and not coordinates.unlike(swimmer)
    if atlas is None or not serves or swimmer.motion.frequency_frame != "body":
        return None
    return replace(swimmer, region=Everywhere(atlas))


def errors_outside(swimmer: Swimmer, numbers: Mapping[str, Any]) -> np.ndarray:
    """Return the expected relative error of u_s (n,) by the surrogate as it comes, of designs that
    the atlas does not cover; NaN of others, and where it was not measured.
    """
    count = max(np.size(value) for value in numbers.values())
    out, atlas, misses = np.full(count, np.nan), of(swimmer), as_it_comes(swimmer)
    if atlas is None or misses is None:
        return out
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        many = lifted(in_terms_of(swimmer, numbers), numbers)
        x, z = _spread(atlas, many, count)
        rows = np.isfinite(z).all(axis=1) & ~coordinates.inside(x, coordinates.kind_of(many))
    out[rows] = misses.of_many(z[rows])
    return out


def errors_inside(swimmer: Swimmer, numbers: Mapping[str, Any], forward: np.ndarray) -> np.ndarray:
    """Return the expected relative error of u_s (n,) by the user's own law or coefficients, of
    designs that the atlas covers: how far it lies from the atlas, whose own error is added.

    NaN of others. `forward` : mean u_s (n,) of the designs by that law.
    """
    atlas, own = of(swimmer), np.full(forward.size, np.nan)
    if atlas is None or coordinates.unlike(swimmer) or swimmer.motion.frequency_frame != "body":
        return own
    judge, n = Everywhere(atlas), forward.size
    bare = Swimmer(body=swimmer.body, tail=swimmer.tail, fluid=swimmer.fluid,
                   motion=swimmer.motion, region=judge)  # fmt: skip
    every = {"tail.amplitude": swimmer.numbers["tail.amplitude"], **numbers}
    every = {m: np.broadcast_to(v, n) for m, v in every.items() if not m.startswith(OWN)}
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        many = lifted(in_terms_of(bare, every), every)
        doubt = judge.expected_of_many(many, n)
    rows = np.isfinite(doubt) & np.isfinite(forward)
    if rows.any():
        theirs = evaluate(bare, {m: v[rows] for m, v in every.items()})["mean_velocity"][:, 0]
        off = np.abs(forward[rows] - theirs) + np.abs(doubt[rows] * theirs)
        own[rows] = off / np.abs(forward[rows])
    return own


def _spread(atlas: Atlas, many: Swimmer, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers (6, count) and scaled coordinates (count, f) of designs."""
    x, z, _ = atlas.place(many)
    x = np.broadcast_to(x.reshape(6, -1), (6, count))
    return x, np.broadcast_to(np.atleast_2d(z), (count, z.shape[-1]))


def warm_up(swimmer: Swimmer) -> None:
    """Load the compiled code by which the atlas answers such swimmers, one and many."""
    many = everywhere(swimmer)
    if many is not None:
        atlas_gait(swimmer)
        evaluate(many, {"tail.amplitude": np.full(MANY, swimmer.numbers["tail.amplitude"])})


def holding(swimmer: Swimmer, numbers: Mapping[str, Any]) -> Swimmer:
    """Return a swimmer whose designs the atlas answers where it holds for all; else itself."""
    own = any(name.startswith(OWN) for name in numbers)
    served = None if own else everywhere(swimmer)
    if served is None:
        return swimmer
    many = lifted(in_terms_of(swimmer, numbers), numbers)
    within = coordinates.inside(coordinates.numbers(many), coordinates.kind_of(many))
    return served if within.all() else swimmer
