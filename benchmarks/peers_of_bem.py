"""One resistance matrix of the base case by MIME and PyGRPY, each in an environment of its own.

Both are asked by other interpreters (`peer_resistance.py`): MIME for points spread evenly over the
surface, PyGRPY for beads along the filament and one for the body. The error is the largest of an
entry of R over ``sqrt(R_ii R_jj)``, against our level fine.
"""

from __future__ import annotations

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from clock import timed

from microswim.models.swimmer_surface import smooth_centreline, tube_point

SPACINGS = (0.078, 0.052, 0.04)  #: of MIME's points; the filament is 0.1 thick
GAPS = (2.0, 1.0, 0.5)  #: between beads, in their radii
ASK = Path(__file__).with_name("peer_resistance.py")


def resistance(one, **options):
    """R at viscosity one, about the body's centre."""
    return np.real(one.gait(model="bem", **options).resistance(0.0)) / one.fluid.viscosity


def along(tail, spacing):
    """Places s that are evenly spaced along the filament, its length, and the sphere's side."""
    s = np.linspace(0.0, tail.length, 4000)
    arc = np.linalg.norm(np.diff(smooth_centreline(tail, s).P, axis=0), axis=1).cumsum()
    count = round(arc[-1] / spacing)
    return np.interp((np.arange(count) + 0.5) / count * arc[-1], [0.0, *arc], s), arc[-1]


def points(one, h):
    """Points, areas and normals of sphere and tube, h apart; what lies in the sphere left out."""
    a, tail = float(one.body.semi_axes3[0]), one.tail
    n = round(4.0 * np.pi * (a / h) ** 2)
    z, turn = 1.0 - (2.0 * np.arange(n) + 1.0) / n, np.pi * (1.0 + 5.0**0.5) * np.arange(n)
    flat = np.sqrt(1.0 - z * z)
    ball = np.stack([z, flat * np.cos(turn), flat * np.sin(turn)], axis=-1)
    s, length = along(tail, h)
    angle = 2.0 * np.pi * np.arange(max(4, round(2.0 * np.pi * tail.radius / h)))
    angle = angle / len(angle)
    x = tube_point(tail, s[:, None], angle) + [a, 0.0, 0.0]
    out = x - (smooth_centreline(tail, s).P + [a, 0.0, 0.0])[:, None]
    x, out = x.reshape(-1, 3), out.reshape(-1, 3) / tail.radius
    outside = np.linalg.norm(x, axis=1) > a
    area = np.full(len(x), 2.0 * np.pi * tail.radius * length / len(x))[outside]
    return {
        "points": np.concatenate([a * ball, x[outside]]),
        "normals": np.concatenate([ball, out[outside]]),
        "weights": np.concatenate([np.full(n, 4.0 * np.pi * a * a / n), area]),
    }


def beads(one, gap):
    """A bead for the body and beads of the filament's radius along it."""
    a, tail = float(one.body.semi_axes3[0]), one.tail
    x = smooth_centreline(tail, along(tail, gap * tail.radius)[0]).P + [a, 0.0, 0.0]
    radii = np.append(a, np.full(len(x), tail.radius))
    return {"centres": np.concatenate([np.zeros((1, 3)), x]), "radii": radii}


def asked(python, given):
    """R and seconds of a peer."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "given.npz"
        np.savez(path, **given)
        run = subprocess.run([python, str(ASK), str(path)], capture_output=True, text=True)
    if run.returncode:
        raise SystemExit(f"{python}: {run.stderr}")
    told = json.loads(run.stdout.splitlines()[-1])
    return np.array(told["R"]), told["seconds"]


def rows(one, mime, pygrpy):
    """Method, unknowns, seconds and largest error (%) of R: ours and theirs."""
    truth = resistance(one, level="fine")
    size = np.sqrt(np.outer(np.diag(truth), np.diag(truth)))
    found = []

    def note(method, unknowns, seconds, R):
        off = float(100.0 * np.abs((R - truth) / size).max())
        print(f"{method}: {unknowns} unknowns, {seconds:.3f} s, R off by {off:.2g} %", flush=True)
        found.append([method, unknowns, seconds, off])

    for level in ("coarse", "standard"):
        seconds, gait = timed(lambda name=level: one.gait(model="bem", level=name), 5)
        R = np.real(gait.resistance(0.0)) / one.fluid.viscosity
        note(f"boundary elements, {level}", gait.info["unknowns"], seconds, R)
    for h in SPACINGS:
        given = points(one, h)
        R, seconds = asked(mime, given)
        note("MIME", 3 * len(given["points"]), seconds, R)
    for gap in GAPS:
        given = beads(one, gap)
        R, seconds = asked(pygrpy, given)
        note("PyGRPY beads", 6 * len(given["radii"]), seconds, R)
    return found
