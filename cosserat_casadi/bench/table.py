"""The rows of a bench as a person reads them in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.bench.effects import MotionCost
from cosserat_casadi.bench.measurement import Measurement, front
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

LABELS = {
    "residual": "residual at rest",
    "jacobian": "residual and Jacobian at rest",
    "inverse_dynamics": "inverse dynamics",
    "dynamics_jacobian": "inverse dynamics with K, C and M",
}
"""Labels of the functions of a model."""

OF_DAMPING = "  of which damping"
"""Label of what damping adds to the row above."""

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
        _digits(row.build_s),
        _digits(row.vm_cold_us),
        _digits(row.igm_us),
        _digits(row.jacobian_us),
        _digits(row.warm_us),
        _digits(row.cold_us),
    )
    return dict(zip(COLUMNS, cells, strict=True))


def _power(value: float) -> str:
    if not isfinite(value):
        return "–"
    return f"{value:.1e}"


def _digits(value: float) -> str:
    """Two digits behind the point of small numbers, none of large numbers."""
    if not isfinite(value):
        return "–"
    if value < 10:
        return f"{value:.2f}"
    if value < 100:
        return f"{value:.1f}"
    return f"{value:,.0f}"


def print_effects(console: Console, rods: Sequence[str], whole: Times | str, parts: Mapping[str, Times | str]) -> None:
    """Time that each effect adds to the compiled times, µs.

    Args:
        console: where to print.
        rods: names of the scene's rods; the IGM that is timed is of the first.
        whole: times of the scene; a sentence where it could not be timed.
        parts: times of the scene without each effect, by its name.
    """
    igm = "IGM"
    if len(rods) > 1:
        igm = f"IGM of {escape(rods[0])} alone"
    table = Table(title="Compiled with -O2: what each effect adds")
    for heading in ("effect", f"{igm}, µs", "residual + Jacobian, µs", "cold solve, µs"):
        table.add_column(heading, justify="left" if heading == "effect" else "right")
    if isinstance(whole, str):
        console.print(f"Not timed: {escape(whole)}", highlight=False)
        return
    table.add_row("the whole scene", f"{whole.igm:.2f}", f"{whole.jacobian:.2f}", f"{whole.cold:.2f}")
    for name, without in parts.items():
        if isinstance(without, str):
            table.add_row(escape(name), "not timed: without it", escape(without), "")
            continue
        # What an effect adds is what is saved without it.
        table.add_row(
            escape(name),
            f"{whole.igm - without.igm:+.2f}",
            f"{whole.jacobian - without.jacobian:+.2f}",
            f"{whole.cold - without.cold:+.2f}",
        )
    console.print(table)


def print_motion_times(console: Console, unknowns: int, motion: MotionCost, undamped: MotionCost | None = None) -> None:
    """Time that inertia and damping add to a residual and to a Jacobian.

    Args:
        console: where to print.
        unknowns: of the model in motion.
        motion: cost of the model in motion.
        undamped: cost of the model without its damping; None where the scene names none.
    """
    table = Table(title=f"In motion, {unknowns} unknowns, in CasADi's virtual machine (not compiled)")
    table.add_column("function")
    for heading in ("operations", "µs", "over statics"):
        table.add_column(heading, justify="right")
    for at_rest, moving in (("residual", "inverse_dynamics"), ("jacobian", "dynamics_jacobian")):
        operations, time_at_rest = motion[at_rest]
        table.add_row(LABELS[at_rest], str(operations), _digits(time_at_rest), "")
        operations, time = motion[moving]
        table.add_row(LABELS[moving], str(operations), _digits(time), f"{time / time_at_rest:.1f} ×")
        if undamped is not None:
            fewer, shorter = undamped[moving]
            table.add_row(OF_DAMPING, str(operations - fewer), f"{time - shorter:+.2f}", "")
    console.print(table)
