r"""Lighthill's integrals A_1 and A_2 [Tabak Eqs. 9, 25-28], fast and to rounding.

.. math:: A_{1,2}(\alpha, \varepsilon) = \ln\varepsilon + \int_\varepsilon^\infty
          \frac{\{\theta\sin\theta,\ \sin^2\theta\}}
               {[\alpha^2\theta^2 + 2(1-\alpha^2)(1-\cos\theta)]^{3/2}}\, d\theta

The integrand is ``1/theta`` at the origin plus a smooth odd part, so the integral splits into
``A(alpha, 0)``, a function of alpha alone, kept as a Chebyshev series in ``ln alpha`` that is made
at first use (some 70 ms), and a smooth integral over ``[0, epsilon]``: a power series for thin
filaments, Gauss-Legendre for thick ones.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from microswim.errors import SpecError
from microswim.numerics.compiling.compiled import FAST, compiled, pays

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
def _table(degree: int = 49) -> np.ndarray:
    """Chebyshev coefficients of ``A_{1,2}(alpha, 0)`` in ``ln alpha``, and Gauss nodes."""
    lo = np.log(ALPHA_RANGE[0])
    y = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
    values = _limit_integrals(np.exp(lo * (1.0 - y) / 2.0))
    return np.ascontiguousarray(np.polynomial.chebyshev.chebfit(y, values.T, degree - 1).T)


@cache
def _near(terms: int = 7) -> np.ndarray:
    r"""Coefficients (2, terms, terms + 1) of the integrals from 0 to epsilon, the logarithm apart.

    Entry n - 1, j stands before ``epsilon^2n beta^j`` with ``beta = 1 - alpha^2``, from the series

    .. math:: \frac{\theta\sin\theta}{\varphi} = \frac1\theta\,\frac{\sin\theta}{\theta}
              (1 - \beta q)^{-3/2},\qquad q = 1 - \frac{2(1-\cos\theta)}{\theta^2}

    and with the square of ``sin theta/theta`` in the second integrand.
    """
    k = np.arange(terms + 1)
    factorials = np.cumprod(np.concatenate([[1.0], np.arange(1, 2 * terms + 3)]))
    signs = (-1.0) ** k
    sinc, q = signs / factorials[2 * k + 1], -2.0 * signs / factorials[2 * k + 2]
    q[0] = 0.0
    power, binomial = np.eye(1, terms + 1)[0], 1.0
    out = np.empty((2, terms, terms + 1))
    for j in range(terms + 1):
        for i, other in enumerate((sinc, np.convolve(sinc, sinc)[: terms + 1])):
            out[i, :, j] = binomial * np.convolve(other, power)[1 : terms + 1] / (2.0 * k[1:])
        power, binomial = np.convolve(power, q)[: terms + 1], binomial * (1.5 + j) / (1.0 + j)
    return out


#: Up to this epsilon, as far as the law means something, the series of the part below epsilon is
#: exact to rounding: its nearest singularity lies five away or more.
THIN = 0.5
LANES = 16  #: arguments that are taken side by side
_GAUSS = np.polynomial.legendre.leggauss(14)


@compiled()
def _from_zero(a: Any, table: Any) -> Any:
    """Return ``A_{1,2}(alpha, 0)`` by Clenshaw's rule."""
    y2 = 2.0 - 4.0 * np.log(a) / np.log(ALPHA_RANGE[0])
    b1, b2, c1, c2 = 0.0 * a, 0.0 * a, 0.0 * a, 0.0 * a
    for m in range(table.shape[1] - 1, 0, -1):
        b1, b2 = table[0, m] + y2 * b1 - b2, b1
        c1, c2 = table[1, m] + y2 * c1 - c2, c1
    return table[0, 0] + 0.5 * y2 * b1 - b2, table[1, 0] + 0.5 * y2 * c1 - c2


@compiled()
def _thin(a: Any, e: Any, table: Any, near: Any) -> Any:
    """Return ``(A_1, A_2)`` of a thin filament: less the series of the part below epsilon."""
    A1, A2 = _from_zero(a, table)
    e2, beta = e * e, 1.0 - a * a
    below1, below2 = 0.0 * e2, 0.0 * e2
    for n in range(near.shape[1] - 1, -1, -1):
        p1, p2 = 0.0 * beta, 0.0 * beta
        for j in range(n + 1, -1, -1):
            p1, p2 = p1 * beta + near[0, n, j], p2 * beta + near[1, n, j]
        below1, below2 = (below1 + p1) * e2, (below2 + p2) * e2
    return A1 - below1, A2 - below2


@compiled()
def _thick(a: Any, e: Any, table: Any, xi: Any, weight: Any) -> Any:
    """Return ``(A_1, A_2)``: less the part below epsilon by quadrature."""
    A1, A2 = _from_zero(a, table)
    for g in range(xi.size):
        theta = e * (xi[g] + 1.0) / 2.0
        sine, half = np.sin(theta), np.sin(theta / 2.0)
        square = (a * theta) ** 2 + (1.0 - a * a) * 4.0 * half * half
        phi = square * np.sqrt(square)
        dw = e * weight[g] / 2.0
        A1 -= (theta * sine / phi - 1.0 / theta) * dw
        A2 -= (sine * sine / phi - 1.0 / theta) * dw
    return A1, A2


@compiled(always=True, fastmath=FAST, error_model="numpy")
def _thin_lanes(a: Any, e: Any, table: Any, near: Any) -> Any:
    """Return what `_thin` does for arrays, several at once: the inner loops are over lanes.

    Two terms of Clenshaw's rule at a time: the table has an odd number of columns.
    """
    A = np.empty((2, a.size))
    b, p, below = np.empty((4, LANES)), np.empty((2, LANES)), np.empty((2, LANES))
    y2, beta, e2 = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    for first in range(0, a.size, LANES):
        for l in range(LANES):
            i = min(first + l, a.size - 1)
            y2[l] = 2.0 - 4.0 * np.log(a[i]) / np.log(ALPHA_RANGE[0])
            beta[l], e2[l] = 1.0 - a[i] * a[i], e[i] * e[i]
            b[0, l], b[1, l], b[2, l], b[3, l] = 0.0, 0.0, 0.0, 0.0
            below[0, l], below[1, l] = 0.0, 0.0
        for m in range(table.shape[1] - 1, 0, -2):
            for l in range(LANES):
                b1 = table[0, m] - b[1, l] + y2[l] * b[0, l]
                c1 = table[1, m] - b[3, l] + y2[l] * b[2, l]
                b[0, l], b[1, l] = table[0, m - 1] - b[0, l] + y2[l] * b1, b1
                b[2, l], b[3, l] = table[1, m - 1] - b[2, l] + y2[l] * c1, c1
        for n in range(near.shape[1] - 1, -1, -1):
            for l in range(LANES):
                p[0, l], p[1, l] = near[0, n, n + 1], near[1, n, n + 1]
            for j in range(n, -1, -1):
                for l in range(LANES):
                    p[0, l] = near[0, n, j] + p[0, l] * beta[l]
                    p[1, l] = near[1, n, j] + p[1, l] * beta[l]
            for l in range(LANES):
                below[0, l] = (below[0, l] + p[0, l]) * e2[l]
                below[1, l] = (below[1, l] + p[1, l]) * e2[l]
        for l in range(min(LANES, a.size - first)):
            for i in range(2):
                own = table[i, 0] + 0.5 * y2[l] * b[2 * i, l] - b[2 * i + 1, l]
                A[i, first + l] = own - below[i, l]
    return A


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
                said = float(f"{x.real:.6g}")  # mostly what a spec works out to, not what it says
                raise SpecError(name, said, f"from {lo} to {hi} for Lighthill's integrals")
        if isinstance(alpha, complex) or isinstance(epsilon, complex):
            alpha, epsilon = complex(alpha), complex(epsilon)
        if epsilon.real <= THIN:
            return _thin(alpha, epsilon, _table(), _near())
        return _thick(alpha, epsilon, _table(), *_GAUSS)
    alpha, epsilon = np.broadcast_arrays(alpha, epsilon)
    kind = np.result_type(alpha, epsilon, np.float64)
    flat = [np.ascontiguousarray(x, dtype=kind).reshape(-1) for x in (alpha, epsilon)]
    A = np.empty((2, alpha.size), dtype=kind)
    thin = np.real(flat[1]) <= THIN
    together = _thin_lanes if kind == np.float64 and pays(0.0) else _thin.written
    A[:, thin] = together(*(x[thin] for x in flat), _table(), _near())
    if not thin.all():
        A[:, ~thin] = _thick.written(*(x[~thin] for x in flat), _table(), *_GAUSS)
    for x, (lo, hi) in zip(flat, (ALPHA_RANGE, EPSILON_RANGE)):
        A[:, ~((np.real(x) >= lo) & (np.real(x) <= hi))] = np.nan
    return A[0].reshape(alpha.shape), A[1].reshape(alpha.shape)
