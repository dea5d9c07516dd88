"""Numbers that hang on the last bits hold on other processors than the one that runs the tests,
whose workers have one thread each.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from threadpoolctl import threadpool_info

ROOT = Path(__file__).parents[1]
SENSITIVE = [
    "tests/calibration/region/test_region.py",
    "-k",
    "last_bit or doubt_of_one or left_out",
]


@pytest.mark.slow
def test_last_bits_hold_without_the_lanes_of_this_processor():
    """Compiled code and BLAS as on a processor with AVX2 alone."""
    other = {"NUMBA_CPU_NAME": "haswell", "OPENBLAS_CORETYPE": "Haswell"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *SENSITIVE]
    run = subprocess.run(
        command, cwd=ROOT, env=os.environ | other, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_a_worker_of_the_tests_has_one_thread():
    """Two for a solve of 300 unknowns on two busy cores take forty times as long as one."""
    threads = {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}
    assert threads == {1} or "PYTEST_XDIST_WORKER" not in os.environ
