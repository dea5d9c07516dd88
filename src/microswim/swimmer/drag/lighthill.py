r"""Lighthill's integrals A_1 and A_2 [Tabak Eqs. 9, 25-28], fast and to rounding.

.. math:: A_{1,2}(\alpha, \varepsilon) = \ln\varepsilon + \int_\varepsilon^\infty
          \frac{\{\theta\sin\theta,\ \sin^2\theta\}}
               {[\alpha^2\theta^2 + 2(1-\alpha^2)(1-\cos\theta)]^{3/2}}\, d\theta

The integrand is ``1/theta`` at the origin plus a smooth odd part, so the integral splits into
``A(alpha, 0)``, a function of alpha alone, kept as a Chebyshev series in ``ln alpha`` that is made
at first use (some 70 ms), and a smooth integral over ``[0, epsilon]`` by Gauss-Legendre.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.compiling.compiled import compiled

ALPHA_RANGE = (0.02, 1.0)
EPSILON_RANGE = (0.0, 4.0)


def _integrands(alpha: np.ndarray, n: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both integrands at ``theta = 2 pi n + x`` (sine and cosine of x alone, exact for large n)."""
    theta = 2.0 * np.pi * n + x
    sine = np.sin(x)
    phi = ((alpha * theta) ** 2 + (1 - alpha**2) * 4.0 * np.sin(x / 2) ** 2) ** 1.5  # Eq. (25)
    return theta * sine / phi, sine**2 / phi


def _limit_integrals(alpha: np.ndarray, periods: int = 200, nodes: int = 60) -> np.ndarray:
    """``A_{1,2}(alpha, 0)``, shape (2, len(alpha)).

    Half a period by Gauss-Legendre; whole periods about ``2 pi n`` with ``x = w sinh u``,
    ``w = 2 pi n alpha``, which resolves the near-singularity of small alpha; the rest of the
    periods by the midpoint Euler-Maclaurin formula, whose integral over n is closed.
    """
    xi, weight = np.polynomial.legendre.leggauss(nodes)
    a = alpha[:, None, None]
    half = np.pi * (xi + 1.0) / 2.0
    first = np.stack(_integrands(a[..., 0], np.zeros(1), half)) - 1.0 / half
    total = first @ (weight * np.pi / 2.0) + np.log(np.pi)

    n = np.arange(1, periods + 1)[:, None]
    w = 2.0 * np.pi * n * a
    span = np.arcsinh(np.pi / w)
    x = w * np.sinh(span * xi)
    jacobian = w * np.cosh(span * xi) * span * weight
    total = total + (np.stack(_integrands(a, n, x)) * jacobian).sum(axis=(-1, -2))
    return total + _tail(a[..., 0], periods + 0.5, np.pi * xi) @ (weight * np.pi)


def _tail(a: np.ndarray, nu: float, x: np.ndarray) -> np.ndarray:
    """Integrand in x of the sum over all periods beyond `nu`: integral + first derivative / 24."""
    theta, sine = 2.0 * np.pi * nu + x, np.sin(x)
    D = (1 - a**2) * 4.0 * np.sin(x / 2) ** 2
    r = np.sqrt((a * theta) ** 2 + D)
    closed = np.stack([sine / (a**2 * r), sine**2 / (a * r * (r + a * theta))]) / (2.0 * np.pi)
    slope = np.stack(
        [sine * (r**-3 - 3 * (a * theta) ** 2 * r**-5), sine**2 * -3 * a**2 * theta * r**-5]
    )
    return closed + slope * 2.0 * np.pi / 24.0


@cache
def _table(degree: int = 48) -> np.ndarray:
    """Chebyshev coefficients of ``A_{1,2}(alpha, 0)`` in ``ln alpha``, and Gauss nodes."""
    lo = np.log(ALPHA_RANGE[0])
    y = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
    values = _limit_integrals(np.exp(lo * (1.0 - y) / 2.0))
    return np.ascontiguousarray(np.polynomial.chebyshev.chebfit(y, values.T, degree - 1).T)


_GAUSS = np.polynomial.legendre.leggauss(14)
#: Up to this epsilon, as far as the law means something, the nearest singularity, five away or
#: more, is so far that fewer nodes give the same digits.
THIN, _FEW = 0.5, np.polynomial.legendre.leggauss(6)


@compiled()
def _at(a: Any, e: Any, table: Any, xi: Any, weight: Any) -> Any:
    """``(A_1, A_2)`` at one point: the series by Clenshaw's rule, less the part below epsilon."""
    y = 1.0 - 2.0 * np.log(a) / np.log(ALPHA_RANGE[0])
    b1, b2, c1, c2 = 0.0 * a, 0.0 * a, 0.0 * a, 0.0 * a
    for m in range(table.shape[1] - 1, 0, -1):
        b1, b2 = table[0, m] + 2.0 * y * b1 - b2, b1
        c1, c2 = table[1, m] + 2.0 * y * c1 - c2, c1
    A1, A2 = table[0, 0] + y * b1 - b2, table[1, 0] + y * c1 - c2
    for g in range(xi.size):
        theta = (e + (e == 0)) * (xi[g] + 1.0) / 2.0  # at 0 the weight is nought
        sine, half = np.sin(theta), np.sin(theta / 2.0)
        square = (a * theta) ** 2 + (1.0 - a * a) * 4.0 * half * half
        phi = square * np.sqrt(square)
        dw = e * weight[g] / 2.0
        A1 -= (theta * sine / phi - 1.0 / theta) * dw
        A2 -= (sine * sine / phi - 1.0 / theta) * dw
    return A1, A2


def lighthill_integrals(alpha: Any, epsilon: Any) -> tuple[Any, Any]:
    """Return Lighthill's periodic integrals ``A_1`` and ``A_2`` [Tabak Eqs. 25-28].

    Parameters
    ----------
    alpha
        Apparent over actual length, 0.02 to 1 (array, real or complex).
    epsilon
        ``5.2 r_t alpha / lambda``, 0 to 4 (broadcast against alpha). At 0 the integrals have
        a finite limit: the logarithm cancels.

    Returns
    -------
    tuple
        ``(A_1, A_2)`` of the broadcast shape, to about 1e-13; NaN where an array leaves the range.

    Raises
    ------
    SpecError
        For single numbers outside the stated range.

    Examples
    --------
    >>> A1, A2 = lighthill_integrals(1.0, 0.1)
    >>> round(float(A1), 6)
    0.423617
    """
    if not (isinstance(alpha, np.ndarray) or isinstance(epsilon, np.ndarray)):
        for name, x, (lo, hi) in (
            ("alpha", alpha, ALPHA_RANGE),
            ("epsilon", epsilon, EPSILON_RANGE),
        ):
            if not lo <= x.real <= hi:
                raise SpecError(name, x.real, f"from {lo} to {hi} for Lighthill's integrals")
        if isinstance(alpha, complex) or isinstance(epsilon, complex):
            alpha, epsilon = complex(alpha), complex(epsilon)
        return _at(alpha, epsilon, _table(), *(_FEW if epsilon.real <= THIN else _GAUSS))
    alpha, epsilon = np.broadcast_arrays(alpha, epsilon)
    kind = np.result_type(alpha, epsilon, np.float64)
    flat = [np.ascontiguousarray(x, dtype=kind).reshape(-1) for x in (alpha, epsilon)]
    A = np.empty((2, alpha.size), dtype=kind)
    thin = np.real(flat[1]) <= THIN
    for rows, rule in ((thin, _FEW), (~thin, _GAUSS)):
        if rows.any():
            A[:, rows] = _at.written(*(x[rows] for x in flat), _table(), *rule)
    for x, (lo, hi) in zip(flat, (ALPHA_RANGE, EPSILON_RANGE)):
        A[:, ~((np.real(x) >= lo) & (np.real(x) <= hi))] = np.nan
    return A[0].reshape(alpha.shape), A[1].reshape(alpha.shape)
