"""Memory a factorisation will take, foreseen, against what the machine has.

A nested-dissection factor of a three-dimensional mesh grows like n^(4/3); the measured peaks of the
whole process from 42,000 to 480,000 unknowns (docs/accuracy-fem.md) lie at most 20 % below
``0.5 GB + c n^(4/3)``, c depending on the polynomial order, since higher order couples more.
"""

from __future__ import annotations

import os
from pathlib import Path

from microswim.errors import MicroswimError

GIGABYTE = 1e9
_BASE = 0.5 * GIGABYTE
_PER_UNKNOWN = {2: 285.0, 3: 330.0}
_EXPONENT = 4.0 / 3.0


def foreseen(unknowns: int, order: int) -> float:
    """Bytes at the peak of a factorisation with PARDISO."""
    return _BASE + _PER_UNKNOWN.get(order, 110.0 * order) * unknowns**_EXPONENT


def available() -> float:
    """Bytes that this process may still take; infinite where the system does not tell."""
    return min(_free_of_machine(), _free_of_container())


def _free_of_machine() -> float:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError, AttributeError):
        return float("inf")


def _free_of_container(group: Path = Path("/sys/fs/cgroup")) -> float:
    try:
        limit = float((group / "memory.max").read_text(encoding="ascii"))
        return limit - float((group / "memory.current").read_text(encoding="ascii"))
    except (OSError, ValueError):  # no such group, or "max"
        return float("inf")


def check(unknowns: int, order: int) -> None:
    """Refuse a factorisation that would not fit.

    Raises
    ------
    MicroswimError
        One sentence: unknowns, what they need, what there is.
    """
    need, there = foreseen(unknowns, order), available()
    if need > there:
        raise MicroswimError(
            f"{unknowns:,} unknowns need about {need / GIGABYTE:.1f} GB of memory and "
            f"{there / GIGABYTE:.1f} GB are free; take a coarser level, a smaller channel or a "
            "larger machine"
        )
