"""What half a beat of many plane waves says, compiled: what `batch_numbers` does with arrays.

Half a period on, a plane wave is its mirror image in q: velocities that keep their sign have even
harmonics alone, those that change it odd ones, the least of which is the greatest turned over. So
m phases over half a period give m terms ``[cos h, sin h, ...]`` of each velocity, and what it does
there is all that it does.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from microswim.models.rft.batch_numbers import RESOLVED
from microswim.models.rft.segment import cosine_sine
from microswim.numerics.compiling.compiled import FAST, compiled, prange
from microswim.numerics.compiling.cores import loop
from microswim.numerics.series.extremes import FLAT, STEPS
from microswim.numerics.series.fourier import MIRROR_Q

BLOCK = 64  #: designs that share scratch
DENSE = 8  #: samples of the shortest wave among which a greatest value is looked for
FELT = 1e-6  #: a term against the largest that may say which sample is the greatest
STILL = 1e-10  #: a step of Newton's method whose square is nothing


class Tables(NamedTuple):
    """Matrices of m phases over half a period; their rows belong to what they take.

    terms
        From samples to terms, (2, m, m): of even and of odd harmonics.
    samples
        From terms to dense samples of half the period, (2, m, s).
    turned
        From samples of a rate of rotation to the angle at the phases, (m, m).
    """

    terms: np.ndarray
    samples: np.ndarray
    turned: np.ndarray


@lru_cache(8)
def _tables(m: int) -> Tables:
    phase, dense = np.pi * np.arange(m) / m, DENSE * m // 2
    even, odd = np.arange(0, m, 2), np.arange(1, m, 2)
    share = np.full((2, m), 2.0 / m)
    share[0, :2] /= 2.0  # the mean
    terms = np.stack([_pairs(h, phase).T for h in (even, odd)]) * share[:, None]
    samples = np.stack([_pairs(h, np.pi * np.arange(dense) / dense) for h in (even, odd)])
    back = _pairs(odd, phase) / odd.repeat(2)[:, None]
    angle = np.empty_like(back)  # of cos comes sin / h, of sin comes - cos / h
    angle[0::2], angle[1::2] = back[1::2], -back[0::2]
    return Tables(terms, samples, terms[1] @ angle)


def _pairs(h: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Cosine and sine of each harmonic in turn, (2 len(h), phases)."""
    turn = h[:, None] * phase
    return np.stack([np.cos(turn), np.sin(turn)], axis=1).reshape(-1, phase.size)


def half_beats(V: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return what twists (n, m, 6) at m phases over half a period, per unit rate, say.

    Returns
    -------
    tuple
        Whether the beat is resolved (n,); where it is, mean and half of peak to peak of each
        velocity (n, 6), and the mean speed ahead, as the swimmer turns to and fro (n,).
    """
    moves = V.any(axis=(0, 1))
    odd = MIRROR_Q < 0.0
    beats = _half_beats.over(len(V) * V.shape[1])  # a phase costs as much as a helix
    return beats(np.ascontiguousarray(V), moves, odd, *_tables(V.shape[1]))


@compiled(fastmath=FAST)
def _around(terms: Any, first: int, x: Any) -> Any:
    """Return value, slope and curvature at a phase; terms of harmonics first, first + 2, ..."""
    c2, s2 = np.cos(2.0 * x), np.sin(2.0 * x)
    c, s = (np.cos(x), np.sin(x)) if first else (1.0, 0.0)
    value, slope, curvature, h = 0.0, 0.0, 0.0, float(first)
    for k in range(0, len(terms), 2):
        term, other = terms[k] * c + terms[k + 1] * s, terms[k + 1] * c - terms[k] * s
        value += term
        slope += h * other
        curvature -= h * h * term
        c, s = c * c2 - s * s2, s * c2 + c * s2
        h += 2.0
    return value, slope, curvature


@compiled(fastmath=FAST)
def _polished(terms: Any, first: int, x: Any, flat: Any, sense: Any) -> Any:
    """Return the greatest value (the least where sense is -1) near the phase x."""
    best = -np.inf
    for _ in range(STEPS + 1):
        value, slope, curvature = _around(terms, first, x)
        best = max(best, sense * value)
        if abs(curvature) <= flat or abs(slope) <= STILL * abs(curvature):
            break
        x -= slope / curvature
    return sense * best


@compiled(fastmath=FAST)
def _half_range(terms: Any, first: int, rows: Any, values: Any, largest: Any) -> Any:
    """Return half of peak to peak from the terms; `values` is scratch for samples."""
    values[:] = 0.0
    for k in range(len(terms)):
        if abs(terms[k]) > FELT * largest:
            for j in range(len(values)):
                values[j] += rows[k, j] * terms[k]
    apart, flat = np.pi / len(values), FLAT * largest
    high, low = np.argmax(values), np.argmin(values)
    if first:
        at, sense = (high, 1.0) if values[high] > -values[low] else (low, -1.0)
        return sense * _polished(terms, 1, at * apart, flat, sense)
    top = _polished(terms, 0, high * apart, flat, 1.0)
    return (top - _polished(terms, 0, low * apart, flat, -1.0)) / 2.0


@compiled(fastmath=FAST)
def _fill_terms(terms: Any, V: Any, moves: Any, odd: Any, to_terms: Any) -> Any:
    """Fill in the terms (6, m) of twists (m, 6); returns whether the last harmonics are nothing."""
    m = len(V)
    largest, last = np.zeros(2), np.zeros(2)  # of velocities and of rates
    for i in range(6):
        terms[i] = 0.0
        if moves[i]:
            first = 1 if odd[i] else 0
            for k in range(m):
                for j in range(m):
                    terms[i, j] += to_terms[first, k, j] * V[k, i]
            largest[i // 3] = max(largest[i // 3], np.abs(terms[i]).max())
            ending = terms[i, m - 2 - 2 * first :]  # of the last three harmonics
            last[i // 3] = max(last[i // 3], np.abs(ending).max())
    return last[0] <= RESOLVED * largest[0] and last[1] <= RESOLVED * largest[1]


@compiled(fastmath=FAST)
def _ahead(V: Any, heading: Any, turned: Any) -> Any:
    """Return the mean of velocities (m, 6) along where the swimmer sets out; `heading` is
    scratch.
    """
    m, total = len(V), 0.0
    heading[:] = 0.0
    for k in range(m):
        for j in range(m):
            heading[j] += turned[k, j] * V[k, 5]
    for j in range(m):
        c, s = cosine_sine(heading[j])
        total += c * V[j, 0] - s * V[j, 1]
    return total / m


@loop(fastmath=FAST)
def _half_beats(V: Any, moves: Any, odd: Any, to_terms: Any, to_samples: Any, turned: Any) -> Any:
    n, m, _ = V.shape
    fine, mean, amplitude = np.empty(n, dtype=np.bool_), np.zeros((n, 6)), np.zeros((n, 6))
    speed = np.zeros(n)
    for block in prange((n + BLOCK - 1) // BLOCK):
        terms, heading, values = np.empty((6, m)), np.empty(m), np.empty(to_samples.shape[2])
        for d in range(block * BLOCK, min(n, (block + 1) * BLOCK)):
            known = np.isfinite(V[d].sum())  # a design that is not answered is NaN
            fine[d] = known and _fill_terms(terms, V[d], moves, odd, to_terms)
            if not fine[d]:
                continue
            speed[d] = abs(_ahead(V[d], heading, turned))
            for i in range(6):
                largest = np.abs(terms[i]).max()
                if largest > 0.0:
                    first = 1 if odd[i] else 0
                    mean[d, i] = 0.0 if first else terms[i, 0]
                    rows = to_samples[first]
                    amplitude[d, i] = _half_range(terms[i], first, rows, values, largest)
    return fine, mean, amplitude, speed
