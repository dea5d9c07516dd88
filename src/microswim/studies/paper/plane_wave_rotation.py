"""Why the paper's plane wave has a negative rotation coefficient, and which physics removes it.

In the plane of the beat the swimmer obeys ``R V + F_p rate = 0`` for (us, uq, or), with
``R = D Gamma + E + R_tail``. Each `Variant` frees some of: the coefficients Gamma, a coupling E of
force across and turning, factors of the tail's c_t and c_n; takes the body's block from the
reference; or adds the tip (`Coefficients.tip`), which neither Eq. (5) nor (14) has. It is fitted to
the reference's velocities, or to the whole R and F_p.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from microswim.gait.gait import Gait
from microswim.models.rft.gait import unchecked
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.swimmer import Swimmer

PHASES = 24
PLANE = (0, 1, 5)
LEAST = 1e-3  #: of a factor of the tail's coefficients
UNKNOWNS = ("gamma_s", "gamma_q", "gamma_r", "coupling", "tail_t", "tail_n")
START = {"gamma_s": 1.0, "gamma_q": 1.0, "gamma_r": 1.0, "coupling": 0.0, "tail_t": 1.0} | {
    "tail_n": 1.0
}


@dataclass(frozen=True)
class Variant:
    """What a variant frees, to what it is fitted, in one or two steps."""

    name: str
    steps: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]
    tip: bool = False
    own_body: bool = False


GAMMA = ("gamma_s", "gamma_q", "gamma_r")
TAIL = ("tail_t", "tail_n")
V, R, F = ("velocity",), ("resistance",), ("propulsion",)
VARIANTS = (
    Variant("diagonal Gamma from velocities (the paper's)", ((GAMMA, V),)),
    Variant("tail factors from the tail's drags, then Gamma", ((TAIL, ("drag",)), (GAMMA, V))),
    Variant("tail factors from propulsion, then Gamma", ((TAIL, F), (GAMMA, V))),
    Variant("Gamma and coupling E from the whole R", (((*GAMMA, "coupling"), R),)),
    Variant("Gamma, E and tail factors from R and F_p", ((UNKNOWNS, (*R, *F)),)),
    Variant("body's 6x6 of the reference, tail factors from velocities", ((TAIL, V),), False, True),
    Variant("tip, then diagonal Gamma from velocities", ((GAMMA, V),), True),
    Variant("tip, tail factors from propulsion, then Gamma", ((TAIL, F), (GAMMA, V)), True),
    Variant("tip; Gamma, E and tail factors from R and F_p", ((UNKNOWNS, (*R, *F)),), True),
)


def study(swimmer: Swimmer, reference: Gait) -> list[dict[str, Any]]:
    """Return each variant's coefficients and how far its velocities, R and F_p are from the
    reference.

    Parameters
    ----------
    swimmer
        A plane wave; its law of local resistance counts.
    reference
        Gait of the same swimmer by a reference, with the body's share.
    """
    return [fitted(swimmer, reference, v) for v in VARIANTS]


def fitted(swimmer: Swimmer, reference: Gait, variant: Variant) -> dict[str, Any]:
    """Return coefficients of one variant, largest error of a velocity, rms errors of R and F_p."""
    values = dict(START)
    truth = _measures(reference)
    own = _own_block(reference) if variant.own_body else None
    for names, wanted in variant.steps:

        def residual(x: Any, values: Any = values, names: Any = names, wanted: Any = wanted) -> Any:
            made = _measures(_model(swimmer, values | dict(zip(names, x)), variant, own))
            return np.concatenate([(made[w] - truth[w]) / _scale(truth[w]) for w in wanted])

        begin = np.array([values[n] for n in names])
        low = [LEAST if n in TAIL else -np.inf for n in names]
        fits = [least_squares(residual, begin * f, bounds=(low, np.inf)) for f in (1.0, 2.0, 0.5)]
        values |= dict(zip(names, map(float, min(fits, key=lambda r: r.cost).x)))
    made = _measures(_model(swimmer, values, variant, own))
    free = {n for names, _ in variant.steps for n in names}
    row: dict[str, Any] = {"variant": variant.name}
    row |= {n: values[n] if n in free else None for n in UNKNOWNS}
    if own is not None:
        drag = swimmer.body.diagonal(swimmer.fluid.viscosity)
        row |= {n: own[i, i] / drag[i] for n, i in zip(GAMMA, PLANE)}
    row["velocity error"] = float(np.abs(made["velocity"] / truth["velocity"] - 1.0).max())
    for name in ("resistance", "propulsion"):
        off = (made[name] - truth[name]) / _scale(truth[name])
        row[f"{name} error"] = float(np.sqrt(np.mean(off**2)))
    return row


def _model(swimmer: Swimmer, values: dict[str, float], variant: Variant, own: Any) -> Gait:
    """The surrogate's gait with given unknowns."""
    x = Interaction(
        translation=(values["gamma_s"], values["gamma_q"], 1.0),
        rotation=(1.0, 1.0, values["gamma_r"]),
        tail=(values["tail_t"], values["tail_n"], 1.0),
    )
    law = replace(swimmer.coefficients, tip=variant.tip)
    made = unchecked(replace(swimmer, interaction=x, coefficients=law))
    phase = 2.0 * np.pi * np.arange(PHASES) / PHASES
    drag = np.array(swimmer.body.diagonal(swimmer.fluid.viscosity))
    R, wrench, G = made.resistance(phase), made.propulsion(phase), made.activity(phase)
    plain = np.diag(drag * np.array([*x.translation, *x.rotation]))
    body = plain.copy()
    body[1, 5] = body[5, 1] = values["coupling"] * np.sqrt(drag[1] * drag[5])
    body = body if own is None else own
    R = R + body - plain
    shares = {"body_R": np.broadcast_to(body, R.shape), "body_F": 0.0 * wrench}
    return Gait.from_samples(R, wrench, G, **shares, rate=made.rate, free=made.free)


def _own_block(reference: Gait) -> np.ndarray:
    """The body's share of the reference's mean resistance, symmetric as a body's own must be."""
    block = reference.body_resistance_series
    assert block is not None
    return 0.5 * (block[0] + block[0].T)


def _measures(gait: Gait) -> dict[str, np.ndarray]:
    """Velocities that the paper fits; mean R, and mean and first harmonic of F_p, in the plane."""
    i = list(PLANE)
    R, wrench = gait.resistance_series[0], gait.propulsion_series
    own = gait.body_resistance_series
    tail = R if own is None else R - own[0]
    return {
        "velocity": np.array([gait.mean_velocity[0], *gait.velocity_amplitude[[1, 5]]]),
        "resistance": np.array([*np.diag(R)[i], R[1, 5]]),
        "drag": np.diag(tail)[:2],
        "propulsion": np.array([wrench[0, 0], *wrench[1:3, 1], *wrench[1:3, 5]]),
    }


def _scale(values: np.ndarray) -> np.ndarray:
    """Scale of each entry: itself, for harmonics the larger of the pair."""
    if len(values) != 5:
        return np.abs(values)
    force, torque = np.hypot(*values[1:3]), np.hypot(*values[3:])
    return np.array([abs(values[0]), force, force, torque, torque])
