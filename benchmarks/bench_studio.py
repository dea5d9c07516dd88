"""The studio, measured in the server: slider to numbers, map, optimum, over the wire and without.

    python benchmarks/bench_studio.py

What must hold on two cores: new numbers within 50 ms of a slider's move, a new map within 300 ms.
The least and the median of many, warm; written to benchmarks/results/studio.json. "busy" is the
least processor time of both cores together, which a machine busy with other work does not change:
on two quiet cores an answer takes no longer than that.
"""

from __future__ import annotations

import os
import platform
import statistics
import sys
import time
import tomllib
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command does

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "studio"))

from clock import keep
from test_studio import call  # a request through the ASGI interface, JSON included

from microswim.models.rft.warm_up import warm_up
from microswim.spec import presets
from microswim.studio.app import create_app

WIDE = {
    "x": {"field": "tail.amplitude", "from": 0.01, "to": 0.2, "count": 72},
    "y": {"field": "tail.waves", "from": 0.5, "to": 8.0, "count": 54},
}
COARSE = {k: {**v, "count": n} for (k, v), n in zip(WIDE.items(), (48, 36))}  # as the page asks


def timed(app, path, bodies):
    """Milliseconds of each request, without the first, which may compile."""
    took, busy = [], []
    for body in bodies:
        start, work = time.perf_counter(), time.process_time()
        status, _, made = call(app, "POST", path, body)
        took.append(1e3 * (time.perf_counter() - start))
        busy.append(1e3 * (time.process_time() - work))
        assert status == 200, made
    found = {"least": min(took[1:]), "median": statistics.median(took[1:]), "busy": min(busy[1:])}
    return {name: round(value, 1) for name, value in found.items()}


def dragged(spec, n=40):
    """A slider under way: every request another design."""
    tail = spec["tail"]
    for i in range(n):
        yield {"tables": {**spec, "tail": {**tail, "ramp": 0.05 + 0.002 * i}}}


def main():
    warm_up()
    results = {}
    for name, axes in (("tabak/helix", WIDE), ("tabak/plane_wave", COARSE), ("goto/A", None)):
        spec = tomllib.loads(presets.read(name))
        app = create_app(spec, name, warm=False)
        results[name] = {"numbers": timed(app, "/api/solve", dragged(spec))}
        if axes:
            results[name]["map"] = timed(
                app, "/api/map", [{**b, **axes} for b in dragged(spec, 12)]
            )
            best = [{**b, **axes, "output": "efficiency"} for b in dragged(spec, 4)]
            results[name]["optimum"] = timed(app, "/api/optimum", best)
    print(f"{'milliseconds':24}{'':12}{'least':>9}{'median':>9}{'busy':>9}")
    for name, kinds in results.items():
        for kind, r in kinds.items():
            print(f"{name:24}{kind:12}{r['least']:9.1f}{r['median']:9.1f}{r['busy']:9.1f}")
    load = os.getloadavg()[0]
    print(f"load of the machine meanwhile: {load:.1f} on {os.cpu_count()} cores")
    facts = {"python": platform.python_version(), "cores": os.cpu_count(), "load": round(load, 1)}
    keep("studio", {"milliseconds": results, **facts})


if __name__ == "__main__":
    main()
