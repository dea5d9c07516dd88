"""A tail that beats as it was filmed: tangent angle in smooth modes along s and harmonics in time.

``psi(s, phase) = sum_m P_m(2 s / L - 1) (c_m0 + sum_h c_mh cos h phase + d_mh sin h phase)``, the
centreline ``int_0^s (cos psi, sin psi) ds'``: the filament keeps its length, and s is arc length.
Out of the plane an angle theta of the same form leads it, the tangent is then
``(cos theta cos psi, cos theta sin psi, sin theta)``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import legendre

from microswim import checks
from microswim.errors import SpecError
from microswim.numerics.quadrature import gauss
from microswim.swimmer.geometry.tails.tail import Sections, SurfaceMotion
from microswim.swimmer.geometry.tails.waveforms.sampled_tail import SampledTail

NODES = 32  #: along the filament up to a point, far more than its modes


@checks.by_name
@dataclass(frozen=True, kw_only=True)
class WaveformTail(SampledTail):
    """Tail with any periodic beat, by its tangent angles; see `read_waveform`.

    Parameters
    ----------
    modes
        A row for each Legendre polynomial along the filament: mean, cosine, sine of the phase,
        cosine and sine of twice the phase, ... of the tangent angle to s (rad).
    modes_out
        The same of its angle out of the plane of x and y, for a beat in space.
    length
        Length along the filament.
    radius
        Radius of the filament (length).
    frequency
        Beats per time.
    wavelength
        For the laws of local resistance that need one; by default that of the travelling wave.
    tolerance
        How exactly the centreline is followed, relative to its largest position.
    sections, surface_motion, position, direction, phase
        As for `WaveTail`.

    Raises
    ------
    SpecError
        If a field is out of range, or the modes are no table.

    Examples
    --------
    >>> import microswim as ms
    >>> tail = ms.WaveformTail(modes=[[0.1, 0.0, 0.0], [0.1, 0.3, 0.2]], length=2.0, radius=0.02)
    >>> round(float(tail.centreline(2.0, 0.0)[0][0]), 3), round(tail.arc_length, 6)
    (1.937, 2.0)
    """

    modes: Any
    length: float
    radius: float
    frequency: float = 1.0
    modes_out: Any = None
    wavelength: float | None = None
    tolerance: float = 1e-7
    sections: Sections = "perpendicular"
    surface_motion: SurfaceMotion = "translating"
    kind: ClassVar[str] = "waveform"
    beats_in_plane: ClassVar[bool] = True

    def __post_init__(self) -> None:
        checks.positive("tail.length", self.length, "length")
        self._check_filament()
        self._check_place()
        if self.surface_motion == "rigid":
            raise SpecError("tail.surface_motion", "rigid", "translating or bending", "it bends")
        rows = _rows(self.modes, "tail.modes")
        object.__setattr__(self, "modes", rows)
        if self.modes_out is not None:
            out = _rows(self.modes_out, "tail.modes_out")
            object.__setattr__(self, "modes_out", out if np.any(out) else None)
        checks.number("tail.tolerance", self.tolerance, "1e-12 to 0.01", least=1e-12, most=0.01)
        if self.wavelength is None:
            object.__setattr__(self, "wavelength", wavelength(np.array(rows), float(self.length)))
        checks.positive("tail.wavelength", self.wavelength, "length")

    @property
    def is_planar(self) -> bool:
        return self.modes_out is None and super().is_planar

    @property
    def sign(self) -> float:
        return 1.0

    @property
    def starts_on_axis(self) -> bool:
        return True

    @property
    def arc_length(self) -> float:
        return self.length

    @property
    def apparent_length(self) -> Any:
        """Arc length: s is measured along the filament."""
        return self.length

    @property
    def bend(self) -> float:
        """Mean curvature of a beat in a plane; one in space has none that a path could follow."""
        if self.modes_out is not None:
            return 0.0
        return mean_curvature(np.array(self.modes), float(np.real(self.length)))

    @property
    def number_of_waves(self) -> float:
        """Number of waves on the filament."""
        return float(np.real(self.length / self.wavelength))  # type: ignore[operator]

    @cached_property
    def centre(self) -> Callable[[Any, Any], np.ndarray]:
        out = None if self.modes_out is None else np.array(self.modes_out)
        return partial(_position, np.array(self.modes), out, float(np.real(self.length)))

    def angle(self, s: Any, phase: Any) -> np.ndarray:
        """Return the tangent angle to s (rad), of shape broadcast(s, phase)."""
        return tangent_angle(np.array(self.modes), float(np.real(self.length)), s, phase)


def _rows(modes: Any, name: str) -> tuple[tuple[float, ...], ...]:
    allowed = "a table: rows alike of a mean, and a cosine and a sine for each harmonic"
    try:
        table = np.array(modes, dtype=float)
    except (TypeError, ValueError):
        raise SpecError(name, modes, allowed) from None
    if table.ndim != 2 or table.size == 0 or table.shape[1] % 2 == 0:
        raise SpecError(name, f"of shape {table.shape}", allowed)
    if not np.isfinite(table).all():
        raise SpecError(name, "not finite", allowed)
    return tuple(tuple(float(v) for v in row) for row in table)


def harmonics(phase: Any, columns: int) -> np.ndarray:
    """Return ``1, cos phase, sin phase, cos 2 phase, ...``, shape phase + (columns,)."""
    h = (np.arange(columns) + 1) // 2
    angle = np.asarray(phase)[..., None] * h
    return np.where(np.arange(columns) % 2 == 1, np.cos(angle), np.where(h, np.sin(angle), 1.0))


def mean_curvature(modes: np.ndarray, length: float) -> float:
    """Return the mean over the filament and the beat of ``d psi / ds``."""
    return float(np.diff(legendre.legval([-1.0, 1.0], modes[:, 0]))[0] / length)


def tangent_angle(modes: np.ndarray, length: float, s: Any, phase: Any) -> np.ndarray:
    """Return psi(s, phase), shape broadcast(s, phase)."""
    P = legendre.legvander(2.0 * np.asarray(s) / length - 1.0, len(modes) - 1)
    return np.einsum("...m,mk,...k->...", P, modes, harmonics(phase, modes.shape[1]), optimize=True)


def _position(
    modes: np.ndarray, out: np.ndarray | None, length: float, s: Any, phase: Any
) -> np.ndarray:
    """``int_0^s (cos theta cos psi, cos theta sin psi, sin theta) ds'`` by Gauss-Legendre."""
    x0, w = gauss(NODES)
    s, phase = np.asarray(s, dtype=float), np.asarray(phase, dtype=float)
    inner = s[..., None] * x0
    psi = tangent_angle(modes, length, inner, phase[..., None])
    theta = 0.0 if out is None else tangent_angle(out, length, inner, phase[..., None])
    flat = np.cos(theta)
    x, y = s * ((flat * np.cos(psi)) @ w), s * ((flat * np.sin(psi)) @ w)
    z = np.zeros_like(x) if out is None else s * (np.sin(theta) @ w)
    return np.stack([x, y, z], axis=-1)


def wavelength(modes: np.ndarray, length: float) -> float:
    """Return that of the travelling wave of the first harmonic, ten lengths at the most.

    With ``a(s) = sum_m (c_m - i d_m) P_m(s)`` the wave is ``Re a exp(i phase)``, and its argument
    falls by 2 pi over a wavelength; least squares weighted by ``|a|^2``.
    """
    if modes.shape[1] < 3:
        return 10.0 * length
    s = np.linspace(0.0, length, 101)
    a = legendre.legval(2.0 * s / length - 1.0, modes[:, 1] - 1j * modes[:, 2])
    weight = np.abs(a) ** 2
    if not weight.max() > 0:
        return 10.0 * length
    argument = np.unwrap(np.angle(a))
    centred = s - np.average(s, weights=weight)
    k = abs(np.sum(weight * centred * argument) / np.sum(weight * centred**2))
    return float(2.0 * np.pi / max(k, 2.0 * np.pi / (10.0 * length)))
