"""Resistive force theory [Tabak Eqs. 4-6, 13-15, 21, 22]: quadrature along the tail gives a gait.

With the local resistance ``C = c_n I + (c_t - c_n) t t'`` per unit length (Eqs. 5, 6; the paper's
``R C R'``), X the position relative to the body's centre and u_hat = dP/dphase,

    B_t = int [ C        -C X^        ]  dl   + spin:  c_r t t' in the angular block
              [ X^ C     -X^ C X^     ]
    F_p = int [ C u_hat;  X x C u_hat ]  dl   + spin:  c_r t (t . w_hat)

where ``X^ v = X x v`` and w_hat is the section's own rate of rotation; a tip with drag adds the
same at ``s = L`` with ``C = 3 pi mu r_t I``. In Eq. (14) the paper prints
``R C R u_hat`` where ``R C R' u_hat`` is meant. The line element is arc length,
``dl = |dP/ds| ds`` (the paper's ``ds`` is the option ``line_element = "apparent"``).

Everything stays analytic, so that the complex-step derivative runs through the same kernels.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError, measured
from microswim.gait.gait import Gait
from microswim.gait.poses.one_pose import remark
from microswim.models.rft import ribbon
from microswim.models.rft.helix import FEWEST_WAVES, helix_tail, ramp_nodes
from microswim.models.rft.placed import remarks_on, sum_over_tails
from microswim.models.rft.plane_wave import wave_phases
from microswim.models.rft.segment import (
    HELIX,
    MOST_NODES,
    PLANE_WAVE,
    STEEPEST,
    centreline_tail,
    node_numbers,
    wave_tail,
)
from microswim.numerics.array import owned
from microswim.numerics.compiling.compiled import pays
from microswim.numerics.quadrature import gauss, panels
from microswim.numerics.series.fourier import MIRROR_Q, add, rotate, series_of, trimmed
from microswim.swimmer import physical_sense
from microswim.swimmer.drag.ribbon import local as drag_of_ribbon
from microswim.swimmer.geometry.tails.kinds import Tail, as_wave
from microswim.swimmer.swimmer import SURROUNDINGS, Swimmer

AXIS = np.array([1.0, 0.0, 0.0])
#: Phases over half a period that resolve the steepest plane wave.
MOST_ON_ONE_RULE = 1000  #: nodes of one Gauss rule, whose cost rises with their square
MOST_PHASES = 768
#: Seconds of a segment as Python: alone, and at many phases side by side.
ALONE, TOGETHER = 5e-5, 1.5e-4


def parameters(swimmer: Swimmer) -> np.ndarray:
    """Return kernel parameters of a swimmer with a wave tail, shape (..., 11), as in `segment`."""
    tail, x = as_wave(swimmer.tail), swimmer.interaction.tail
    local = swimmer.coefficients.local(tail, swimmer.fluid.viscosity)
    values = (
        *(tail.apparent_length, tail.amplitude, tail.wavenumber, tail.ramp, tail.sign),
        *(factor * c for factor, c in zip(x, local)),
        *(swimmer.body.semi_axes3[0], tail.spin),
        swimmer.coefficients.end(tail, swimmer.fluid.viscosity),
    )
    if np.ndarray in map(type, values):
        return np.stack(np.broadcast_arrays(*values), axis=-1)
    return np.array(values)


def body_resistance(swimmer: Swimmer) -> np.ndarray:
    """Return the body resistance with its interaction coefficients [Tabak Eqs. 3, 21, 22]."""
    body, mu = swimmer.body, swimmer.fluid.viscosity
    if not body.is_balanced:
        return swimmer.interaction.coupled(body.resistance(mu))
    return swimmer.interaction.body_resistance(body.diagonal(mu))


def rules(swimmer: Swimmer, nodes: int | None = None) -> tuple[Any, Any]:
    """Return the quadrature rules for ramp and rest; `nodes` overrides the number on the rest.

    Raises
    ------
    SpecError
        If a plane wave is too steep, or has so many turns that it would take too many nodes.
    """
    tail = as_wave(swimmer.tail)
    numbers = (tail.number_of_waves, tail.amplitude * tail.wavenumber, tail.ramp)
    numbers = [np.max(x.real) if isinstance(x, np.ndarray) else x.real for x in numbers]
    kind = HELIX if tail.is_rigid else PLANE_WAVE
    on_ramp, rest = node_numbers(kind, *numbers)
    if kind == PLANE_WAVE and numbers[1] > STEEPEST:
        most = STEEPEST * tail.amplitude / numbers[1]
        allowed = f"{measured(most, 'tail.amplitude')} at most at this wavelength"
        raise SpecError("tail.amplitude", tail.amplitude, allowed)
    if on_ramp + rest > MOST_NODES:
        most = numbers[0] * MOST_NODES / (on_ramp + rest)
        raise SpecError("tail.waves", float(numbers[0]), f"{most:.4g} at most at this steepness")
    return panels(on_ramp), panels(rest) if nodes is None else gauss(nodes)


def gait(swimmer: Swimmer, *, nodes: int | None = None, phases: int | None = None) -> Gait:
    """Return the gait by resistive force theory.

    Parameters
    ----------
    swimmer
        Any swimmer; its numbers may be complex (`microswim.swimmer.fields.lifted`).
    nodes
        Gauss-Legendre nodes along the tail behind the ramp; by default enough for rounding, or
        the closed integrals of a helix.
    phases
        Phases over half a period of a tail that is not a rigid helix; enough by default.

    Returns
    -------
    Gait
        With ``model = "rft"``.

    Raises
    ------
    SpecError
        If the tail is so steep or has so many turns that it cannot be resolved, or interaction
        coefficients make a swimmer that gains power from the fluid.

    Notes
    -----
    A gait of ordinary size runs as Python, in about a millisecond and without a compiler; one with
    so many nodes and phases that this would take a tenth of a second runs compiled. Which of the
    two depends on the swimmer alone, never on earlier calls. Who computes gaits by the thousand one
    by one calls `microswim.warm_up` first: compiled, a gait takes less than a tenth of that.
    """
    checks.count("nodes", nodes)
    checks.count("phases", phases)
    physical_sense.require_drag(swimmer)
    made = unchecked(swimmer, nodes, phases)
    physical_sense.require_dissipation(swimmer, made)
    return made


def unchecked(swimmer: Swimmer, nodes: int | None = None, phases: int | None = None) -> Gait:
    """Return `gait` of any coefficients, for searches that pass through what no fluid would do."""
    body = body_resistance(swimmer)
    tail = swimmer.tail
    if tail.is_placed:
        series = sum_over_tails(swimmer, lambda alone: tail_series(alone, nodes, phases))
    else:
        series = tail_series(swimmer, nodes, phases)
    made = owned(
        Gait,
        resistance_series=add(series[0], body[None]),
        propulsion_series=series[1],
        activity_series=series[2],
        rate=tail.rate,
        free=swimmer.motion.mask,
        body_resistance_series=body[None],
        body_propulsion_series=None,
        model="rft",
        units=swimmer.units,
        info=_about(swimmer),
    )
    if swimmer.motion.frequency_frame == "lab":
        return made.in_lab_frame(tail.rate, tail.sign)
    return made


def tail_series(
    swimmer: Swimmer, nodes: int | None = None, phases: int | None = None
) -> tuple[np.ndarray, ...]:
    """Return series of ``B_t``, ``F_p``, G of one tail at the joint."""
    tail = swimmer.tail
    if tail.is_absent:
        return np.zeros((1, 6, 6)), np.zeros((1, 6)), np.zeros(1)
    if tail.is_rigid and tail.in_batches:
        p = parameters(swimmer)
        arc = swimmer.motion.line_element == "arc"
        R, F, G = _helix(arc, p, nodes, swimmer)
        return rotate(R, tail.sign), rotate(F, tail.sign), np.array([G])
    return series_over_period(lambda n: _samples(swimmer, nodes, n), phases)


def _helix(arc: bool, p: np.ndarray, nodes: int | None, swimmer: Swimmer) -> tuple[Any, ...]:
    tail: Any = swimmer.tail
    numbers = tail.number_of_waves, tail.amplitude * tail.wavenumber, tail.ramp
    waves, bk, ramp = (x.real for x in numbers)
    on_ramp = ramp_nodes(waves * ramp, bk, 12.0)
    if nodes is not None or waves < FEWEST_WAVES or on_ramp > MOST_ON_ONE_RULE:
        plain = rules(swimmer, nodes)
        much = pays(ALONE * sum(x.size for x, _ in plain))
        run = wave_tail.dispatcher if much else wave_tail.written
        return run(HELIX, arc, p, 0.0, *plain)
    return helix_tail(arc, p, 0.0, gauss(on_ramp))


def _about(swimmer: Swimmer) -> dict[str, Any]:
    around = [name for name in SURROUNDINGS if getattr(swimmer, name) is not None]
    heard = "its coefficients may, when they were calibrated there"
    boundaries = [f"the surrogate itself knows no {name}; {heard}" for name in around]
    turning = physical_sense.turning(swimmer) if around else ""
    boundaries += [remark(turning)] if turning else []
    held = {"one_pose": turning} if turning else {}
    remarks = [*swimmer.remarks_on_drag, *remarks_on(swimmer.tail), *boundaries]
    return {"remarks": remarks, **held}


def series_over_period(
    samples: Callable[[int], tuple[np.ndarray, ...]], phases: int | None
) -> tuple[np.ndarray, ...]:
    """Return series of ``B_t``, ``F_p``, G of a tail that deforms; doubled until they are resolved.

    ``samples(n)`` gives the three at 2 n phases; `phases` fixes n.
    """
    n = phases or 12
    while True:
        series = tuple(series_of(x) for x in samples(n))
        settled = all(
            np.abs(x[-4:]).max() <= 1e-11 * max(np.abs(x).max(), 1e-300) for x in series[:2]
        )
        if phases or settled or n >= MOST_PHASES:
            return tuple(trimmed(x) for x in series)
        n *= 2


def _samples(swimmer: Swimmer, nodes: int | None, n: int) -> tuple[np.ndarray, ...]:
    """Samples of ``B_t``, ``F_p``, G at 2 n phases.

    A plane wave half a period on is its mirror image in q, which saves half of them.
    """
    arc = swimmer.motion.line_element == "arc"
    phase = np.pi * np.arange(2 * n) / n
    if not swimmer.tail.in_batches:
        return _any_samples(swimmer, nodes, phase)
    p = parameters(swimmer)
    return with_mirror_image(*wave_phases(arc, p, phase[:n], *rules(swimmer, nodes)))


def with_mirror_image(R: np.ndarray, F: np.ndarray, G: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return ``B_t``, ``F_p``, G over the period of what mirrors itself in q after half of it."""
    mirrored = R * MIRROR_Q[:, None] * MIRROR_Q, F * MIRROR_Q, G
    return tuple(np.concatenate(pair) for pair in zip((R, F, G), mirrored))


def _any_samples(swimmer: Swimmer, nodes: int | None, phases: np.ndarray) -> tuple[np.ndarray, ...]:
    tail: Any = swimmer.tail
    edges, waves = tail.edges, float(np.real(tail.number_of_waves))
    along_s = []
    for a, b in zip(edges, edges[1:]):
        x, w = panels(nodes or int(24 + 24 * waves * (b - a)))
        along_s.append((a + (b - a) * x, (b - a) * w))
    x, w = (np.concatenate(part) for part in zip(*along_s))
    length = tail.apparent_length
    s, phase = length * x[None, :], phases[:, None]
    at = tail.centreline(s, phase)
    tip = tail.centreline(length + np.zeros((1, 1)), phase)
    normal = None if tail.section is None else ribbon.normals(tail.radial(s, phase), at[1])
    return centreline_sums(swimmer, at, length * w, tip, normal, _narrowing(tail, length * x))


def _narrowing(tail: Tail, s: np.ndarray) -> np.ndarray | None:
    """Half axes at nodes over those at the root, None where they are the same all along."""
    is_tapered = getattr(tail.own, "radius_end", None) is not None
    return np.asarray(tail.narrowing(s)) if is_tapered else None


def centreline_sums(
    swimmer: Swimmer,
    at: tuple[np.ndarray, ...],
    ds: np.ndarray,
    tip: tuple[np.ndarray, ...],
    normal: np.ndarray | None = None,
    narrowing: np.ndarray | None = None,
) -> tuple[np.ndarray, ...]:
    """Return ``B_t``, ``F_p``, G at m phases of a tail that is given by its centreline.

    Parameters
    ----------
    swimmer
        Whose law and interaction coefficients hold.
    at, tip
        Position, slope and velocity per unit phase rate from the joint, at n nodes (m, n, 3), and
        at the free end (m, 1, 3).
    ds
        Weights of the nodes along the tail, (n,).
    normal
        Unit normals of a ribbon's sections, (m, n, 3).
    narrowing
        Half axes at the nodes over those at the root, (n,), of a tapered tail.
    """
    tail, offset, (P, P_s, U) = swimmer.tail, swimmer.body.semi_axes3[0], at
    local = swimmer.coefficients.local(tail, swimmer.fluid.viscosity)
    c = tuple(f * x for f, x in zip(swimmer.interaction.tail, local))
    kind = np.result_type(P, offset, ds, *c)
    c = tuple(np.asarray(v, dtype=kind)[()] for v in c)
    ds = ds.astype(kind)
    end = swimmer.coefficients.end(tail, swimmer.fluid.viscosity)
    end = end * tail.narrowing(tail.apparent_length)
    drag = tuple(np.asarray(v, dtype=kind)[()] for v in (end, end, 0.0))
    arc = swimmer.motion.line_element == "arc"
    placed = P + offset * AXIS, P_s, U
    if normal is None and narrowing is None:
        along = _quadrature(placed, ds, arc, c, tail.spin)
    else:
        normal = np.zeros_like(P) if normal is None else normal
        thick = 1.0 if narrowing is None else narrowing
        own = drag_of_ribbon(swimmer.coefficients, tail, swimmer.fluid.viscosity, thick)
        x_t, x_n, x_r = swimmer.interaction.tail
        own = tuple(x * f for x, f in zip((x_t, x_n, x_n, x_r), own))
        along = ribbon.sums(placed, normal, ds, arc, own, tail.spin)
    point = np.ones(1, dtype=kind)
    ending = _quadrature((tip[0] + offset * AXIS, *tip[1:]), point, False, drag, 0.0)
    return tuple(a + b for a, b in zip(along, ending))


def _quadrature(at: Any, ds: np.ndarray, arc: bool, c: Any, spin: float) -> tuple[np.ndarray, ...]:
    """``B_t``, ``F_p``, G at each phase from position, slope and velocity at nodes, (m, n, 3)."""
    if not pays(TOGETHER * ds.size):
        beside = (np.moveaxis(v, 0, -1).astype(ds.dtype) for v in at)
        R, F, G = centreline_tail.written(*beside, ds, arc, c, spin)
        return np.moveaxis(R, -1, 0), np.moveaxis(F, -1, 0), G
    at = [np.ascontiguousarray(v, dtype=ds.dtype) for v in at]
    run = centreline_tail.dispatcher
    each = [run(*(v[j] for v in at), ds, arc, c, spin) for j in range(len(at[0]))]
    return tuple(np.array(part) for part in zip(*each))
