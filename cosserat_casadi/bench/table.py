"""The rows of a bench as a person reads them in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.bench.measurement import Measurement
from cosserat_casadi.bench.pareto import front
from cosserat_casadi.bench.program import Times
from cosserat_casadi.bench.reference import Reference

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
    """The table with its front marked, what errors are measured against, and why what is missing is missing."""
    console.print(f"[bold]{escape(title or 'Untitled scene')}[/]", highlight=False)
    console.print(_table(rows, WIDE if console.width >= ROOM else NARROW))
    console.print("● on the front: nothing measured is both more exact and faster. Times are of compiled C.")
    console.print(f"Errors are against {escape(reference_words(reference))}.", highlight=False)
    for row in rows:
        if row.note:
            console.print(f"[dim]{escape(f'{row.name}: {row.note}')}[/]", highlight=False)


def reference_words(reference: Reference) -> str:
    """What errors are measured against, and how far that is from the finest discretisation."""
    if reference.distance is None:
        return reference.method
    return f"{reference.method}; {reference.distance:.0e} from the finest discretisation"


def print_strains(console: Console, apart: dict[str, float]) -> None:
    """How far richer strain models are from that of the scene."""
    for strain, distance in apart.items():
        sentence = f"The tip of the {strain} model is {distance:.1e} from that of the scene's strain model."
        console.print(sentence, highlight=False)


def _table(rows: Sequence[Measurement], columns: Sequence[str]) -> Table:
    table = Table(box=None, header_style="bold", pad_edge=False)
    for heading in columns:
        table.add_column(heading, justify="left" if heading in ("", "point", "modes") else "right", no_wrap=True)
    best = set(front(rows))
    for row in sorted(rows, key=lambda row: (row.strain, not isfinite(row.pose_error), -row.pose_error)):
        cells = dict(zip(COLUMNS, _cells(row, row in best), strict=True))
        table.add_row(*(cells[heading] for heading in columns), style="bold green" if row in best else "")
    return table


def _cells(row: Measurement, best: bool) -> list[str]:
    """Cells in the order of COLUMNS."""
    size = ["●" if best else "", escape(row.name), row.modes, row.intervals, str(row.unknowns)]
    errors = [_power(v) for v in (row.pose_error, row.position_error, row.rotation_error, row.wrench_error)]
    times = [_digits(v) for v in (row.build_s, row.vm_cold_us, row.igm_us, row.jacobian_us, row.warm_us, row.cold_us)]
    operations = f"{row.jacobian_operations:,.0f}" if isfinite(row.jacobian_operations) else "–"
    return [*size, *errors, operations, *times]


def _power(value: float) -> str:
    return f"{value:.1e}" if isfinite(value) else "–"


def _digits(value: float) -> str:
    """Two digits behind the point of what is small, none of what is large."""
    if not isfinite(value):
        return "–"
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 100 else f"{value:,.0f}"


def print_effects(console: Console, whole: Times | str, parts: Mapping[str, Times | str]) -> None:
    """What each effect adds to the compiled times, µs."""
    table = Table(title="Compiled with -O2: what each effect adds")
    for heading in ("effect", "IGM, µs", "residual + Jacobian, µs", "cold solve, µs"):
        table.add_column(heading, justify="left" if heading == "effect" else "right")
    if isinstance(whole, str):
        console.print(f"Not timed: {escape(whole)}", highlight=False)
        return
    table.add_row("the whole scene", *(f"{value:.2f}" for value in (whole.igm, whole.jacobian, whole.cold)))
    for name, rest in parts.items():
        if isinstance(rest, str):
            table.add_row(escape(name), "not timed: without it", escape(rest), "")
            continue
        added = (whole.igm - rest.igm, whole.jacobian - rest.jacobian, whole.cold - rest.cold)
        table.add_row(escape(name), *(f"{value:+.2f}" for value in added))
    console.print(table)
