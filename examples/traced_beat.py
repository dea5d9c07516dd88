"""A tail traced from a film.

Dots: a tail as somebody traced it, 26 points in each frame, with 80 nm of noise; every third frame
of one beat. Lines: the beat that is found from two hundred milliseconds of such frames, the
frequency and the number of modes with it. The film is planted, so that one sees what comes back.
The last line is the answer: how fast a head of 5 by 3 by 1 micrometres swims by that tail.
"""

import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

LENGTH, RATE, FRAMES = 50.0, 30.0, 250.0  # um, beats and frames per second


def traced():
    """Planted frames: times, arc length, positions with noise (um)."""
    s, t = np.linspace(0, LENGTH, 26), np.arange(50) / FRAMES
    angle = 0.9 * np.sin(2 * np.pi * (RATE * t[:, None] - 0.9 * s / LENGTH)) * np.sqrt(s / LENGTH)
    step = np.diff(s, prepend=0.0)
    random = np.random.default_rng(3)
    x, y = (np.cumsum(f(angle) * step, axis=1) for f in (np.cos, np.sin))
    return t, s, x + random.normal(0, 0.08, x.shape), y + random.normal(0, 0.08, y.shape)


def main():
    t, s, x, y = traced()
    rows = [f"{i},{s[j]},{x[i, j]},{y[i, j]}" for i in range(t.size) for j in range(s.size)]
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "beat.csv"
        table.write_text("frame,s (um),x (um),y (um)\n" + "\n".join(rows))
        beat = ms.read_waveform(table, fps=FRAMES)
    tail = beat.tail(radius=0.25e-6)
    shown = np.arange(0, round(FRAMES / RATE), 3)
    line = np.linspace(0, float(tail.apparent_length), 101)
    fits = [1e6 * tail.centreline(line, 2 * np.pi * beat.frequency * t[i])[0] for i in shown]
    head = ms.Ellipsoid(semi_axes=(2.5e-6, 1.5e-6, 0.5e-6))
    water = ms.Fluid(viscosity=1e-3, density=1e3)
    flat = ms.Motion(free=("us", "uq", "or"))
    cell = ms.Swimmer(body=head, tail=tail, fluid=water, motion=flat, units="SI")
    return {
        "traced": [(x[i], y[i]) for i in shown],
        "found": [(fit[:, 0], fit[:, 1]) for fit in fits],
        "beats per second": float(beat.frequency),
        "misfit (nm)": 1e9 * float(beat.misfit),
        "forward velocity (um/s)": -1e6 * float(cell.gait().mean_velocity[0]),
    }


def figure(results):
    fig = Figure(figsize=(7.2, 2.6), layout="constrained")
    axes = fig.subplots()
    colours = ["#0072B2", "#D55E00", "#009E73"]
    for colour, dots, line in zip(colours, results["traced"], results["found"]):
        axes.plot(*line, color=colour, lw=1.4)
        axes.plot(*dots, ".", color=colour, ms=4)
    axes.set(xlabel="along the head (µm)", ylabel="across (µm)", aspect="equal")
    return fig


if __name__ == "__main__":
    results = main()
    print("beats per second:", results["beats per second"])
    figure(results).savefig("traced_beat.svg")
