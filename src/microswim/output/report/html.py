"""The report of a run: tables of numbers in readable units, and one self-contained HTML page.

Pictures are embedded, so the page is one file that can be sent around.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING, Any

from microswim import checks
from microswim.gait.gait import DEGREES_OF_FREEDOM
from microswim.gait.quantities import QUANTITIES
from microswim.gait.readable import EXPLAINED, percent, quantity, significant, with_error
from microswim.gait.screw import way_of
from microswim.gait.turning.driven import DRIVEN
from microswim.gait.units import unit
from microswim.output.report import bent, magnetic
from microswim.output.report.document import document
from microswim.output.report.document import table as document_table
from microswim.swimmer import physical_sense
from microswim.swimmer.geometry.tails.kinds import Tail
from microswim.swimmer.swimmer import Swimmer

if TYPE_CHECKING:
    import xarray as xr


@checks.by_name
@dataclass(frozen=True)
class Table:
    """A table for the terminal and for the page.

    Parameters
    ----------
    title
        What it shows.
    header
        Names of the columns; the first column holds names, the others numbers.
    rows
        Texts, one tuple per row.
    note
        Where the numbers come from, in a sentence or two.

    Examples
    --------
    >>> import microswim as ms
    >>> ms.report.Table("Speeds", ("", "u_s"), [("helix", "-0.037")]).rows[0]
    ('helix', '-0.037')
    """

    title: str
    header: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    note: str = ""


@checks.given(numbers=checks.mapping, name=checks.text)
def numbers_table(numbers: dict[str, Any], name: str) -> Table:
    """Return the numbers of a run in readable units.

    Parameters
    ----------
    numbers
        What `microswim.io.numbers` gives; with an ``expected_error`` the numbers carry it.
    name
        Name of the swimmer.

    Returns
    -------
    Table
        Quantity, value, and the same in other words.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("goto/C")
    >>> table = ms.report.numbers_table(ms.io.numbers(swimmer, swimmer.gait()), "goto/C")
    >>> table.rows[0][:2]
    ('swimming speed', '10.21 µm/s')
    """
    off = numbers.get("expected_error") or {}

    def q(value: float, kind: str, of: str = "") -> str:
        return with_error(value, off.get(of), unit(numbers["units"], kind))

    def row(name: str, told: str, of: str = "", symbol: str = "") -> tuple[str, str, str]:
        about = QUANTITIES[name]
        return about.label + symbol, q(numbers[name], about.dimension, of), told

    si = numbers["units"] == "SI"
    turns = f"{significant(numbers['body_turns_per_period'])} revolutions per period"
    hertz = f", {quantity(numbers['body_rate_hz'], 'Hz')}" if si else ""
    lengths = f"{significant(numbers['body_lengths_per_time'])} body lengths per {_time(si)}"
    u_s = q(numbers["mean_velocity"][0], "speed", "us")
    rows = [
        row("swimming_speed", lengths, "us"),
        *bent.rows(numbers, row, off),
        ("mean velocity u_s", u_s, way_of(numbers)),
        row("lateral_amplitude", "half of peak to peak", "uq", " u_q"),
        row("body_rate", turns + hertz, "os", " |Omega_s|"),
        row("path_radius", "of the body's centre about the screw axis"),
        row("path_pitch", "advance per turn of the period's screw"),
        row("frequency", "of the tail relative to the body"),
        row("mean_power", "mean over the period"),
        row("mean_torque", "mean over the period"),
        ("efficiency", f"{significant(100.0 * numbers['efficiency'], 3)} %", "Eq. (24)"),
    ]
    rows += [
        (
            driven.label,
            q(numbers[driven.name], driven.dimension),
            f"{driven.meaning}; microswim regimes",
        )
        for driven in DRIVEN.values()
        if driven.name in numbers
    ]
    if not any(numbers["mean_velocity"]) and not any(numbers["velocity_amplitude"]):
        force = q(numbers["held_wrench"][0], "force")
        rows.append(("force along s", force, "by the fluid on the held swimmer, mean; held_wrench"))
    if off:
        rows.append(("expected error of u_s", percent(off["us"]), str(off["how"])))
    note = f"{'SI units' if si else 'in the units of the spec'}; body frame"
    note += f"; {EXPLAINED}" if off else ""
    return Table(f"{name}, model {numbers['model']}", ("", "value", ""), rows, note)


def _time(si: bool) -> str:
    return "second" if si else "time"


@checks.given(swimmer=checks.swimmer)
def derived(swimmer: Swimmer) -> dict[str, Any]:
    """Return what a swimmer works out to, as numbers: wave, local resistance, Reynolds number.

    Examples
    --------
    >>> import microswim as ms
    >>> round(ms.report.derived(ms.Swimmer.preset("tabak/helix"))["alpha"], 4)
    0.7277
    """
    each = [_of_tail(swimmer, tail) for tail in swimmer.tail.each]
    return {
        "units": swimmer.units,
        "semi_axes": tuple(float(r) for r in swimmer.body.semi_axes3),
        **(each[0] if len(each) == 1 else {"tails": each}),
        "reynolds_number": physical_sense.reynolds(swimmer),
        "free": [n for n, free in zip(DEGREES_OF_FREEDOM, swimmer.motion.mask) if free],
        **magnetic.magnetic(swimmer),
    }


def _of_tail(swimmer: Swimmer, tail: Tail) -> dict[str, Any]:
    """Return what one tail works out to."""
    viscosity = swimmer.fluid.viscosity
    c_t, c_n, c_r = (float(c) for c in swimmer.coefficients.local(tail, viscosity))
    k = getattr(tail, "wavenumber", None)
    return {
        "apparent_length": float(tail.apparent_length),
        "arc_length": float(tail.arc_length),
        "alpha": float(tail.alpha),
        "number_of_waves": float(tail.number_of_waves),
        "wavenumber": None if k is None else float(k),
        "c_t": c_t,
        "c_n": c_n,
        "c_r": c_r,
        "tip": float(swimmer.coefficients.end(tail, viscosity)),
    }


@checks.given(swimmer=checks.swimmer)
def spec_table(swimmer: Swimmer) -> Table:
    """Return what a swimmer works out to, in readable units; the numbers are those of `derived`.

    Examples
    --------
    >>> import microswim as ms
    >>> table = ms.report.spec_table(ms.Swimmer.preset("tabak/helix"))
    >>> [row[1] for row in table.rows if row[0] == "alpha"]
    ['0.7277']
    """
    d, tail = derived(swimmer), swimmer.tail
    axes = " x ".join(quantity(r, unit(swimmer.units, "length")) for r in d["semi_axes"])
    body = f"semi-axes {axes}" if any(d["semi_axes"]) else "an isolated tail"
    if tail.is_absent:
        rows = [("body", swimmer.body.shape, body), ("tail", "none", "nothing propels it")]
        rows += [_motions(swimmer, d), *magnetic.rows(swimmer)]
        return Table("What the spec works out to", ("", "value", ""), rows, swimmer.units)
    tails = d.get("tails", [d])
    rows = [
        ("body", swimmer.body.shape, body),
        *(
            r
            for one, (n, t) in zip(tails, tail.named.items())
            for r in _tail_rows(swimmer, n, t, one)
        ),
        ("Reynolds number", significant(d["reynolds_number"], 3), "from body length and frequency"),
        _motions(swimmer, d),
        *magnetic.rows(swimmer),
    ]
    return Table("What the spec works out to", ("", "value", ""), rows, swimmer.units)


def _tail_rows(
    swimmer: Swimmer, name: str, tail: Tail, d: dict[str, Any]
) -> list[tuple[str, str, str]]:
    """Return the rows of one tail."""

    def q(key: str, kind: str) -> str:
        return quantity(d[key], unit(swimmer.units, kind))

    wave = []
    if d["wavenumber"] is not None:  # a tail of any shape has none
        wave = [("wavenumber k", q("wavenumber", "wavenumber"), "2 pi over wavelength")]
    motion = f"{tail.sections} sections, {tail.surface_motion} surface motion"
    return [
        (name, tail.kind, f"{motion} (for bem and fem)"),
        ("apparent length L", q("apparent_length", "length"), "along s"),
        ("arc length", q("arc_length", "length"), "along the filament, ramp left out"),
        ("alpha", significant(d["alpha"]), "apparent over arc length"),
        ("number of waves N", significant(d["number_of_waves"]), "L over wavelength"),
        *wave,
        ("c_t", q("c_t", "viscosity"), f"along the filament, law {swimmer.coefficients.law}"),
        ("c_n", q("c_n", "viscosity"), "across the filament"),
        ("c_r", q("c_r", "drag of spin"), "spin about itself"),
        ("tip", q("tip", "drag of a point"), "drag of the free end (tip = true)"),
    ]


def _motions(swimmer: Swimmer, d: dict[str, Any]) -> tuple[str, str, str]:
    frame = f"motor rate read in the {swimmer.motion.frequency_frame} frame"
    return "free motions", " ".join(d["free"]) or "none", "" if swimmer.tail.is_absent else frame


@checks.given(figure=partial(checks.instance, kind="Figure"))
def png(figure: Any) -> bytes:
    """Return a figure as PNG.

    Examples
    --------
    >>> import microswim as ms
    >>> from matplotlib.figure import Figure
    >>> ms.report.png(Figure(figsize=(1, 1)))[1:4]
    b'PNG'
    """
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=220)
    return buffer.getvalue()


@checks.given(run=checks.dataset, name=checks.text)
def page(
    run: xr.Dataset,
    name: str,
    tables: Sequence[Table],
    pictures: Sequence[tuple[str, bytes]],
    lead: str = "",
) -> str:
    """Return the report as one HTML page.

    Parameters
    ----------
    run
        Dataset of `microswim.io.dataset`: its attributes are the provenance.
    name
        Name of the swimmer, the title.
    tables
        The first stands beside the title, the others follow the pictures.
    pictures
        Caption and PNG of each.
    lead
        A sentence or two below the title.

    Returns
    -------
    str
        HTML without any reference to another file.

    Examples
    --------
    >>> import microswim as ms
    >>> swimmer = ms.Swimmer.preset("tabak/helix")
    >>> run = ms.io.dataset(swimmer, swimmer.gait(), periods=1)
    >>> table = ms.report.numbers_table(ms.io.numbers(swimmer, swimmer.gait()), "helix")
    >>> ms.report.page(run, "helix", [table], [])[:15]
    '<!doctype html>'
    """
    keys = ("microswim_version", "created", "model", "units", "periods")
    made = [(key.replace("_", " "), str(run.attrs[key])) for key in keys]
    first, *others = [_table(t) for t in tables]
    figures = [_figure(caption, data) for caption, data in pictures]
    style = files("microswim.output.report").joinpath("report.css").read_text(encoding="utf-8")
    spec = escape(run.attrs.get("spec", "").strip()) or "given in Python, without a spec file"
    parts = [
        f"<main><header><p>microswim report</p><h1>{escape(name)}</h1>{_paragraph(lead)}</header>",
        *(first, *figures, *others),
        f"<section><h2>Specification</h2><pre>{spec}</pre></section>",
        _table(Table("Provenance", ("", ""), made)),
        "</main>",
    ]
    return document(f"{name} swims", style, parts)


def _paragraph(text: str) -> str:
    return f'<p class="lead">{escape(text)}</p>' if text else ""


def _figure(caption: str, data: bytes) -> str:
    source = f"data:image/png;base64,{base64.b64encode(data).decode()}"
    shown = escape(caption)
    return f'<figure><img src="{source}" alt="{shown}"><figcaption>{shown}</figcaption></figure>'


def _table(table: Table) -> str:
    rows = []
    for first, *rest in table.rows:
        cells = "".join(f"<td>{_symbols(cell)}</td>" for cell in rest)
        rows.append(f'<tr><th scope="row">{_symbols(first)}</th>{cells}</tr>')
    note = f'<p class="note">{escape(table.note)}</p>' if table.note else ""
    body = document_table([_symbols(h) for h in table.header], rows)
    title = f"<h2>{escape(table.title)}</h2>"
    return f"<section>{title}{body}{note}</section>"


_SYMBOLS = ("u_s", "u_q", "u_r", "c_t", "c_n", "c_r", "Omega_s", "Omega_q", "Omega_r")


def _symbols(text: str) -> str:
    """Escaped text with the symbols of the field set as such."""
    out = escape(text)
    for symbol in _SYMBOLS:
        letter, index = symbol.split("_")
        letter = letter.replace("Omega", "&Omega;")
        out = out.replace(symbol, f"<i>{letter}<sub>{index}</sub></i>")
    return out.replace("alpha", "&alpha;").replace(" pi ", " &pi; ").replace(" x ", " &times; ")
