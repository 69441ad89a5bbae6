"""The rows of a bench as a person reads them in the terminal."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.effect_times import compact_number
from tests.fine_reference import Reference
from work_precision.measurement import Measurement, front

NARROW = ("", "point", "unknowns", "pose error", "IGM, µs", "Jacobian, µs", "cold, µs")
"""Columns that are always shown."""

COLUMNS = (
    "",
    "point",
    "modes",
    "intervals",
    "unknowns",
    "pose error",
    "position/ℓ",
    "rotation, rad",
    "base wrench",
    "operations",
    "build, s",
    "VM solve, µs",
    "IGM, µs",
    "Jacobian, µs",
    "warm, µs",
    "cold, µs",
)
"""All columns."""

WIDE = tuple(heading for heading in COLUMNS if heading != "pose error")
"""Columns where there is room: the pose error is the larger of two of them."""

ROOM = 178
"""Characters of a line that holds all columns."""


def print_bench(console: Console, title: str, reference: Reference, rows: Sequence[Measurement]) -> None:
    """The table with its front marked, the reference of the errors, and the reasons for missing rows."""
    console.print(f"[bold]{escape(title or 'Untitled scene')}[/]", highlight=False)
    columns = WIDE if console.width >= ROOM else NARROW
    console.print(_table(rows, columns))
    console.print("● on the front: nothing measured is both more exact and faster. Times are of compiled C.")
    console.print(f"Errors are against {escape(reference.method)}.", highlight=False)
    for row in rows:
        if row.note:
            note = escape(f"{row.name}: {row.note}")
            console.print(f"[dim]{note}[/]", highlight=False)


def print_strains(console: Console, model_distances: dict[str, float]) -> None:
    """How far richer strain models are from that of the scene."""
    for strain, distance in model_distances.items():
        sentence = f"The tip of the {strain} model is {distance:.1e} from that of the scene's strain model."
        console.print(sentence, highlight=False)


def _table(rows: Sequence[Measurement], columns: Sequence[str]) -> Table:
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in columns:
        is_text = heading in ("", "point", "modes")
        table.add_column(heading, justify="left" if is_text else "right", no_wrap=True)
    best = set(front(rows))
    for row in sorted(rows, key=_order):
        cells = _cells(row, row in best)
        shown = [cells[heading] for heading in columns]
        table.add_row(*shown, style="bold green" if row in best else "")
    return table


def _order(row: Measurement) -> tuple[str, bool, float]:
    """The scene's own strain model first, then the largest error; rows without error stand last."""
    unknown = not isfinite(row.pose_error)
    return row.strain, unknown, -row.pose_error


def _cells(row: Measurement, best: bool) -> dict[str, str]:
    """Cells by column."""
    operations = f"{row.jacobian_operations:,.0f}" if isfinite(row.jacobian_operations) else "–"
    cells = (
        "●" if best else "",
        escape(row.name),
        row.modes,
        row.intervals,
        str(row.unknowns),
        _power(row.pose_error),
        _power(row.position_error),
        _power(row.rotation_error),
        _power(row.wrench_error),
        operations,
        compact_number(row.build_s),
        compact_number(row.vm_cold_us),
        compact_number(row.igm_us),
        compact_number(row.jacobian_us),
        compact_number(row.warm_us),
        compact_number(row.cold_us),
    )
    return dict(zip(COLUMNS, cells, strict=True))


def _power(value: float) -> str:
    if not isfinite(value):
        return "–"
    return f"{value:.1e}"
