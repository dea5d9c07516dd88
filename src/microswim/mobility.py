"""The 6x6 solve for a twist, compiled. Depends on numba.

Analytic, so that complex-step derivatives run through it.
"""

from __future__ import annotations

from typing import Any

from numba import njit


@njit(cache=True)
def solve(A: Any, V: Any, free: Any) -> None:
    """Overwrite V with ``A^-1 V`` over the free degrees of freedom, zero on the others; A is lost.

    LDL' without pivoting (A is positive definite for any physical swimmer), no conjugates; reads
    the lower triangle of A.
    """
    for i in range(6):
        if not free[i]:
            for j in range(6):
                A[i, j] = 0.0
                A[j, i] = 0.0
            A[i, i] = 1.0
            V[i] = 0.0
    for j in range(6):
        inverse = 1.0 / A[j, j]
        for i in range(j + 1, 6):
            ratio = A[i, j] * inverse
            for m in range(j + 1, i + 1):
                A[i, m] -= ratio * A[m, j]
            V[i] -= ratio * V[j]
            A[j, i] = ratio
        V[j] *= inverse
    for j in range(4, -1, -1):
        for i in range(j + 1, 6):
            V[j] -= A[j, i] * V[i]
