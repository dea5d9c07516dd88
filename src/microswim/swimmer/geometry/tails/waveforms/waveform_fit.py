"""From points on a filmed filament to modes of its beat: least squares that keep the arc length.

The tangent angle is linear in the modes, positions are its integral: a first guess from the angles
of the pieces between points, then Gauss-Newton on the positions themselves. How many modes and
harmonics the film supports is found by cross-validation over frames.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from microswim import checks
from microswim.errors import SpecError
from microswim.swimmer.geometry.tails.waveforms.waveform import Beat, Waveform
from microswim.swimmer.geometry.tails.waveforms.waveform_tail import harmonics, tangent_angle

MOST_MODES, MOST_HARMONICS = 8, 4
FOLDS = 8
NODES = 16
RIDGE = 1e-6  #: on the modes, relative to the largest entry of the normal equations
CHUNK = 4000
FEWEST_FRAMES = 8
LEAST_BEATS = 0.75
FAR = 3.0  #: lengths from the base, beyond which a point is wrong


def fit(
    beat: Beat,
    length: float | None = None,
    frequency: float | None = None,
    modes: int | None = None,
    harmonics: int | None = None,
) -> Waveform:
    """Return the beat of a filament by least squares.

    Parameters
    ----------
    beat
        The points.
    length
        Of the filament; the largest arc length by default.
    frequency
        Beats per time; found by default.
    modes, harmonics
        Legendre modes along s and harmonics in time; found by default.

    Raises
    ------
    SpecError
        If there are too few frames or points, or less than three quarters of a beat.
    """
    L = float(np.max(beat.s)) if length is None else length
    frames = beat.frames
    per_frame = beat.s.size / frames.size
    most = min(MOST_MODES, int(per_frame / 2)) if modes is None else modes
    high = min(MOST_HARMONICS, (frames.size - 1) // 6) if harmonics is None else harmonics
    if frames.size < FEWEST_FRAMES or most < 1 or per_frame < most + 1 or high < 1:
        raise SpecError(
            f"tail.file: {frames.size} frames of {per_frame:.0f} points; a beat needs at least "
            f"{FEWEST_FRAMES} frames with six points along the filament"
        )
    _check_sizes(beat, L)
    if frames.size <= 2 * high + 1:
        raise SpecError("tail.harmonics", high, f"{(frames.size - 2) // 2} at most")
    found = _frequency(beat, L, most) if frequency is None else frequency
    T = float(frames[-1] - frames[0])
    if T * abs(found) < LEAST_BEATS:
        raise SpecError(
            f"tail.file: {T * abs(found):.2g} beats at {found:.4g} per time; give tail.frequency, "
            "or film at least three quarters of a beat"
        )
    for _ in range(2):
        start = _gauss_newton(beat, L, found, _first(beat, L, found, most, high), 3)
        M, H = _chosen(beat, L, found, start, modes, harmonics)
        c = _gauss_newton(beat, L, found, start[:, :M, : 1 + 2 * H], 4)
        moved, error = (0.0, 0.0) if frequency else _shift(beat, L, found, c)
        found += moved
        if abs(moved) < 0.01 / T:
            break
    c = _gauss_newton(beat, L, found, _first(beat, L, found, M, H) if moved else c, 5)
    off = _model(beat, L, found, c)[0] - beat.filmed
    count = max(off.size - c.size, 1)
    return Waveform(
        modes=c[0],
        modes_out=c[1] if beat.in_space else None,
        length=L,
        frequency=float(found),
        frequency_error=float(error),
        misfit=float(np.sqrt(np.mean(off**2))),
        noise=float(np.sqrt(np.sum(off**2) / count)),
        fitted=beat.filmed + off,
        beat=beat,
    )


def _check_sizes(beat: Beat, L: float) -> None:
    """Refuse numbers that are wrong by far, one of which would rule all others."""
    span = checks.nearly_empty(beat.frames)
    if span:
        raise SpecError(
            f"tail.file: {beat.frames.size} frames in {span:.3g} frames' time; is a time wrong?"
        )
    far = 0.0 if beat.position is None else float(np.abs(beat.position).max()) / L
    if far > FAR:
        raise SpecError(f"tail.file: a point {far:.3g} lengths from the base; is a number wrong?")


def pieces(beat: Beat) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return time, arc length, tangent angles (n, 1), or (n, 2) in space, and weight of the pieces
    between points of a frame.
    """
    if beat.angle is not None:
        return beat.time, beat.s, beat.angle[:, None], np.ones_like(beat.s)
    assert beat.position is not None
    order = np.lexsort((beat.s, beat.time))
    t, s, x = beat.time[order], beat.s[order], beat.position[order]
    same = (np.diff(t) == 0) & (np.diff(s) > 0)
    step, ds = np.diff(x, axis=0)[same], np.diff(s)[same]
    raw = np.arctan2(step[:, 1], step[:, 0])
    first = np.concatenate([[True], np.diff(t[1:][same]) != 0])
    angle = raw.copy()
    for i in range(1, raw.size):
        if not first[i]:
            angle[i] = angle[i - 1] + (raw[i] - angle[i - 1] + np.pi) % (2 * np.pi) - np.pi
    both = [angle]
    if beat.in_space:
        both.append(np.arctan2(step[:, 2], np.hypot(step[:, 0], step[:, 1])))
    return t[1:][same], (s[1:] + s[:-1])[same] / 2.0, np.stack(both, axis=-1), ds / ds.max()


def _basis(L: float, s: np.ndarray, phase: np.ndarray, M: int, H: int) -> np.ndarray:
    """``P_m(s) F_k(phase)``, shape s + (M (1 + 2 H),)."""
    P = legendre.legvander(2.0 * s / L - 1.0, M - 1)
    both = P[..., :, None] * harmonics(phase, 1 + 2 * H)[..., None, :]
    return both.reshape(*both.shape[:-2], -1)


def _first(beat: Beat, L: float, f: float, M: int, H: int) -> np.ndarray:
    """Modes of each angle from those of the pieces, linear least squares."""
    t, s, angles, weight = pieces(beat)
    B = _basis(L, s, 2.0 * np.pi * f * t, M, H) * weight[:, None]
    c = np.linalg.solve(_with_ridge(B.T @ B, 1, M, H), B.T @ (weight[:, None] * angles))
    return c.T.reshape(-1, M, 1 + 2 * H)


def _with_ridge(gram: np.ndarray, angles: int, M: int, H: int) -> np.ndarray:
    """Normal equations that hold back high modes and harmonics where the film says nothing."""
    order = np.arange(M)[:, None] ** 2 + ((np.arange(1 + 2 * H) + 1) // 2)[None, :] ** 2
    ridge = np.tile(0.1 + order.ravel(), angles)
    return gram + RIDGE * gram.diagonal().max() * np.diag(ridge)


def _frequency(beat: Beat, L: float, M: int) -> float:
    """Frequency whose mean, cosine and sine explain the angles best."""
    t, s, angles, weight = pieces(beat)
    frames, which = np.unique(t, return_inverse=True)
    P = legendre.legvander(2.0 * s / L - 1.0, min(M, 4) - 1) * weight[:, None]
    A = np.zeros((frames.size, P.shape[1] * angles.shape[1]))
    for j in range(frames.size):
        here = which == j
        A[j] = np.linalg.lstsq(P[here], (weight[:, None] * angles)[here], rcond=1e-3)[0].ravel()
    T, dt = float(frames[-1] - frames[0]), float(np.median(np.diff(frames)))

    def left(f: float) -> float:
        B = harmonics(2.0 * np.pi * f * frames, 3)
        return float(np.sum((A - B @ np.linalg.lstsq(B, A, rcond=None)[0]) ** 2))

    tried = np.arange(LEAST_BEATS / T, 0.5 / dt, 0.05 / T)
    if tried.size < 3:
        raise SpecError("tail.file: too few frames for a frequency; give tail.frequency")
    best = tried[int(np.argmin([left(f) for f in tried]))]
    from scipy.optimize import minimize_scalar  # nobody waits for it without a film

    fine = minimize_scalar(left, bounds=(best - 0.05 / T, best + 0.05 / T), method="bounded")
    return float(getattr(fine, "x", best))


def _model(
    beat: Beat, L: float, f: float, c: np.ndarray, part: slice = slice(None)
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the modes say of the data (n, d), its derivatives by modes and by frequency."""
    s, t = beat.s[part], beat.time[part]
    phase, M, H = 2.0 * np.pi * f * t, c.shape[1], c.shape[2] // 2
    if beat.angle is not None:
        B = _basis(L, s, phase, M, H)
        turning = _by_phase(L, s, phase, c[0])[:, None] * t[:, None]
        return (B @ c.ravel())[:, None], B[:, None, :], turning
    xi, w = np.polynomial.legendre.leggauss(NODES)
    inner, later = s[:, None] * (xi + 1.0) / 2.0, np.broadcast_to(phase[:, None], (s.size, NODES))
    tangent, across = _tangent([tangent_angle(one, L, inner, later) for one in c])
    half, basis = s[:, None] / 2.0 * w, _basis(L, inner, later, M, H)
    x = np.einsum("ndq,nq->nd", tangent, half)
    J = np.concatenate([(one * half[:, None, :]) @ basis for one in across], axis=-1)
    by_f = sum(
        np.einsum("ndq,nq->nd", one, half * _by_phase(L, inner, later, modes))
        for one, modes in zip(across, c)
    )
    return x, J, by_f * t[:, None]


def _tangent(angles: list[np.ndarray]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Tangent (n, d, q) and its derivatives by each of the angles: in a plane, or in space."""
    c, d = np.cos(angles[0]), np.sin(angles[0])
    if len(angles) == 1:
        return np.stack([c, d], axis=1), [np.stack([-d, c], axis=1)]
    flat, up = np.cos(angles[1]), np.sin(angles[1])
    return np.stack([flat * c, flat * d, up], axis=1), [
        np.stack([-flat * d, flat * c, 0.0 * up], axis=1),
        np.stack([-up * c, -up * d, flat], axis=1),
    ]


def _by_phase(L: float, s: np.ndarray, phase: np.ndarray, c: np.ndarray) -> np.ndarray:
    """``2 pi d psi / d phase``."""
    h = (np.arange(c.shape[1]) + 1) // 2
    turned = np.zeros_like(c)
    turned[:, 1::2], turned[:, 2::2] = c[:, 2::2] * h[2::2], -c[:, 1::2] * h[1::2]
    return 2.0 * np.pi * tangent_angle(turned, L, s, phase)


def _normal(
    beat: Beat, L: float, f: float, c: np.ndarray, part: np.ndarray | slice
) -> tuple[np.ndarray, np.ndarray, float]:
    """Gram matrix of modes, right side for the linearised model, sum of squares."""
    index = np.arange(beat.s.size)[part]
    n = c.size
    gram, right, total = np.zeros((n, n)), np.zeros(n), 0.0
    for low in range(0, index.size, CHUNK):
        some: np.ndarray = index[low : low + CHUNK]
        x, J, _ = _model(beat, L, f, c, some)  # type: ignore[arg-type]
        J = J.reshape(-1, n)
        y = (beat.filmed[some] - x).ravel() + J @ c.ravel()
        gram += J.T @ J
        right += J.T @ y
        total += float(y @ y)
    return gram, right, total


def _gauss_newton(beat: Beat, L: float, f: float, c: np.ndarray, steps: int) -> np.ndarray:
    angles, M, H = c.shape[0], c.shape[1], c.shape[2] // 2
    for _ in range(steps if beat.angle is None else 1):
        gram, right, _total = _normal(beat, L, f, c, slice(None))
        c = np.linalg.solve(_with_ridge(gram, angles, M, H), right).reshape(c.shape)
    return c


def _chosen(
    beat: Beat, L: float, f: float, c: np.ndarray, modes: int | None, high: int | None
) -> tuple[int, int]:
    """Numbers of modes and harmonics that foretell frames left out best, the smaller if alike."""
    angles, M, K = c.shape
    fold = np.unique(beat.time, return_inverse=True)[1] % FOLDS
    parts = [_normal(beat, L, f, c, fold == k) for k in range(FOLDS)]
    gram = sum(p[0] for p in parts)
    right = sum(p[1] for p in parts)
    tried = {}
    for m in range(1, M + 1) if modes is None else [M]:
        for h in range(1, K // 2 + 1) if high is None else [K // 2]:
            keep = np.zeros((angles, M, K), dtype=bool)
            keep[:, :m, : 1 + 2 * h] = True
            i = np.flatnonzero(keep.ravel())
            errors = []
            for g, r, total in parts:
                rest = _with_ridge((gram - g)[np.ix_(i, i)], angles, m, h)
                x = np.linalg.solve(rest, (right - r)[i])
                errors.append(total - 2.0 * x @ r[i] + x @ g[np.ix_(i, i)] @ x)
            tried[m, h] = np.array(errors)
    best = min(tried, key=lambda k: float(tried[k].sum()))
    alike = {
        k: v for k, v in tried.items()
        if np.sum(v - tried[best]) <= np.std(v - tried[best]) * np.sqrt(FOLDS)
    }  # fmt: skip
    return min(alike, key=lambda k: k[0] * (1 + 2 * k[1]))


def _shift(beat: Beat, L: float, f: float, c: np.ndarray) -> tuple[float, float]:
    """Change of the frequency that the data ask for, and its standard uncertainty."""
    x, J, by_f = _model(beat, L, f, c)
    J, d = J.reshape(-1, c.size), by_f.ravel()
    off = (beat.filmed - x).ravel()
    clean = d - J @ np.linalg.lstsq(J, d, rcond=1e-9)[0]
    stiff = float(clean @ clean)
    if stiff <= 1e-12 * float(d @ d):
        return 0.0, np.inf
    moved = float(clean @ off) / stiff
    left = float(np.sum((off - moved * clean) ** 2)) / max(off.size - c.size - 1, 1)
    return moved, float(np.sqrt(left / stiff))
