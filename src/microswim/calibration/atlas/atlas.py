"""The atlas in use: a gait by corrected resistive force theory, and the error to expect.

    R, F_p = decode(y; R_0, F_0),    y = scale * (mean + sum_i k(z, z_i) alpha_i)

R_0, F_0 from `region.body_flow`, y the corrections of `region.positive_definite`, k the kernel of
`region.matern`, scale the product of powers of the design's numbers that takes the known growth of
a correction (a lateral force grows with b) off it. All of it is analytic: complex steps pass.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from importlib.resources import files
from typing import Any

import numpy as np

from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.near import Misses
from microswim.calibration.region import body_flow as shaded
from microswim.calibration.region import positive_definite as blocks
from microswim.calibration.region.matern import matern_of_arrays
from microswim.models.rft.plane_wave import fill_nodes
from microswim.numerics.fourier import MIRROR_R
from microswim.swimmer.swimmer import Swimmer

FILE = "helix.npz"
SOME = 16  #: designs side by side: more would not fit the processor's memory
SHARES = slice(10, 13)  #: corrections of the force on the body alone


@dataclass(frozen=True, eq=False)
class Group:
    """A Gaussian process as an answer needs it: designs, kernel, weights (see `region.kriging`).

    Parameters
    ----------
    Z, N
        Scaled coordinates (n, f) and numbers of waves (n,) of the designs.
    lengths, phasors, noise
        Of the kernel.
    alpha, mean
        Weights (n, m) and means (m,) of the corrections, complex where they turn with the tail.
    """

    Z: np.ndarray
    N: np.ndarray
    lengths: np.ndarray
    phasors: np.ndarray
    noise: Any
    alpha: np.ndarray
    mean: np.ndarray

    def __call__(self, z: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Return corrections (k, m) at designs, complex ones as pairs, in plain NumPy."""
        k = matern_of_arrays(self._distance(z))
        own: Any
        theirs: Any
        even, odd = 1.0, 0.0
        for m, a in enumerate(self.phasors, 1):
            if a > 0:
                own, theirs = (np.exp(2j * np.pi * m * N) for N in (self.N, np.real(waves)))
                dN = 2.0 * np.pi * m * (waves - np.real(waves))  # of a complex step
                c, s = np.cos(dN), np.sin(dN)
                cos, sin = (c * theirs.real - s * theirs.imag), (s * theirs.real + c * theirs.imag)
                even = even + a * (np.outer(cos, own.real) + np.outer(sin, own.imag))
                odd = odd - a * (np.outer(sin, own.real) - np.outer(cos, own.imag))
        if not np.iscomplexobj(self.alpha):
            return (k * even) @ self.alpha + self.mean
        a, b = np.real(self.alpha), np.imag(self.alpha)
        real = (k * even) @ a - (k * odd) @ b + np.real(self.mean)
        imag = (k * even) @ b + (k * odd) @ a + np.imag(self.mean)
        return np.stack([real, imag], axis=-1).reshape(len(k), -1)

    @cached_property
    def _scaled(self) -> tuple[np.ndarray, np.ndarray]:
        own = self.Z / self.lengths
        return np.ascontiguousarray(own.T), np.sum(own * own, axis=1)

    def _distance(self, z: np.ndarray) -> np.ndarray:
        """Return the squared distances (k, n), by the products of the coordinates."""
        own, squares = self._scaled
        x = z / self.lengths
        r2 = np.sum(x * x, axis=1)[:, None] + squares - 2.0 * (x @ own)
        return np.where(np.real(r2) < 0.0, 0.0 * r2, r2)


@dataclass(frozen=True, eq=False)
class Atlas:
    """Corrections over the design space, and what they and the surrogate miss.

    Parameters
    ----------
    groups
        Gaussian processes of the corrections, axial, others without direction, lateral.
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

    groups: tuple[Group, ...]
    centre: np.ndarray
    spread: np.ndarray
    exponents: np.ndarray
    misses: Misses
    plain: dict[str, Misses]
    about: dict[str, Any] = field(default_factory=dict)

    def place(self, swimmer: Swimmer) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return numbers (6, ...), scaled coordinates (..., f) and waves of a design."""
        x = coordinates.numbers(swimmer)
        z = (coordinates.features(x).T - self.centre) / self.spread
        return x, z, x[2]

    def corrections(self, x: np.ndarray, z: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Return the corrections y (25, ...) of designs."""
        rows, N = np.atleast_2d(z), np.atleast_1d(waves)
        y = np.concatenate([
            np.concatenate([g(rows[i : i + SOME], N[i : i + SOME]) for g in self.groups], axis=1)
            for i in range(0, len(rows), SOME)
        ])  # fmt: skip
        scale = np.exp(np.tensordot(self.exponents, coordinates.powers(x), axes=1))
        return y.T.reshape(scale.shape) * scale

    def matrices(self, swimmer: Swimmer) -> tuple[Any, ...]:
        """Return R (6, 6, ...), F_p (6, ...), G at phase 0 and the body's share (3, ...).

        Arrays of designs (`microswim.swimmer.fields.lifted`) stand in the last axis.
        """
        one = _bare(swimmer)
        y = self.corrections(*self.place(one))
        return rebuilt(one, y)


def _bare(swimmer: Swimmer) -> Swimmer:
    """Return the swimmer with the exact drag of its body: there is no other truth."""
    body = swimmer.body.exact
    return swimmer if body is swimmer.body else replace(swimmer, body=body)


def base(swimmer: Swimmer) -> tuple[Any, ...]:
    """Return R_0 (6, 6, ...), F_0 (6, ...), G_0 of the left-handed tail, and D (6, ...)."""
    p = np.moveaxis(shaded.parameters(swimmer), -1, 0)
    D = np.array(np.broadcast_arrays(*swimmer.body.diagonal(swimmer.fluid.viscosity)))
    kind, each = np.result_type(p, D), np.broadcast_shapes(p.shape[1:], D.shape[1:])
    most = int(np.max(shaded.sizes(swimmer.tail.number_of_waves)))
    ramp_rule, *rows = shaded.rules(most)
    rule = shaded.behind_ramp.written(most, *rows)
    nodes = np.zeros((7, ramp_rule[0].size + rule[0].size, *each), dtype=kind)
    fill_nodes.written(nodes, p, ramp_rule, rule)
    nodes[6, -1] = 1.0
    R, F = np.zeros((6, 6, *each), dtype=kind), np.zeros((6, *each), dtype=kind)
    for i in range(6):
        R[i, i] = D[i]
    G = shaded.add_tail.written(R, F, p, nodes, 0.0, 1.0)
    upper = np.triu_indices(6, 1)
    R[upper] = R.swapaxes(0, 1)[upper]
    return R, F, G, D


def rebuilt(swimmer: Swimmer, y: np.ndarray) -> tuple[Any, ...]:
    """Return R, F_p, G and the body's share of a swimmer from given corrections y (25, ...)."""
    R, F, G, D = base(swimmer)
    a, mu = swimmer.body.semi_axes3[0], swimmer.fluid.viscosity
    kind = np.result_type(R, y)
    R, F = R.astype(kind), F.astype(kind)
    lateral = np.concatenate([y[: blocks.REAL], y[SHARES.stop :]])
    G = blocks.decode_helix.written(lateral, R, F, G, a, mu, D[3])
    share = y[SHARES]
    extra = np.array([D[0] * np.exp(share[0]), share[1] * mu * a * a, share[2] * mu * a * a])
    if swimmer.tail.sign < 0:
        mirror = MIRROR_R.reshape(-1, *[1] * (F.ndim - 1))
        R, F, extra = (
            R * mirror * mirror[:, None],
            F * mirror,
            extra * _HAND.reshape(mirror[:3].shape),
        )
    return R, F, G, extra


#: Signs of the body's axial drag, of its coupling with the turn, and of its share of F_p.
_HAND = np.array([1.0, -1.0, 1.0])


@cache
def shipped() -> Atlas | None:
    """Return the atlas that comes with the package, None where there is none."""
    from microswim.calibration.atlas.text import unpack

    path = files("microswim.calibration.atlas").joinpath(FILE)
    return unpack(path.read_bytes()) if path.is_file() else None
