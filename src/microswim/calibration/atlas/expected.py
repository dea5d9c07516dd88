"""The error to expect of each mean velocity, whatever model gave it, and how it is known."""

from __future__ import annotations

from typing import Any

import numpy as np

from microswim import checks
from microswim.calibration.atlas import coordinates
from microswim.calibration.atlas.atlas import of
from microswim.calibration.atlas.gait import gait as atlas_gait
from microswim.calibration.atlas.near import QUANTITIES, Misses
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.swimmer.drag.coefficients import Unchosen
from microswim.swimmer.drag.interaction import Interaction
from microswim.swimmer.geometry.tails.kinds import as_wave
from microswim.swimmer.provenance import Provenance
from microswim.swimmer.swimmer import Swimmer

#: Largest difference of a level of the boundary elements from the finest, over the design range.
LEVELS = {"coarse": 0.0035, "standard": 0.002, "fine": 0.0005}
#: The same of ribbons, twice over: few were compared (docs/cad.md).
RIBBONS = {"coarse": 0.01, "standard": 0.006, "fine": 0.003}
#: Largest differences of an elastic tail's us and os from boundary elements on the same motion, by
#: its drive: the designs of benchmarks/accuracy_elastic.py, 12 each.
ELASTIC = {
    "pivot": {"us": 0.85, "os": 0.08}, "rotate": {"us": 0.85, "os": 0.08}, "heave": {"us": 0.86},
    "moment": {"us": 1.6}, "in space": {"us": 2.6},
}  # fmt: skip
#: Ranges of these designs: radii of filament and body over the length, sperm number, ...
LIKE = ((0.005, 0.03), (0.08, 0.3), (1.5, 5.0))
#: ... and the size of the drive: angle, heave over the body's radius, moment over B / L.
SIZES = {"pivot": (0.2, 0.8), "rotate": (0.2, 0.8), "heave": (0.1, 0.4), "moment": (2.0, 8.0)}
#: Of helices at rest: radius and pitch over the length.
COILED = ((0.02, 0.05), (0.6, 1.2))
#: The same of flagella with a mean curvature by each law of local resistance: u_s, u_q, mean w_r,
#: and the curvature of the path, over the law's own values (benchmarks/accuracy_flagella.py).
BENT = {
    "lighthill": {"us": 0.11, "uq": 0.19, "or": 0.11, "path_curvature": 0.07},
    "gray_hancock": {"us": 0.34, "uq": 0.44, "or": 0.10, "path_curvature": 0.18},
    "cox": {"us": 0.27, "uq": 0.21, "or": 0.11, "path_curvature": 0.16},
}
#: Ranges of those: radius and head over the length, bend (rad), waves.
BENT_LIKE = ((0.003, 0.01), (0.04, 0.12), (0.3, 1.5), (0.6, 1.6))
#: What is known of the force on a held swimmer: local drag was off by a factor of five on thick
#: helices (`tabak/helix`: 196 against 37 by boundary elements).
UNJUDGED = "no error is known, and local drag may be off by a factor; --model bem computes it"
#: What is said of a swimmer that is a body alone.
UNPROPELLED = (
    "without a tail nothing propels it: it rests, exactly, until a field, a flow or a force moves "
    "it; microswim mobility tells its resistance and how wrong that may be"
)
#: What is said of a rigid tail alone, its motor's own rotation free.
UNRESISTED = (
    "a tail that turns against nothing turns itself back: it rests in the lab, exactly, until a "
    "field, a flow or a force moves it"
)
HELD = {
    "bem": "the level's difference holds",
    "fem": "the mesh decides",
    "atlas": "the errors of a free one hold roughly",
}
#: Of finite elements in a channel, against boundary elements (docs/accuracy-fem.md).
CHANNEL = 0.005
#: Share of the largest velocity below which one is nothing but rounding.
VANISHED = 1e-9
#: Entry of `QUANTITIES` of each degree of freedom.
_ENTRY = (0, 1, 1, 2, 3, 3)


@checks.given(swimmer=checks.swimmer, gait=checks.gait)
def expected_error(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return the relative error to expect of each mean velocity of a gait.

    Parameters
    ----------
    swimmer
        The swimmer.
    gait
        Its gait, by any model.

    Returns
    -------
    dict
        ``us`` to ``or``: within it lie 95 of 100 such designs, relative to the mean velocity, or
        to the amplitude where the velocity averages out; None where it is not known; ``how``.

    Raises
    ------
    SpecError
        If an argument is of another kind.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix-constant")
    >>> 0.05 < ms.expected_error(swimmer, swimmer.gait())["us"] < 0.5
    True
    """
    by_model = {"atlas": _of_atlas, "rft": _of_surrogate, "bem": _of_elements}
    by_model["elastic"] = _of_elastic
    if swimmer.tail.is_absent:
        return {**dict.fromkeys(DEGREES_OF_FREEDOM, 0.0), "how": UNPROPELLED}
    if swimmer.body.is_absent and swimmer.tail.is_rigid and gait.free[3]:
        return {**dict.fromkeys(DEGREES_OF_FREEDOM, 0.0), "how": UNRESISTED}
    values, how = by_model.get(gait.model, _unknown)(swimmer, gait)
    held = [0.0 if not free else value for value, free in zip(values, gait.free)]
    known: dict[str, Any] = dict(zip(DEGREES_OF_FREEDOM, held))
    if swimmer.tail.bend:
        known["path_curvature"] = _of_curvature(swimmer, gait, known)
    if not any(gait.free):
        how = "held still: no velocity to be wrong; of its force " + HELD.get(gait.model, UNJUDGED)
    return {**known, "how": how}


def _of_curvature(swimmer: Swimmer, gait: Gait, known: dict[str, Any]) -> float | None:
    """Return the relative error of the path's curvature: rate of turning over speed."""
    if gait.model == "rft" and _is_like_bent(swimmer):
        return BENT[swimmer.coefficients.law]["path_curvature"]
    us, turn = known["us"], known["or"]
    return None if us is None or turn is None else float(us + turn)


def _unknown(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    return [None] * 6, f"not known for model {gait.model}"


def _of_atlas(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    atlas = of(swimmer)
    assert atlas is not None
    how = f"19 of 20 of the {atlas.about['solves']} boundary-element solves, left out, lie within"
    return _relative(atlas.misses, swimmer, gait), how


def _of_surrogate(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    atlas, calibrated = of(swimmer), gait.info.get("expected_errors")
    made = swimmer.calibration
    if calibrated:
        known = {"mean.us": "us", "mean.os": "os", "amplitude.uq": "uq", "amplitude.or": "or"}
        own, by = of_reference(made) if made else (0.0, "")
        if gait.info.get("outside"):
            return [None] * 6, "not known outside its calibrated region; compare with model bem"
        errors = {known[n]: 2.0 * value + own for n, value in calibrated.items() if n in known}
        how = f"twice the error left out, calibrated{by}"
        return [errors.get(n) for n in DEGREES_OF_FREEDOM], how
    if made is not None and not (made.away(swimmer) or made.changed(swimmer)):
        return _promised(made, swimmer)
    if atlas is not None and not coordinates.outside(swimmer):
        return _from_atlas(swimmer, gait)
    if swimmer.tail.bend:
        return _of_bent(swimmer, gait)
    law = swimmer.coefficients.law
    if swimmer.interaction != Interaction() or law == "constant":
        return [None] * 6, "not known: law or interaction coefficients are the user's own"
    misses = as_it_comes(swimmer)
    if atlas is None or misses is None:
        return [None] * 6, "not measured for such swimmers; compare with model bem"
    with np.errstate(divide="ignore"):
        _, z, _ = atlas.place(swimmer)
    if not np.all(np.isfinite(z)):
        return [None] * 6, "not measured without a wave"
    how = f"within it {law} lies from boundary elements for 19 of 20 of the nearest designs solved"
    return _relative(misses, swimmer, gait), how


def _of_bent(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    """Return what a law of local resistance missed of flagella that are bent in the mean."""
    if not (_is_like_bent(swimmer) and all(gait.free)):
        return [None] * 6, "not measured for such bent tails; compare with model bem"
    misses = BENT[swimmer.coefficients.law]
    how = "largest difference of this law from boundary elements, 24 bent flagella"
    return [misses.get(name, 0.0) for name in DEGREES_OF_FREEDOM], how


def _is_like_bent(swimmer: Swimmer) -> bool:
    """Whether a swimmer is one as those of `BENT`, by local resistance as it comes."""
    tail, head = swimmer.tail, float(max(swimmer.body.semi_axes3))
    L = float(tail.arc_length)
    place = (tail.radius / L, head / L, abs(tail.bend) * L, tail.number_of_waves)
    inside = all(low <= np.real(x) <= high for x, (low, high) in zip(place, BENT_LIKE))
    plain = swimmer.interaction == Interaction() and swimmer.calibration is None
    return inside and plain and swimmer.region is None and swimmer.coefficients.law in BENT


def as_it_comes(swimmer: Swimmer) -> Misses | None:
    """Return what a swimmer's law of local resistance missed, uncorrected; None if not measured."""
    atlas, used = of(swimmer), swimmer.coefficients
    known = used.spin and not used.tip and swimmer.interaction == Interaction()
    if atlas is None or not known or coordinates.unlike(swimmer):
        return None
    return atlas.plain.get(used.law)


def _of_elastic(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    tail: Any = swimmer.tail
    kind, inside = _like(tail, swimmer.body.semi_axes3[0], gait.info["sperm_number"])
    round_body = len(set(swimmer.body.semi_axes3)) == 1
    open_ = isinstance(swimmer.coefficients, Unchosen) and swimmer.interaction == Interaction()
    open_ = open_ and swimmer.hook is None
    if not (inside and round_body and open_ and all(gait.free)):
        return [None] * 6, "not measured for such elastic tails; compare with model bem"
    how = "largest difference from boundary elements on the same motion of the tail, 12 designs"
    return [ELASTIC[kind].get(name) for name in DEGREES_OF_FREEDOM], how


def _like(tail: Any, body: float, sperm_number: float) -> tuple[str, bool]:
    """Return of which designs an elastic tail is one, and whether it lies among them."""
    L = tail.length
    place, ranges = [tail.radius / L, body / L, sperm_number], [*LIKE]
    driven = {
        "heave": (tail.amplitude or 0.0) / (body or 1.0),
        "moment": (tail.moment or 0.0) * L / tail.bending,
    }
    size, low_high = driven.get(tail.drive, tail.angle or 0.0), SIZES.get(tail.drive, (1.0, 0.0))
    if not tail.is_bent:
        place, ranges = [*place, size], [*ranges, low_high]
    elif tail.drive in ("rotate", "none") or not (tail.rest_radius and tail.rest_pitch):
        return tail.drive, False
    else:
        coil = tail.rest_radius / L, abs(tail.rest_pitch) / L
        place, ranges = [*place, *coil], [*ranges, *COILED]
    inside = all(low <= np.real(x) <= high for x, (low, high) in zip(place, ranges))
    return "in space" if tail.is_bent else tail.drive, inside


def _promised(made: Provenance, swimmer: Swimmer) -> tuple[list[Any], str]:
    """Return what a calibration at one design left there, and the reference's own error."""
    if made.reference == "measurements":
        return [None] * 6, "not known: that of the measurements it was calibrated on"
    left = {**made.unmatched, **made.matched}
    own, _ = of_reference(made)
    names = {"us": "mean.us", "uq": "amplitude.uq", "os": "mean.os", "or": "amplitude.or"}
    errors = {n: abs(left[q]) + own for n, q in names.items() if q in left}
    if swimmer.tail.is_rigid:  # both lateral directions turn with the tail
        errors |= {a: errors[b] for a, b in (("ur", "uq"), ("oq", "or")) if b in errors}
    how = f"left by the calibration at this design, by {made.by}"
    return [errors.get(n) for n in DEGREES_OF_FREEDOM], how


def of_reference(made: Provenance) -> tuple[float, str]:
    """Return how wrong the reference itself was that a calibration was made by, and its name."""
    own = {"bem": LEVELS.get(made.level, LEVELS["coarse"]), "fem": CHANNEL}.get(made.reference, 0.0)
    return own, f", and that of {made.by} itself" if own else ""


def _from_atlas(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    """Return how far the surrogate lies from the atlas, and the atlas at most from the truth."""
    better = atlas_gait(swimmer)
    own, _ = _of_atlas(swimmer, better)
    mean, theirs = (np.real(g.mean_velocity) for g in (gait, better))
    size, other = (np.real(g.velocity_amplitude) for g in (gait, better))
    axial = np.array(_ENTRY) % 2 == 0
    off = np.abs(np.where(axial, mean - theirs, size - other))
    over = np.abs(np.where(axial, mean, size))
    doubt = np.array([np.nan if e is None else e for e in own]) * np.where(axial, theirs, other)
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = (off + np.abs(doubt)) / over
    how = "its difference from the atlas, whose own error is added; --model atlas does better"
    return _with_stills(swimmer, errors), how


def _of_elements(swimmer: Swimmer, gait: Gait) -> tuple[list[Any], str]:
    level = gait.info.get("level", "")
    if level not in LEVELS:
        return [None] * 6, "not known for a level of one's own"
    if swimmer.tail.section is not None:
        how = f"twice the largest difference of level {level} from fine, ribbons up to 5:1"
        return np.maximum(doubt(gait), RIBBONS[level]).tolist(), how
    how = f"largest difference of level {level} from finer ones"
    errors, found = [LEVELS[level]] * 6, gait.info.get("error")
    if found is not None:
        usual = LEVELS[level] + LEVELS[found["against"]]  # as far as levels lie apart
        errors = [LEVELS[level] if x <= usual else float(x) for x in found["velocities"]]
        if max(errors) > LEVELS[level]:
            how += f"; the difference from level {found['against']} where that is larger than usual"
    own = doubt(gait)
    if np.any(own > errors):
        how += "; where larger, what its resistance lacks in symmetry makes of the velocities"
    return np.maximum(own, errors).tolist(), how


def doubt(gait: Gait) -> np.ndarray:
    """Return relative errors (6,) of the velocities, from what R of a reference lacks in symmetry.

    R and ``F_p`` are made of the same densities f_i of rigid motions, ``int f_i . u dS = 0`` at the
    velocity u of the surface of the free swimmer. These integrals are taken to be off by the
    asymmetry times ``sqrt(R_ii P)``, independently, P the power of that motion: ``|dV_i|^2 = a^2 P
    sum_j (R^-1)_ij^2 R_jj``. A velocity that nearly cancels is off by more than R is.
    """
    R, F = np.real(gait.resistance(0.0)), np.real(gait.propulsion(0.0))
    free = np.ix_(gait.free, gait.free)
    mobility = np.zeros((6, 6))
    mobility[free] = np.linalg.inv(R[free])
    power = float(np.real(gait.activity(0.0))) - F @ mobility @ F
    size = float(gait.info.get("asymmetry") or 0.0) * abs(float(np.real(gait.rate)))
    off = size * np.sqrt(mobility**2 @ (np.diag(R) * max(power, 0.0)))
    axial = np.array(_ENTRY) % 2 == 0
    over = np.abs(np.where(axial, gait.mean_velocity, gait.velocity_amplitude))
    sizes = np.repeat([over[:3].max(), over[3:].max()], 3)  # what vanishes by symmetry is not off
    return np.divide(off, over, out=np.zeros(6), where=over > VANISHED * sizes)


def _relative(misses: Misses, swimmer: Swimmer, gait: Gait) -> list[Any]:
    """Return errors of the six velocities, lateral ones over their amplitudes."""
    atlas = of(swimmer)
    assert atlas is not None
    _, z, _ = atlas.place(swimmer)
    found = misses(np.real(z)[None])[0]
    rate, size = abs(float(np.real(gait.rate))), np.abs(np.real(gait.velocity_amplitude))
    scale = {"u_lateral": rate * float(np.real(as_wave(swimmer.tail).amplitude)), "o_lateral": rate}
    errors = np.array([found[entry] for entry in _ENTRY])
    for i, entry in enumerate(_ENTRY):
        name = QUANTITIES[entry]
        if name in scale:
            errors[i] *= scale[name] / size[i] if size[i] > 0 else np.inf
    return _with_stills(swimmer, errors)


def _with_stills(swimmer: Swimmer, errors: np.ndarray) -> list[Any]:
    """Return errors, None where not known; in its plane a beat moves nothing else, exactly."""
    known = [float(e) if np.isfinite(e) else None for e in errors]
    if swimmer.tail.is_planar:
        known[2:5] = 0.0, 0.0, 0.0
    return known
