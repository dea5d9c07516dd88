"""One process of the tests must not disturb the other: each worker has a core of its own."""

import os

WORKER = os.environ.get("PYTEST_XDIST_WORKER")

if WORKER:
    for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[variable] = "1"
