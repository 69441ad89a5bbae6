"""Sought inputs: changes of decision variables in their scales, and the verdict on their inputs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.control.decision_variables import DecisionVariables
from cosserat_casadi.control.inverse_result import Inverse, meets_all
from cosserat_casadi.control.targets import target_errors
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.system_functions import SystemFunctions

SEED = 20_240
"""Seed of the generator that scatters starts, so that equal scenes have equal starts."""

AT_BOUND = 1e-6
"""Distance from a bound, over half the range, below which an input counts as at the bound."""


@dataclass(frozen=True)
class SoughtInputs(ABC):
    """Targets, and n decision variables as changes in their scales from an origin.

    Attributes:
        model: the model.
        targets: poses and positions to reach.
        variables: the decision variables.
        scale: scale of each decision variable, shape (n,).
        origin: stacked inputs from which changes are counted.
    """

    model: SystemFunctions
    targets: tuple[scenes.Target, ...]
    variables: DecisionVariables
    scale: FloatArray
    origin: FloatArray

    @abstractmethod
    def solve(self, start: Equilibrium[Any], change: FloatArray) -> Inverse:
        """Search from one start, and judge the result.

        Args:
            start: solution at the initial inputs.
            change: initial inputs as changes from the origin in their scales, shape (n,).
        """

    def judged(self, start: Equilibrium[Any] | FloatArray | None, change: FloatArray, rounds: int) -> Inverse:
        """Solve for the equilibrium at the resulting inputs, and judge it like any other.

        Args:
            start: solution, or unknowns, from which the solve starts; None for the unloaded scene.
            change: resulting decision variables, as changes from the origin in their scales, shape (n,).
            rounds: number of runs of the optimiser.
        """
        inputs = self.inputs(change)
        values = self.model.inputs.unpack(inputs)
        solution = solve(self.model, values, start=start, estimate_error=False)
        gaps = target_errors(solution, self.targets)
        result = Inverse(solution, self.targets, gaps, False, rounds, at_bounds=self._at_bounds(inputs))
        return replace(result, met=meets_all(result))

    def change(self, inputs: FloatArray) -> FloatArray:
        """Decision variables among stacked inputs, clipped to their ranges, as changes from the origin, shape (n,)."""
        difference = self.variables.clipped(inputs) - self.origin
        return np.asarray(difference[self.variables.indices] / self.scale)

    def inputs(self, change: FloatArray) -> FloatArray:
        """Stacked inputs for a change of the decision variables, shape (inputs,)."""
        inputs = self.origin.copy()
        inputs[self.variables.indices] += self.scale * change
        # Rounding may leave a range by the last digit.
        return self.variables.clipped(inputs)

    def scattered(self, count: int) -> FloatArray:
        """Scatter initial changes of the decision variables, shape (count, n); empty if no range is closed.

        Entries without a range on both sides stay at the origin.
        """
        lower, upper = self.ranges()
        closed = np.isfinite(upper - lower) & (upper > lower)
        if not np.any(closed):
            return np.zeros((0, len(self.scale)))
        shares = np.random.default_rng(SEED).random((count, len(self.scale)))
        least = np.where(closed, lower, 0.0)
        most = np.where(closed, upper, 0.0)
        return np.asarray(least + shares * (most - least))

    def _at_bounds(self, inputs: FloatArray) -> tuple[str, ...]:
        """Names of the decision variables at a bound, without variables whose bounds coincide."""
        variables = self.variables
        values = inputs[variables.indices]
        near = AT_BOUND * self.scale
        at_bound = (values <= variables.lower + near) | (values >= variables.upper - near)
        free = variables.upper > variables.lower
        stacked = set(variables.indices[at_bound & free].tolist())
        slices = self.model.inputs.slices.items()
        return tuple(name for name, entries in slices if stacked & set(range(entries.start, entries.stop)))

    def ranges(self) -> tuple[FloatArray, FloatArray]:
        """Least and largest changes of the decision variables, each of shape (n,)."""
        start = self.origin[self.variables.indices]
        lower = (self.variables.lower - start) / self.scale
        upper = (self.variables.upper - start) / self.scale
        return lower, upper
