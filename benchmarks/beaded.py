"""Gaits of swimmers that are made of beads, by a method that shares nothing with the package.

A sphere of beads on a shell and a planar wave of beads are held together: forces on the beads are
those of the mobility of equal spheres [Rotne and Prager 1969, Yamakawa 1970], beads that overlap
included. Of the package only what a gait looks like is used.

    python benchmarks/beaded.py      (a wave of beads beside boundary elements)
"""

from __future__ import annotations

import numpy as np

import microswim as ms

PHASES = 16
SHELL = 200  #: beads of the body


def mobility(x: np.ndarray, a: float) -> np.ndarray:
    """Return the mobility of equal spheres at x (n, 3), radius a, viscosity one: (3 n, 3 n)."""
    d = x[:, None] - x[None]
    r = np.linalg.norm(d, axis=-1)
    np.fill_diagonal(r, 1.0)
    outer = d[..., :, None] * d[..., None, :] / (r**2)[..., None, None]
    far = (1.0 + 2.0 * a**2 / (3.0 * r**2), 1.0 - 2.0 * a**2 / r**2)
    near = (
        8.0 * r / (6.0 * a) * (1.0 - 9.0 * r / (32.0 * a)),
        8.0 * r / (6.0 * a) * 3.0 * r / (32.0 * a),
    )
    even, along = (np.where(r > 2.0 * a, *pair) / (8.0 * np.pi * r) for pair in zip(far, near))
    np.fill_diagonal(even, 1.0 / (6.0 * np.pi * a))
    np.fill_diagonal(along, 0.0)
    M = even[..., None, None] * np.eye(3) + along[..., None, None] * outer
    return M.transpose(0, 2, 1, 3).reshape(3 * len(x), 3 * len(x))


def rigid(x: np.ndarray) -> np.ndarray:
    """Return velocities of points by those of a body, (3 n, 6)."""
    turn = np.cross(np.eye(3)[None], x[:, None]).transpose(0, 2, 1)
    return np.concatenate([np.tile(np.eye(3), (len(x), 1, 1)), turn], axis=2).reshape(-1, 6)


def shell(radius: float, a: float) -> np.ndarray:
    """Return beads on a sphere whose drag is that of a sphere of a radius."""
    k = np.arange(SHELL) + 0.5
    polar, turn = np.arccos(1.0 - 2.0 * k / SHELL), np.pi * (1.0 + 5.0**0.5) * k
    x = np.stack([np.cos(polar), np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn)], -1)
    size = radius
    for _ in range(20):
        K = rigid(size * x)
        drag = (K.T @ np.linalg.solve(mobility(size * x, a), K))[0, 0] / (6.0 * np.pi)
        size *= radius / drag
    return size * x


def beaded(swimmer: ms.Swimmer) -> ms.Gait:
    """Return the gait of a sphere with a planar wave of beads, those of the tail moved across."""
    own = swimmer.numbers
    length, b, a, R = (own[f"{k}"] for k in
                       ("tail.length", "tail.amplitude", "tail.radius", "body.radius"))  # fmt: skip
    k, ramp = 2.0 * np.pi * own["tail.waves"] / length, own["tail.ramp"] * length
    fine = np.linspace(0.0, length, 4001)
    slope = np.gradient(b * np.minimum(fine / ramp, 1.0) * np.cos(k * fine), fine)
    arc = np.concatenate([[0.0], np.cumsum(np.sqrt(1.0 + slope[1:] ** 2) * (fine[1] - fine[0]))])
    count = int(np.ceil(arc[-1] / (2.0 * a)))
    s = np.interp(arc[-1] * (np.arange(count) + 0.5) / count, arc, fine)
    body, size = shell(R, a), b * np.minimum(s / ramp, 1.0)
    rows = []
    for phase in 2.0 * np.pi * np.arange(PHASES) / PHASES:
        tail = np.stack([R + s, size * np.cos(k * s - phase), 0.0 * s], axis=-1)
        u = np.zeros((SHELL + count, 3))
        u[SHELL:, 1] = size * np.sin(k * s - phase)
        x = np.concatenate([body, tail])
        K, M = rigid(x), own["fluid.viscosity"] ** -1 * mobility(x, a)
        held, moved = np.linalg.solve(M, K), np.linalg.solve(M, u.ravel())
        rows.append((K.T @ held, K.T @ moved, u.ravel() @ moved))
    R6, F, G = (np.array(column) for column in zip(*rows))
    rate = 2.0 * np.pi * own["tail.frequency"]
    return ms.Gait.from_samples(R6, F, G, rate=rate, model="beads")


def main() -> None:
    """Print how far beads are from boundary elements of tails of the same radius."""
    for amplitude, waves in ((0.1, 3.0), (0.2, 1.5), (0.06, 2.0)):
        swimmer = ms.Swimmer.preset("tabak/plane_wave").with_(
            {"tail.amplitude": amplitude, "tail.waves": waves}
        )
        rows = []
        for gait in (beaded(swimmer), swimmer.gait("bem", level="coarse"), swimmer.gait("rft")):
            rows.append([gait.mean_velocity[0], *gait.velocity_amplitude[[1, 5]]])
        print(amplitude, waves, np.round(rows, 5).tolist())


if __name__ == "__main__":
    main()
