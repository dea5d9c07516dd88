"""Published data, each set a CSV with a TOML sidecar that tells its birthplace.

The sidecar says where the numbers come from (``source``, ``place``), how they were ``obtained``,
their ``uncertainty``, the ``rights``, a ``note`` on what to beware of, and unit and meaning of
every column. A set without a complete sidecar does not pass the tests.
"""

from __future__ import annotations

import csv
import tomllib
from importlib.resources import files
from typing import TYPE_CHECKING

from microswim import checks
from microswim.errors import SpecError

if TYPE_CHECKING:
    import xarray

__all__ = ["load", "names"]

_HERE = files(__name__)
_MISSING = ("-", "")


def __dir__() -> list[str]:
    """Return what a user means to see, not what the module imports."""
    return __all__


@checks.given()
def names() -> list[str]:
    """Return names of all sets, in alphabetical order.

    Examples
    --------
    >>> import microswim as ms
    >>> "tabak-table-2" in ms.data.names()
    True
    """
    return sorted(f.name[:-4] for f in _HERE.iterdir() if f.name.endswith(".csv"))


@checks.given(name=checks.text)
def load(name: str) -> xarray.Dataset:
    """Load a set of published data.

    Parameters
    ----------
    name
        One of `names()`.

    Returns
    -------
    xarray.Dataset
        One variable per column, with ``units`` and ``long_name``; the key columns are its
        dimensions, missing entries are NaN. The attributes tell source, place, how obtained,
        uncertainty, rights and a note.

    Raises
    ------
    SpecError
        If there is no set of that name.

    Examples
    --------
    >>> import microswim as ms
    >>> specimen = ms.data.load("tabak-table-2").sel(specimen="C")
    >>> float(specimen.frequency), specimen.frequency.units
    (73.95, 'Hz')
    """
    import pandas as pd

    if name not in names():
        raise SpecError("data set", name, "one of " + ", ".join(names()))
    sidecar = tomllib.loads((_HERE / f"{name}.toml").read_text(encoding="utf-8"))
    header, *rows = csv.reader((_HERE / f"{name}.csv").read_text(encoding="utf-8").splitlines())
    columns = {key: _column([row[i] for row in rows]) for i, key in enumerate(header)}
    keys, about = sidecar.pop("index"), sidecar.pop("columns")
    dataset = pd.DataFrame(columns, dtype=object).set_index(keys).to_xarray()
    for key, entries in columns.items():
        kind = str if isinstance(entries[0], str) else float
        dataset[key] = (dataset[key].dims, dataset[key].values.astype(kind))
    for key, text in about.items():
        dataset[key].attrs = {"units": text["unit"], "long_name": text["meaning"]}
    return dataset.assign_attrs(name=name, **sidecar)


def _column(entries: list[str]) -> list[str] | list[float]:
    """Read a column as numbers, or as text when an entry is neither a number nor missing."""
    try:
        return [float("nan") if entry in _MISSING else float(entry) for entry in entries]
    except ValueError:
        return entries
