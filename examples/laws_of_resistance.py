"""Three laws of local resistance.

Normal over tangential resistance of the filament, the number that lets a helix push at all (at 1
it would not). Solid: Lighthill's slender-body theory, which knows amplitude and wavelength;
dashed and dash-dotted: Gray & Hancock and Cox, which do not know the amplitude. Circle: the
constant pair that the paper took from its CFD at amplitude 0.1. The theories hold for thin
filaments; this one is thick.
"""

import numpy as np
from matplotlib.figure import Figure

import microswim as ms

LAWS = {"Lighthill": ms.Lighthill(), "Gray & Hancock": ms.GrayHancock(), "Cox": ms.Cox()}
STYLES = (("#0072B2", "-"), ("#D55E00", "--"), ("#009E73", "-."))


def main():
    robot = ms.Swimmer.preset("tabak/helix-constant")
    amplitude = np.linspace(0.01, 0.15, 29)
    tails = [robot.with_({"tail.amplitude": float(b)}).tail for b in amplitude]
    results = {"amplitude": amplitude}
    for name, law in LAWS.items():
        pairs = [law.local(tail, 100.0) for tail in tails]
        results[name] = np.array([float(c[1] / c[0]) for c in pairs])
    results["constant pair"] = 995.5 / 775.2
    results["ratio of Lighthill at 0.1"] = float(np.interp(0.1, amplitude, results["Lighthill"]))
    return results


def figure(results):
    fig = Figure(figsize=(7.2, 3.0), layout="constrained")
    axes = fig.subplots()
    for name, (colour, style) in zip(LAWS, STYLES):
        axes.plot(results["amplitude"], results[name], color=colour, ls=style, label=name)
    axes.plot(0.1, results["constant pair"], "o", mfc="none", mec="#222222", label="CFD, paper")
    axes.set(xlabel="amplitude of the helix (body diameters)", ylabel="$c_n / c_t$")
    axes.legend(frameon=False)
    return fig


if __name__ == "__main__":
    results = main()
    print("c_n / c_t, Lighthill, amplitude 0.1:", results["ratio of Lighthill at 0.1"])
    figure(results).savefig("laws_of_resistance.svg")
