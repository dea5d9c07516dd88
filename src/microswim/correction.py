"""A region calibration in use: the surrogate corrected over a region of designs.

``swimmer.gait()`` and `microswim.evaluate` of a swimmer that carries a `Correction` give the
corrected R and F_p; a gait also the expected error, and says when the design lies outside.
Depends on shaded, blocks, kriging.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numba import njit

from . import blocks, shaded
from .errors import SpecError
from .gait import MIRROR_Q, Gait
from .kernels import HELIX
from .kriging import Surfaces, predict
from .mobility import solve
from .swimmer import Swimmer

MIRROR_R = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
SAMPLES = 8  #: phases over a period of a plane wave
HALF = SAMPLES // 2
FEATURES = ("ln bk", "ln k r_t", "ln N", "ln r_s/r_t", "ln r_q/r_s", "ln r_r/r_s", "ramp")
_FREELY = ("fluid.", "tail.frequency", "coefficients.", "interaction.")
_WORDS = ("kind", "sections", "surface_motion", "length_measure")


class RegionWarning(UserWarning):
    """A design lies outside the region that a calibration covers."""


def features(swimmer: Swimmer) -> np.ndarray:
    """Dimensionless numbers of a design, shape (..., 7), as `FEATURES`."""
    tail, (r_s, r_q, r_r) = swimmer.tail, swimmer.body.semi_axes3
    k = tail.wavenumber
    values = (
        *(np.log(x) for x in (tail.amplitude * k, k * tail.radius, tail.number_of_waves)),
        *(np.log(x) for x in (r_s / tail.radius, r_q / r_s, r_r / r_s)),
        tail.ramp,
    )
    return np.stack(np.broadcast_arrays(*values), axis=-1)


def words(swimmer: Swimmer) -> dict[str, str]:
    """What is chosen by word, and must be as it was in the calibration."""
    own = {w: str(getattr(swimmer.tail, w)) for w in _WORDS if hasattr(swimmer.tail, w)}
    return own | {"shape": swimmer.body.shape}


def fixed_numbers(swimmer: Swimmer, names: Any) -> dict[str, float]:
    """Numbers of the spec that decide the flow and do not vary over the region."""
    varied = set(names)
    return {
        name: float(value)
        for name, value in swimmer.numbers.items()
        if not name.startswith(_FREELY) and name not in varied
    }


def _number(swimmer: Swimmer, name: str) -> float:
    """A number of the spec by its dotted name, NaN if there is none."""
    part, _, field_ = name.partition(".")
    field_, _, index = field_.rstrip("]").partition("[")
    value = getattr(getattr(swimmer, part), field_, None)
    value = value[int(index)] if index and value is not None else value
    return float("nan") if value is None else float(np.real(value))


@dataclass(frozen=True, eq=False)
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
        Quantity to (doubt to error factor, median, 90 % quantile, worst leave-one-out error).
    scales
        Quantity to the scale that its error refers to; 0 where it is the value itself.
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
    about: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def _order(self) -> np.ndarray:
        return self.columns[0].astype(int)

    @staticmethod
    def parameters(swimmer: Swimmer) -> np.ndarray:
        """Kernel parameters (..., 10) of the base."""
        return shaded.parameters(swimmer)

    def inputs(self, swimmer: Swimmer) -> tuple[np.ndarray, np.ndarray]:
        """Scaled features (n, f) and numbers of waves (n,) of one or many designs."""
        x = np.atleast_2d(features(swimmer))[:, self._order]
        N = np.broadcast_to(swimmer.tail.number_of_waves, (len(x),))
        return np.ascontiguousarray((x - self.columns[1]) / self.columns[2]), N

    def outside(self, swimmer: Swimmer) -> list[str]:
        """In words, what puts a design outside the region; empty inside."""
        out = []
        for name, low in self.low.items():
            value, high = _number(swimmer, name), self.high[name]
            slack = 1e-9 * max(abs(low), abs(high))
            if not low - slack <= value <= high + slack:
                out.append(f"{name} = {value:.6g} is not in {low:g} to {high:g}")
        for name, held in self.fixed.items():
            value = _number(swimmer, name)
            if not abs(value - held) <= 1e-9 * abs(held):
                out.append(f"{name} = {value:.6g} is not {held:g}")
        for name, word in words(swimmer).items():
            if word != self.choices.get(name):
                out.append(f"{name} is {word}, not {self.choices.get(name)}")
        return out

    def expected(self, swimmer: Swimmer) -> dict[str, float]:
        """Expected relative error of each quantity at a design (one standard deviation)."""
        Z, N = self.inputs(swimmer)
        spread = np.sqrt(self.surfaces.doubt(np.real(Z), np.real(N))[0])
        return {name: float(e["factor"] * spread) for name, e in self.errors.items()}

    def gait(self, swimmer: Swimmer) -> Gait:
        """Corrected gait of a design.

        Raises
        ------
        SpecError
            If the design is of another kind than those of the region.
        """
        if swimmer.tail.kind != self.choices["kind"]:
            raise SpecError(
                "tail.kind", swimmer.tail.kind, f'"{self.choices["kind"]}", as calibrated'
            )
        helix = swimmer.tail.kind == "helix"
        R, F, G, extra = self._matrices(swimmer)
        missing = self.outside(swimmer)
        if missing:
            warnings.warn(
                f"outside the calibrated region, expect larger errors: {'; '.join(missing)}",
                RegionWarning,
                stacklevel=3,
            )
        expected = self.expected(swimmer)
        info = {
            "expected_error": expected["mean.us"] if not missing else float("nan"),
            "expected_errors": expected,
            "outside": missing,
            "reference": self.about.get("reference", "bem"),
        }
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
        if sign < 0:
            both = {"body_R": body_R * np.outer(MIRROR_R, MIRROR_R), "body_F": body_F * MIRROR_R}
        made = Gait.from_rotation(R[0, 0], F[0, 0], G[0, 0], sign=sign, **both, **common)
        if swimmer.motion.frequency_frame == "lab":
            return made.in_lab_frame(swimmer.tail.rate, sign)
        return made

    def _matrices(self, many: Swimmer) -> tuple[np.ndarray, ...]:
        """R (n, m, 6, 6), F (n, m, 6), G (n, m) over the phases, and the body's share (n, 3)."""
        Z, N = self.inputs(many)
        n = len(Z)
        p = np.ascontiguousarray(np.broadcast_to(shaded.parameters(many), (n, 10)))
        drags = many.body.diagonal(many.fluid.viscosity)
        D = np.stack([np.broadcast_to(d, (n,)) for d in drags], axis=-1)
        mu = np.broadcast_to(many.fluid.viscosity, (n,))
        kind = np.result_type(Z, p, D, mu, np.float64)
        arrays = (np.ascontiguousarray(x, dtype=kind) for x in (p, D, mu, Z, N))
        *packed, mean = self.surfaces.packed
        turn = shaded.code(many) == HELIX
        run = helices if turn else waves
        R, F, G, extra = run(*arrays, *shaded.nodes(0, N), *packed, mean)
        if turn and many.tail.sign < 0:
            R, F = R * np.outer(MIRROR_R, MIRROR_R), F * MIRROR_R
        return R, F, G, extra

    def solve(self, many: Swimmer, free: np.ndarray, phases: int) -> tuple[np.ndarray, ...]:
        """Twists (n, m, 6), tail powers and drag times speed (n, m), per unit rate, of designs.

        A helix at phase 0, a plane wave at `phases` over half a period.
        """
        R, F, G, extra = self._matrices(many)
        if self.choices["kind"] == "plane_wave":
            R, F, G = (_finer(x, 2 * phases)[:, :phases] for x in (R, F, G))
        V = twists(np.ascontiguousarray(R), np.ascontiguousarray(F), free)
        power = G + np.einsum("nmi,nmi->nm", F, V)
        drag = extra[:, None, 0] * V[..., 0] + extra[:, None, 1] * V[..., 3] + extra[:, None, 2]
        return V, power, drag * V[..., 0]


def _finer(samples: np.ndarray, count: int) -> np.ndarray:
    """Samples over the period at more phases, the Nyquist term left out."""
    hat = np.fft.rfft(samples, axis=1)[:, :HALF]
    return np.fft.irfft(hat, count, axis=1) * (count / samples.shape[1])


def _with_body(gait: Gait, body_R: np.ndarray, body_F: Any) -> Gait:
    from dataclasses import replace

    return replace(gait, body_resistance_series=body_R, body_propulsion_series=body_F)


@njit(cache=True, nogil=True)
def helices(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, ramp_rule: Any, rule: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Corrected R, F, G of rigid helices at phase 0, and the axial force on the body."""
    n = p.shape[0]
    R = np.empty((n, 1, 6, 6), dtype=p.dtype)
    F = np.empty((n, 1, 6), dtype=p.dtype)
    G = np.empty((n, 1), dtype=p.dtype)
    extra = np.empty((n, 3), dtype=p.dtype)
    for d in range(n):
        y = mean.astype(p.dtype)
        predict(y, Z[d], N[d], nodes, tips, lengths, phasors, cut, alpha)
        R0, F0, G0 = shaded.shaded_tail(0, p[d], 0.0, ramp_rule, rule)
        for i in range(6):
            R0[i, i] += D[d, i]
        a = p[d, 8]
        extra[d, 0] = D[d, 0] * np.exp(y[10])
        extra[d, 1] = y[11] * mu[d] * a * a
        extra[d, 2] = y[12] * mu[d] * a * a
        for i in range(12):
            y[10 + i] = y[13 + i]
        r, f, g = blocks.decode_helix(y, R0, F0, G0, a, mu[d], D[d, 3])
        G[d, 0] = g
        for i in range(6):
            F[d, 0, i] = f[i]
            for j in range(6):
                R[d, 0, i, j] = r[i, j]
    return R, F, G, extra


@njit(cache=True)
def scales(R0: Any, F0: Any, G0: Any) -> Any:
    """Scales of F_s, F_q, T_r and G of a plane wave, from samples over half a period."""
    out = np.empty(4, dtype=R0.dtype)
    thrust, power, across, turn = 0 * G0[0], 0 * G0[0], 0 * G0[0], 0 * G0[0]
    for j in range(len(G0)):
        thrust += F0[j, 0] / len(G0)
        power += G0[j] / len(G0)
        across += R0[j, 1, 1] / len(G0)
        turn += R0[j, 5, 5] / len(G0)
    out[0], out[3] = thrust, power
    out[1], out[2] = np.sqrt(power * across), np.sqrt(power * turn)
    return out


@njit(cache=True)
def wave_base(p: Any, D: Any, ramp_rule: Any, rule: Any) -> Any:
    """Base R, F, G of a plane wave at the phases of half a period."""
    R0 = np.empty((HALF, 6, 6), dtype=p.dtype)
    F0 = np.empty((HALF, 6), dtype=p.dtype)
    G0 = np.empty(HALF, dtype=p.dtype)
    for j in range(HALF):
        R0[j], F0[j], G0[j] = shaded.shaded_tail(1, p, np.pi * j / HALF, ramp_rule, rule)
        for i in range(6):
            R0[j, i, i] += D[i]
    return R0, F0, G0


@njit(cache=True)
def beat(y: Any, phase: float) -> Any:
    """Corrections (16,) at a phase from the harmonics, packed as `region` fits them."""
    out = np.empty(16, dtype=y.dtype)
    c1, s1 = np.cos(phase), np.sin(phase)
    c2, s2, c3, s3 = np.cos(2 * phase), np.sin(2 * phase), np.cos(3 * phase), np.sin(3 * phase)
    for i in range(len(blocks.EVEN)):
        out[blocks.EVEN[i]] = y[i] + c2 * y[10 + 2 * i] - s2 * y[11 + 2 * i]
    for i in range(len(blocks.ODD)):
        first = c1 * y[30 + 2 * i] - s1 * y[31 + 2 * i]
        out[blocks.ODD[i]] = first + c3 * y[42 + 2 * i] - s3 * y[43 + 2 * i]
    return out


@njit(cache=True, nogil=True)
def waves(
    p: Any, D: Any, mu: Any, Z: Any, N: Any, ramp_rule: Any, rule: Any,
    nodes: Any, tips: Any, lengths: Any, phasors: Any, cut: Any, alpha: Any, mean: Any,
) -> Any:  # fmt: skip
    """Corrected R, F, G of plane waves at uniform phases of the whole period."""
    n = p.shape[0]
    R = np.empty((n, SAMPLES, 6, 6), dtype=p.dtype)
    F = np.empty((n, SAMPLES, 6), dtype=p.dtype)
    G = np.empty((n, SAMPLES), dtype=p.dtype)
    extra = np.zeros((n, 3), dtype=p.dtype)
    for d in range(n):
        y = mean.astype(p.dtype)
        predict(y, Z[d], N[d], nodes, tips, lengths, phasors, cut, alpha)
        R0, F0, G0 = wave_base(p[d], D[d], ramp_rule, rule)
        scale = scales(R0, F0, G0)
        extra[d, 0] = D[d, 0]
        for j in range(HALF):
            now = beat(y, np.pi * j / HALF)
            r, f, g = blocks.decode_wave(now, R0[j], F0[j], G0[j], p[d, 8], scale)
            G[d, j] = G[d, j + HALF] = g
            for i in range(6):
                F[d, j, i] = f[i]
                F[d, j + HALF, i] = MIRROR_Q[i] * f[i]
                for m in range(6):
                    R[d, j, i, m] = r[i, m]
                    R[d, j + HALF, i, m] = MIRROR_Q[i] * MIRROR_Q[m] * r[i, m]
    return R, F, G, extra


@njit(cache=True, nogil=True)
def twists(R: Any, F: Any, free: Any) -> Any:
    """``V = -R^-1 F`` on the free degrees of freedom, of many designs and phases."""
    V = -F
    A = np.empty_like(R)
    A[:] = R
    for d in range(R.shape[0]):
        for j in range(R.shape[1]):
            solve(A[d, j], V[d, j], free)
    return V
