"""Fig. 6: maps of velocity and efficiency over amplitude 0.01 to 0.5 and 0.5 to 5 waves.

The paper does not say which equations its maps come from. Its helical velocity is met by the closed
form of Eq. (20) (no ramp), the tail's rate counted in the lab frame, and the constant pair; its
plane wave by Eqs. (14), (15) integrated over the apparent length with the constant pair. Those
readings are drawn; `readings` tabulates the others.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from microswim.models.rft.batch import evaluate
from microswim.output.plots.style import ORANGE, WIDE, letter, look, panels
from microswim.studies.paper.context import AMPLITUDE, WAVES, Context, swimmer
from microswim.swimmer.drag.coefficients import closed_form
from microswim.swimmer.fields import lifted
from microswim.swimmer.swimmer import Swimmer

TITLE = "Fig. 6. Maps of velocity and efficiency"
CAPTION = (
    "Forward speed and efficiency over amplitude and number of waves. The paper does not say from "
    "which equations: its helix is met by the closed form (20) without ramp, the tail's rate in "
    "the lab frame and the constant pair, its plane wave by Eqs. (14) and (15) along the apparent "
    "length. Those are drawn; the table lists the other readings."
)


def grid(context: Context) -> tuple[np.ndarray, np.ndarray]:
    """Return amplitudes and numbers of waves of the maps."""
    step = 2 if context.quick else 1
    return np.linspace(0.01, 0.5, 50)[::-step][::-1], np.linspace(0.5, 5.0, 91)[::step]


def closed(coefficients: str, b: Any, n: Any, frame: str = "lab") -> tuple[Any, Any]:
    """Return ``|u_s|`` and efficiency of a helix by force and torque balance of Eq. (20).

    With the tail's rate in the lab frame the force balance alone gives u_s; relative to the body,
    the torque balance ``T_t(u_s, omega + Omega) = 8 pi mu r_b^3 gamma Omega`` joins it.
    """
    who = lifted(swimmer("helix", coefficients), {AMPLITUDE: b, WAVES: n})
    tail = who.tail
    c_t, c_n = who.coefficients.pair(tail, who.fluid.viscosity)
    D = [g * d for g, d in zip(who.interaction.translation, who.body.diagonal(who.fluid.viscosity))]
    spin = who.interaction.rotation[0] * who.body.diagonal(who.fluid.viscosity)[3]
    # Both are linear: F = F_0 + F_u u_s, T = T_0 + T_u u_s at the unit rate 2 pi frequency.
    F0, T0 = closed_form(tail, c_n=c_n, c_t=c_t)
    F1, T1 = closed_form(tail, c_n=c_n, c_t=c_t, u_s=1.0)
    u = F0 / (D[0] - (F1 - F0))
    torque = T0 + (T1 - T0) * u
    # At a tail rate omega in the lab the body turns with Omega = T/spin; the motor with their
    # difference. Everything is linear in omega.
    motor = 1.0 if frame == "lab" else tail.rate / (tail.rate - torque / spin)
    u, torque = u * motor, torque * motor
    return np.abs(u), D[0] * u**2 / np.abs(torque * tail.rate)


def full(who: Swimmer, b: np.ndarray, n: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return ``|u_s|`` and efficiency of the model with all its free motions on the grid b x n.

    NaN where the law of the coefficients fails or the tail touches itself.
    """
    B, N = np.meshgrid(b, n, indexing="ij")
    result = evaluate(who, {AMPLITUDE: B.ravel(), WAVES: N.ravel()}, tolerance=1e-4)
    speed = np.abs(result["mean_velocity"][:, 0]).reshape(B.shape)
    return speed, result["efficiency"].reshape(B.shape)


def compute(context: Context) -> dict[str, Any]:
    """Return the four maps in the readings that meet the paper's velocities."""
    b, n = grid(context)
    helix = closed("constant", b[:, None], n[None, :])
    plane = full(swimmer("plane_wave", "constant"), b, n)
    return {
        "b": b, "n": n, "helix": helix, "plane_wave": plane, "readings": readings(context),
    }  # fmt: skip


def readings(context: Context) -> list[dict[str, Any]]:
    """Return the fastest and most efficient design of every reading, on a coarser grid."""
    b, n = np.linspace(0.02, 0.5, 13), np.linspace(0.5, 5.0, 46)
    rows = []
    for c in ("constant", "sbt"):
        for frame in ("lab", "body"):
            maps = closed(c, b[:, None], n[None, :], frame)
            rows.append(_row("helix", f"closed form (20), {frame} rate", c, b, n, maps))
            who = swimmer("helix", c, {"motion.frequency_frame": frame})
            rows.append(
                _row("helix", f"Eqs. (5), (14), ramp, {frame} rate", c, b, n, full(who, b, n))
            )
        for line in ("apparent", "arc"):
            who = swimmer("plane_wave", c, {"motion.line_element": line})
            rows.append(_row("plane_wave", f"Eqs. (5), (14), {line} ds", c, b, n, full(who, b, n)))
    return rows


def _row(tail: str, reading: str, c: str, b: Any, n: Any, maps: Any) -> dict[str, Any]:
    speed, efficiency = (np.where(np.isfinite(m), m, -1.0) for m in maps)
    i, j = np.unravel_index(np.argmax(speed), speed.shape)
    k, m = np.unravel_index(np.argmax(efficiency), efficiency.shape)
    return {
        "tail": tail, "reading": reading, "coefficients": c,
        "largest |u_s|": speed[i, j], "at b": b[i], "at N": n[j],
        "largest efficiency": efficiency[k, m], "eff. at b": b[k], "eff. at N": n[m],
    }  # fmt: skip


def optimum(context: Context, tail: str, quantity: str = "velocity", coefficients: str = "constant",
            frame: str = "lab") -> np.ndarray:  # fmt: skip
    """Return largest value of a map, its amplitude and number of waves, on a grid of 0.05 waves.

    Helix: closed form; plane wave: the model.
    """
    b, n = np.linspace(0.02, 0.5, 25), np.linspace(0.5, 5.0, 91)
    maps = context.once(
        ("map", tail, coefficients, frame),
        lambda: (
            closed(coefficients, b[:, None], n[None, :], frame)
            if tail == "helix"
            else full(swimmer(tail, coefficients), b, n)
        ),
    )
    values = maps[0 if quantity == "velocity" else 1]
    i, j = np.unravel_index(np.nanargmax(values), values.shape)
    return np.array([values[i, j], b[i], n[j]])


def speed_at(context: Context, tail: str, b: float, n: float) -> float:
    """Return ``|u_s|`` of the constant pair at one design, in the reading that is drawn."""
    if tail == "helix":
        return float(closed("constant", b, n)[0])
    return float(full(swimmer(tail, "constant"), np.array([b]), np.array([n]))[0][0, 0])


def height(context: Context, **which: Any) -> float:
    """Return the largest value of a map alone."""
    return float(optimum(context, **which)[0])


def place(context: Context, **which: Any) -> np.ndarray:
    """Return the amplitude and number of waves of the largest value."""
    return optimum(context, **which)[1:]


def plot(result: dict[str, Any]) -> Figure:
    """Return maps (a, b) of velocity and (c, d) of efficiency; a cross marks each optimum."""
    titles = {"helix": "rotating helix", "plane_wave": "travelling plane wave"}
    with look():
        figure, axes = panels(2, 2, (WIDE, 5.2), sharex=True, sharey=True)
        for j, (tail, title) in enumerate(titles.items()):
            for i, factor in enumerate((1.0, 100.0)):
                ax, values = axes[i, j], factor * result[tail][i]
                mesh = ax.pcolormesh(
                    result["n"],
                    result["b"],
                    values,
                    cmap="cividis",
                    shading="gouraud",
                    rasterized=True,
                )
                ax.contour(result["n"], result["b"], values, 8, colors="white", linewidths=0.4)
                _mark(ax, result, values, "%" if i else "")
                bar = figure.colorbar(mesh, ax=ax, pad=0.02)
                bar.set_label(
                    r"$|\overline{u}_s|$ (body diameters / period)" if i == 0 else r"$\eta$ (%)"
                )
                ax.set(xlim=(0.5, 5), ylim=(result["b"][0], 0.5))
                letter(ax, "abcd"[2 * i + j])
                if i == 0:
                    ax.set_title(title)
        for ax in axes[1]:
            ax.set_xlabel(r"number of waves, $N_\lambda$")
        for ax in axes[:, 0]:
            ax.set_ylabel("amplitude, $b$ / body diameter")
    return figure


def _mark(ax: Any, result: dict[str, Any], values: np.ndarray, unit: str) -> None:
    i, j = np.unravel_index(np.nanargmax(values), values.shape)
    n, b = result["n"][j], result["b"][i]
    ax.plot(n, b, marker="x", color=ORANGE, ms=7, mew=1.8, clip_on=False, zorder=5)
    ax.annotate(
        f"{values[i, j]:.3g}{unit} at b = {b:.2g}, N = {n:.3g}", (n, b), xytext=(8, -10),
        textcoords="offset points", color="black", fontsize=7,
        bbox={"fc": "white", "ec": "none", "alpha": 0.85, "pad": 1.5}, va="top",
    )  # fmt: skip


def flatness(context: Context) -> float:
    """Return the helical speed at (0.5, 1) over the largest of the map."""
    return speed_at(context, "helix", 0.5, 1.0) / height(context, tail="helix")


def ridge(context: Context, line: str = "arc", fewest: float = 1.0) -> float:
    """Return the largest efficiency (percent) of the plane wave with the constant pair for N >=
    `fewest`.
    """
    b, n = np.linspace(0.02, 0.5, 25), np.linspace(fewest, 5.0, 41)
    who = swimmer("plane_wave", "constant", {"motion.line_element": line})
    return float(100.0 * np.nanmax(full(who, b, n)[1]))


def efficiency(context: Context, **which: Any) -> float:
    """Return the largest efficiency of a map, percent."""
    return 100.0 * height(context, quantity="efficiency", **which)


def helix_leads(context: Context, quantity: str = "velocity") -> float:
    """Return the largest value of the helix over that of the plane wave, constant pair."""
    return height(context, tail="helix", quantity=quantity) / height(
        context, tail="plane_wave", quantity=quantity
    )
