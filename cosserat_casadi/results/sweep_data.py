"""A sweep, and its Sobol indices, as plain data."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.results.presentation import NamedArrays
from cosserat_casadi.sweeps.outcome_table import Sweep
from cosserat_casadi.sweeps.sobol import CONFIDENCE, Estimates, SobolIndices


def sweep_result(sweep: Sweep) -> dict[str, Any]:
    """Columns of a sweep by name, the outcome of each row, and the record; rows without a result have NaN."""
    return {
        "outcome": sweep.outcome,
        "columns": {name: sweep[name] for name in sweep.columns},
        "record": sweep.record,
    }


def sweep_arrays(sweep: Sweep) -> NamedArrays:
    """The columns of a sweep: for a full grid over one axis per swept column, else over ``row``."""
    attributes = {"title": sweep.record.get("title") or ""}
    swept = np.column_stack([sweep[name] for name in sweep.swept])
    ticks = [np.unique(column) for column in swept.T]
    shape = tuple(len(values) for values in ticks)
    if len(swept) == math.prod(shape) == len(np.unique(swept, axis=0)):
        # In the order of the axes: the last column varies fastest.
        order = np.lexsort(swept.T[::-1])
        arrays = NamedArrays(coordinates=dict(zip(sweep.swept, ticks, strict=True)), attributes=attributes)
        axes, names = sweep.swept, sweep.found
    else:
        order = np.arange(len(swept))
        shape = (len(swept),)
        arrays = NamedArrays(attributes=attributes)
        axes, names = ("row",), sweep.columns
    for name in names:
        arrays.add(name, axes, sweep[name][order].reshape(shape))
    arrays.variables["outcome"] = (axes, np.array(sweep.outcome)[order].reshape(shape), {})
    return arrays


def sobol_result(indices: SobolIndices) -> dict[str, Any]:
    """Indices of every result by column; NaN for a constant result."""
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
