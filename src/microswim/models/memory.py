"""The memory there is, and what a solve will take of it: one look for both reference solvers.

Boundary elements: a dense matrix, factorised in place. Finite elements: a nested-dissection factor
of a three-dimensional mesh grows like n^(4/3); the measured peaks of the whole process from 42,000
to 480,000 unknowns (docs/accuracy-fem.md) lie at most 20 % below ``0.5 GB + c n^(4/3)``, c
depending on the polynomial order, since higher order couples more.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from microswim.errors import MachineError

GIGABYTE = 1e9
_BASE = 0.5 * GIGABYTE
_PER_UNKNOWN = {2: 285.0, 3: 330.0}
_EXPONENT = 4.0 / 3.0
_LIMITS = (  # of a group: file of its limit, of its use, name of what it can give back at once
    ("memory.max", "memory.current", "inactive_file"),
    ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
)


def of_dense(unknowns: int) -> float:
    """Return the bytes of a dense solve: its matrix, solved in place, and a tenth for the rest."""
    return 1.1 * 8.0 * (unknowns + 1.0) ** 2


def of_sparse(unknowns: int, order: int) -> float:
    """Return the bytes at the peak of a factorisation with PARDISO."""
    return _BASE + _PER_UNKNOWN.get(order, 110.0 * order) * unknowns**_EXPONENT


def available() -> float:
    """Return the bytes that this process may still take; infinite where no system tells.

    The least of what the machine has and what the limit of every group of processes around this
    one, such as a container or a job of a cluster, leaves.
    """
    return min(_free_of_machine(), *_free_of_groups())


def require(bytes_: float, unknowns: int, mend: str) -> None:
    """Refuse a solve that would not fit.

    Raises
    ------
    MachineError
        One sentence: unknowns, what they need, what there is.
    """
    there = available()
    if bytes_ > there:
        raise MachineError(
            f"{unknowns:,} unknowns need about {bytes_ / GIGABYTE:.1f} GB of memory and "
            f"{there / GIGABYTE:.1f} GB are free; {mend}"
        )


def _free_of_machine() -> float:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * float(line.split()[1])
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError, AttributeError):
        return float("inf")


def _free_of_groups(
    mount: Path = Path("/sys/fs/cgroup"), own: Path = Path("/proc/self/cgroup")
) -> Iterator[float]:
    """Yield what each control group of this process, and each above it, leaves (Linux)."""
    for group in _groups(mount, own):
        for limit, used, reclaimed in _LIMITS:
            try:
                left = float((group / limit).read_text(encoding="ascii"))
                left -= float((group / used).read_text(encoding="ascii"))
            except (OSError, ValueError):  # no such group, or "max"
                continue
            yield left + _stated(group / "memory.stat", reclaimed)
    yield float("inf")


def _groups(mount: Path, own: Path) -> Iterator[Path]:
    """Yield the folders of this process's groups, version 2 and 1, up to the root.

    In a container the paths may be the host's, and its own group is mounted as the root.
    """
    try:
        lines = own.read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    for top, controllers in ((mount, ""), (mount / "memory", "memory")):
        yield top
        for line in lines:
            _, names, path = line.split(":", 2)
            if controllers in names.split(","):
                steps = Path(path).parts[1:]
                yield from (top.joinpath(*steps[:n]) for n in range(1, len(steps) + 1))


def _stated(file: Path, name: str) -> float:
    """Return a number of a group's statistics; 0 if it is not there."""
    try:
        for line in file.read_text(encoding="ascii").splitlines():
            key, _, value = line.partition(" ")
            if key == name:
                return float(value)
    except (OSError, ValueError):
        pass
    return 0.0
