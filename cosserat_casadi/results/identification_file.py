"""The file of an identification: identified values, their uncertainty, and the remaining misfit."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.identification import Identification
from cosserat_casadi.identification.fit_unknowns import UnknownEntry, parts
from cosserat_casadi.scene.values import names_in

MOST_OUTLIERS = 100
"""Largest number of outliers in the file."""


def identification_result(found: Identification) -> dict[str, Any]:
    """An identification as the data of its file."""
    starts, ended_here = found.starts
    return {
        "converged": found.converged,
        "outcome": found.outcome,
        "message": found.message,
        "iterations": found.iterations,
        "starts": starts,
        "starts_that_ended_here": ended_here,
        "cases": len(found.cases),
        "numbers": sum(not row.held_out for row in found.rows),
        "unknowns": {**_shared(found), **_own(found)},
        "correlation_of": list(found.labels),
        "correlation": found.statistics.correlation,
        "noise_factor": found.statistics.noise,
        "unseen": [
            {"direction": direction.parts, "deviation": direction.deviation} for direction in found.statistics.unseen
        ],
        "at_bounds": list(found.at_bounds),
        "residual": _residual(found),
        "outliers": [
            {"where": row.where, "residual": row.residual, "weight": row.weight}
            for row in found.outliers[:MOST_OUTLIERS]
        ],
        "stable": not found.unstable if found.cases else None,
        "unstable": list(found.unstable),
        "left_out": [{"where": case.where, "reason": case.reason} for case in found.left_out],
        "warnings": list(found.warnings),
        "error_estimate": found.error_estimate,
        "error_case": found.error_case,
        "within_tolerance": found.within_tolerance,
        **_steps(found),
        "discretisation": found.model.resolution,
    }


def _shared(found: Identification) -> dict[str, Any]:
    """Unknowns common to all cases, by name: numbers, or lists of numbers."""
    entries = {}
    first = 0
    intervals = found.intervals
    for entry, numbers in parts(found.layout.shared, found.shared):
        span = slice(first, first + entry.size)
        first += entry.size
        values: dict[str, Any] = {
            "value": entry.values(numbers),
            "sigma": found.sigma[span],
            "interval_95": intervals[span],
            "determined": found.statistics.determined[span],
        }
        if not found.converged:
            # Statistics are valid at the least misfit only.
            values["determined"] = np.zeros(entry.size, dtype=bool)
        single = {key: _single(value) for key, value in values.items()}
        entries[entry.record.name] = {**single, "unit": entry.unit, **_tied(entry)}
    return entries


def _tied(entry: UnknownEntry) -> dict[str, list[str]]:
    """Entry with the names of numbers tied to an identified number; empty without any."""
    names = names_in(entry.record.parameter or ())
    return {"tied": list(names[1:])} if len(names) > 1 else {}


def _own(found: Identification) -> dict[str, Any]:
    """Unknowns of the single cases, by name: a list with an entry for each case."""
    entries = {}
    first = 0
    for entry in found.layout.own:
        span = slice(first, first + entry.size)
        first += entry.size
        values = [_single(entry.values(numbers[span])) for numbers in found.own]
        sigma = [_single(deviations[span]) for deviations in found.statistics.own]
        entries[entry.record.name] = {"value": values, "sigma": sigma, "cases": list(found.cases), "unit": entry.unit}
    return entries


def _steps(found: Identification) -> dict[str, Any]:
    """Entry of the time steps of measured motions, s, and their error in standard deviations; empty without motions."""
    if found.step is None:
        return {}
    return {"step": found.step, "step_error": found.step_error}


def _single(values: npt.NDArray[Any]) -> Any:
    """The number in a list of length one; a longer list unchanged."""
    return values.tolist()[0] if len(values) == 1 else values.tolist()


def _residual(found: Identification) -> dict[str, Any]:
    """Root mean squares of residuals, in standard deviations, and for each measurement also in its unit."""
    by_measurement: dict[str, Any] = {}
    for number, measurement in enumerate(found.model.scene.measurements):
        rows = [row for row in found.rows if row.measurement == number and not row.held_out]
        by_unit: dict[str, list[float]] = {}
        for row in rows:
            by_unit.setdefault(measurement.differences[row.entry], []).append(row.modelled - row.measured)
        entry = {
            "numbers": len(rows),
            "rms": found.rms(measurement=number),
            "held_out_rms": found.rms(held_out=True, measurement=number),
            "markers": [
                {key: getattr(marker, key) for key in ("at", "rows", "rms", "largest", "mean")}
                for marker in found.distances
                if marker.measurement == number
            ],
            "rms_by_unit": {unit: float(np.sqrt(np.mean(np.square(values)))) for unit, values in by_unit.items()},
        }
        title = measurement.title
        by_measurement[title if title not in by_measurement else f"{title} {number}"] = entry
    return {"rms": found.rms(), "by_measurement": by_measurement, "held_out_rms": found.rms(held_out=True)}
