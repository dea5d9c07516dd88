"""The memory that a solve may take: the machine's, and that of the groups around the process."""

import numpy as np
import pytest

from microswim.errors import MachineError
from microswim.models import memory
from microswim.models.bem import system
from microswim.models.fem.stokes import Stokes


def group(folder, **files):
    folder.mkdir(parents=True, exist_ok=True)
    for name, number in files.items():
        (folder / name).write_text(f"{number}\n")


def test_the_group_of_a_container_counts_and_the_groups_above_it(tmp_path):
    """Version 2: each level may be the tightest; pages of files that nobody uses come back."""
    own = tmp_path / "own"
    own.write_text("0::/pod/box\n")
    mount = tmp_path / "cgroup"
    group(mount / "pod", **{"memory.max": 9000, "memory.current": 8500})
    group(mount / "pod/box", **{"memory.max": 3000, "memory.current": 1000})
    assert min(memory._free_of_groups(mount, own)) == 500
    (mount / "pod" / "memory.stat").write_text("anon 100\ninactive_file 4000\n")
    assert min(memory._free_of_groups(mount, own)) == 2000
    (mount / "pod/box" / "memory.max").write_text("max\n")
    assert min(memory._free_of_groups(mount, own)) == 4500


def test_a_group_of_the_first_version_counts(tmp_path):
    own = tmp_path / "own"
    own.write_text("5:cpu,memory:/job_7\n1:name=systemd:/\n")
    files = {"memory.limit_in_bytes": 700, "memory.usage_in_bytes": 300}
    group(tmp_path / "cgroup/memory/job_7", **files)
    assert min(memory._free_of_groups(tmp_path / "cgroup", own)) == 400


def test_where_there_are_no_groups_the_machine_decides(tmp_path, monkeypatch):
    assert min(memory._free_of_groups(tmp_path, tmp_path / "none")) == np.inf
    monkeypatch.setattr(memory, "_free_of_groups", lambda: iter([np.inf]))
    assert 1e8 < memory.available() < 1e14


def solve_by_boundary_elements():
    system.require_memory(10_000)


def solve_by_finite_elements():
    huge = Stokes.__new__(Stokes)
    huge.inverse, huge.order, huge.unknowns = None, 3, 100_000_000
    huge.factorise(1.0)


@pytest.mark.parametrize("solve", [solve_by_boundary_elements, solve_by_finite_elements])
def test_both_judges_ask_before_they_take(solve, monkeypatch):
    monkeypatch.setattr(memory, "_free_of_groups", lambda: iter([3e8]))
    words = r"unknowns need about .* GB of memory and 0.3 GB are free"
    with pytest.raises(MachineError, match=words):
        solve()
