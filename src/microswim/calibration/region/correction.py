"""A region calibration in use: the surrogate corrected over a region of designs.

``swimmer.gait()`` and `microswim.evaluate` of a swimmer that carries a `Correction` give the
corrected R and F_p; a gait also the expected error, and says when the design lies outside.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region.beats import finer
from microswim.calibration.region.evaluate import matrices, twists
from microswim.calibration.region.surfaces import Surfaces
from microswim.errors import SpecError, measured, warn
from microswim.gait.gait import Gait
from microswim.gait.poses.one_pose import remark
from microswim.numerics.array import read_only
from microswim.swimmer import physical_sense
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.swimmer import Swimmer

NEAR = 0.7  #: spreads of the features over which left-out errors are averaged
FEATURES = ("ln bk", "ln k r_t", "ln N", "ln r_s/r_t", "ln r_q/r_s", "ln r_r/r_s", "ramp")
_FREELY = ("fluid.", "tail.frequency", "coefficients.", "interaction.", "magnet.", "field.")
_WORDS = ("kind", "sections", "surface_motion", "length_measure")


class RegionWarning(UserWarning):
    """A design lies outside the region that a calibration covers."""


def features(swimmer: Swimmer) -> np.ndarray:
    """Return the dimensionless numbers of a design, shape (..., 7), as `FEATURES`."""
    tail, (r_s, r_q, r_r) = as_wave(swimmer.tail), swimmer.body.semi_axes3
    k = tail.wavenumber
    values = (
        *(np.log(x) for x in (tail.amplitude * k, k * tail.radius, tail.number_of_waves)),
        *(np.log(x) for x in (r_s / tail.radius, r_q / r_s, r_r / r_s)),
        tail.ramp,
    )
    if any(isinstance(v, np.ndarray) for v in values):
        return np.stack(np.broadcast_arrays(*values), axis=-1)
    return np.array(values)


def words(swimmer: Swimmer) -> dict[str, str]:
    """Return what is chosen by word, and must be as it was in the calibration."""
    own = {w: str(getattr(swimmer.tail, w)) for w in _WORDS if hasattr(swimmer.tail, w)}
    around = "free fluid" if swimmer.wall is None else "a wall"
    if swimmer.channel is not None:
        around = f"a {swimmer.channel.shape}"
    return own | {"shape": swimmer.body.shape, "surroundings": around}


def _asked(name: str, ends: tuple[float, ...]) -> str:
    return ("in " if len(ends) > 1 else "") + " to ".join(measured(end, name) for end in ends)


def fixed_numbers(swimmer: Swimmer, names: Any) -> dict[str, float]:
    """Return numbers of the spec that decide the flow and do not vary over the region."""
    varied = set(names)
    return {
        name: float(value)
        for name, value in swimmer.numbers.items()
        if not name.startswith(_FREELY) and name not in varied
    }


def _number(swimmer: Swimmer, name: str) -> Any:
    """A number of the spec by its dotted name (an array, of many designs), NaN if there is none."""
    part, _, field_ = name.partition(".")
    field_, _, index = field_.rstrip("]").partition("[")
    value = getattr(getattr(swimmer, part), field_, None)
    value = value[int(index)] if index and value is not None else value
    return float("nan") if value is None else np.real(value)


@dataclass(frozen=True, eq=False)
@read_only
class Correction:
    """Smooth corrections of R and F_p over a region of designs.

    Parameters
    ----------
    low, high
        The region: dotted name to its bounds.
    fixed, choices
        Numbers and words of the spec that the region shares.
    surfaces
        What predicts the corrections.
    columns
        Features used, their means and spreads: shape (3, f).
    errors
        Quantity to median, 90 % quantile and worst leave-one-out error.
    spots, ratios
        Scaled features (m, f) of all designs whose left-out error is known, and the square of that
        error over the doubt there, (m, quantities) in the order of `errors`.
    about
        Reference, solves and the like.
    """

    low: dict[str, float]
    high: dict[str, float]
    fixed: dict[str, float]
    choices: dict[str, str]
    surfaces: Surfaces
    columns: np.ndarray
    errors: dict[str, dict[str, float]]
    spots: np.ndarray
    ratios: np.ndarray
    about: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def _order(self) -> np.ndarray:
        return self.columns[0].astype(int)

    @staticmethod
    def parameters(swimmer: Swimmer) -> np.ndarray:
        """Return the kernel parameters (..., 11) of the base."""
        return shaded.parameters(swimmer)

    def inputs(self, swimmer: Swimmer) -> tuple[np.ndarray, np.ndarray]:
        """Return the scaled features (n, f) and numbers of waves (n,) of one or many designs."""
        x = np.atleast_2d(features(swimmer))[:, self._order]
        N = np.broadcast_to(swimmer.tail.number_of_waves, (len(x),))
        return np.ascontiguousarray((x - self.columns[1]) / self.columns[2]), N

    def _misses(self, many: Swimmer) -> list[tuple[str, Any, tuple[float, ...], Any]]:
        """Name, value, ends of what is asked of it, and whether it misses that, of each number."""
        out = []
        for name, low in self.low.items():
            value, high = _number(many, name), self.high[name]
            slack = 1e-9 * max(abs(low), abs(high))
            inside = (value >= low - slack) & (value <= high + slack)
            out.append((name, value, (low, high), np.logical_not(inside)))
        for name, held in self.fixed.items():
            value = _number(many, name)
            same = np.abs(value - held) <= 1e-9 * abs(held)
            out.append((name, value, (held,), np.logical_not(same)))
        return out

    def _wrong_words(self, swimmer: Swimmer) -> list[str]:
        return [
            f"{name} is {word}, not {self.choices.get(name)}"
            for name, word in words(swimmer).items()
            if word != self.choices.get(name)
        ]

    def outside(self, swimmer: Swimmer) -> list[str]:
        """Return what puts a design outside the region, in words; empty inside."""
        numbers = [
            f"{name} = {measured(value, name)} is not {_asked(name, ends)}"
            for name, value, ends, misses in self._misses(swimmer)
            if misses
        ]
        return numbers + self._wrong_words(swimmer)

    def expected(self, swimmer: Swimmer) -> dict[str, float]:
        """Return the expected relative error of each quantity at a design (one standard deviation).

        The doubt of the Gaussian processes knows how far the solved designs are, not where the
        reference is rough; the left-out errors around the design, in units of it, do.
        """
        return self._expected(*self.inputs(swimmer))

    def _expected(self, Z: np.ndarray, N: np.ndarray) -> dict[str, float]:
        z = np.real(Z[0])
        doubt = self.surfaces.doubt_of_one(z, float(np.real(N[0])))
        return dict(zip(self.errors, np.sqrt(doubt * self._around(z[None])[0]).tolist()))

    def _around(self, z: np.ndarray) -> np.ndarray:
        """Mean of `ratios` around designs (n, f), weighted by a Gaussian, (n, quantities)."""
        far = np.sum((z[:, None] - self.spots) ** 2, axis=-1) / (2.0 * NEAR**2)
        weight = np.exp(far.min(axis=1, keepdims=True) - far)
        return (weight @ self.ratios) / weight.sum(axis=1, keepdims=True)

    def expected_of_many(self, many: Swimmer, count: int) -> np.ndarray:
        """Return the expected relative error of the mean forward velocity (count,), NaN outside
        the region.
        """
        misses = np.full(count, bool(self._wrong_words(many)))
        for _, _, _, there in self._misses(many):
            misses |= there
        out, rows = np.full(count, np.nan), np.flatnonzero(~misses)
        Z, N = (np.broadcast_to(x, (count, *x.shape[1:])) for x in self.inputs(many))
        forward = list(self.errors).index("mean.us")
        for part in np.array_split(rows, -(-len(rows) // 1024) or 1):
            doubt = self.surfaces.doubt(Z[part], N[part])
            out[part] = np.sqrt(doubt * self._around(Z[part])[:, forward])
        return out

    def gait(self, swimmer: Swimmer) -> Gait:
        """Return the corrected gait of a design.

        Raises
        ------
        SpecError
            If the design is of another kind than those of the region.
        """
        if swimmer.tail.kind != self.choices["kind"]:
            raise SpecError(
                "tail.kind", swimmer.tail.kind, f'"{self.choices["kind"]}", as calibrated'
            )
        as_wave(swimmer.tail)
        helix = swimmer.tail.is_rigid
        inputs = self.inputs(swimmer)
        R, F, G, extra = matrices(swimmer, *inputs, self.surfaces)
        missing = self.outside(swimmer)
        if missing:
            warn(
                f"outside the calibrated region, expect larger errors: {'; '.join(missing)}",
                RegionWarning,
                stacklevel=3,
            )
        expected = self._expected(*inputs)
        info = {
            "expected_error": expected["mean.us"] if not missing else float("nan"),
            "expected_errors": expected if not missing else dict.fromkeys(expected, float("nan")),
            "outside": missing,
            "reference": self.about.get("reference", "bem"),
        }
        turning = physical_sense.turning(swimmer)
        if turning:
            info |= {"one_pose": turning, "remarks": [remark(turning)]}
        common = {"rate": swimmer.tail.rate, "free": swimmer.motion.mask, "units": swimmer.units}
        common |= {"model": "rft", "info": info}
        drag = np.diag(np.array(swimmer.body.diagonal(swimmer.fluid.viscosity)))
        if not helix:
            made = Gait.from_samples(R[0], F[0], G[0], **common)
            return _with_body(made, drag[None], None)
        body_R, body_F = drag.astype(R.dtype), np.zeros(6, dtype=R.dtype)
        body_R[0, 0], body_R[0, 3], body_F[0] = extra[0]
        sign = swimmer.tail.sign
        both = {"body_R": body_R, "body_F": body_F}
        made = Gait.from_rotation(R[0, 0], F[0, 0], G[0, 0], sign=sign, **both, **common)
        if swimmer.motion.frequency_frame == "lab":
            return made.in_lab_frame(swimmer.tail.rate, sign)
        return made

    def solve(self, many: Swimmer, free: np.ndarray, phases: int) -> tuple[np.ndarray, ...]:
        """Return twists (n, m, 6), tail powers and drag times speed (n, m), per unit rate, of
        designs.

        A helix at phase 0, a plane wave at `phases` over half a period.
        """
        R, F, G, extra = matrices(many, *self.inputs(many), self.surfaces)
        if many.tail.is_planar:
            R, F, G = (finer(x, 2 * phases)[:, :phases] for x in (R, F, G))
        V = twists(np.ascontiguousarray(R), np.ascontiguousarray(F), free)
        power = G + np.einsum("nmi,nmi->nm", F, V)
        drag = extra[:, None, 0] * V[..., 0] + extra[:, None, 1] * V[..., 3] + extra[:, None, 2]
        return V, power, drag * V[..., 0]


def _with_body(gait: Gait, body_R: np.ndarray, body_F: Any) -> Gait:
    from dataclasses import replace

    return replace(gait, body_resistance_series=body_R, body_propulsion_series=body_F)
