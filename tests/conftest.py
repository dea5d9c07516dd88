"""One process of the tests must not disturb the other.

Two processes that compile the same kernel for different types can overwrite each other's cache
files, so each worker has a cache of its own; and each worker has a core of its own.
"""

import os
from pathlib import Path

WORKER = os.environ.get("PYTEST_XDIST_WORKER")

if WORKER:
    CACHE = Path(__file__).parents[1] / ".numba_cache" / WORKER
    os.environ["NUMBA_CACHE_DIR"] = str(CACHE)
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
