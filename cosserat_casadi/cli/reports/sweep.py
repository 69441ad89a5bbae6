"""The reports of ``sweep`` and of its ``--sobol``."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosserat_casadi.cli.reports.format import listed, print_written, table_of, title_line
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.spelling import counted
from cosserat_casadi.sweeps.outcome_file import STABLE, record_file
from cosserat_casadi.sweeps.outcome_table import ERROR, Sweep
from cosserat_casadi.sweeps.sobol import SobolIndices
from cosserat_casadi.sweeps.work import Shard

ROUNDING = float(np.finfo(np.float64).eps)
"""Negligible difference of poses: over the length of the longest rod, and in rad."""


def print_sweep(console: Console, sweep: Sweep, output: Path, plot: Path | None, *, finished: bool) -> None:
    """Print outcomes of rows, discretisation, check of some rows, and files.

    Args:
        console: where to print.
        sweep: results of the sweep.
        output: file of the results.
        plot: the figure, if one was drawn.
        finished: whether the file had the finished sweep already, without computation.
    """
    record = sweep.record
    tolerance = record["tolerance"]
    console.print(title_line(record["title"]))
    console.print(_outcome_table(sweep))
    if "tubes" in record:
        chosen = f"Each row has as many steps as the tolerance {tolerance:g} asks for."
    else:
        chosen = _choice_sentence(record["chosen"], tolerance)
    console.print(chosen, soft_wrap=True)
    checked = _check_sentences(record["checked"], tolerance)
    for sentence in (*_error_sentences(sweep), *checked, *_stability_sentences(sweep)):
        console.print(sentence, soft_wrap=True)

    written: list[Path] = []
    if finished:
        _print_finished(console, output)
    else:
        written += [output, record_file(output)]
    if plot is not None:
        written.append(plot)
    print_written(console, written, soft_wrap=True)


def print_stopped_sweep(console: Console, part: Path | None) -> None:
    """Print the file with the finished rows of a stopped sweep."""
    if part is None or not part.exists():
        console.print("Stopped before any row was solved. Nothing was written.")
        return
    console.print(f"Stopped. {escape(str(part))} keeps the finished rows: the same command goes on from them.")


def _print_finished(console: Console, output: Path) -> None:
    console.print(f"{escape(str(output))} already holds this sweep: nothing was computed")


def print_shard(console: Console, shard: Shard, rows: int, output: Path, *, finished: bool) -> None:
    """Print that a shard is finished, and how to merge all shards.

    Args:
        console: where to print.
        shard: the shard.
        rows: number of its rows.
        output: file of the results.
        finished: whether the file had the finished shard already, without computation.
    """
    if finished:
        _print_finished(console, output)
        return
    file = escape(str(shard.file(output)))
    sentence = f"Shard {shard}: {counted(rows, 'row')} kept in {file}. When all are done, --merge writes the results."
    console.print(sentence)


def _outcome_table(sweep: Sweep) -> Table:
    table = table_of("outcome", right=("rows", "share"))
    for label, count in sweep.counts.items():
        table.add_row(label, f"{count:,}", f"{count / len(sweep.outcomes):.1%}")
    return table


def _choice_sentence(chosen: dict[str, Any], tolerance: float) -> str:
    """Sentence on the discretisation of rows, with the error of a chosen one."""
    discretisation = chosen["discretisation"]
    if discretisation is None:
        return "The scene fixes modes, nodes or rotation. Those that it leaves open have their defaults."
    # Rows without an equilibrium do not count for the discretisation.
    count = len(chosen["rows"])
    sections = discretisation.get("sections")
    sums = f", layers summed at {sections} sections an element" if sections else ""
    words = f"Modes {discretisation['modes']}, {discretisation['nodes']} intervals{sums}"
    sentence = escape(f"{words}, chosen on {counted(count, 'row')}")
    estimate = chosen["error_estimate"]
    if estimate is None:
        return f"{sentence}, [bold red]but none has an equilibrium.[/]"
    if chosen["converged"] < count:
        sentence += f", {chosen['converged']} of which have an equilibrium"
    return f"{sentence}: estimated error {estimate:.1e}, {_within(estimate, tolerance)} {tolerance:g}."


def _error_sentences(sweep: Sweep) -> Iterator[str]:
    """Number of converged rows above the tolerance, and the remedy; empty without error estimates."""
    if ERROR not in sweep.found:
        return
    known, largest, row = sweep.worst
    if not known:
        return
    tolerance = sweep.record["tolerance"]
    missed = sweep.missed_count
    # Rows are numbered from 1 for users.
    error = f"Estimated error of {counted(known, 'converged row')} at most {largest:.1e} (row {1 + row})"
    if not sweep.tolerance_binds:
        yield f"{error}; the scene fixes its discretisation, and asks for no tolerance."
    elif not missed:
        yield f"{error}, within {tolerance:g}."
    else:
        yield f"{error}: [bold red]{counted(missed, 'row')} above the tolerance of {tolerance:g}.[/] {_remedy(sweep)}"


def _remedy(sweep: Sweep) -> str:
    """The remedy for rows whose error is above the tolerance."""
    if sweep.record["chosen"]["discretisation"] is None:
        return (
            "The scene fixes its modes, nodes or rotation: leave them out, or choose them for the ranges of the table "
            "with cosserat tune."
        )
    return "Choose modes on more rows with --samples, or for the ranges of the table with cosserat tune."


def _check_sentences(checked: list[dict[str, Any]], tolerance: float) -> Iterator[str]:
    """Sentences about the rows that were solved again in Python.

    Args:
        checked: for each such row its number, counted from 0; the estimated error, the distance of its poses from the
            sweep's, None where Python found no equilibrium, and whether it is stable.
        tolerance: tolerance of the scene.
    """
    compared = [entry for entry in checked if entry["difference"] is not None]
    if compared:
        # A missing error estimate counts as infinite.
        estimates = [math.inf if entry["error_estimate"] is None else entry["error_estimate"] for entry in compared]
        error = max(estimates)
        difference = max(entry["difference"] for entry in compared)
        differing_by = "by rounding alone" if difference <= ROUNDING else f"by at most {difference:.1e}"
        yield (
            f"{counted(len(compared), 'row')} solved again in Python: estimated error at most {error:.1e}, "
            f"{_within(error, tolerance)} {tolerance:g}; poses differ {differing_by}."
        )
    lost = [entry for entry in checked if entry["difference"] is None]
    if lost:
        yield f"[bold red]Python found no equilibrium for {_rows(lost)}.[/]"
    differing = [entry for entry in compared if entry["difference"] > tolerance]
    if differing:
        yield f"[bold red]Python found another equilibrium for {_rows(differing)}.[/]"
    # None, for loads without a potential, is not unstable.
    unstable = [entry for entry in compared if entry["stable"] is False]
    if unstable:
        yield (
            f"[bold yellow]Unstable among these: {_rows(unstable)}.[/] A real rod leaves such an equilibrium. "
            "--stability judges every row."
        )


def _stability_sentences(sweep: Sweep) -> Iterator[str]:
    """Number of stable rows, if stability was computed."""
    if STABLE not in sweep.found:
        return
    stable = sweep[STABLE][sweep.converged]
    sentence = f"Stable: {counted(int(np.sum(stable == 1.0)), 'row')}, unstable: {int(np.sum(stable == 0.0))}"
    without_potential = int(np.sum(np.isnan(stable)))
    if without_potential:
        sentence += f", not judged, since their loads have no potential: {without_potential}"
    yield f"{sentence}."


def _rows(entries: list[dict[str, Any]]) -> str:
    """Numbers of rows, counted from 1."""
    numbers = [entry["row"] + 1 for entry in entries]
    return listed(numbers, "row")


def _within(error: float, tolerance: float) -> str:
    return "within" if error <= tolerance else "[bold red]more than[/]"


def print_sobol(console: Console, indices: SobolIndices) -> None:
    """Print the indices of every result, and the number of omitted draws."""
    table = table_of("result", "input", "first (95 %)", "total (95 %)", unbroken=["result", "input"])
    constant = []
    for name, found in indices.results.items():
        if not np.all(np.isfinite(found.first)):
            constant.append(name)
            continue
        for k, factor in enumerate(indices.factors):
            shown = escape(name) if k == 0 else ""
            first = _with_interval(found.first[k], found.first_interval[k])
            total = _with_interval(found.total[k], found.total_interval[k])
            table.add_row(shown, escape(factor), first, total)
    console.print(table)
    if constant:
        console.print(f"Constant: {escape(', '.join(constant))}.", soft_wrap=True)
    if indices.left_out:
        sentence = (
            f"[bold yellow]Left out: {counted(indices.left_out, 'draw')} of {indices.samples + indices.left_out}, "
            "since a row of each has no equilibrium.[/] The other draws give the indices."
        )
        console.print(sentence, soft_wrap=True)


def _with_interval(value: float, bounds: FloatArray) -> str:
    return f"{value:.3f} ({bounds[0]:.3f} … {bounds[1]:.3f})"
