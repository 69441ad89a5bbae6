"""C library of a model that maps rows of measurements to the inputs that explain them, for estimates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.kernel_files import kernel_sources
from cosserat_casadi.codegen.kernels import kernel, kernels
from cosserat_casadi.codegen.library import LEAST_MISFIT, FolderContents, library_sources
from cosserat_casadi.codegen.names import model_names
from cosserat_casadi.codegen.plain import pointer
from cosserat_casadi.codegen.rows import loaded, to_compile
from cosserat_casadi.compiling.c_tables import numbers
from cosserat_casadi.compiling.cache import kept_texts
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.numerics.arrow_least_squares import Limits

NAME = "estimate"
"""Prefix of every symbol of the libraries that estimate."""

ENDINGS = ("found", "no_equilibrium", "singular", "not_found")
"""Outcomes of the search for a row, in the order of their numbers in C."""

JUDGED = ("outcome", "iterations", "cost")
"""First columns of every row of results."""


@dataclass(frozen=True)
class Knowledge:
    """Prior knowledge of the unknowns of a row.

    Attributes:
        limits: bounds and priors.
        size: typical sizes of the unknowns, shape (unknowns,).
    """

    limits: Limits
    size: FloatArray

    @property
    def vectors(self) -> tuple[FloatArray, ...]:
        """Lower and upper bounds, means, weights and sizes, as arguments of functions in C."""
        limits = self.limits
        return limits.lower, limits.upper, limits.mean, limits.weight, self.size

    def with_held(self, values: FloatArray) -> Knowledge:
        """Append further numbers that are held at given values, shape (q,), to the unknowns.

        The prior of numbers that all rows share is counted once, not for each row: held numbers have no prior cost.
        """
        nothing = np.zeros_like(values)
        held = Limits(values, values, nothing, nothing, np.zeros(len(values), dtype=bool))
        sizes = np.where(values != 0.0, np.abs(values), 1.0)
        return Knowledge(self.limits.with_blocks(held, 1), np.concatenate([self.size, sizes]))


@dataclass(frozen=True)
class MeasuredCases:
    """Measured cases, as rows.

    Attributes:
        inputs: stacked inputs and parameters, the unknown ones with their initial values, shape
            (cases, inputs + parameters).
        at: abscissae of the measured sections, shape (cases, sections).
        measured: measured numbers, shape (cases, numbers).
        weights: inverse standard deviation of each difference, 0 if it was not measured, shape (cases, rows).
    """

    inputs: FloatArray
    at: FloatArray
    measured: FloatArray
    weights: FloatArray

    def part(self, rows: slice | npt.NDArray[np.int64]) -> MeasuredCases:
        """Select some of the cases."""
        return MeasuredCases(self.inputs[rows], self.at[rows], self.measured[rows], self.weights[rows])


@dataclass(frozen=True)
class Estimates:
    """Estimates of measured cases; NaN where a search has failed.

    Attributes:
        outcome: outcome of each search as an index of ENDINGS, shape (cases,).
        iterations: number of steps, shape (cases,).
        cost: half the sum of squares, including the prior, in squared standard deviations, shape (cases,).
        unknowns: estimated unknowns, shape (cases, k).
        information: inverse of the covariance, of data and prior, shape (cases, k, k).
        gradient: gradient of the cost, zero except for unknowns at their bounds, shape (cases, k).
        residuals: differences in standard deviations, 0 if not measured, shape (cases, rows).
        x: unknowns of the equilibria, shape (cases, size).
    """

    outcome: npt.NDArray[np.int64]
    iterations: npt.NDArray[np.int64]
    cost: FloatArray
    unknowns: FloatArray
    information: FloatArray
    gradient: FloatArray
    residuals: FloatArray
    x: FloatArray

    @classmethod
    def of_columns(cls, results: FloatArray, k: int, size: int) -> Estimates:
        """Split the results of the function in C, a row for each case, with k estimates and ``size`` unknowns."""
        rows = results.shape[1] - len(JUDGED) - 2 * k - k * k - size
        ends = np.cumsum([len(JUDGED), k, k * k, k, rows])
        judged, unknowns, information, gradient, residuals, x = np.split(results, ends, axis=1)
        return cls(
            outcome=judged[:, 0].astype(np.int64),
            iterations=judged[:, 1].astype(np.int64),
            cost=judged[:, 2],
            unknowns=unknowns,
            information=information.reshape(-1, k, k),
            gradient=gradient,
            residuals=residuals,
            x=x,
        )

    def first(self, count: int) -> Estimates:
        """Return the estimates of the first numbers, for all other numbers held."""
        return replace(
            self,
            unknowns=self.unknowns[:, :count],
            information=self.information[:, :count, :count],
            gradient=self.gradient[:, :count],
        )

    @classmethod
    def joined(cls, parts: Sequence[Estimates]) -> Estimates:
        """Join estimates of consecutive cases."""
        arrays = ([getattr(part, field.name) for part in parts] for field in fields(cls))
        return cls(*map(np.concatenate, arrays))

    @classmethod
    def chosen(cls, runs: Sequence[Estimates], run: npt.NDArray[np.int64]) -> Estimates:
        """Take each case from the run with its index in ``run``, shape (cases,)."""
        cases = np.arange(len(run))
        arrays = ([getattr(one, field.name) for one in runs] for field in fields(cls))
        return cls(*(np.array(of_runs)[run, cases] for of_runs in arrays))


@dataclass(frozen=True)
class EstimatorLibrary:
    """C sources as text, so that any machine can compile them, once.

    Attributes:
        files: content by file name, as pairs.
        unknowns: number of estimated numbers in each case.
        rows: number of differences between model and measurement in each case.
        size: number of unknowns of the model.
    """

    files: tuple[tuple[str, str], ...]
    unknowns: int
    rows: int
    size: int

    def estimate(self, cases: MeasuredCases, known: Knowledge) -> Estimates:
        """Compute the estimates that explain the cases best; other threads run meanwhile.

        Raises:
            ExportError: there is no C compiler, or it fails.
            MemoryError: there is none for the workspace.
        """
        k = self.unknowns
        count = len(cases.inputs)
        results = np.empty((count, len(JUDGED) + 2 * k + k * k + self.rows + self.size))
        tables = [cases.inputs, cases.at, cases.measured, cases.weights]
        given = [np.ascontiguousarray(array, dtype=np.float64) for array in (*tables, *known.vectors)]
        function = loaded(NAME, self.files)[f"{NAME}_estimate"]
        if function(count, *map(pointer, given), pointer(results)):
            raise MemoryError("there is no memory for the solver's workspace")
        return Estimates.of_columns(results, k, self.size)

    def costs(
        self, cases: MeasuredCases, inputs: FloatArray, x: FloatArray, known: Knowledge, steps: FloatArray
    ) -> FloatArray:
        """Compute costs at some steps from estimates, shape (cases, draws); infinite without an equilibrium.

        Args:
            cases: cases as for :meth:`estimate`.
            inputs: the estimates with all other inputs and parameters, shape (cases, inputs + parameters).
            x: unknowns of the equilibria at the estimates, shape (cases, size).
            known: prior knowledge as for :meth:`estimate`; outside its bounds a cost is infinite.
            steps: changes of the estimated numbers, shape (cases, draws, k).

        Raises:
            ExportError: there is no C compiler, or it fails.
            MemoryError: there is none for the workspace.
        """
        count, draws, _ = steps.shape
        results = np.empty((count, draws))
        tables = [inputs, x, cases.at, cases.measured, cases.weights]
        given = [np.ascontiguousarray(array, dtype=np.float64) for array in (*tables, *known.vectors, steps)]
        function = loaded(NAME, self.files)[f"{NAME}_costs"]
        if function(count, draws, *map(pointer, given), pointer(results)):
            raise MemoryError("there is no memory for the solver's workspace")
        return results


def estimator_library(
    model: Model, measured: ca.Function, indices: Sequence[int], kind: Sequence[Any]
) -> EstimatorLibrary:
    """Write sources of the solver of a model with a function that estimates inputs.

    Args:
        model: the measured model; its parameters are further inputs here.
        measured: (x, inputs, at, measured) ↦ differences between model and measurement, and their derivatives by x and
            by the estimated numbers. Parameters are appended to the inputs.
        indices: indices of the estimated numbers among the stacked inputs and parameters.
        kind: data that distinguish this function from others of the model.

    Raises:
        ExportError: two parts of the scene would have one name in C.
    """
    made_from = (estimator_library.__name__, model, kind)
    files = kept_texts(NAME, made_from, lambda: _texts(model, measured, indices))
    return EstimatorLibrary(tuple(files.items()), len(indices), measured.size1_out(0), model.size)


def _texts(model: Model, measured: ca.Function, indices: Sequence[int]) -> dict[str, str]:
    """Write the sources and headers of :func:`estimator_library`."""
    names = model_names(NAME, model)
    parts = assembled(model, names)
    generated = kernel_sources(kernels(model, names, parts), names)
    arguments = measured.mx_in()
    value = ca.Function("value", arguments, measured.call(arguments)[:1])
    own = [kernel(model, value, f"{NAME}_k_difference"), kernel(model, measured, f"{NAME}_k_measured")]
    generated |= kernel_sources(own, names, f"{NAME}_measured")
    words = {
        "name": names.name,
        "unknowns": len(indices),
        "indices": numbers(list(indices)),
        "rows": measured.size1_out(0),
        "sections": measured.nnz_in(2),
        "measured": measured.nnz_in(3),
    }
    files = {**library_sources(model, names, FolderContents(generated, parts)), **generated}
    # A part of the library's own source: it uses the solver's linear algebra.
    files[f"{NAME}.c"] += render("estimate.c.in", words)
    files[LEAST_MISFIT] = resource("c", LEAST_MISFIT)
    return dict(to_compile(files))
