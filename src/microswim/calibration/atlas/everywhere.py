"""The atlas in place of a region calibration: many designs side by side, for sweeps."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
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
from microswim.swimmer.variants import unchosen

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


def everywhere(swimmer: Swimmer, varied: Iterable[str] = ()) -> Swimmer | None:
    """Return a swimmer whose batches the atlas answers; None where `auto` would not take it.

    Nor does it where the user's own law or coefficients are among the numbers that are `varied`, or
    for a motor whose rate is that in the lab, which batches do not know.
    """
    atlas, own = of(swimmer), any(name.startswith(OWN) for name in varied)
    serves = swimmer.region is None and swimmer.is_open and not coordinates.unlike(swimmer)
    serves = serves and not own
    if atlas is None or not serves or swimmer.motion.frequency_frame != "body":
        return None
    return replace(swimmer, region=Everywhere(atlas))


def errors_of_law(swimmer: Swimmer, numbers: Mapping[str, Any], forward: np.ndarray) -> np.ndarray:
    """Return the expected relative error of u_s (n,) by local resistance, by the spec's own law or
    as it comes.

    Of designs that the atlas covers how far they lie from it, its own error added; of others what
    the law missed of the nearest solved. NaN where neither is known.

    Parameters
    ----------
    forward
        Mean u_s (n,) of the designs by that law.
    """
    out, atlas = np.full(forward.size, np.nan), of(swimmer)
    if atlas is None or coordinates.unlike(swimmer):
        return out
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        many = lifted(in_terms_of(swimmer, numbers), numbers)
        x, z = _spread(atlas, many, forward.size)
    covered, misses = coordinates.inside(x, coordinates.kind_of(many)), as_it_comes(swimmer)
    if misses is not None:
        beyond = ~covered & np.isfinite(z).all(axis=1)
        out[beyond] = misses.of_many(z[beyond])
    within = covered & np.isfinite(forward)
    if within.any() and swimmer.motion.frequency_frame == "body":
        judge = replace(unchosen(swimmer), region=Everywhere(atlas))
        every = {"tail.amplitude": swimmer.numbers["tail.amplitude"], **numbers}
        every = {m: np.broadcast_to(v, forward.size)[within] for m, v in every.items()}
        known = {m: v for m, v in every.items() if not m.startswith(OWN)}
        theirs, own = evaluate(judge, known)["mean_velocity"][:, 0], forward[within]
        doubt = np.abs(atlas.misses.of_many(z[within]) * theirs)
        out[within] = (np.abs(own - theirs) + doubt) / np.abs(own)
    return out


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
    served = everywhere(swimmer, numbers)
    if served is None:
        return swimmer
    many = lifted(in_terms_of(swimmer, numbers), numbers)
    within = coordinates.inside(coordinates.numbers(many), coordinates.kind_of(many))
    return served if within.all() else swimmer
