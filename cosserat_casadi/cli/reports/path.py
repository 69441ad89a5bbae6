"""The report of ``path``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_written
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.equilibrium_path import CONTACT_WORDS, EquilibriumPath, PathEvent
from cosserat_casadi.results.facts import digits


def print_path(console: Console, path: EquilibriumPath, written: Sequence[Path]) -> None:
    """Print the outcome, the events and the end, and the files that were written."""
    print_outcome(console, path.model.scene.title, path.message, good=path.converged)
    if len(path.factor):
        console.print(_path_table(path))
    console.print(_merit_sentence(path))
    print_written(console, written)


def _merit_sentence(path: EquilibriumPath) -> str:
    changes = sum(event.contact is not None for event in path.events)
    parts = [f"{len(path.factor)} points"]
    # A path with friction looks for none.
    if not path.model.scene.rubs:
        parts.append(f"{len(path.events) - changes} limit points and bifurcations")
    if path.model.scene.touches_exactly:
        parts.append(f"{changes} changes of contact")
    if path.error_estimate is not None:
        parts.append(f"estimated error of events and end {path.error_estimate:.1e}")
    return escape("; ".join([*parts, *path.model.resolution_words]))


@dataclass(frozen=True)
class _TableRow:
    """A point of a path that the table shows.

    Attributes:
        kind: start, end, or the kind of an event.
        factor: of the input's value.
        beyond: index of the first point of the path beyond it, whose stability is shown.
        positions: of the shown section of every rod, m.
    """

    kind: str
    factor: float
    beyond: int
    positions: Sequence[FloatArray]


def _path_table(path: EquilibriumPath) -> Table:
    """The start, the events and the end of a path, with the stability of what follows."""
    table = Table()
    for heading in ("point", "factor", path.name, "beyond it", "rod", "position, m"):
        table.add_column(escape(heading), no_wrap=heading in ("point", "factor", "beyond it"))
    # Of a rod whose tip is held another section is shown: its tip does not move.
    abscissae = {name: path.section(name) for name in path.model.discrete.rods}
    for row in _table_rows(path, abscissae):
        _add_row(table, path, row, abscissae)
    return table


def _table_rows(path: EquilibriumPath, abscissae: dict[str, float]) -> list[_TableRow]:
    factors = path.factor.tolist()
    last = len(factors) - 1
    along = [path.position(X, name) for name, X in abscissae.items()]
    start = [positions[0] for positions in along]
    end = [positions[-1] for positions in along]

    rows = [_TableRow("start", factors[0], 0, start)]
    for event in path.events:
        positions = [path.event_position(event, X, name) for name, X in abscissae.items()]
        # An event lies between two points; beyond the last one there is none to judge.
        beyond = min(event.position, last)
        rows.append(_TableRow(_event_kind(event), event.factor, beyond, positions))
    rows.append(_TableRow("end", factors[last], last, end))
    return rows


def _event_kind(event: PathEvent) -> str:
    contact = event.contact
    if contact is not None and contact.of_body:
        return f"{CONTACT_WORDS[event.kind]}, {contact.owner} on {contact.obstacle}"
    if contact is not None:
        return f"{CONTACT_WORDS[event.kind]}, {contact.owner} X = {contact.start:.4g} on {contact.obstacle}"
    if event.multiplicity == 1:
        return event.kind
    return f"{event.kind}, {event.multiplicity}-fold"


def _add_row(table: Table, path: EquilibriumPath, row: _TableRow, abscissae: dict[str, float]) -> None:
    """A line for each rod; what belongs to the point stands on the first."""
    value = np.ravel(path.value_at(row.factor), order="F")
    value_cell = ", ".join(digits(value))
    cells = [row.kind, f"{row.factor:.10g}", f"[{value_cell}]", _stability(path, row.beyond)]
    for (name, X), position in zip(abscissae.items(), row.positions, strict=True):
        point_cells = [escape(cell) for cell in cells]
        position_cell = ", ".join(digits(position))
        section = f"{name} tip" if X == 1.0 else f"{name} X = {X:.3g}"
        table.add_row(*point_cells, escape(section), position_cell)
        cells = [""] * len(cells)


def _stability(path: EquilibriumPath, index: int) -> str:
    if path.stable is None or path.neutral is None:
        return "not judged"
    # Neutral first: an equilibrium that can be moved on at no cost is called stable too.
    if path.neutral[index]:
        return "neutral"
    if path.stable[index]:
        return "stable"
    return "unstable"
