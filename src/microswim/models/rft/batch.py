"""Many designs at once: the surrogate over arrays of numbers of the spec, on all cores.

A rigid helix on a body of revolution looks the same at each phase but for a rotation, so one phase
tells all; a plane wave is sampled over half a period, the other half being its mirror image.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from microswim.errors import MicroswimError, SpecError
from microswim.gait.quantities import summary
from microswim.models.rft.gait import body_resistance, parameters
from microswim.models.rft.helix import FEWEST_WAVES, MOST_NODES, helix_tail, ramp_nodes
from microswim.models.rft.plane_wave import in_a_row
from microswim.models.rft.segment import HELIX, PLANE_WAVE, node_numbers, wave_tail
from microswim.numerics.compiled import Kernel
from microswim.numerics.fourier import MIRROR_Q
from microswim.numerics.quadrature import gauss
from microswim.numerics.solve6 import solve
from microswim.swimmer.swimmer import Swimmer

CHUNK = 8192
PHASES = 16  #: over half a period of a plane wave
OUTPUTS = (
    "mean_velocity",
    "velocity_amplitude",
    "swimming_speed",
    "mean_power",
    "mean_torque",
    "efficiency",
)


def evaluate(swimmer: Swimmer, values: dict[str, Any], tolerance: float = 1e-8) -> dict[str, Any]:
    """Surrogate results for n designs that differ in some numbers of the spec.

    Parameters
    ----------
    swimmer
        What the designs have in common.
    values
        Dotted names of numbers of the spec to arrays of shape (n,).
    tolerance
        Relative accuracy of the quadrature, 1e-12 to 1e-3.

    Returns
    -------
    dict
        ``mean_velocity`` (n, 6), ``velocity_amplitude`` (n, 6), ``swimming_speed``,
        ``mean_power``, ``mean_torque``, ``efficiency`` (n,), as `summary` has them; NaN where a
        design is out of range, touches itself or is beyond the law of its coefficients.

    Examples
    --------
    >>> import numpy as np, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> result = ms.evaluate(swimmer, {"tail.amplitude": np.linspace(0.05, 0.15, 5)})
    >>> result["mean_velocity"].shape
    (5, 6)
    """
    arrays = {k: np.asarray(v, dtype=float).reshape(-1) for k, v in values.items()}
    n = max((a.size for a in arrays.values()), default=1)
    swimmer = _alternatives(swimmer, arrays)
    results = [
        _chunk(swimmer, {k: v[i : i + CHUNK] for k, v in arrays.items()}, tolerance)
        for i in range(0, n, CHUNK)
    ]
    return {name: np.concatenate([r[name] for r in results]) for name in OUTPUTS}


def expected_errors(swimmer: Swimmer, values: dict[str, Any]) -> np.ndarray:
    """Expected relative error of the mean forward velocity (n,) of a calibrated surrogate.

    NaN outside its region. It costs more than the evaluation itself, so searches do without.
    """
    assert swimmer.region is not None
    arrays = {k: np.asarray(v, dtype=float).reshape(-1) for k, v in values.items()}
    many = _alternatives(swimmer, arrays).lifted(arrays)
    return swimmer.region.expected_of_many(many, max(a.size for a in arrays.values()))


def _alternatives(swimmer: Swimmer, arrays: dict[str, Any]) -> Swimmer:
    """Swimmer that has the one of `waves` and `wavelength` that varies."""
    for one in ("tail.waves", "tail.wavelength"):
        if one in arrays and one not in swimmer.numbers:
            swimmer = swimmer.with_({one: float(np.ravel(arrays[one])[0])})
    return swimmer


def _chunk(swimmer: Swimmer, arrays: dict[str, Any], tolerance: float) -> dict[str, Any]:
    n = max((a.size for a in arrays.values()), default=1)
    if not is_regular(swimmer, arrays):
        return _one_by_one(swimmer, arrays, n)
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        many = swimmer.lifted(arrays)
        own = parameters if swimmer.region is None else swimmer.region.parameters
        p = np.ascontiguousarray(np.broadcast_to(own(many), (n, 11)))
        body = np.ascontiguousarray(np.broadcast_to(body_resistance(many), (n, 6, 6)))
        good = _buildable(many, p, body)
        rate = np.broadcast_to(many.tail.rate, (n,))
    if swimmer.region is not None:
        if not good.all():
            many = swimmer.lifted({k: v[good] if v.size > 1 else v for k, v in arrays.items()})
        return _calibrated(swimmer, many, good, rate)
    if swimmer.tail.kind == "helix":
        return _helix(swimmer, *_solved_helices(swimmer, p, body, good, tolerance), body, rate)
    return _plane_wave(swimmer, *_solved_waves(swimmer, p, body, good, tolerance), body, rate)


def _solved_helices(
    swimmer: Swimmer, p: Any, body: Any, good: Any, tolerance: float
) -> tuple[Any, Any]:
    """Twists (n, 1, 6) and tail powers (n, 1) of helices at phase 0."""
    arc, free = swimmer.motion.line_element == "arc", np.array(swimmer.motion.mask)
    waves, digits = p[:, 0] * p[:, 2] / (2.0 * np.pi), -np.log10(tolerance)
    counts = _ramp_counts(waves, p[:, 1] * p[:, 2], p[:, 3], digits, good)
    V, power = _loops(helix_tail, 1).solve_helices(arc, p, body, free, counts)
    for i in np.flatnonzero(good & (counts < 0)):
        rules = node_numbers(HELIX, waves[i], p[i, 1] * p[i, 2], p[i, 3])
        R, F, G = wave_tail(HELIX, arc, p[i], 0.0, *map(gauss, rules))
        V[i] = -F
        solve(R + body[i], V[i], free)
        power[i] = G + F @ V[i]
    return V[:, None], power[:, None]


def _loops(kernel: Kernel, calls: int) -> Any:
    """The module whose loops serve: compiled ones, once this kernel has been called often."""
    if kernel.due(calls):
        from microswim.models.rft import loops_compiled as loops
    else:
        from microswim.models.rft import loops_python as loops
    return loops


def _ramp_counts(waves: Any, bk: Any, ramp: Any, digits: float, good: Any) -> np.ndarray:
    """Nodes on the ramp; negative for designs that are not good or not for closed integrals."""
    needed = ramp_nodes.written(waves * ramp, bk, digits)
    good = good & (waves >= FEWEST_WAVES) & (needed <= MOST_NODES)
    return np.where(good, needed, -1).astype(np.int64)


def _solved_waves(
    swimmer: Swimmer, p: Any, body: Any, good: Any, tolerance: float
) -> tuple[Any, Any]:
    """Twists (n, m, 6) and tail powers (n, m) of plane waves over half a period."""
    phase = np.pi * np.arange(PHASES) / PHASES
    V = np.full((len(p), PHASES, 6), np.nan)
    power = np.full((len(p), PHASES), np.nan)
    arc, free = swimmer.motion.line_element == "arc", np.array(swimmer.motion.mask)
    loops = _loops(in_a_row, 1 + len(p) // 256)
    for rules, group in _groups(p, good, tolerance):
        V[group], power[group] = loops.solve_waves(arc, p[group], body[group], phase, free, *rules)
    return V, power


def _calibrated(swimmer: Swimmer, many: Swimmer, good: Any, rate: Any) -> dict[str, Any]:
    """Results of a surrogate that carries a region calibration; `many` are the good designs."""
    assert swimmer.region is not None
    n, helix = len(good), swimmer.tail.kind == "helix"
    V = np.full((n, 1 if helix else PHASES, 6), np.nan)
    power, work = np.full(V.shape[:2], np.nan), np.full(V.shape[:2], np.nan)
    if good.any():
        free = np.array(swimmer.motion.mask)
        V[good], power[good], work[good] = swimmer.region.solve(many, free, PHASES)
    none = np.zeros((n, 6, 6))
    out = (_helix if helix else _plane_wave)(swimmer, V, power, none, rate)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = work.mean(axis=1) / power.mean(axis=1)
    return out | {"efficiency": np.where(power.mean(axis=1) != 0, share, 0.0)}


def is_regular(swimmer: Swimmer, arrays: dict[str, Any]) -> bool:
    """Whether the symmetries hold on which the batched evaluation rests."""
    if swimmer.tail.kind == "custom" or np.any(np.ravel(swimmer.interaction.coupling)):
        return False
    if any("coupling" in name for name in arrays):
        return False
    if swimmer.tail.kind == "plane_wave":
        return True
    gamma, free = swimmer.interaction, swimmer.motion.mask
    varied = any("[1]" in k or "[2]" in k for k in arrays)
    round_body = swimmer.body.is_axisymmetric and not (varied and swimmer.body.shape == "ellipsoid")
    alike = gamma.translation[1] == gamma.translation[2] and gamma.rotation[1] == gamma.rotation[2]
    sided = any(k.startswith("interaction.") and varied for k in arrays)
    return round_body and alike and not sided and free[1] == free[2] and free[4] == free[5]


def _buildable(many: Swimmer, p: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Designs that make sense; the others stay NaN."""
    tail, numbers = many.tail, many.numbers
    good = np.isfinite(p).all(axis=1) & np.isfinite(body).all(axis=(1, 2))
    good &= (p[:, 0] > 0) & (p[:, 1] >= 0) & (p[:, 2] > 0) & (p[:, 5] > 0) & (p[:, 6] > 0)
    good &= (np.asarray(tail.radius) > 0) & (tail.radius < tail.room())
    good &= (p[:, 3] >= 0) & (p[:, 3] <= 1) & (np.asarray(many.fluid.viscosity) > 0)
    for name, value in numbers.items():
        if name.startswith(("body.", "interaction.tail")):
            good &= np.asarray(value) > 0
    return good


def _groups(p: np.ndarray, good: np.ndarray, tolerance: float) -> Any:
    """Quadrature rules with the designs that need them."""
    digits = -np.log10(tolerance) / 12.0
    waves, bk = p[:, 0] * p[:, 2] / (2.0 * np.pi), p[:, 1] * p[:, 2]
    need = np.stack(node_numbers.written(PLANE_WAVE, waves, bk, p[:, 3]), axis=-1)
    need = np.where(good[:, None], need, 0.0).astype(np.int64)
    need = np.where(need > 0, np.ceil(6 + (need - 6) * digits).astype(np.int64), 0)
    rung = np.where(need > 64, 64, 8)  # few distinct rules: making one takes longer than a design
    need = rung * -(-need // rung)
    keys = need[:, 0] << 32 | need[:, 1]
    for key in np.unique(keys[good]):
        group = np.flatnonzero(good & (keys == key))
        yield (gauss(int(key >> 32)), gauss(int(key & 0xFFFFFFFF))), group


def _helix(swimmer: Swimmer, V: Any, power: Any, body: Any, rate: Any) -> dict[str, Any]:
    """Results of rigid helices from phase 0: the lateral parts turn with the tail.

    In the frame of the tail the twist is constant, so the axis of the screw motion is along
    ``W + sign rate e_s`` and the swimming speed ``U . (W + sign rate e_s) / |W + sign rate e_s|``.
    """
    V, power = V[:, 0], power[:, 0]
    sign = swimmer.tail.sign
    if swimmer.motion.frequency_frame == "lab":
        rate = rate / (1.0 + sign * V[:, 3])
    W = V * rate[:, None]
    mean, amplitude = np.zeros_like(W), np.zeros_like(W)
    mean[:, ::3] = W[:, ::3]
    for i in (1, 4):
        amplitude[:, i] = amplitude[:, i + 1] = np.hypot(W[:, i], W[:, i + 1])
    mean[np.isnan(W[:, 0])] = amplitude[np.isnan(W[:, 0])] = np.nan
    spin = W[:, 3:].copy()
    spin[:, 0] += sign * rate
    size = np.linalg.norm(spin, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        speed = np.abs(np.sum(W[:, :3] * spin, axis=1)) / size
    total = power * rate**2
    work = np.einsum("nj,nj,n->n", body[:, 0], W, W[:, 0])
    return _results(mean, amplitude, speed, total, work, rate)


def _plane_wave(swimmer: Swimmer, V: Any, power: Any, body: Any, rate: Any) -> dict[str, Any]:
    """Results of plane waves from half a period, the other half mirrored in q.

    The motion is planar: heading ``int W_r dt``, displacement ``int R(heading) U dt``.
    """
    W = np.concatenate([V, V * MIRROR_Q], axis=1) * rate[:, None, None]
    m = W.shape[1]
    mean = W.mean(axis=1)
    amplitude = _half_peak_to_peak(W)
    h = np.fft.rfftfreq(m, 1.0 / m)
    hat = np.fft.rfft(W[:, :, 5], axis=1)
    hat[:, 1:] /= 1j * h[1:]
    hat[:, 0] = 0.0
    with np.errstate(invalid="ignore", divide="ignore"):
        heading = np.fft.irfft(hat, m, axis=1) / rate[:, None]
    c, s = np.cos(heading), np.sin(heading)
    ahead, aside = c * W[..., 0] - s * W[..., 1], s * W[..., 0] + c * W[..., 1]
    speed = np.hypot(ahead.mean(axis=1), aside.mean(axis=1))
    total = power.mean(axis=1) * rate**2
    work = np.einsum("nj,nmj,nm->n", body[:, 0], W, W[..., 0]) / m
    return _results(mean, amplitude, speed, total, work, rate)


def _half_peak_to_peak(W: np.ndarray, finer: int = 8) -> np.ndarray:
    """Half of peak to peak over the period, by zero-padded interpolation and a parabola."""
    m = W.shape[1]
    hat = np.fft.rfft(W, axis=1)
    fine = np.fft.irfft(hat, m * finer, axis=1) * finer
    tops = []
    for sense in (1.0, -1.0):
        at = np.argmax(sense * fine, axis=1)[:, None]
        a, b, c = (
            np.take_along_axis(fine, (at + i) % (m * finer), axis=1)[:, 0] for i in (-1, 0, 1)
        )
        bend = a - 2.0 * b + c
        flat = np.abs(bend) < 1e-300
        tops.append(b - np.where(flat, 0.0, (a - c) ** 2 / (8.0 * np.where(flat, 1.0, bend))))
    return (tops[0] - tops[1]) / 2.0


def _results(mean: Any, amplitude: Any, speed: Any, power: Any, work: Any, rate: Any) -> dict:
    with np.errstate(invalid="ignore", divide="ignore"):
        torque = np.where(rate != 0, power / rate, 0.0 * power)
        efficiency = np.where(power != 0, work / power, 0.0)
    results = (mean, amplitude, speed, power, torque, np.where(np.isnan(power), np.nan, efficiency))
    return dict(zip(OUTPUTS, results))


def _one_by_one(swimmer: Swimmer, arrays: dict[str, Any], n: int) -> dict[str, Any]:
    """Designs without the symmetries: each by its own gait."""
    out = {name: np.full((n, 6) if "velocity" in name else n, np.nan) for name in OUTPUTS}
    for i in range(n):
        try:
            values = {k: float(v[i if v.size > 1 else 0]) for k, v in arrays.items()}
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                made = summary(swimmer.with_(values).gait())
        except (SpecError, MicroswimError):
            continue
        for name in OUTPUTS:
            out[name][i] = made[name]
    return out
