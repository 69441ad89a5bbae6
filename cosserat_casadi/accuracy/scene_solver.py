"""Common state of the solves of one scene, at one set of inputs, on one discretisation after the other.

See docs/theory.md, sections 9 and 10.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.equilibrium.judge import correct, judge
from cosserat_casadi.equilibrium.load_path import NEARLY_LOADED
from cosserat_casadi.equilibrium.metrics import prolong
from cosserat_casadi.equilibrium.relax import can_relax
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.solve import solve, stabilised
from cosserat_casadi.equilibrium.taut_rods import held_taut
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.required_modes import SLOW_MODES, signal_modes, unloaded_turn
from cosserat_casadi.numerics.continuation import ContinuationSettings
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress, Report
from cosserat_casadi.rod.discretisation import Discretisation

LOG = logging.getLogger(__name__)

TIGHT = 1e-6
"""Tolerance below which a reference solution takes the rotation integrator of eighth order, else of sixth."""

MOST_VAIN_DESCENTS = 3
"""Most discretisations on which descent fails: with few modes a rod may have no stable equilibrium."""


@dataclass
class SceneSolver:
    """Solves one scene at one set of inputs, on one discretisation after the other.

    Attributes:
        scene: the scene.
        values: inputs by name.
        stable: whether a stable equilibrium is wanted for a free rod too.
        progress: receives the share of the load path that is done.
        report: receives each attempt.
        relaxed: whether the current equilibrium, or the one it was corrected from, was reached by descent in energy.
        vain_descents: number of discretisations on which descent has failed.
        taut: whether the last solve ended early because of taut inextensible rods, for which more modes do not help.
        large_tension: whether tension grew so large on the last load path that the shape alone bounded its steps.
        iterations: Newton steps so far, on all discretisations.
    """

    scene: scenes.Scene
    values: Mapping[str, npt.ArrayLike] | None
    stable: bool
    progress: Progress | None
    report: Report | None
    relaxed: bool = False
    vain_descents: int = 0
    taut: bool = False
    large_tension: bool = False
    iterations: int = 0

    @property
    def tolerance(self) -> float:
        """Wanted error of the tip poses."""
        return self.scene.accuracy.tolerance

    @property
    def reference_transport(self) -> str:
        """Rotation integrator of a reference solution for the tolerance."""
        if self.tolerance < TIGHT or self.is_held:
            return "magnus8"
        return "magnus6"

    @cached_property
    def is_held(self) -> bool:
        """Whether rods are held at both ends, so that several equilibria are near each other, and can relax."""
        if not self.scene.supports:
            return False
        coarsest = build(self.scene, discretise(self.scene, 1, 2))
        return can_relax(coarsest)

    @property
    def is_assembly(self) -> bool:
        """Whether joints or carried rods tie rods together."""
        return bool(self.scene.joints) or any(rod.base.rod is not None for rod in self.scene.rods)

    @cached_property
    def unloaded_turn(self) -> float:
        """Largest turn of an element of an unloaded rod, rad."""
        return unloaded_turn(self.scene)

    @cached_property
    def signal_modes(self) -> int:
        """Least modes of a level that resolves the waves in the scene's data."""
        return signal_modes(self.scene)

    @property
    def wave_modes(self) -> int:
        """``signal_modes`` of a scene with waves along its rods, 0 if all signals vary slowly."""
        if self.signal_modes > SLOW_MODES:
            return self.signal_modes
        return 0

    def build(self, discretisation: dict[str, Discretisation]) -> Model:
        """The model on a discretisation, which is reported."""
        model = build(self.scene, discretisation)
        if self.report is not None:
            most_nodes = max(d.nodes for d in discretisation.values())
            self.report(f"{model.size} unknowns, {most_nodes} intervals")
        return model

    def solve(self, discretisation: dict[str, Discretisation], coarser: Solution | None) -> Solution:
        """Solution on a discretisation, from a coarser solution if that is near, else from the unloaded scene."""
        model = self.build(discretisation)
        if coarser is not None:
            # This stays on the branch of the coarser solution, and costs only a few Newton steps.
            corrected = corrected_from(model, prolong(coarser, model), coarser.inputs)
            if corrected is not None:
                return self._counted(corrected)
        method = "taut" if self.large_tension else "continuation"
        solution = solve(model, self.values, method=method, progress=self.progress, estimate_error=False)
        self._counted(solution)
        self.large_tension = solution.paced
        self.relaxed = False
        if solution.outcome is Outcome.LOAD_STALLED:
            self.taut = held_taut(model, solution.inputs)
            return solution if self.taut else self.relax(self._paced(solution))
        return solution

    def _paced(self, stalled: Solution) -> Solution:
        """The end of a path on which the shape alone bounds the steps, if loads without a potential leave no other."""
        model, inputs = stalled.model, stalled.inputs
        if stalled.load_factor <= NEARLY_LOADED or self.is_assembly or model.has_potential(inputs):
            return stalled
        paced = self._counted(solve(model, self.values, method="taut", progress=self.progress, estimate_error=False))
        self.large_tension = paced.converged
        return paced if paced.converged else stalled

    def _counted(self, solution: Solution) -> Solution:
        """Count the iterations of a solution, log it, and return it."""
        self.iterations += solution.iterations
        sizes = {name: (chosen.modes, chosen.nodes) for name, chosen in solution.model.discretisation.items()}
        LOG.info("modes and intervals %s: %s, %d iterations", sizes, solution.outcome.name, solution.iterations)
        return solution

    def relax(self, solution: Solution) -> Solution:
        """A stable solution if one is wanted and found, else the given solution.

        For a held rod it is always wanted: springs of the solver, not loads of the scene, lead to its supports.
        """
        wanted_stable = self.stable or bool(self.scene.supports)
        if not wanted_stable or solution.stable or self.vain_descents == MOST_VAIN_DESCENTS:
            return solution
        if not solution.model.has_potential(solution.inputs):
            return solution
        relaxed = stabilised(solution, ContinuationSettings(), self.progress)
        self.iterations += relaxed.iterations - solution.iterations
        self.relaxed = bool(relaxed.stable)
        self.vain_descents += not relaxed.stable
        return relaxed


def corrected_from(model: Model, start: FloatArray, inputs: FloatArray) -> Solution | None:
    """Newton's method from a near start; None if it does not stay near, and may be on another branch."""
    settings = ContinuationSettings().newton
    result = correct(model, inputs, start, settings)
    if result is None:
        return None
    return judge(model, inputs, result.x, result.outcome, result.iterations, 1.0, settings.tolerance)
