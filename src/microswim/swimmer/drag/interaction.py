"""Hydrodynamic interaction: coefficients on the resistance of body and tail.

[Tabak Eqs. 4, 21, 22]. All formulas accept arrays and complex numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from microswim import checks
from microswim.errors import SpecError

Triple = tuple[float, float, float]
_ROW: Triple = (0.0, 0.0, 0.0)
_ZERO = (_ROW, _ROW, _ROW)


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class Interaction:
    """Interaction coefficients; all one (no interaction) by default.

    Parameters
    ----------
    translation
        ``gamma_N`` along s, q, r: factors on the body's isolated drag [Tabak Eq. 21] (the
        ``Gamma_N`` of Eq. 18 is the first).
    rotation
        ``gamma_R`` about s, q, r [Tabak Eq. 22], (``Gamma_R`` of Eq. 19 is the first). Negative
        values are allowed, as the paper has them, but have no physical meaning by themselves.
    coupling
        Body block E of Eq. (3) in units of ``sqrt(D_N,i D_R,j)`` with the isolated resistances;
        row: direction of the force, column: of the rotation.
    tail
        Factors on the tail's own ``(c_t, c_n, c_r)``, positive.

    Raises
    ------
    SpecError
        If an entry is not a finite number or a tail factor is not positive.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.Interaction(translation=(2.24, 1.25, 1.25), rotation=(1.09, 1, 1)).translation[0]
    2.24
    """

    translation: Triple = (1.0, 1.0, 1.0)
    rotation: Triple = (1.0, 1.0, 1.0)
    coupling: tuple[Triple, Triple, Triple] = _ZERO
    tail: Triple = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        for name in ("translation", "rotation"):
            checks.numbers(f"interaction.{name}", getattr(self, name), 3, "three finite numbers")
            object.__setattr__(self, name, tuple(getattr(self, name)))
        checks.numbers(
            "interaction.tail", self.tail, 3, "three positive factors on c_t, c_n, c_r", above=0.0
        )
        object.__setattr__(self, "tail", tuple(self.tail))
        rows = self.coupling
        if not isinstance(rows, (tuple, list, np.ndarray)) or len(rows) != 3:
            raise SpecError("interaction.coupling", rows, "a 3 x 3 table of numbers")
        for i, row in enumerate(rows):
            checks.numbers(f"interaction.coupling[{i}]", row, 3, "three finite numbers")
        object.__setattr__(self, "coupling", tuple(tuple(row) for row in rows))

    def coupled(self, isolated: np.ndarray) -> np.ndarray:
        """Return the body resistance from a full isolated one: ``sqrt(g_i g_j) R_ij``.

        For bodies whose isolated resistance about the centre is not diagonal; negative factors
        count as zero there.

        Parameters
        ----------
        isolated
            Shape (6, 6).
        """
        diagonal = tuple(np.diagonal(isolated))
        gamma = np.array([*self.translation, *self.rotation])
        root = np.sqrt(np.where(np.real(gamma) > 0.0, gamma, 0.0))
        rest = isolated - np.diag(diagonal)
        return self.body_resistance(diagonal) + np.multiply.outer(root, root) * rest

    @cached_property
    def resists(self) -> bool:
        """Whether no entry can take a drag away: no factor below zero, and no coupling."""
        factors = (*self.translation, *self.rotation)
        return not self.is_coupled and all(np.min(np.real(x)) >= 0.0 for x in factors)

    @property
    def is_coupled(self) -> bool:
        """Whether the body's rotation and translation are coupled."""
        return self.coupling != _ZERO

    def scaled(self, isolated: tuple[Any, ...]) -> list[Any]:
        """Return the six isolated resistances times their coefficients [Tabak Eqs. 21, 22]."""
        return [g * d for g, d in zip((*self.translation, *self.rotation), isolated)]

    def body_resistance(self, isolated: tuple[Any, ...]) -> np.ndarray:
        """Return the body resistance ``B_b`` about its centre [Tabak Eqs. 3, 21, 22].

        Parameters
        ----------
        isolated
            Six isolated resistances (numbers or arrays of one shape).

        Returns
        -------
        ndarray
            Shape (..., 6, 6), symmetric.
        """
        scaled = self.scaled(isolated)
        if not self.is_coupled and np.ndarray not in map(type, scaled):
            values = np.array(scaled)
            B = np.zeros(36, dtype=values.dtype)
            B[::7] = values
            return B.reshape(6, 6)
        diagonal = np.stack(np.broadcast_arrays(*scaled), axis=-1)
        B = diagonal[..., None] * np.eye(6)
        if not self.is_coupled:
            return B
        E = np.array([[self.coupling[i][j] for j in range(3)] for i in range(3)])
        root = np.sqrt(np.stack(np.broadcast_arrays(*isolated), axis=-1))
        B = B + np.zeros((), dtype=E.dtype)
        B[..., :3, 3:] = E * root[..., :3, None] * root[..., None, 3:]
        B[..., 3:, :3] = np.swapaxes(B[..., :3, 3:], -1, -2)
        return B
