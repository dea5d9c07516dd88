"""A run as a Dataset, in and out of files: netCDF, Zarr, CSV of the path; with its birthplace.

Every number carries its unit, and every file the version, date, model and spec it came from.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from io import StringIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from microswim import __version__, checks
from microswim.errors import SpecError
from microswim.gait import quantities
from microswim.gait.gait import DEGREES_OF_FREEDOM, Gait
from microswim.gait.observed import observed
from microswim.gait.screw import leading_end
from microswim.gait.turning.driven import driven
from microswim.gait.units import UNITS
from microswim.gait.units import unit as unit
from microswim.numerics.array import sealed
from microswim.numerics.files import write
from microswim.path.trajectory import trajectory
from microswim.swimmer import physical_sense
from microswim.swimmer.geometry.extent import nose_to_tip
from microswim.swimmer.magnetism.drive import drive_of
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr

SAMPLES = 48  # per period of the trajectory


@checks.given(swimmer=checks.swimmer, gait=checks.gait)
def numbers(swimmer: Swimmer, gait: Gait) -> dict[str, Any]:
    """Return the numbers of a run: what ``microswim run --json`` prints.

    Parameters
    ----------
    swimmer
        The swimmer.
    gait
        A gait of this swimmer, by any model.

    Returns
    -------
    dict
        ``model``, ``units``, ``mean_velocity``, ``velocity_amplitude``, ``swimming_speed``,
        ``efficiency`` and more; angular velocities in radians per time, frequencies in cycles.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("goto/C")
    >>> round(1e6 * float(ms.io.numbers(swimmer, swimmer.gait())["swimming_speed"]), 2)
    10.21
    """
    if physical_sense.stands_still(swimmer):  # held or free, nothing else moves: no rounding left
        gait = replace(gait, free=physical_sense.ABOUT_S)
    found = quantities.numbers(gait, swimmer.body_length) | driven(gait, drive_of(swimmer))
    if swimmer.tail.bend:
        found["curvature_ratio"] = found["path_curvature"] / abs(float(swimmer.tail.bend))
    return {
        "model": gait.model,
        "units": gait.units,
        "degrees_of_freedom": list(DEGREES_OF_FREEDOM),
        **found,
        "leading_end": leading_end(gait, "joint" if swimmer.body.is_absent else "body"),
        "body_rotation_frequency": found["mean_velocity"][3]
        / (2.0 * np.pi),  # its old name, signed
    }


@checks.given(swimmer=checks.swimmer, gait=checks.gait, speed=checks.reals)
def enough_periods(swimmer: Swimmer, gait: Gait, speed: float | None = None) -> int:
    """Return the periods in which a swimmer goes one and a half times its own length (4 to 400).

    `speed` is its swimming speed, where that is known already.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix-constant")
    >>> ms.io.enough_periods(swimmer, swimmer.gait())
    122
    """
    speed = float(observed(gait, "swimming_speed")) if speed is None else speed
    step = speed * _period(gait)
    return int(np.clip(np.ceil(1.5 * nose_to_tip(swimmer) / step), 4, 400)) if step > 0 else 4


def _period(gait: Gait) -> float:
    return float(gait.period) if gait.rate != 0 else 1.0


@checks.given(
    swimmer=checks.swimmer,
    gait=checks.gait,
    periods=checks.above_zero("number of periods"),
    spec=checks.text,
    known=checks.mapping,
)
def dataset(
    swimmer: Swimmer,
    gait: Gait,
    *,
    periods: float | None = None,
    spec: str = "",
    known: dict[str, Any] | None = None,
    **loads: Any,
) -> xr.Dataset:
    """Return everything about a run: velocities over the period, path, numbers, provenance.

    Parameters
    ----------
    swimmer
        The swimmer.
    gait
        A gait of this swimmer, by any model.
    periods
        Length of the path in periods of the motor; by default until the swimmer has gone one
        and a half times its own length.
    spec
        Text of the spec file, kept as an attribute.
    known
        What `numbers` gave for this swimmer and gait, if it was asked already.
    loads
        What `trajectory` takes: external force, field, flow, ...

    Returns
    -------
    xarray.Dataset
        ``velocity`` (phase, dof) and ``power`` (phase) over one period; ``position`` (time,
        axis), ``quaternion`` (time, wxyz), ``motor_phase`` (time); the numbers of `numbers`; the
        gait's series; attributes ``microswim_version``, ``created``, ``model``, ``units``,
        ``spec``. Without a path where the gait holds at one pose (`Gait.one_pose`).

    Raises
    ------
    SpecError
        If `periods` is not positive.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> run = ms.io.dataset(swimmer, swimmer.gait(), periods=3)
    >>> run.position.dims, run.swimming_speed.units
    (('time', 'axis'), 'length/time')
    """
    known = numbers(swimmer, gait) if known is None else known
    if gait.one_pose:  # no path is followed from it
        if periods is not None or loads:
            gait.check_path()
        return sealed(_about(_over_the_period(gait).merge(_scalars(known)), gait, 0.0, spec))
    if periods is None:
        periods = enough_periods(swimmer, gait, known["swimming_speed"])
    if not 0 < periods <= 1e5:
        raise SpecError("periods", periods, "above 0 and at most 100000")
    times = np.linspace(0.0, periods * _period(gait), max(2, round(periods * SAMPLES) + 1))
    run = trajectory(gait, times, **loads).rename(phase="motor_phase")
    whole = run.merge(_over_the_period(gait)).merge(_scalars(known))
    return sealed(_about(whole, gait, periods, spec))


def _about(run: xr.Dataset, gait: Gait, periods: float, spec: str) -> xr.Dataset:
    """Return a run with its birthplace."""
    run = run.assign_attrs(model=gait.model, units=gait.units, periods=float(periods))
    return with_birthplace(run, spec, "Swimming of a micro-swimmer")


def with_birthplace(run: xr.Dataset, spec: str, title: str) -> xr.Dataset:
    """Return a run with what it came from: version, date, model and spec."""
    return run.assign_attrs(
        title=title,
        source=f"microswim {__version__}, model {run.attrs['model']}",
        microswim_version=__version__,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        spec=spec,
    )


def over_the_period(gait: Gait) -> xr.Dataset:
    """Return velocity and power over one period of a gait, with its numbers."""
    known = quantities.numbers(gait) | {"units": gait.units}
    return _over_the_period(gait).merge(_scalars(known)).assign_attrs(units=gait.units)


#: Units of the series, of a swimmer without units and in SI: per unit velocity, rotation and rate.
_SERIES = (
    {
        "resistance_series": "force, torque per velocity, rotation",
        "propulsion_series": "force, torque per rate",
        "activity_series": "power per squared rate",
    },
    {
        "resistance_series": "N s/m, N s/rad; N m s/m, N m s/rad",
        "propulsion_series": "N s/rad, N m s/rad",
        "activity_series": "W s^2/rad^2",
    },
)


def _over_the_period(gait: Gait) -> xr.Dataset:
    import xarray as xr

    phase = np.linspace(0.0, 2.0 * np.pi, 145)
    text = {k: unit(gait.units, k) for k in UNITS}
    variables: dict[str, Any] = {
        "velocity": (
            ("phase", "dof"),
            gait.velocity(phase),
            {"units": text["twist"], "long_name": "velocity, body frame, about the body's centre"},
        ),
        "power": ("phase", gait.power(phase), {"units": text["power"], "long_name": "motor power"}),
        "resistance_series": (("term_r", "dof", "dof_column"), gait.resistance_series),
        "propulsion_series": (("term_p", "dof"), gait.propulsion_series),
        "activity_series": ("term_a", gait.activity_series),
    }
    for name, units in _SERIES[gait.units == "SI"].items():
        about = f"{name[:-7]}: [mean, cos 1, sin 1, cos 2, ...]"
        variables[name] += ({"units": units, "long_name": about},)
    names = list(DEGREES_OF_FREEDOM)
    phases = ("phase", phase, {"units": "rad", "long_name": "phase of the tail"})
    return xr.Dataset(variables, coords={"phase": phases, "dof": names, "dof_column": names})


def _scalars(known: dict[str, Any]) -> xr.Dataset:
    import xarray as xr

    listed = quantities.QUANTITIES.values()
    about = {q.name: (q.dimension, q.meaning) for q in listed}
    about["body_rotation_frequency"] = ("frequency", "old name of body_rate_hz, with its sign")
    return xr.Dataset(
        {
            name: (
                "dof" if kind in quantities.VECTORS else (),
                known[name],
                {"units": unit(known["units"], kind), "long_name": meaning},
            )
            for name, (kind, meaning) in about.items()
            if name in known
        }
    )


@checks.given(run=checks.dataset, path=checks.place)
def save(run: xr.Dataset, path: str | PathLike[str]) -> Path:
    """Write a Dataset: ``.nc`` netCDF, ``.zarr`` Zarr, ``.csv`` the trajectory alone.

    Raises
    ------
    SpecError
        If the ending is another.

    Examples
    --------
    >>> import tempfile, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> run = ms.io.dataset(swimmer, swimmer.gait(), periods=1)
    >>> ms.io.save(run, tempfile.mkdtemp() + "/run.nc").name
    'run.nc'
    """
    path = Path(path)
    match path.suffix:
        case ".nc":
            write(path, netcdf(run))
        case ".zarr":
            run.to_zarr(path, mode="w", zarr_format=2, consolidated=True)
        case ".csv":
            _save_csv(run, path)
        case ending:
            raise SpecError("file ending", ending, ".nc, .zarr or .csv")
    return path


def netcdf(data: xr.Dataset) -> bytes:
    """Return a Dataset as the bytes of a netCDF file.

    HDF5, left to write to a disk that fills up, ends the process.
    """
    return bytes(data.to_netcdf(engine="h5netcdf"))


@checks.given(path=checks.place)
def load(path: str | PathLike[str]) -> xr.Dataset:
    """Read a Dataset written by `save` (``.nc`` or ``.zarr``), into memory.

    Raises
    ------
    SpecError
        If there is no such file or it cannot be read.

    Examples
    --------
    >>> import tempfile, microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> run = ms.io.dataset(swimmer, swimmer.gait(), periods=1)
    >>> back = ms.io.load(ms.io.save(run, tempfile.mkdtemp() + "/run.nc"))
    >>> back.equals(run)
    True
    """
    import xarray as xr

    path = Path(path)
    try:
        with xr.open_dataset(path, engine="zarr" if path.suffix == ".zarr" else "h5netcdf") as run:
            return sealed(run.load())
    except (OSError, ValueError, KeyError) as error:
        raise SpecError(f"{path}: no readable run: {' '.join(str(error).split())}") from None


def _motors(run: xr.Dataset) -> tuple[list[str], np.ndarray]:
    """Names and columns of the motors: the phase; of tails on their own, phase and rate of each."""
    if run.motor_phase.ndim == 1:
        return ["motor_phase"], run.motor_phase.values
    each = range(run.sizes["tail"])
    names = [f"motor_{what}[{n}]" for what in ("phase", "rate") for n in each]
    return names, np.column_stack([run.motor_phase, run.rate])


def _save_csv(run: xr.Dataset, path: Path) -> None:
    """Time, position and quaternion; where it comes from in comment lines."""
    length, time = run.position.attrs["units"], run.time.attrs["units"]
    motor, motors = _motors(run)
    units = f"{time}, {length}, rad" + (f", rad/{time}" if run.motor_phase.ndim == 2 else "")
    header = [
        f"{run.attrs['source']}, {run.attrs['created']}",
        f"body centre in the lab frame; quaternion body to lab; units: {units}",
        ",".join(["time,x,y,z,qw,qx,qy,qz", *motor, *(["path"] if "path" in run.dims else [])]),
    ]
    one = run.position.transpose(..., "time", "axis").values.reshape(-1, run.time.size, 3)
    q = run.quaternion.values.reshape(-1, run.time.size, 4)
    tables = [
        np.column_stack([run.time, one[i], q[i], motors])
        if len(one) == 1
        else np.column_stack([run.time, one[i], q[i], motors, np.full(run.time.size, i)])
        for i in range(len(one))
    ]
    table = np.concatenate(tables)
    comments = "".join(f"# {line}\n" for line in header[:2])
    text = StringIO()
    np.savetxt(text, table, fmt="%.12g", delimiter=",")
    write(path, f"{comments}{header[2]}\n{text.getvalue()}")
