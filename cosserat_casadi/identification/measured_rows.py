"""Comparison of measured rows with the model: the residuals of one measurement, and their derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.identification.case_equilibria import split
from cosserat_casadi.identification.measured_cases import Datum
from cosserat_casadi.identification.measured_quantities import QUANTITIES, difference
from cosserat_casadi.maths.grid import Indices
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.tubes.tube_functions import AnyModel


class MeasuredRows:
    """All rows of one measurement that depends on unknowns and inputs at one place: an equilibrium, or an instant.

    Attributes:
        record: the measurement.
        cases: case of each place, shape (count,).
        times: time of each place in the motion of its case, s, shape (count,); NaN for equilibria.
        data: these rows, in the order of the residuals, each with the index of its entry.
        row_cases: case of each row.
        places: place of each row, shape (rows,).
        sigma: standard deviations of the entries, section by section of a place.
    """

    def __init__(self, model: AnyModel, record: Any, rows: Sequence[tuple[int, list[Datum]]]) -> None:
        self.record = record
        self.cases: Indices = np.array([case for case, _ in rows], dtype=np.int64)
        self.times = np.array([data[0].time for _, data in rows])
        count = len(rows)
        sections = max(len(data) for _, data in rows)
        self._at, self._measured, known = measured_numbers(record, [data for _, data in rows], sections)
        # The order is that of the residuals: places, then their sections, then the entries of each section.
        numbers = np.argwhere(known)
        self.data: list[tuple[Datum, int]] = [(rows[i][1][k], entry) for i, k, entry in numbers.tolist()]
        self.places: Indices = numbers[:, 0]
        self.row_cases: list[int] = self.cases[self.places].tolist()
        self._known = known.reshape(count, -1)
        deviations = np.broadcast_to(np.asarray(record.sigma, dtype=float), len(record.differences))
        self.sigma = np.tile(deviations, sections)
        self._model = model

    @cached_property
    def _functions(self) -> tuple[ca.Function, ca.Function]:
        """Function of the differences of all places, and function of these with their derivatives."""
        count, sections = self._at.shape
        function = difference(self._model, self.record, sections)
        arguments = function.mx_in()
        value = ca.Function("value", arguments, function.call(arguments)[:1])
        return value.map("values", "serial", count, [2], []), function.map("derivatives", "serial", count, [2], [])

    def _arguments(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> list[FloatArray]:
        at = self._at.reshape(1, -1)
        measured = self._measured.reshape(at.size, -1).T
        return [x.T, inputs.T, p, at, measured]

    def residual(self, x: FloatArray, inputs: FloatArray, p: FloatArray) -> FloatArray:
        """Measured differences in standard deviations, place by place, shape (rows,).

        Args:
            x: unknowns of each place, shape (count, size).
            inputs: theirs, shape (count, size of the inputs).
            p: parameters.
        """
        values = self._functions[0](*self._arguments(x, inputs, p)).full().T
        scaled = values / self.sigma
        return np.asarray(scaled[self._known])

    def derivatives(
        self, x: FloatArray, inputs: FloatArray, p: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of the residual by x, inputs and p of its place, (rows, …) each."""
        count = len(self.cases)
        _, *matrices = self._functions[1](*self._arguments(x, inputs, p))
        by_x, by_inputs, by_p = ((split(matrix, count) / self.sigma[:, None])[self._known] for matrix in matrices)
        return by_x, by_inputs, by_p


def measured_numbers(
    record: Any, rows: Sequence[Sequence[Datum]], sections: int
) -> tuple[FloatArray, FloatArray, npt.NDArray[np.bool_]]:
    """Convert the data of one measurement to arrays.

    Args:
        record: the measurement.
        rows: data of each place, one for each of its sections.
        sections: most data of a place.

    Returns:
        abscissae, shape (places, sections); numbers, (places, sections, entries); mask of the measured differences,
        (places, sections, differences).
    """
    at = np.zeros((len(rows), sections))
    measured = QUANTITIES[record.quantity].blank(len(rows), sections)
    known = np.zeros((len(rows), sections, len(record.differences)), dtype=bool)
    for i, data in enumerate(rows):
        for k, datum in enumerate(data):
            at[i, k] = 0.0 if np.isnan(datum.at) else datum.at
            given = np.isfinite(datum.values)
            measured[i, k, given] = datum.values[given]
            # A measured pose has one number more than it has differences: all four of a quaternion, or none.
            known[i, k] = given[: known.shape[2]]
    return at, measured, known


def by_instant(rows: Sequence[tuple[int, list[Datum]]]) -> list[tuple[int, list[Datum]]]:
    """Group rows of cases by instant: rows of one time, or of one equilibrium, are together."""
    instants: dict[tuple[int, float | None], list[Datum]] = {}
    for case, data in rows:
        for datum in data:
            # No number that is none equals another.
            time = None if np.isnan(datum.time) else datum.time
            instants.setdefault((case, time), []).append(datum)
    return [(case, data) for (case, _), data in instants.items()]
