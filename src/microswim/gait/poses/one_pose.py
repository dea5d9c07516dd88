"""What is said of a gait that holds at one pose, because a wall or a channel is fixed in its frame.

Its velocity is right at that pose. Along a path the wall would turn with the swimmer, where the
real one stays in the lab; so no path is followed.
"""

from __future__ import annotations

from microswim.errors import SpecError


def remark(boundary: str) -> str:
    """Return what an answer says, for ``"wall"`` or ``"channel"``."""
    return (
        f"holds at this pose of the {boundary}: no path is followed, along which the {boundary} "
        "would turn with the swimmer, so its speed, radius and pitch are left out; microswim path "
        "and ms.path follow it where that stays in the lab"
    )


def remark_turned(boundary: str) -> str:
    """Return what is said of a robot that a field turns, in place of `remark`."""
    return (
        f"holds for the side that is turned to the {boundary} now, as if the {boundary} turned "
        "with the robot: another side has another step-out and velocity, and what drives it "
        f"sideways along the {boundary} is left out; microswim path follows it where the "
        f"{boundary} stays"
    )


def refusal(boundary: str) -> SpecError:
    """Return the error of what would follow a path."""
    return SpecError(
        f"{boundary}: this gait holds at one pose, and along a path the {boundary} would turn with "
        f"the swimmer; take its velocity at that pose (mean_velocity), follow it with ms.path or "
        f"ms.Stepper.of, which know the gait at every pose, or leave [{boundary}] out"
    )
