"""The file of a table of targets: one row per target, with outcome, gaps, error and the inputs found."""

from __future__ import annotations

from collections.abc import Sequence

from cosserat_casadi.control.inverse_result import Inverse
from cosserat_casadi.control.target_table import TargetTable
from cosserat_casadi.equilibrium.contact.contact_state import given_entries, given_inputs
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.results.json_text import csv_text

MET = "met"
"""Outcome of a row with a met target."""

MISSED = "missed"
"""Outcome of a row with an equilibrium that misses its target."""

UNSTABLE = "unstable"
"""Outcome of a row with an unstable equilibrium."""


def row_outcome(inverse: Inverse, unstable: bool) -> str:
    """Outcome of a row in a word: met, missed, unstable, or the label of a failed solve.

    Args:
        inverse: result of the row.
        unstable: whether an unstable equilibrium is accepted.
    """
    if not inverse.solution.converged:
        return inverse.solution.outcome.label
    if inverse.unstable and not unstable:
        return UNSTABLE
    return MET if inverse.met else MISSED


def table_text(table: TargetTable, found: Sequence[Inverse], unstable: bool) -> str:
    """The file as text: columns of the table, outcome, gaps with their errors, error of the tips, and inputs.

    Args:
        table: table of the targets.
        found: result of each row.
        unstable: whether unstable equilibria are accepted.
    """
    first = found[0].solution.model
    given = set(given_entries(first).tolist())
    inputs = [name for name, index in column_indices(first.inputs).items() if index in given]
    gaps = ("position_gap", "angle_gap", "position_error_estimate", "angle_error_estimate")
    errors = ("error_estimate", "within_tolerance")
    rows = []
    for given, inverse in zip(table.values.tolist(), found, strict=True):
        cells: list[object] = [*given, row_outcome(inverse, unstable)]
        # Rows without an equilibrium have empty cells.
        if inverse.solution.converged:
            (gap,) = inverse.gaps
            cells += [gap.position, gap.angle, gap.position_error, gap.angle_error]
            cells += [inverse.solution.error_estimate, inverse.solution.within_tolerance]
            cells += given_inputs(inverse.solution.model, inverse.solution.inputs).tolist()
        else:
            cells += [None] * (len(gaps) + len(errors) + len(inputs))
        rows.append(cells)
    return csv_text([*table.columns, "outcome", *gaps, *errors, *inputs], rows)
