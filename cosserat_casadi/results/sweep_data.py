"""A sweep, and its Sobol indices, as plain data."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.sobol import CONFIDENCE, Estimates, SobolIndices


def sweep_result(sweep: Sweep) -> dict[str, Any]:
    """Columns of a sweep by name, the outcome of each row, and the record; NaN where a row has no result."""
    return {
        "outcome": sweep.outcome,
        "columns": {name: sweep[name] for name in sweep.columns},
        "record": sweep.record,
    }


def sobol_result(indices: SobolIndices) -> dict[str, Any]:
    """Indices of every result by column; NaN where the result does not vary."""
    return {
        "factors": list(indices.factors),
        "samples": indices.samples,
        "left_out": indices.left_out,
        "confidence": CONFIDENCE,
        "results": {name: _entry(indices.factors, found) for name, found in indices.results.items()},
    }


def _entry(factors: tuple[str, ...], found: Estimates) -> dict[str, Any]:
    return {
        "mean": found.mean,
        "standard_deviation": found.variance**0.5,
        "first": _by_factor(factors, found.first, found.first_interval),
        "total": _by_factor(factors, found.total, found.total_interval),
    }


def _by_factor(factors: tuple[str, ...], values: FloatArray, intervals: FloatArray) -> dict[str, Any]:
    entries = {}
    for name, value, interval in zip(factors, values, intervals, strict=True):
        entries[name] = {"value": float(value), "interval_95": interval}
    return entries
