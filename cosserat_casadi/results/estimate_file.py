"""Estimates of every row, as JSON or CSV."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.estimation import Estimate


def estimate_result(found: Estimate) -> dict[str, Any]:
    """An estimate as the data of its file."""
    rows = [
        {
            "row": case,
            "outcome": outcome,
            "stable": found.stable[i] if found.stable else None,
            "value": found.values[i],
            "sigma": found.sigma[i],
            "covariance": found.covariance[i],
            "cost": found.cost[i],
            "deviations": found.consistency.row_deviations[i],
            **_second_best(found, i),
        }
        for i, (case, outcome) in enumerate(zip(found.cases, found.outcomes, strict=True))
    ]
    return {
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
        "discretisation": found.model.resolution,
        "rows": rows,
    }


def _shared(found: Estimate) -> list[dict[str, Any]]:
    """Unknowns common to all rows; empty if there are none."""
    shared = found.shared
    if shared is None:
        return []
    columns = zip(shared.labels, shared.units, shared.values, shared.sigma, strict=True)
    return [{"unknown": label, "unit": unit, "value": value, "sigma": sigma} for label, unit, value, sigma in columns]


def _second_best(found: Estimate, case: int) -> dict[str, Any]:
    """The second best minimum of a row, if several searches were made for it."""
    if found.second is None:
        return {}
    second = found.second
    return {"share": second.share[case], "second": {"value": second.values[case], "cost": second.cost[case]}}


def estimate_table(found: Estimate) -> tuple[list[str], list[list[Any]]]:
    """Header and rows: row, outcome, unknowns with standard deviations; NaN without an estimate.

    After several searches for a row: also the share of the posterior mass of these values, and the second-best values.
    """
    pairs = [name for label in found.labels for name in (label, f"{label}.sigma")]
    numbers = np.stack([found.values, found.sigma], axis=2).reshape(len(found.cases), -1)
    if found.second is not None:
        pairs += ["share", *(f"{label}.second" for label in found.labels)]
        numbers = np.column_stack([numbers, found.second.share, found.second.values])
    endings = zip(found.cases, found.outcomes, numbers.tolist(), strict=True)
    return ["row", "outcome", *pairs], [[case, outcome, *row] for case, outcome, row in endings]
