"""Sobol indices of a sweep as JSON."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.results.json_text import SCHEMA, json_text, plain
from cosserat_casadi.sweep.sobol import CONFIDENCE, Estimates, SobolIndices


def sobol_text(indices: SobolIndices) -> str:
    """The file of Sobol indices as text."""
    return json_text(plain(sobol_result(indices)))


def sobol_result(indices: SobolIndices) -> dict[str, Any]:
    """Indices of every result by column; null where the result does not vary."""
    return {
        "schema": SCHEMA,
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
