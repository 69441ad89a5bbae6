"""Sessions of a page in the browser: moves, error estimates, and inputs for a wanted tip position.

The page sends inputs, and receives equilibria as drawn parts.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.accuracy.refine import solve
from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.control.inverse import search
from cosserat_casadi.control.inverse_result import Inverse, with_verdict
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.page.slider_ranges import Slider, movable, sliders

SAME = 1e-5
"""Largest difference of unknowns between two solves of one equilibrium."""

ELSEWHERE = "These inputs have an equilibrium at the point, and lead the robot to another one."

OF_EVERY_SESSION = frozenset({"move", "reset", "derivatives", "eigenvalues", "accuracy"})
"""Questions answered by every session."""


@dataclass
class RobotSession(ABC):
    """A robot moved from a browser: its present equilibrium, and the questions about it.

    Attributes:
        first: the equilibrium at the inputs of the scene.
        asked: ranges of the sliders; by default those of the choice of modes.
        model: the model for moves.
        questions: names of the answered questions, which are the names of their methods.
        searched: the inverse problem for a wanted position.
    """

    first: Any
    asked: Given | None = None
    model: Any = field(init=False)
    questions: ClassVar[frozenset[str]] = OF_EVERY_SESSION
    searched: ClassVar[Callable[..., Inverse]] = search
    _present: Any = field(init=False)
    _problems: dict[tuple[tuple[str, str], ...], LiftedProblem] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        self.model = self.first.model
        self._present = self.first

    @property
    def pose_names(self) -> dict[str, list[str]]:
        """Names of rods and bodies with target positions, by kind."""
        return {"rod": list(self.model.lengths), "body": [body.name for body in self.model.scene.bodies]}

    @abstractmethod
    def facts(self) -> dict[str, Any]:
        """Facts of the scene for its page, with the questions that this session answers."""

    def move(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs: by continuation from the last one, or by a new solve if that fails.

        Raises:
            SceneError: an input of tubes is not a number or out of range.
        """
        given = self._read(inputs)
        found = self._followed(given)
        if found is not None and found.converged:
            return self._accepted(given, found, anew=False)
        return self._accepted(given, self._solved(given), anew=found is not None)

    def reset(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs by a solve from its default start; errors of :meth:`move`."""
        given = self._read(inputs)
        return self._accepted(given, self._solved(given), anew=False)

    def derivatives(self) -> list[float] | None:
        """Derivatives of all tip and body poses by all inputs, [pose][input][7]; None if undefined."""
        return None

    def eigenvalues(self) -> list[float] | None:
        """Eigenvalues of the second variation, ascending; None if they do not decide stability."""
        return None

    def accuracy(self) -> dict[str, Any]:
        """The estimated error of the present equilibrium, in the form of :func:`accuracy_of`."""
        if not self._present.converged:
            return accuracy_of(None)
        return accuracy_of(solve(self.model, self._present.inputs, start=self._present.x))

    def reach(self, pose: Mapping[str, str], position: Sequence[float]) -> dict[str, Any]:
        """Inputs that move a tip or a body to a point, by ``inverse`` from the present equilibrium.

        Args:
            pose: {"rod": name} for the tip of a rod or tube, or {"body": name}.
            position: target position, world axes, m.

        Returns:
            the equilibrium as from :meth:`move`, with the inputs, and a sentence on whether the target is met.
        """
        target = scenes.PositionTarget(kind="position", position=tuple(position), **pose)
        key = tuple(pose.items())
        if key not in self._problems:
            # The target position is a parameter of the same problem.
            changes = {"targets": (target,), "bounds": self._bounds()}
            self._problems[key] = self._lifted(self.model.scene.model_copy(update=changes))
        problem = self._problems[key]
        start = solve(self.model, self._present.inputs, start=self._last.x, estimate_error=False)
        asked = replace(problem, targets=(target,), origin=problem.variables.clipped(start.inputs))
        found = with_verdict(type(self).searched(asked, start, stable=False, starts=0), stable=False)
        return {**self._reached(found), "inputs": found.solution.inputs.tolist()}

    def _bounds(self) -> tuple[scenes.Bound, ...]:
        """Bounds of the scene, or else the ranges of the movable sliders."""
        bounds: tuple[scenes.Bound, ...] = self.model.scene.bounds
        if bounds:
            return bounds
        ends: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in movable(self.model)}
        for slider in self._sliders():
            if slider.input in ends:
                ends[slider.input][0].append(slider.least)
                ends[slider.input][1].append(slider.most)
        return tuple(
            scenes.Bound(input=name, lower=min(lower), upper=max(upper)) for name, (lower, upper) in ends.items()
        )

    def _read(self, inputs: Sequence[float | None]) -> FloatArray:
        """Stacked inputs from the page."""
        return stacked_inputs(inputs)

    @property
    def _last(self) -> Any:
        """The present equilibrium, or the first one if there is none."""
        present = self._present
        return present if present.converged else self.first

    @abstractmethod
    def _followed(self, given: FloatArray) -> Any:
        """The result of continuation to these inputs; None without continuation, e.g. without a start equilibrium."""

    @abstractmethod
    def _solved(self, given: FloatArray) -> Any:
        """The result of a solve without continuation."""

    @abstractmethod
    def _accepted(self, given: FloatArray, found: Any, *, anew: bool) -> dict[str, Any]:
        """The result of a solve in the form for the page; it becomes the present result."""

    def _sliders(self) -> list[Slider]:
        return sliders(self.model, self.asked)

    def _lifted(self, scene: scenes.Scene) -> LiftedProblem:
        """The inverse problem of a scene with one target."""
        asked = build(scene, self.model.discretisation)
        return lifted_problem(asked, scene.targets, self.first, stable=False)

    def _reached(self, found: Inverse) -> dict[str, Any]:
        """The robot moved to the inputs found by a search, and whether it meets the target there."""
        moved = self.move(found.solution.inputs.tolist())
        if not self._present.converged:
            return {**moved, "met": False}
        # Continuation to these inputs may lead to another equilibrium than the one found by the search.
        led_there = np.allclose(self._present.x, found.solution.x, rtol=0, atol=SAME)
        if found.met and not led_there:
            return {**moved, "text": ELSEWHERE, "met": False}
        return {**moved, "text": found.solution.message, "met": found.met}


def stacked_inputs(inputs: Sequence[float | None]) -> FloatArray:
    """Stacked inputs; NaN for null."""
    return np.array([np.nan if value is None else value for value in inputs], dtype=np.float64)


def state_of(found: Equilibrium[Any] | CompiledSolution, drawn: FloatArray, *, anew: bool) -> dict[str, Any]:
    """The result of a solve for a page.

    Args:
        found: outcome of the solve, in Python or in C.
        drawn: drawn parts of the equilibrium, shape (k,).
        anew: whether it was solved from the unloaded scene after a failed continuation.
    """
    return {
        "found": found.converged,
        "label": found.outcome.label,
        "text": found.outcome.value,
        "anew": anew,
        "loadFactor": found.load_factor,
        "iterations": found.iterations,
        "drawn": drawn.tolist(),
    }


def accuracy_of(solution: Equilibrium[Any] | None) -> dict[str, Any]:
    """The estimated error of an equilibrium for a page, as text, and whether it is within the tolerance.

    Args:
        solution: equilibrium with error estimates; None without an equilibrium.
    """
    if solution is None or solution.within_tolerance is None:
        return {"within": None, "text": "", "refines": False}
    accuracy = solution.model.scene.accuracy
    error = solution.judged_error
    if error is None or not solution.converged:
        return {"within": False, "text": solution.message, "refines": False}
    text = f"Estimated error {error:.1g} of the length, asked {accuracy.tolerance:g}."
    if not solution.within_tolerance:
        text += " " + solution.remedy
    scene = solution.model.scene
    refines = not (solution.within_tolerance or accuracy.fixed_by_hand or scene.touches_exactly or scene.tubes)
    return {"within": solution.within_tolerance, "text": text, "refines": refines}
