"""Estimates of every row, as JSON or CSV."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.estimation import Estimate
from cosserat_casadi.files import write_atomically
from cosserat_casadi.results.json_text import SCHEMA, discretisation_entries, plain


def estimate_result(found: Estimate) -> dict[str, Any]:
    """An estimate as plain data; a number that is not known becomes null."""
    rows = [
        {
            "row": case,
            "outcome": outcome,
            "value": found.values[i],
            "sigma": found.sigma[i],
            "covariance": found.covariance[i],
            "cost": found.cost[i],
            "deviations": found.consistency.row_deviations[i],
            **_second_best(found, i),
        }
        for i, (case, outcome) in enumerate(zip(found.cases, found.outcomes, strict=True))
    ]
    data: dict[str, Any] = plain(
        {
            "schema": SCHEMA,
            "message": found.message,
            "unknowns": list(found.labels),
            "units": list(found.units),
            "outcomes": found.counts,
            "shared": _shared(found),
            "consistency": {
                "holds": found.consistency.holds,
                "squares": found.consistency.squares,
                "expected": found.consistency.freedom,
                "deviations": found.consistency.deviations,
                "bias": [{"sensor": name, "deviations": bias} for name, bias in found.consistency.bias.items()],
            },
            "unseen": [{"direction": direction, "rows": count} for direction, count in found.unseen.items()],
            "within_tolerance": found.within_tolerance,
            "checked": [{"row": found.cases[row], "error_estimate": error} for row, error in found.checked],
            "warnings": list(found.warnings),
            "discretisation": discretisation_entries(found.model),
            "rows": rows,
        }
    )
    return data


def _shared(found: Estimate) -> list[dict[str, Any]]:
    """Numbers that all rows share; empty where none of them is unknown."""
    shared = found.shared
    if shared is None:
        return []
    columns = zip(shared.labels, shared.units, shared.values, shared.sigma, strict=True)
    return [{"unknown": label, "unit": unit, "value": value, "sigma": sigma} for label, unit, value, sigma in columns]


def _second_best(found: Estimate, case: int) -> dict[str, Any]:
    """The second best minimum of a row, where several searches were made for it."""
    if found.second is None:
        return {}
    second = found.second
    return {"share": second.share[case], "second": {"value": second.values[case], "cost": second.cost[case]}}


def estimate_table(found: Estimate) -> str:
    """The rows as CSV: where they are, how they ended, unknowns with deviations; empty where not found.

    Where several searches were made for a row: the share of the posterior mass that these values stand for, and the
    second-best values.
    """
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    pairs = [name for label in found.labels for name in (label, f"{label}.sigma")]
    numbers = np.stack([found.values, found.sigma], axis=2).reshape(len(found.cases), -1)
    if found.second is not None:
        pairs += ["share", *(f"{label}.second" for label in found.labels)]
        numbers = np.column_stack([numbers, found.second.share, found.second.values])
    writer.writerow(["row", "outcome", *pairs])
    for case, outcome, row in zip(found.cases, found.outcomes, numbers.tolist(), strict=True):
        writer.writerow([case, outcome, *("" if np.isnan(number) else repr(number) for number in row)])
    return lines.getvalue()


def write_estimate_table(found: Estimate, file: Path) -> None:
    """Write the rows as CSV, whole or not at all."""
    write_atomically(file, estimate_table(found).encode())
