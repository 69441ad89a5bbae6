"""Result of an identification: the identified numbers, their uncertainty, and the remaining misfit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.identification.fit_unknowns import UnknownLayout
from cosserat_casadi.identification.fitted_scene import with_identified
from cosserat_casadi.identification.measured_quantities import QUANTITIES
from cosserat_casadi.identification.statistics import Statistics
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.result import Result
from cosserat_casadi.scene import Scene
from cosserat_casadi.tubes.tube_functions import AnyModel

OUTLIER = 4.0
"""Residual, in standard deviations of the residuals, above which a number is reported as an outlier."""

EARLY = ("stalled", "max_iterations")
"""Outcomes of searches that ended before the minimum of the misfit."""

NORMAL_MEDIAN = 0.6744897501960817
"""Median absolute value of a normally distributed number, in standard deviations."""


@dataclass(frozen=True)
class Row:
    """One measured number, with that of the model.

    Attributes:
        where: its row in words.
        measurement: index of its measurement.
        entry: index of the number in the quantity.
        case: index of its case.
        measured: measured value, SI units; 0 for an orientation.
        modelled: measured value plus the difference.
        residual: the difference in standard deviations.
        weight: weight of the residual in the loss, 1 for full weight.
        held_out: whether it was predicted and not fitted.
        time: time of the measurement in its motion, s; None in an equilibrium.
        at: abscissa X, or number of the mode, of its row; None without one.
    """

    where: str
    measurement: int
    entry: int
    case: int
    measured: float
    modelled: float
    residual: float
    weight: float
    held_out: bool
    time: float | None = None
    at: float | None = None


@dataclass(frozen=True)
class MarkerDistances:
    """Distances of the model from one marker, over all rows in which all of its coordinates were measured.

    Attributes:
        measurement: index of its measurement.
        at: abscissa X of its section; None for a marker on a body.
        rows: number of rows, without the held-out ones.
        rms: root mean square of the distances, m.
        largest: largest distance, m.
        mean: mean of model less measurement, world axes, shape (3,), m, which an offset of the marker could explain.
    """

    measurement: int
    at: float | None
    rows: int
    rms: float
    largest: float
    mean: FloatArray


@dataclass(frozen=True)
class LeftOut:
    """A case that took no part.

    Attributes:
        where: its first row in words.
        reason: reason, as a sentence.
    """

    where: str
    reason: str


@dataclass(frozen=True, repr=False)
class Identification(Result):
    """Result of an identification.

    Attributes:
        model: the fitted model, with its parameters.
        layout: the unknowns.
        shared: identified numbers that all cases share, shape (n,), in the order of ``layout.shared_labels``.
        own: identified numbers of each case, shape (cases, k).
        statistics: statistics of the shared unknowns.
        converged: whether the misfit is minimal, and data and priors determine the numbers.
        outcome: outcome in a word.
        message: outcome in sentences.
        iterations: number of steps of the search.
        cost: half the sum of squares, in squared standard deviations, including priors.
        rows: every measured number with that of the model.
        cases: first row of each case, in words.
        unknowns_x: unknowns of the model in each case, for motions at their start, shape (cases, size). Cases
            in exact contact have different models: see equilibria.
        inputs: stacked inputs of each case, for motions at their start, shape (cases, size of the inputs).
        unstable: cases whose equilibrium is unstable.
        left_out: cases that took no part.
        at_bounds: names of the numbers that are at a bound.
        warnings: warnings as sentences.
        starts: number of starts, and number of starts that ended here.
        step: step size of the measured motions, s; None if nothing was measured over time.
        step_error: largest error of a residual by these steps, in standard deviations; None without steps.
        error_estimate: largest estimated error of the measured equilibria by modes and nodes, as for a solution:
            distance over the length, angle in rad, 1 if unknown; None without equilibria.
        error_case: the case with the largest such error; None without equilibria.
        equilibria: equilibria of the cases with their contacts, for exact contact.
    """

    model: AnyModel
    layout: UnknownLayout
    shared: FloatArray
    own: FloatArray
    statistics: Statistics
    converged: bool
    outcome: str
    message: str
    iterations: int
    cost: float
    rows: tuple[Row, ...]
    cases: tuple[str, ...]
    unknowns_x: FloatArray
    inputs: FloatArray
    unstable: tuple[str, ...]
    left_out: tuple[LeftOut, ...]
    at_bounds: tuple[str, ...]
    warnings: tuple[str, ...]
    starts: tuple[int, int]
    step: float | None = None
    step_error: float | None = None
    error_estimate: float | None = None
    error_case: str | None = None
    equilibria: tuple[Solution, ...] = ()

    @property
    def within_tolerance(self) -> bool | None:
        """Whether the estimated error is within the scene's tolerance; None if no tolerance has a meaning."""
        accuracy = self.model.scene.accuracy
        if self.error_estimate is None or not accuracy.binds:
            return None
        return self.error_estimate <= accuracy.tolerance

    @cached_property
    def parameters(self) -> dict[str, FloatArray]:
        """Values of the parameters by name, as arguments of ``solve(…, parameters=…)``."""
        values = self.layout.identified(self.shared, of_input=False)
        defaults = {entry.name: entry.shape for entry in self.model.parameters.entries}
        return {name: value.reshape(defaults[name], order="F") for name, value in values.items()}

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of the numbers that all cases share."""
        return self.layout.shared_labels

    @property
    def sigma(self) -> FloatArray:
        """Standard deviations, shape (n,); NaN if undetermined."""
        return self.statistics.sigma

    @property
    def intervals(self) -> FloatArray:
        """Intervals that contain the true values in 95 % of all experiments, shape (n, 2); NaN if undetermined."""
        half = self.statistics.quantile * self.sigma
        return np.column_stack([self.shared - half, self.shared + half])

    def rms(self, *, held_out: bool = False, measurement: int | None = None) -> float | None:
        """Root mean square of the residuals, in standard deviations; None without residuals."""
        chosen = [
            row.residual for row in self.rows if row.held_out is held_out and measurement in (None, row.measurement)
        ]
        return float(np.sqrt(np.mean(np.square(chosen)))) if chosen else None

    @property
    def distances(self) -> tuple[MarkerDistances, ...]:
        """Distances of the model from each marker, in the order of the measurements and along the rods."""
        apart: dict[tuple[int, float | None], dict[tuple[int, str], dict[int, float]]] = {}
        for row in self.rows:
            record = self.model.scene.measurements[row.measurement]
            if row.held_out or row.entry >= QUANTITIES[record.quantity].coordinates:
                continue
            of_marker = apart.setdefault((row.measurement, row.at), {})
            of_marker.setdefault((row.case, row.where), {})[row.entry] = row.modelled - row.measured
        markers = []
        for (measurement, at), by_row in sorted(apart.items(), key=lambda item: (item[0][0], item[0][1] or 0.0)):
            whole = [[parts[axis] for axis in range(3)] for parts in by_row.values() if len(parts) == 3]
            if whole:
                differences = np.array(whole)
                sizes = np.linalg.norm(differences, axis=1)
                rms = float(np.sqrt(np.mean(sizes**2)))
                mean = differences.mean(axis=0)
                markers.append(MarkerDistances(measurement, at, len(whole), rms, float(sizes.max()), mean))
        return tuple(markers)

    @property
    def outliers(self) -> tuple[Row, ...]:
        """Outliers: numbers far from the model, the farthest first.

        If most residuals exceed the stated deviations, they are compared with their median.
        """
        fitted = [row for row in self.rows if not row.held_out]
        fitted.sort(key=lambda row: -abs(row.residual))
        sizes = [abs(row.residual) for row in fitted]
        spread = max(1.0, float(np.median(sizes)) / NORMAL_MEDIAN) if sizes else 1.0
        return tuple(row for row in fitted if abs(row.residual) > OUTLIER * spread)

    @property
    def ended_early(self) -> bool:
        """Whether the search ended before the minimum of the misfit, with numbers better than those of the start."""
        return self.outcome in EARLY

    def fitted_scene(self, scene: Scene | None = None, *, early: bool = False) -> Scene:
        """Make the scene with the identified numbers; unknowns of single cases keep the scene's values.

        Args:
            scene: the scene that was identified; by default the model's, with its inputs and parameters.
            early: whether numbers of a search that ended early are accepted.

        Raises:
            SceneError: nothing was found, or the scene refuses a number.
        """
        if not self.converged and not (early and self.ended_early):
            raise SceneError(Problem("unknowns", "were not found", self.message))
        return with_identified(scene or self.model.scene, self.model, self.layout, self.shared)

    def value(self, name: str) -> float | npt.NDArray[np.float64]:
        """Return the identified value of an unknown that all cases share, by its name.

        Raises:
            KeyError: there is no such unknown.
        """
        values = self.layout.identified(self.shared, of_input=False)
        values |= self.layout.identified(self.shared, of_input=True)
        if name not in values:
            raise KeyError(f"{name!r} is not an unknown that all cases share; they are {', '.join(values) or 'none'}")
        found = values[name]
        return float(found[0]) if found.size == 1 else found
