"""What ``microswim design`` says in a terminal: numbers in units that people read."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from microswim.studies.optimisation.limits import for_people, limit_said

SHOWN = ("swimming_speed", "mean_torque", "mean_power", "efficiency", "body_rate")
ROWS = 15  #: of a front
FLAT = 1e-5  #: per cent per per cent that a search leaves at an optimum


class Said:
    """Numbers of a design in the units of its swimmer.

    Parameters
    ----------
    units
        ``"SI"`` or ``"dimensionless"``.
    """

    def __init__(self, units: str) -> None:
        self.units = units

    def __call__(self, name: str, value: Any) -> str:
        """A number of the spec, a quantity or an expression; nothing where there is none."""
        if value is None or isinstance(value, str):
            return value or ""
        return for_people(name, value, self.units)

    def limit(self, text: str) -> str:
        """Return a constraint, its number with the unit."""
        return limit_said(text, self.units)


def show(report: dict[str, Any], units: str) -> None:
    """Print a front, or an optimum and what there is to know about it."""
    console, said = Console(soft_wrap=True), Said(units)
    if "front" in report:
        _front(report, said, console)
        return
    wish, _, objective = report["objective"].partition(" ")
    console.print(f"{wish} {objective}: {said(objective, report['value'])}")
    table = Table("", "optimum", "% per %", "at bound", "± for 1 % loss")
    for name, s in report["sensitivity"].items():
        if s["varied"]:
            place, room = said(name, s["value"]), said(name, s["one_percent_range"])
            table.add_row(name, place, _slope(s["elasticity"]), s["bound"] or "", room)
    console.print(table)
    for name, value in report["values"].items():
        if isinstance(value, str):
            console.print(f"{name} = {value}")
    for line in (*_held(report), *_margins(report, said)):
        console.print(line)
    numbers = report["quantities"]
    console.print(", ".join(f"{k} {said(k, numbers.get(k))}" for k in SHOWN))
    for line in _notes(report, said, objective):
        console.print(line)


def _front(report: dict[str, Any], said: Said, console: Console) -> None:
    from microswim.gait.readable import percent

    names = [text.split(" ", 1)[1] for text in report["objectives"]]
    shown = [*names, *(k for k in report["front"] if "." in k)]
    table = Table(*shown, title=", ".join(report["objectives"]))
    n = len(report["front"][shown[0]])
    for i in sorted(
        {round(j * (n - 1) / (ROWS - 1)) for j in range(ROWS)} if n > ROWS else range(n)
    ):
        table.add_row(*(said(k, report["front"][k][i]) for k in shown))
    console.print(table)
    console.print(f"{n} designs; --json or --out has them all")
    off = [e for e in report["front"].get("expected_error", ()) if e is not None and e == e]
    if off:
        console.print(f"expected error of u_s {percent(min(off))[:-2]} to {percent(max(off))}")


def _slope(value: float) -> str:
    """Per cent per per cent; at an optimum it is zero, to the search's tolerance."""
    return "0" if abs(value) < FLAT else f"{value:.4g}"


def _held(report: dict[str, Any]) -> list[str]:
    """The numbers that did not vary: those that one can build, then the factors of a fit."""
    all_ = report["sensitivity"].items()
    held = {k: s["elasticity"] for k, s in all_ if not s["varied"] and s["elasticity"]}
    fitted = {k: v for k, v in held.items() if k.startswith("interaction.")}
    built = {k: v for k, v in held.items() if k not in fitted}
    return [
        f"{what}, % per %: " + ", ".join(f"{k} {_slope(v)}" for k, v in list(some.items())[:most])
        for what, some, most in (("held", built, 5), ("fitted", fitted, 3))
        if some
    ]


def _margins(report: dict[str, Any], said: Said) -> list[str]:
    return [
        f"{said.limit(text)}: {'active' if abs(margin or 0) < 1e-5 else f'margin {margin:.0%}'}"
        for text, margin in report["margins"].items()
    ]


def _notes(report: dict[str, Any], said: Said, objective: str) -> list[str]:
    from microswim.gait.readable import EXPLAINED, percent

    lines = []
    if report["inside_calibrated_neighbourhood"] is None:
        error = report["expected_error"]
        off = "not known" if error is None else f"± {percent(error)}"
        lines.append(
            f"model {report['model']}, error of u_s {off}: {report['remarks'][0]}; {EXPLAINED}"
        )
        lines += report["remarks"][1:]
    elif report["inside_calibrated_neighbourhood"]:
        lines.append(f"calibrated here, expected error {percent(report['expected_error'] or 0.0)}")
    else:
        lines.append("outside the calibrated neighbourhood: expect larger errors")
    for i, r in enumerate(report["verification"], 1):
        if "miss" in r:
            ours, theirs = (said(objective, r[who]) for who in ("surrogate", "reference"))
            lines.append(
                f"round {i}: {ours} by the surrogate, {theirs} by {r['model']}, "
                f"{100 * r['miss']:.1f} % off{', agreed' if r['agreed'] else ''}"
            )
    if "yield" in report:
        lines.append(f"yield {100 * report['yield']:.1f} ± {100 * report['yield_error']:.1f} %")
        shares = sorted(report["sobol_indices"].items(), key=lambda item: -item[1]["total"])
        blame = ", ".join(f"{k} {v['total']:.0%}" for k, v in shares)
        lines.append(f"spread caused by: {blame}")
    return lines
