"""The atlas in use: a gait by corrected resistive force theory, and the error to expect.

    R, F_p = decode(y; R_0, F_0),    y = scale * (mean + sum_i k(z, z_i) alpha_i)

R_0, F_0 from `region.body_flow`, y the corrections of `region.positive_definite` (without a body
both are those of `alone`), k the kernel of
`region.kriging`, scale the product of powers of the design's numbers that takes the known growth of
a correction (a lateral force grows with b) off it. All of it is analytic: complex steps pass.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas import side_by_side as python
from microswim.calibration.atlas.near import Misses
from microswim.calibration.region.surfaces import Surfaces
from microswim.numerics.compiling.compiled import pays
from microswim.swimmer.parts import replaced
from microswim.swimmer.swimmer import Swimmer

#: By the kind of design (`coordinates.kind_of`).
FILES = {n: f"{n}.npz" for n in ("helix", "plane_wave", "helix_alone", "plane_wave_alone")}
SOME = 64  #: designs side by side: more would not fit the processor's memory
EACH = 4e-4  #: seconds of a design as Python


@dataclass(frozen=True, eq=False)
class Atlas:
    """Corrections over the design space, and what they and the surrogate miss.

    Parameters
    ----------
    surfaces
        Gaussian processes of the corrections, over the same designs.
    centre, spread
        Of the coordinates, (f,).
    exponents
        Powers of each correction's scale (corrections, 6).
    misses
        Of the atlas: relative error of u_s and Omega_s, error of the lateral amplitudes over
        ``b rate`` and ``rate``.
    plain
        Law of local resistance to the same of the surrogate as it comes.
    about
        Reference, level, number of solves, range, version.
    """

    surfaces: Surfaces
    centre: np.ndarray
    spread: np.ndarray
    exponents: np.ndarray
    misses: Misses
    plain: dict[str, Misses]
    about: dict[str, Any] = field(default_factory=dict)

    def place(self, swimmer: Swimmer, x: Any = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return numbers (6, ...), scaled coordinates (..., f) and waves of a design; x its
        numbers, where they are known.
        """
        x = coordinates.numbers(swimmer) if x is None else x
        features = coordinates.features(x, coordinates.kind_of(swimmer))
        z = (features.T - self.centre) / self.spread
        return x, z, x[2]

    def matrices(self, swimmer: Swimmer, x: Any = None) -> tuple[np.ndarray, ...]:
        """Return R (n, m, 6, 6), F_p (n, m, 6), G (n, m) and the body's share (n, 3).

        Of one design, n = 1, or of arrays of designs (`microswim.swimmer.fields.lifted`), x (6,
        ...) their numbers where they are known. A helix at phase 0, a plane wave at m phases of the
        period. Many run compiled; few, and complex ones, as Python.
        """
        one = _bare(swimmer)
        x, z, waves = self.place(one, x)
        Z, N = np.atleast_2d(z), np.atleast_1d(waves)
        size = np.exp(self.exponents @ coordinates.powers(x))
        known = not (np.iscomplexobj(size) or swimmer.body.is_absent)
        if known and pays(EACH * len(Z)):
            from microswim.calibration.region import evaluate as compiled  # loads Numba

            return compiled.matrices(one, Z, N, self.surfaces, np.atleast_2d(size.T))
        parts = [slice(i, i + SOME) for i in range(0, len(Z), SOME)]
        y = np.concatenate([python.predicted(self.surfaces, Z[p], N[p]) for p in parts], axis=1)
        return python.rebuilt(one, y.reshape(size.shape) * size)


def _bare(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer with the exact drag of its body: there is no other truth."""
    body = swimmer.body.exact
    return swimmer if body is swimmer.body else replaced(swimmer, "body", body)


@cache
def shipped(kind: str = "helix") -> Atlas | None:
    """Return the atlas of a kind of design that comes along, None where there is none."""
    from microswim.calibration.atlas.text import unpack

    if kind not in FILES:
        return None
    path = files("microswim.calibration.atlas").joinpath(FILES[kind])
    return unpack(path.read_bytes()) if path.is_file() else None


def of(swimmer: Swimmer) -> Atlas | None:
    """Return the shipped atlas of the swimmer's kind of design, None where there is none."""
    return shipped(coordinates.kind_of(swimmer))
