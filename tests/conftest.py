"""One process of the tests must not disturb the other, and on CI nothing is left out.

Each worker has a core of its own. Where ``CI`` is set, what a test needs has to be there: a test
that would be skipped for want of NGSolve, PyVista or a Chromium fails instead.
"""

import os

import pytest
from threadpoolctl import threadpool_limits

WORKER = os.environ.get("PYTEST_XDIST_WORKER")
CI = os.environ.get("CI", "").lower() not in ("", "0", "false")

if WORKER:
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
    threadpool_limits(1)  # a plugin has loaded NumPy by now, which reads no variable any more


def _not_left_out(report):
    if CI and report.skipped and not hasattr(report, "wasxfail"):
        why = report.longrepr[-1] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"{report.nodeid}: on CI no test is left out ({why})"
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """A module that skips itself."""
    return _not_left_out((yield))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item, call):
    """A test or a fixture that skips."""
    return _not_left_out((yield))
