"""The report of ``identify``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import print_outcome, print_written, table_of
from cosserat_casadi.cli.reports.model import error_words
from cosserat_casadi.errors import SceneError
from cosserat_casadi.identification import Identification
from cosserat_casadi.spelling import counted

MOST_CASES = 10
"""Largest number of cases with printed unknowns; the file has them all."""


def print_identification(console: Console, found: Identification, written: Sequence[Path]) -> None:
    """Print the outcome, the values with their uncertainty, and the files that were written."""
    print_outcome(console, found.model.scene.title, found.message, good=found.converged)
    if found.labels and found.cases:
        console.print(_unknowns(found))
    if found.converged and found.layout.own:
        console.print(_own_unknowns(found))
    if found.rows:
        console.print(_residuals(found))
        console.print(escape("; ".join(found.model.resolution_words)))
    if found.error_estimate is not None:
        tolerance = found.model.scene.accuracy.tolerance
        error = error_words(found.error_estimate, found.within_tolerance, tolerance)
        console.print(f"estimated error of the model at most {error} ({escape(str(found.error_case))})")
    print_written(console, written)


def print_refused_scene(console: Console, refusal: SceneError) -> None:
    """Print why the values give no valid scene, so that none was written."""
    for problem in refusal.problems:
        console.print(f"[bold red]No scene was written:[/] {escape(str(problem))}", soft_wrap=True)


def _unknowns(found: Identification) -> Table:
    table = table_of("unknown", "value", "σ", "95 % from", "to", "unit", fold=["unknown"])
    units = [entry.unit for entry in found.layout.shared for _ in entry.labels]
    for label, value, sigma, interval, unit in zip(
        found.labels, found.shared, found.sigma, found.intervals, units, strict=True
    ):
        known = [_number(sigma, 2), _number(interval[0], 5), _number(interval[1], 5)]
        if not found.converged:
            known = ["", "", ""]
        elif not np.isfinite(sigma):
            known = ["at a bound" if label in found.at_bounds else "not determined", "", ""]
        table.add_row(escape(label), _number(value, 6), *known, "" if unit == "1" else unit)
    return table


def _own_unknowns(found: Identification) -> Table:
    table = table_of("case", *(escape(label) for label in found.layout.own_labels))
    for case, values, sigma in list(zip(found.cases, found.own, found.statistics.own, strict=True))[:MOST_CASES]:
        cells = [f"{value:.4g} ± {deviation:.1g}" for value, deviation in zip(values, sigma, strict=True)]
        table.add_row(escape(case), *cells)
    if len(found.cases) > MOST_CASES:
        table.add_row(f"… and {len(found.cases) - MOST_CASES} more")
    return table


def _number(value: float, figures: int) -> str:
    return f"{value:.{figures}g}" if np.isfinite(value) else ""


def _residuals(found: Identification) -> str:
    """Sentence with the residuals between model and measurements."""
    numbers = sum(not row.held_out for row in found.rows)
    sentence = (
        f"{counted(numbers, 'number')} in {counted(len(found.cases), 'case')}, residuals {found.rms():.3g} σ (rms)"
    )
    held_out = found.rms(held_out=True)
    if held_out is not None:
        sentence += f"; held out {held_out:.3g} σ"
    outliers = len(found.outliers)
    if outliers:
        sentence += f"; {counted(outliers, 'outlier')}"
    if found.step is not None:
        sentence += f"; steps of {found.step:.3g} s, with an error of {found.step_error:.2g} σ"
    starts, ended_here = found.starts
    if starts > 1:
        sentence += f"; {ended_here} of {starts} starts ended here"
    return sentence
