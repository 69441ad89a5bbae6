"""The sequence of discretisations of an inverse problem: modes of rods, or steps of tubes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.assess import min_modes
from cosserat_casadi.accuracy.levels import verified_model, verified_modes
from cosserat_casadi.accuracy.refine import FINER_MODES, solve
from cosserat_casadi.equilibrium.answer_error import estimated
from cosserat_casadi.equilibrium.contact.contact_answer_error import beside_finer, estimated_in_contact
from cosserat_casadi.equilibrium.contact.contact_state import given_inputs
from cosserat_casadi.equilibrium.metrics import SAFETY, largest_turn, prolong, with_estimate
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_functions import TubeFunctions
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import FEWEST_STEPS, MOST_STEPS, error_beside, finer_than, model_of, solution_near

MODES_OF_SHORT = (2, 4)
"""Modes of the first levels for rods with short elements, as each mode multiplies the optimiser's unknowns."""


class Levels(Protocol):
    """Levels of a scene, each verified by the next."""

    @property
    def counts(self) -> Sequence[int]:
        """Modes or steps of the levels that verify others."""

    def first(self) -> SystemFunctions:
        """The model of the first level."""

    def finer(self, count: int, model: Any, solutions: Sequence[Any]) -> SystemFunctions:
        """The model of a level that verifies the solutions of another one."""

    def told(self, model: Any) -> str:
        """A model in words."""

    def reference(self, solution: Any, finer: Any) -> Equilibrium[Any]:
        """The equilibrium of a finer model beside a solution, at the same inputs."""

    def judged(self, solution: Any, reference: Any) -> Equilibrium[Any]:
        """A solution with the error that its reference gives it, where both are equilibria."""


@dataclass(frozen=True)
class LevelsOfRods:
    """Levels of modes; a scene that fixes modes or nodes has one, and a few modes more verify it."""

    scene: scenes.Scene

    @property
    def counts(self) -> tuple[int, ...]:
        """Modes of the levels that verify others."""
        return self._modes[1:]

    def first(self) -> Model:
        """The model of the first level."""
        if self.scene.accuracy.fixed:
            return build(self.scene)
        return verified_model(self.scene, self._modes[0], 0.0)

    @property
    def _modes(self) -> tuple[int, ...]:
        """Modes of all levels; the first level verifies no other."""
        return verified_modes(self.scene, MODES_OF_SHORT)

    def finer(self, count: int, model: Model, solutions: Sequence[Solution]) -> Model:
        """Make the model of a level, with modes and intervals for the turns of the rods on the level before."""
        turns = [largest_turn(solution) for solution in solutions]
        tolerance = self.scene.accuracy.tolerance
        visible_from = [min_modes(*own, tolerance) for own in zip(solutions, turns, strict=True)]
        count = max(count, *visible_from)
        most = max(max(discretisation.modes) for discretisation in model.discretisation.values())
        if self.scene.accuracy.fixed or count <= most:
            count = max(count, most + FINER_MODES)
        return verified_model(self.scene, count, max(turns))

    def told(self, model: Model) -> str:
        """A model in words."""
        most_nodes = max(discretisation.nodes for discretisation in model.discretisation.values())
        return f"{model.size} unknowns, {most_nodes} intervals"

    def reference(self, solution: Solution, finer: Model) -> Solution:
        """The equilibrium of a finer model beside a solution, at the same inputs."""
        start = solution if self.scene.touches_exactly else prolong(solution, finer)
        given = given_inputs(solution.model, solution.inputs)
        return solve(finer, finer.inputs.unpack(given), start=start, estimate_error=False)

    def judged(self, solution: Solution, reference: Solution) -> Solution:
        """A solution with the error that its reference gives it, where both are equilibria."""
        if not solution.converged or not reference.converged:
            return solution
        if self.scene.touches_exactly:
            return beside_finer(solution, reference)
        return with_estimate(solution, reference)


@dataclass(frozen=True)
class LevelsOfTubes:
    """Levels of steps, each with twice the steps of the level before; the unknowns do not depend on the steps."""

    scene: scenes.Scene

    @property
    def counts(self) -> tuple[int, ...]:
        """Steps of the levels that verify others."""
        doublings = (MOST_STEPS // FEWEST_STEPS).bit_length()
        return tuple(FEWEST_STEPS * 2**power for power in range(1, doublings))

    def first(self) -> TubeFunctions:
        """The model of the first level."""
        return model_of(robot_of(self.scene), FEWEST_STEPS)

    def finer(self, count: int, model: TubeFunctions, solutions: Sequence[TubeSolution]) -> TubeFunctions:
        """The model of a level."""
        return model_of(model.robot, count)

    def told(self, model: TubeFunctions) -> str:
        """A model in words."""
        return f"{model.size} unknowns, {model.steps} steps a piece"

    def reference(self, solution: TubeSolution, finer: TubeFunctions) -> TubeSolution:
        """The equilibrium of a finer model beside a solution, at the same inputs."""
        return solution_near(finer, solution.inputs, solution.x)

    def judged(self, solution: TubeSolution, reference: TubeSolution) -> TubeSolution:
        """A solution with the error that its reference gives it, where both are equilibria."""
        return replace(solution, error_estimate=error_beside(solution, reference, SAFETY))


def levels_of(scene: scenes.Scene) -> Levels:
    """The levels of a scene of rods or of concentric tubes."""
    if scene.tubes:
        return LevelsOfTubes(scene)
    return LevelsOfRods(scene.baked())


def with_error(solution: Equilibrium[Any]) -> Equilibrium[Any]:
    """Add the error estimate to an equilibrium of a model, and keep its message."""
    if isinstance(solution, Solution):
        return estimated(solution) if not solution.model.scene.touches_exactly else estimated_in_contact(solution)
    assert isinstance(solution, TubeSolution)
    return replace(solution, error_estimate=error_beside(solution, finer_than(solution), SAFETY))
