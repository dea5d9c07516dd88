"""What data determine: singular values in log space, covariance, warnings in physical words.

With the weighted Jacobian ``J_ij = (dy_i / d ln x_j) / sigma_i = U S V'`` the combination
``V_k . ln x`` is known to ``1/S_k``: it counts as determined when that is below one, that is,
when the data tell it from half or twice its value.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from microswim.gait.readable import percent
from microswim.numerics.gauss_newton import NOISE
from microswim.swimmer.swimmer import Swimmer


@dataclass(frozen=True)
class Direction:
    """A combination of unknowns (weights on their logarithms) and how well it is known."""

    names: tuple[str, ...]
    weights: tuple[float, ...]
    singular_value: float
    determined: bool

    @property
    def uncertainty(self) -> float:
        """Relative uncertainty of the combination."""
        return 1.0 / self.singular_value if self.singular_value > 0 else float("inf")

    def __str__(self) -> str:
        terms = [(w, n) for w, n in zip(self.weights, self.names) if abs(w) >= 0.1]
        text = " ".join(f"{w:+.2f} {n}" for w, n in terms)
        known = f"known to {percent(self.uncertainty)}" if self.determined else "not determined"
        return f"{text}: {known}"

    def as_dict(self) -> dict[str, Any]:
        """Return its content for JSON."""
        return {
            "weights": dict(zip(self.names, self.weights)),
            "singular_value": self.singular_value,
            "determined": self.determined,
        }


def determined(
    J: np.ndarray, values: np.ndarray, names: Sequence[str]
) -> tuple[tuple[Direction, ...], np.ndarray]:
    """Return directions in log space and the covariance of the values.

    Parameters
    ----------
    J
        Weighted Jacobian (data, unknowns) with respect to the values themselves.
    values
        Where it was taken; the logarithm of a negative value is that of its magnitude.
    names
        Of the unknowns.
    """
    scale = np.where(np.abs(values) > 1e-3, np.abs(values), 1.0)
    _, S, Vt = np.linalg.svd(J * scale, full_matrices=True)
    S = np.concatenate([S, np.zeros(len(values) - len(S))])
    real = NOISE * max(S[0], 1e-300) < S
    directions = tuple(
        Direction(
            tuple(names),
            tuple(float(w) for w in v * np.sign(v[np.argmax(np.abs(v))])),
            float(s) if ok else 0.0,
            bool(ok and s > 1.0),
        )
        for s, v, ok in zip(S, Vt, real)
    )
    known = (Vt[real].T / S[real] ** 2) @ Vt[real]
    covariance = known * np.outer(scale, scale)
    blind = np.sum(Vt[~real] ** 2, axis=0) > 1e-12
    covariance[blind, :] = covariance[:, blind] = 0.0
    covariance[blind, blind] = np.inf
    return directions, covariance


def physical_warnings(swimmer: Swimmer, directions: Sequence[Direction]) -> tuple[str, ...]:
    """Return what a physicist would object to."""
    out = []
    x = swimmer.interaction
    for kind, gammas in (("translation", x.translation), ("rotation", x.rotation)):
        for axis, gamma in zip("sqr", gammas):
            if gamma < 0:
                refused = "; no model takes it: keep it positive" if kind == "translation" else ""
                verb = "moving along" if kind == "translation" else "turning about"
                out.append(
                    f"{kind}.{axis} = {gamma:.3g} is a negative resistance: a body {verb} {axis} "
                    "would gain energy from the fluid; the coefficient makes up for something that "
                    "the model lacks (a coupling, or the tail's own resistance)" + refused
                )
    out += _not_definite(swimmer)
    blind = [d for d in directions if not d.determined]
    if blind:
        known = len(directions) - len(blind)
        out.append(
            f"the data determine {known} of {len(directions)} combinations; not determined: "
            + "; ".join(str(d).rpartition(":")[0] for d in blind)
        )
    return tuple(out)


def _not_definite(swimmer: Swimmer) -> list[str]:
    """Whether the body's own matrix, and the whole, dissipate energy in every motion."""
    from microswim.models.rft.gait import body_resistance

    out = []
    matrix = body_resistance(swimmer)
    scale = np.sqrt(np.abs(np.diag(matrix)))
    drags = np.diag(matrix) > 0
    if drags.all() and np.linalg.eigvalsh(matrix / np.outer(scale, scale))[0] <= 0:
        out.append(
            "the body's resistance matrix is not positive definite: its coupling is too large"
        )
    if not is_definite(swimmer):
        out.append(
            "the resistance matrix of the whole swimmer is not positive definite: some motion "
            "would gain energy from the fluid, and its velocities mean nothing"
        )
    return out


def is_definite(swimmer: Swimmer) -> bool:
    """Return whether the resistance of the whole swimmer is positive definite in every motion."""
    from microswim.models.rft.gait import unchecked as surrogate

    total = surrogate(swimmer).resistance(np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False))
    size = np.sqrt(np.abs(np.diagonal(total, axis1=1, axis2=2)))
    return bool(np.linalg.eigvalsh(total / (size[:, :, None] * size[:, None, :])).min() > 0)
