"""The 6x6 solve for a twist, compiled: one, or several side by side.

Analytic, so that complex-step derivatives run through it.
"""

from __future__ import annotations

from typing import Any

from microswim.numerics.compiling.compiled import compiled


@compiled()
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


@compiled(always=True, error_model="numpy")
def solve_lanes(A: Any, V: Any, free: Any, W: Any) -> None:
    """Apply `solve` to as many systems as the last axis of A (6, 6, n) and V (6, n) is long.

    The same steps; the inner loops run over the systems, which the processor takes several at
    once. W (2, n) is scratch.
    """
    n = V.shape[1]
    for i in range(6):
        if not free[i]:
            for l in range(n):
                V[i, l] = 0.0
                for j in range(6):
                    A[i, j, l] = 0.0
                    A[j, i, l] = 0.0
                A[i, i, l] = 1.0
    for j in range(6):
        for l in range(n):
            W[0, l] = 1.0 / A[j, j, l]
        for i in range(j + 1, 6):
            for l in range(n):
                W[1, l] = A[i, j, l] * W[0, l]
            for m in range(j + 1, i + 1):
                for l in range(n):
                    A[i, m, l] -= W[1, l] * A[m, j, l]
            for l in range(n):
                V[i, l] -= W[1, l] * V[j, l]
                A[j, i, l] = W[1, l]
        for l in range(n):
            V[j, l] *= W[0, l]
    for j in range(4, -1, -1):
        for i in range(j + 1, 6):
            for l in range(n):
                V[j, l] -= A[j, i, l] * V[i, l]
