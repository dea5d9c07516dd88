"""One beat of a plane wave.

Velocities over one period of a travelling plane wave, dotted: their means. Panel a: the swimmer
advances along s almost evenly, with two ripples in each beat (solid), and sways across it once,
as fast as it advances (dashed). Panel b: the body turns to and fro about r, the normal of the
plane of the beat (dash-dotted). Panel c: the power of the motor, which ripples like the advance.
"""

import microswim as ms


def main():
    swimmer = ms.Swimmer.preset("tabak/plane_wave")
    gait = swimmer.gait()
    return {
        "mean forward velocity": gait.mean_velocity[0],
        "amplitude of the sway": gait.velocity_amplitude[1],
        "amplitude of the turning": gait.velocity_amplitude[5],
        "run": ms.io.dataset(swimmer, gait, periods=2),
    }


def figure(results):
    return ms.plots.velocity(results["run"])


if __name__ == "__main__":
    results = main()
    print(*(f"{k}: {v:.4g}" for k, v in results.items() if k != "run"), sep="\n")
    figure(results).savefig("one_period.svg")
