"""Made robots differ.

Four thousand robots printed from one drawing, each with its own small errors: 5 % in amplitude,
10 % in the thickness of the filament, 2 % in length. Bars: how many swim at which speed; orange:
slower than the 0.035 that was asked for. Dashed: the speed of the drawing. The yield stands
above.
"""

import microswim as ms
from microswim.output.plots import design as plots_design


def main():
    robot = ms.Swimmer.preset("tabak/helix-constant")
    made = ms.robustness(
        robot,
        {"tail.amplitude": "5%", "tail.radius": "10%", "tail.length": "2%"},
        subject_to="swimming_speed >= 0.035",
    )
    return {
        "yield": float(made.attrs["yield"]),
        "nominal speed": float(ms.screw(robot.gait()).speed),
        "made": made,
    }


def figure(results):
    return plots_design.robustness(results["made"], "swimming_speed", results["nominal speed"])


if __name__ == "__main__":
    results = main()
    print("yield:", results["yield"], "speed as designed:", results["nominal speed"])
    figure(results).savefig("made_robots_differ.svg")
