"""A gait by the atlas: the model of that name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.atlas import of
from microswim.errors import SpecError
from microswim.gait.gait import Gait
from microswim.numerics.array import owned
from microswim.numerics.series.fourier import rotate
from microswim.swimmer.swimmer import Swimmer


def gait(swimmer: Swimmer) -> Gait:
    """Return the gait by the atlas: resistive force theory corrected by boundary-element solves,
    shipped.

    Parameters
    ----------
    swimmer
        A rigid helix or a plane wave on a sphere or spheroid, in the range of `coordinates`; its
        law of local resistance and its interaction coefficients do not count. Numbers may be
        complex.

    Returns
    -------
    Gait
        With ``model = "atlas"``.

    Raises
    ------
    SpecError
        If the atlas does not cover the swimmer.
    """
    atlas, kind, x = of(swimmer), coordinates.kind_of(swimmer), None
    missing = coordinates.unlike(swimmer)
    if not missing:
        x = coordinates.numbers(swimmer)
        missing = coordinates.beyond(x, kind)
    if atlas is None or missing:
        why = "; ".join(missing) or "none comes with this build"
        raise SpecError("model", "atlas", f"another one: the atlas does not cover this, {why}",
                        'take "auto", "rft" or "bem"')  # fmt: skip
    R, F, G, extra = (each[0] for each in atlas.matrices(swimmer, x))
    drag = np.diag(np.array(swimmer.body.diagonal(swimmer.fluid.viscosity))).astype(R.dtype)
    fields = {"rate": swimmer.tail.rate, "free": swimmer.motion.mask, "units": swimmer.units}
    fields |= {"model": "atlas", "info": {}}
    if swimmer.tail.is_planar:
        made = Gait.from_samples(R, F, G, **fields)
        return replace(made, body_resistance_series=drag[None])
    held, sign = np.zeros(6, dtype=R.dtype), swimmer.tail.sign
    drag[0, 0], drag[0, 3], held[0] = extra
    made = owned(
        Gait,
        resistance_series=rotate(R[0], sign),
        propulsion_series=rotate(F[0], sign),
        activity_series=G,
        body_resistance_series=rotate(drag, sign),
        body_propulsion_series=rotate(held, sign),
        **fields,
    )
    if swimmer.motion.frequency_frame == "lab":
        return made.in_lab_frame(swimmer.tail.rate, sign)
    return made
