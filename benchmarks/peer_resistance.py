"""The resistance of a rigid robot by MIME's boundary elements, or by PyGRPY's beads.

    PYTHON_WITH_THE_PEER benchmarks/peer_resistance.py FILE.npz

For bench_bem.py, by another interpreter, one with an environment of its own. The file holds
``points``, ``weights``, ``normals`` of a surface for MIME, or ``centres`` and ``radii`` of beads
for PyGRPY; viscosity one, about the origin. Prints R and the processor seconds of a second call.
"""

import json
import os
import sys
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"

import numpy as np


def by_mime(given):
    """Regularised Stokeslets at the points, a width of half their distance."""
    import jax

    jax.config.update("jax_enable_x64", True)
    from mime.nodes.environment.stokeslet.resistance import compute_resistance_matrix

    width = 0.5 * float(np.sqrt(np.median(given["weights"])))
    x, w, n = (jax.numpy.asarray(given[name]) for name in ("points", "weights", "normals"))
    found = compute_resistance_matrix(x, w, jax.numpy.zeros(3), width, 1.0, n, use_dlp=False)
    return np.asarray(found)


def by_beads(given):
    """Rotne, Prager and Yamakawa's tensors of beads that may overlap."""
    from pygrpy.grpy_tensors import conglomerateMobilityMatrix

    return np.linalg.inv(conglomerateMobilityMatrix(given["centres"], given["radii"]))


def main():
    given = dict(np.load(sys.argv[1]))
    solve = by_beads if "radii" in given else by_mime
    solve(given)  # may compile
    start = time.process_time()
    R = solve(given)
    print(json.dumps({"R": R.tolist(), "seconds": time.process_time() - start}))


if __name__ == "__main__":
    main()
