"""Calibration files of electromagnet systems: YAML, a list of coils of multipole sources each.

Tables of B on a grid are read by `microswim.spec.readers.magnetic`, coils by their measures by
`microswim.spec.readers.windings`.

The layout is that of the Multi-Scale Robotics Lab's ``ElectromagnetCalibration``: ``Coil_List``
names the coils, each coil's ``Source_List`` its sources, each with ``A_Coeff``, ``B_Coeff``,
``Source_Position`` and ``Source_Direction``; metres, teslas, amperes.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from microswim.errors import MachineError, SpecError
from microswim.spec.readers.magnetic import read_grid
from microswim.spec.readers.text import read_text
from microswim.spec.readers.windings import read_windings
from microswim.swimmer.magnetism.grid import GridCoil
from microswim.swimmer.magnetism.multipole import Coil, Source
from microswim.swimmer.magnetism.winding import Winding

MOST_ORDER = 30
TABLES = (".csv", ".tsv", ".txt", ".dat")  #: what is no calibration in YAML


def read_coils(file: str) -> tuple[Coil | GridCoil | Winding, ...]:
    """Return the coils of a calibration file, of their measures, or of a table of B on a grid.

    Raises
    ------
    SpecError
        One sentence: what in the file is missing or wrong.
    MachineError
        If PyYAML is not installed.
    """
    if Path(file).suffix.lower() in TABLES:
        return read_grid(file)
    if Path(file).suffix.lower() == ".toml":
        return read_windings(file)
    text = read_text(file)
    try:
        import yaml
    except ImportError:
        raise MachineError(
            'a file of coils needs PyYAML: pip install "microswim[magnetic]"'
        ) from None
    try:
        tables = yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError) as error:
        raise SpecError(f"{file}: not valid YAML: {' '.join(str(error).split())}") from None
    coils = _entry(file, tables, "Coil_List")
    if not isinstance(coils, list) or not coils:
        raise SpecError(f"{file}: Coil_List must be a list of the names of the coils")
    return tuple(_coil(file, tables, str(name)) for name in coils)


def _coil(file: str, tables: Any, name: str) -> Coil:
    table = _entry(file, tables, name)
    sources = _entry(file, table, "Source_List", name)
    if not isinstance(sources, list) or not sources:
        raise SpecError(f"{file}: {name}.Source_List must be a list of the names of its sources")
    return Coil(name, tuple(_source(file, table, name, str(source)) for source in sources))


def _source(file: str, table: Any, coil: str, name: str) -> Source:
    where, source = f"{coil}.{name}", _entry(file, table, name, coil)
    if not isinstance(source, dict):
        raise SpecError(f"{file}: {where} must hold coefficients, position and direction")
    inner, outer = (
        _numbers(file, f"{where}.{k}", source.get(k, [])) for k in ("A_Coeff", "B_Coeff")
    )
    if not len(inner) + len(outer) >= 1 or max(len(inner), len(outer)) > MOST_ORDER:
        raise SpecError(
            f"{file}: {where} must have 1 to {MOST_ORDER} coefficients A_Coeff, B_Coeff"
        )
    place, axis = (
        _numbers(file, f"{where}.{k}", _entry(file, source, k, where))
        for k in ("Source_Position", "Source_Direction")
    )
    size = float(np.linalg.norm(axis))
    if len(place) != 3 or len(axis) != 3 or not size:
        raise SpecError(f"{file}: {where} must have three numbers as position and as direction")
    return Source(inner, outer, place, tuple(float(x) / size for x in axis))  # type: ignore[arg-type]


def _entry(file: str, table: Any, key: str, where: str = "") -> Any:
    if not isinstance(table, dict) or key not in table:
        raise SpecError(f"{file}: {where + '.' if where else ''}{key} is missing")
    return table[key]


def _numbers(file: str, where: str, given: Any) -> tuple[float, ...]:
    """Numbers of a list, or of a column of lists of one."""
    try:
        found = np.asarray([] if given is None else given, dtype=float).ravel()
    except (TypeError, ValueError):
        raise SpecError(f"{file}: {where} must be made of numbers") from None
    if not np.isfinite(found).all():
        raise SpecError(f"{file}: {where} must be made of finite numbers")
    return tuple(map(float, found))
