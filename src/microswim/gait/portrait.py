"""How things are printed: a title and about five lines that a person can read, with units."""

from __future__ import annotations

from abc import ABC, abstractmethod
from html import escape
from typing import Any

import numpy as np

from microswim.errors import MicroswimError
from microswim.gait.readable import quantity, significant
from microswim.gait.units import unit

Rows = list[tuple[str, str]]
NOISE = 1e-12  #: of the largest component; below it a velocity is rounding


def as_text(title: str, rows: Rows) -> str:
    """Return a title and aligned rows as text.

    Examples
    --------
    >>> print(as_text("Gait", [("speed", "1 m/s"), ("rate", "2 rad/s")]))
    Gait
      speed  1 m/s
      rate   2 rad/s
    """
    width = max(len(name) for name, _ in rows)
    return "\n".join([title, *(f"  {name:<{width}}  {text}" for name, text in rows)])


def as_html(title: str, rows: Rows) -> str:
    """Return a title and rows as a table for a notebook."""
    style = ' style="text-align:left"'
    cells = (
        f"<tr><th{style}>{escape(name)}</th><td{style}>{escape(text)}</td></tr>"
        for name, text in rows
    )
    return f"<table><caption>{escape(title)}</caption>{''.join(cells)}</table>"


class Printed(ABC):
    """What prints as a title and about five lines, in a notebook as a table."""

    @abstractmethod
    def _portrait(self) -> tuple[str, Rows]:
        """Return the title, and a row for each line."""

    def __repr__(self) -> str:
        """Return a title and about five lines with units."""
        return as_text(*self._portrait())

    def _repr_html_(self) -> str:
        return as_html(*self._portrait())


def of_gait(gait: Any) -> tuple[str, Rows]:
    """Return title and rows of a gait: what moves, how fast, at what cost."""
    free = "all velocities free" if all(gait.free) else f"{sum(gait.free)} of 6 velocities free"
    title = f"Gait by {gait.model}, {gait.units}, {free}"
    try:
        return title, [*_numbers(gait), *_trust(gait)]
    except MicroswimError as error:
        return title, [("moves", f"not: {error}")]


def _trust(gait: Any) -> Rows:
    """Where its coefficients come from, and who says how wrong its numbers may be."""
    names = ("calibrated", "but")
    said = zip(names, gait.info.get("calibration", ()))
    origin = [(name, line.removeprefix("calibrated ")) for name, line in said]
    return [*origin, ("wrong by", "ms.expected_error(swimmer, gait) tells")]


def _numbers(gait: Any) -> Rows:
    mean, size = _clean(gait.mean_velocity), _clean(gait.velocity_amplitude)
    power, rate = np.real(gait.mean_power), np.real(gait.rate)

    def q(value: Any, kind: str) -> str:
        return quantity(np.real(value), unit(gait.units, kind))

    turn = f", {significant(mean[3] / abs(rate))} turns per period" if rate else ""
    rows = [
        ("forward", f"{q(-mean[0], 'speed')} (u_s = {q(mean[0], 'speed')})"),
        ("sideways", f"{q(size[1], 'speed')} along q, {q(size[2], 'speed')} along r (amplitudes)"),
        ("body", f"turns at {q(mean[3], 'rate')} about s{turn}"),
        (
            "motor",
            f"frequency {q(rate / (2.0 * np.pi), 'frequency')}, power {q(power, 'power')}, "
            f"torque {q(gait.mean_torque, 'torque')}",
        ),
    ]
    if gait.body_resistance_series is not None:
        rows.append(("efficiency", f"{significant(100.0 * np.real(gait.efficiency), 3)} %"))
    return rows


def _clean(twist: Any) -> np.ndarray:
    """Return the real twist without what is rounding beside its largest component."""
    twist = np.real(twist).reshape(2, 3)
    largest = np.abs(twist).max(axis=1, keepdims=True)
    return np.where(np.abs(twist) > NOISE * largest, twist, 0.0).ravel()
