"""Loops on one core and on all: the same numbers, one at a time."""

import os
import subprocess
import sys

import numpy as np

from microswim.control import motion
from microswim.numerics.compiling.cores import MANY

THREADS = """
from concurrent.futures import ThreadPoolExecutor
import numpy as np, microswim as ms
one = ms.Stepper(ms.Swimmer.preset("tabak/helix").gait())
many = ms.State.at(np.zeros((400, 3)))
def run(i):
    own = ms.Stepper(one.gait)
    return own.step(many, dt=0.1 + 0.01 * i).values
with ThreadPoolExecutor(4) as pool:
    found = list(pool.map(run, range(12)))
print(all((run(i) == found[i]).all() for i in range(12)))
"""


def test_few_cases_wake_no_threads():
    assert motion.advance_all.over(1) is motion.advance_all.alone
    assert motion.advance_all.over(MANY) is not motion.advance_all.alone


def test_one_core_and_all_of_them_give_the_same():
    rng = np.random.default_rng(0)
    tables = rng.normal(size=(3, 27)), rng.normal(size=(3, 36)), np.ones(12), np.ones(6)
    Y, U = rng.normal(size=(MANY, 8)), rng.normal(size=(MANY, motion.INPUT)) / 10.0
    Y[:, 3:7] /= np.linalg.norm(Y[:, 3:7], axis=1)[:, None]
    ends = []
    for run in (motion.advance_all.alone, motion.advance_all.parallel):
        ends.append(Y.copy())
        run(*tables, ends[-1], U, 0.1, 2, np.empty((8, motion.WORK)))
    assert np.isfinite(ends[0]).all()
    assert (ends[0] == ends[1]).all()


def test_threads_take_turns():
    """Numba's plainest layer of threads aborts the process if two loops run at once."""
    done = subprocess.run(
        [sys.executable, "-c", THREADS],
        env={**os.environ, "NUMBA_THREADING_LAYER": "workqueue"},
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
    )
    assert done.stdout.split() == ["True"], done.stderr[-500:]
