"""What `microswim path` tells of a path: numbers, and a table of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from microswim.cli._options import Given

if TYPE_CHECKING:
    import xarray as xr

    from microswim.output.report.html import Table

UNJUDGED = "not measured for a tail followed in time; its drag is local"
_LINEAR, _ANGULAR = ("us", "uq", "ur"), ("os", "oq", "or")
BY_TORQUE = "not measured for motors that give a torque; every tail drags as if alone"


def report(
    given: Given, solved: dict[str, Any], found: xr.Dataset, seconds: float
) -> dict[str, Any]:
    """Return what is told of a path, as `--json` prints it."""
    import numpy as np

    from microswim.calibration.atlas.expected import expected_error
    from microswim.gait.gait import DEGREES_OF_FREEDOM
    from microswim.path.by_torque import by_motor
    from microswim.path.loads import left_out

    poses = solved.get("poses")
    gait = solved.get("gait") if poses is None else poses.gait
    many = "path" in found.dims
    x, q = found.position.values, found.quaternion.values
    ends = x[:, -1] if many else x[-1:]
    about = found.attrs
    said = {
        "swimmer": given.name,
        "model": about["model"],
        "boundary": _boundary(given.swimmer),
        "units": about["units"],
        "time": float(found.time[-1]),
        "position": ends.mean(axis=0),
        "quaternion": None if many else q[-1],
        "outcome": about["outcome"],
        "circle_radius": about["circle_radius"],
        "circle_sense": about["circle_sense"] or None,
        "gap_mean": about["gap_mean"],
        "drift": (ends.mean(axis=0) - (x[0, 0] if many else x[0])) / float(found.time[-1]),
    }
    if "repeats_after" in about:
        said["repeats_after"] = int(about["repeats_after"])
    if many:
        moved = ends - x[:, 0]
        said["paths"] = len(ends)
        said["mean_square_displacement"] = float((moved**2).sum(axis=1).mean())
        said["covariance"] = np.cov(moved.T)
    if "motor_work" in found:
        said["motor_work"] = float(found.motor_work[-1])
    if "dissipated" in found:
        said["dissipated"] = float(found.dissipated[-1])
    if "tail" in found.dims:
        said |= by_motor(found)
    if gait is not None:
        velocity = expected_error(given.swimmer, gait)
    elif "velocity_error" in about:
        each = dict(zip(DEGREES_OF_FREEDOM, about["velocity_error"], strict=True))
        velocity = each | {"rates": about["rate_error"], "how": about["how"]}
    else:
        how = UNJUDGED if given.swimmer.motor is None else BY_TORQUE
        velocity = dict.fromkeys(DEGREES_OF_FREEDOM) | {"how": how}
    position = about["position_error"]
    return said | {
        "expected_error": {
            "position": position,
            "velocity": velocity,
            "poses": None if poses is None else poses.expected_error,
            "how": "position: of the time steps alone, against looser ones; velocity: of the model",
        },
        "steps": about.get("steps"),
        "remarks": left_out(given.swimmer),
        "wall_seconds": seconds,
    }


def _boundary(swimmer: Any) -> str | None:
    if swimmer.channel is not None:
        return "channel"
    return None if swimmer.wall is None else "wall"


def _of_hooks(report: dict[str, Any]) -> list[tuple[str, str]]:
    """Return rows of hooks that bend, in degrees, if there are any."""
    import numpy as np

    if "hook_bend" not in report:
        return []
    degrees = [f"{np.degrees(x):.3g}" for x in (*report["hook_bend"], report["largest_hook_bend"])]
    rows = [("hooks bent by, at the end", ", ".join(degrees[:-1]) + f" deg; at most {degrees[-1]}")]
    if len(degrees) > 2:
        rows.append(("widest angle of two tails", f"{np.degrees(report['widest_angle']):.3g} deg"))
    return rows


def _between(poses: dict[str, Any] | None) -> str:
    """Return how well poses that were not solved are met, in words."""
    from microswim.gait.readable import percent

    if not poses:
        return ""
    most = max(poses[name] for name in _LINEAR)
    return f"between the poses solved velocities within {percent(most)} of the speed (95 %)"


def table(who: str, report: dict[str, Any]) -> Table:
    """Return the same as a table."""
    from microswim.gait.readable import EXPLAINED, but_rounding, percent, quantity, significant
    from microswim.gait.units import unit
    from microswim.output.report.html import Table
    from microswim.path.repeating import words

    units = report["units"]

    def q(value: float, kind: str) -> str:
        return quantity(value, unit(units, kind))

    length = [q(value, "length") for value in but_rounding(report["position"])]
    rows = [("at the end, x, y, z" if "paths" not in report else "mean end", ", ".join(length))]
    rows.append(("drift, x, y, z", ", ".join(q(v, "speed") for v in but_rounding(report["drift"]))))
    if "paths" in report:
        spread = report["mean_square_displacement"] ** 0.5
        rows.append(("root mean square displacement", q(spread, "length")))
    else:
        rows.append(("outcome", report["outcome"]))
    seen = "+x" if report["boundary"] == "channel" else "above"
    if report["circle_sense"]:
        circle = f"{q(report['circle_radius'], 'length')}, {report['circle_sense']} from {seen}"
        rows.append(("radius of its circle", circle))
    if "repeats_after" in report:
        rows.append(("shape repeats after", words(report["repeats_after"])))
    if report["gap_mean"] == report["gap_mean"]:
        rows.append(("mean gap", q(report["gap_mean"], "length")))
    if "motor_work" in report:
        rows.append(("work of the motor", q(report["motor_work"], "work")))
    off = report["expected_error"]
    error, of_speed = off["position"], off["velocity"]["us"]
    model = (
        f"u_s of model {report['model']} within {percent(of_speed)}, {EXPLAINED}"
        if of_speed
        else ""
    )
    if "motor_frequency" in report:
        model = f"how wrong the model may be is {BY_TORQUE}"
        if "rates" in off["velocity"]:
            most = [max(off["velocity"][k] for k in names) for names in (_LINEAR, _ANGULAR)]
            shares = [percent(x) for x in (*most, max(off["velocity"]["rates"]))]
            model = f"velocity within {shares[0]}, turning {shares[1]}, motors' rates {shares[2]}"
        turns = [q(f, "frequency") for f in report["motor_frequency"]]
        rows.append(("motors turn at, on average", ", ".join(turns)))
        if len(turns) > 1:
            late = [f"{value:.4g} rad" for value in report["phase_difference"][1:]]
            rows.append(("phases against the first, at the end", ", ".join(late)))
    rows += _of_hooks(report)
    known = f"end within {q(error, 'length')} by the time steps" if error == error else ""
    note = "; ".join(part for part in (known, _between(off["poses"]), model) if part)
    steps = "" if report["steps"] is None else f", {report['steps']:,} steps"
    title = f"{who}: path over {q(report['time'], 'time')}{steps}"
    note = f"{note}; {significant(report['wall_seconds'], 2)} s".lstrip("; ")
    return Table(title, ("", ""), rows, note)
