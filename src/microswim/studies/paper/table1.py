"""Table 1: the base case, drawn to scale with both tails (the paper's Fig. 1), and what follows.

Also the base case by the reference: velocities, forces on the held and the free swimmer, and the
four ways in which the tail's surface may move.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from microswim import data
from microswim.gait.gait import Gait
from microswim.output.plots.style import BLUE, GREY, PALE, WIDE, letter, look, panels
from microswim.studies.paper.context import Context, observed, swimmer
from microswim.swimmer.drag.coefficients import Constant, closed_form
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.swimmer import Swimmer

TITLE = "Table 1. Base case"
CAPTION = (
    "The base case to scale with both tails (the paper's Fig. 1). Below: what follows from its "
    "numbers, and its velocities and forces by our reference, for the four ways in which the "
    "tail's surface may move."
)
MOTIONS = tuple((s, m) for s in ("perpendicular", "sheared") for m in ("rigid", "translating"))


def compute(context: Context) -> dict[str, Any]:
    """Return the table's rows with our values where they follow from others; the reference if
    wanted.
    """
    table = data.load("tabak-table-1")
    ours = derived(swimmer("helix", "constant"))
    rows = [
        {"parameter": str(p), "symbol": str(table.symbol.sel(parameter=p).item()),
         "paper": str(table.printed.sel(parameter=p).item()), "ours": ours.get(str(p), "as given")}
        for p in table.parameter.values
    ]  # fmt: skip
    out = {"rows": rows, "more": []}
    if context.circles:
        out["more"] = surface_motions(context)
    return out


def derived(who: Swimmer) -> dict[str, float]:
    """Return the Reynolds number and body resistances that follow from the other entries."""
    force, torque = who.body.diagonal(who.fluid.viscosity)[::3]
    reynolds = who.fluid.density * who.tail.frequency * 1.0 / who.fluid.viscosity
    return {
        "reynolds_number": reynolds,
        "body_translational_resistance": float(force),
        "body_rotational_resistance": float(torque),
    }


def resistances(context: Context) -> np.ndarray:
    """Return ``6 pi mu r_b`` and ``8 pi mu r_b^3``."""
    return np.array(swimmer("helix", "constant").body.diagonal(100.0))[[0, 3]]


def reynolds(context: Context) -> float:
    """Return the scaling Reynolds number."""
    return derived(swimmer("helix", "constant"))["reynolds_number"]


def velocity(context: Context, model: str = "bem", tail: str = "helix", coefficients: str =
             "constant") -> np.ndarray:  # fmt: skip
    """Return the base case: mean u_s, lateral amplitude, body rotation (rad per unit time)."""
    who = swimmer(tail, coefficients)
    return observed(_gait(context, who, model)) * np.array([1.0, 1.0, 2.0 * np.pi])


def component(context: Context, index: int, **which: Any) -> float:
    """Return one entry of `velocity`."""
    return float(velocity(context, **which)[index])


def _gait(context: Context, who: Swimmer, model: str) -> Gait:
    return context.reference(who) if model == "bem" else who.gait()


def surface_motions(context: Context) -> list[dict[str, Any]]:
    """Return base case by the reference for the four ways in which the tail's surface may move."""
    rows = []
    for sections, motion in MOTIONS:
        who = swimmer("helix", "constant").with_(
            {"tail.sections": sections, "tail.surface_motion": motion}
        )
        u, v, w = observed(context.reference(who))
        rows.append({"sections": sections, "surface motion": motion, "mean u_s": u,
                     "lateral amplitude": v, "mean Omega_s (rad)": 2.0 * np.pi * w})  # fmt: skip
    return rows


def spread(context: Context, quantity: str) -> np.ndarray:
    """Return values of one column of `surface_motions`."""
    return np.array([row[quantity] for row in surface_motions(context)])


def held(context: Context) -> np.ndarray:
    """Return axial force and torque by the fluid on the tail of the held swimmer (reference)."""
    gait = context.reference(swimmer("helix", "constant"))
    body = np.asarray(gait.body_propulsion_series)
    return -gait.rate * (gait.propulsion_series[0] - body[0])[[0, 3]]


def held_torque(context: Context) -> float:
    """Return the axial torque by the fluid on the tail of the held swimmer (reference)."""
    return float(held(context)[1])


def held_pair(context: Context) -> np.ndarray:
    """Return ``c_n, c_t`` that Eq. (20) gives for the reference's thrust and torque of the held
    tail.
    """
    tail = swimmer("helix", "constant").tail
    thrust, torque = held(context)
    pair = Constant.from_held_tail(tail, thrust, torque)
    return np.array([pair.normal, pair.tangential])


def implied_thrust(context: Context) -> float:
    """Return the thrust that the paper's pair implies through Eq. (20), over the reference's."""
    tail = swimmer("helix", "constant").tail
    return float(closed_form(tail, c_n=995.5, c_t=775.2)[0] / held(context)[0])


def round_trip(context: Context) -> np.ndarray:
    """Return the paper's pair through Eq. (20) to thrust and torque and back."""
    tail = swimmer("helix", "constant").tail
    pair = Constant.from_held_tail(tail, *closed_form(tail, c_n=995.5, c_t=775.2))
    return np.array([pair.normal, pair.tangential])


def body_force(context: Context) -> float:
    """Return the mean axial drag on the body of the free swimmer (reference)."""
    return float(body_forces(context)[0])


def body_forces(context: Context) -> np.ndarray:
    """Return `body_force` for the four ways in which the tail's surface may move."""
    out = []
    for sections, motion in MOTIONS:
        who = swimmer("helix", "constant").with_(
            {"tail.sections": sections, "tail.surface_motion": motion}
        )
        out.append(abs(context.reference(who).body_wrench(np.arange(8) * np.pi / 4)[:, 0].mean()))
    return np.array(out)


def body_lateral_force(context: Context) -> float:
    """Return the amplitude of the lateral force on the body of the free swimmer (reference)."""
    gait = context.reference(swimmer("helix", "constant"))
    return float(np.hypot(*gait.body_wrench(0.0)[1:3]))


def ripple(context: Context, index: int) -> float:
    """Return the variation of a velocity over the period, percent of its mean (reference)."""
    gait = context.reference(swimmer("helix", "constant"))
    V = gait.velocity(np.linspace(0.0, 2.0 * np.pi, 33))[:, index]
    return float(100.0 * np.ptp(V) / abs(V.mean()))


def waves_and_wavenumber(context: Context, which: str) -> float:
    """Return the number of waves or wavenumber of the base case."""
    tail = as_wave(swimmer("helix", "constant").tail)
    return float(tail.number_of_waves if which == "waves" else tail.wavenumber)


def seconds_of_a_rotation(context: Context) -> float:
    """Return the wall time of one rotation of the helix, 64 poses in the lab frame, after
    compilation.
    """
    from time import perf_counter

    from microswim.path.trajectory import trajectory

    gait = swimmer("helix", "sbt").gait()
    taken = []
    for _ in range(3):
        start = perf_counter()
        trajectory(swimmer("helix", "sbt").gait(), np.linspace(0.0, gait.period, 65))
        taken.append(perf_counter() - start)
    return min(taken)


def plot(result: dict[str, Any]) -> Figure:
    """Return both swimmers from the side, to scale."""
    with look():
        figure, axes = panels(1, 2, (WIDE, 1.6), sharey=True)
        for ax, tail, name in zip(axes[0], ("helix", "plane_wave"), "ab"):
            draw(ax, swimmer(tail, "constant"))
            letter(ax, name)
            ax.set_title("rotating helix" if tail == "helix" else "travelling plane wave")
            ax.set_xlabel("s / body diameter")
        axes[0, 0].set_ylabel("q / body diameter")
    return figure


def draw(ax: Any, who: Swimmer) -> None:
    """Draw a swimmer from the side: body, and the tail as thick as it is."""
    r_s = who.body.semi_axes3[0]
    tail = who.tail
    s = np.linspace(0.0, tail.apparent_length, 600)
    P, P_s, _ = tail.centreline(s, 0.0)
    slope = P_s[:, 1] / P_s[:, 0]
    across = np.stack([-slope, np.ones_like(slope)], -1) / np.sqrt(1 + slope**2)[:, None]
    edges = [P[:, :2] + side * tail.radius * across for side in (1, -1)]
    outline = np.concatenate([edges[0], edges[1][::-1]])
    ax.fill(*outline.T, facecolor=BLUE, edgecolor="none", alpha=0.85)
    ax.add_patch(Circle((-r_s, 0), r_s, facecolor=PALE, edgecolor=GREY, lw=0.8))
    ax.set(aspect="equal", xlim=(-2.2 * r_s, tail.apparent_length * 1.05), ylim=(-0.6, 0.6))
