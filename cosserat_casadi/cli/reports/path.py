"""The report of ``path``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_written, table_of
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.paths.equilibrium_path import CONTACT_WORDS, EquilibriumPath, PathEvent
from cosserat_casadi.results.facts import digits


def print_path(console: Console, path: EquilibriumPath, written: Sequence[Path]) -> None:
    """Print the outcome, the events and the end, and the files that were written."""
    print_outcome(console, path.model.scene.title, path.message, good=path.converged)
    if len(path.factor):
        # For a rod with a held tip another section is printed.
        abscissae = {name: path.section(name) for name in path.model.discrete.rods}
        stations = _stations(path, abscissae)
        console.print(_events_table(path, stations))
        console.print(_positions_table(abscissae, stations))
    console.print(_merit_sentence(path))
    print_written(console, written)


def _merit_sentence(path: EquilibriumPath) -> str:
    changes = sum(event.contact is not None for event in path.events)
    parts = [f"{len(path.factor)} points"]
    # Paths with friction have no search for events.
    if not path.model.rubs_on_paths:
        parts.append(f"{len(path.events) - changes} limit points and bifurcations")
    if path.model.scene.touches_exactly:
        parts.append(f"{changes} changes of contact")
    if path.error_estimate is not None:
        parts.append(f"estimated error of events and end {path.error_estimate:.1e}")
    return escape("; ".join([*parts, *path.model.resolution_words]))


@dataclass(frozen=True)
class _Station:
    """The start of a path, an event or the end, as tables show it.

    Attributes:
        kind: name of the station.
        factor: factor of the path at the station.
        index: index of the first point of the path after the station.
        positions: position of the printed section of each rod, shape (3,), m.
    """

    kind: str
    factor: float
    index: int
    positions: Sequence[FloatArray]


def _stations(path: EquilibriumPath, abscissae: Mapping[str, float]) -> list[_Station]:
    along = [path.position(X, name) for name, X in abscissae.items()]
    factors = path.factor.tolist()
    last = len(factors) - 1
    stations = [_Station("start", factors[0], 0, [positions[0] for positions in along])]
    for event in path.events:
        positions = [path.event_position(event, X, name) for name, X in abscissae.items()]
        # An event lies between two points; after the last point there is no stability.
        stations.append(_Station(_event_kind(event), event.factor, min(event.position, last), positions))
    stations.append(_Station("end", factors[last], last, [positions[-1] for positions in along]))
    return stations


def _events_table(path: EquilibriumPath, stations: Sequence[_Station]) -> Table:
    """Table of start, events and end of a path, with the stability after each."""
    table = table_of("point", "factor", escape(path.name), "after it", unbroken=("factor", "after it"))
    for station in stations:
        value = ", ".join(digits(np.ravel(path.value_at(station.factor), order="F")))
        cells = [station.kind, _factor(station), f"[{value}]", _stability(path, station.index)]
        table.add_row(*map(escape, cells))
    return table


def _positions_table(abscissae: Mapping[str, float], stations: Sequence[_Station]) -> Table:
    """Table of the positions of a section of each rod at start, events and end."""
    table = table_of("factor", "section", right=("x, m", "y, m", "z, m"), unbroken=("factor",), fold=("section",))
    for station in stations:
        factor = _factor(station)
        for (name, X), position in zip(abscissae.items(), station.positions, strict=True):
            section = f"{name} tip" if X == 1.0 else f"{name} X = {X:.3g}"
            table.add_row(factor, escape(section), *digits(position))
            # The factor is in the row of the first rod.
            factor = ""
    return table


def _factor(station: _Station) -> str:
    return f"{station.factor:.10g}"


def _event_kind(event: PathEvent) -> str:
    contact = event.contact
    if contact is not None and contact.of_body:
        return f"{CONTACT_WORDS[event.kind]}, {contact.owner} on {contact.obstacle}"
    if contact is not None:
        return f"{CONTACT_WORDS[event.kind]}, {contact.owner} X = {contact.start:.4g} on {contact.obstacle}"
    if event.multiplicity == 1:
        return event.kind
    return f"{event.kind}, {event.multiplicity}-fold"


def _stability(path: EquilibriumPath, index: int) -> str:
    if path.stable is None or path.neutral is None:
        return "not judged"
    # Neutral is tested first: neutral equilibria are flagged as stable too.
    if path.neutral[index]:
        return "neutral"
    if path.stable[index]:
        return "stable"
    return "unstable"
