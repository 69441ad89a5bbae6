"""A session of a page in the browser: moves, the error, inputs that bring a tip to a point.

Data that go to and from a page are inputs as it sends them, and equilibria as it draws them.
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
"""Questions that every session answers."""


@dataclass
class RobotSession(ABC):
    """A robot that is moved from a browser: the equilibrium it is in, and what can be asked about it.

    Attributes:
        first: the equilibrium at the scene's own inputs.
        asked: ranges of the sliders; by default the ranges that modes are chosen for.
        model: the model that is moved.
        questions: names of the questions that it answers, each by the method of that name.
        searched: the search for the inputs of a point.
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
        """Names of what can be led to a point, by kind."""
        return {"rod": list(self.model.lengths), "body": [body.name for body in self.model.scene.bodies]}

    @abstractmethod
    def facts(self) -> dict[str, Any]:
        """Facts of the scene for its page, which offers only the questions that this session answers."""

    def move(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs: along the way from the last one, or anew where that leads nowhere.

        Raises:
            SceneError: of tubes, an input is no number, or out of its range.
        """
        given = self._read(inputs)
        found = self._followed(given)
        if found is not None and found.converged:
            return self._accepted(given, found, anew=False)
        return self._accepted(given, self._solved(given), anew=found is not None)

    def reset(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs from where a solve begins, whatever was before; raises as :meth:`move`."""
        given = self._read(inputs)
        return self._accepted(given, self._solved(given), anew=False)

    def derivatives(self) -> list[float] | None:
        """Derivatives of all tips and bodies by all inputs, [pose][input][7]; None where there are none."""
        return None

    def eigenvalues(self) -> list[float] | None:
        """Eigenvalues of the second variation, ascending; None where they are not what stability is judged by."""
        return None

    def accuracy(self) -> dict[str, Any]:
        """The estimated error of the present equilibrium, as :func:`accuracy_of` tells it."""
        if not self._present.converged:
            return accuracy_of(None)
        return accuracy_of(solve(self.model, self._present.inputs, start=self._present.x))

    def reach(self, pose: Mapping[str, str], position: Sequence[float]) -> dict[str, Any]:
        """Inputs that bring a tip or a body to a point, as ``inverse`` finds them from where the robot is.

        Args:
            pose: {"rod": name} of a tip, of a rod or a tube; or {"body": name}.
            position: world axes, m.

        Returns:
            the equilibrium as :meth:`move` gives it, with the inputs and a sentence on whether the point is met.
        """
        target = scenes.PositionTarget(kind="position", position=tuple(position), **pose)
        key = tuple(pose.items())
        if key not in self._problems:
            # Other points are other parameters of the same problem.
            changes = {"targets": (target,), "bounds": self._bounds()}
            self._problems[key] = self._lifted(self.model.scene.model_copy(update=changes))
        problem = self._problems[key]
        start = solve(self.model, self._present.inputs, start=self._last.x, estimate_error=False)
        asked = replace(problem, targets=(target,), origin=problem.variables.clipped(start.inputs))
        found = with_verdict(type(self).searched(asked, start, stable=False, starts=0), stable=False)
        return {**self._reached(found), "inputs": found.solution.inputs.tolist()}

    def _bounds(self) -> tuple[scenes.Bound, ...]:
        """The scene's bounds, or else the ends of the sliders that a hand may move."""
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
        """Stacked inputs as the page sends them."""
        return stacked_inputs(inputs)

    @property
    def _last(self) -> Any:
        """The present equilibrium; the first one where there is none."""
        present = self._present
        return present if present.converged else self.first

    @abstractmethod
    def _followed(self, given: FloatArray) -> Any:
        """The end of the way to these inputs; None where none is followed, as without an equilibrium to begin at."""

    @abstractmethod
    def _solved(self, given: FloatArray) -> Any:
        """The end of a solve without a way."""

    @abstractmethod
    def _accepted(self, given: FloatArray, found: Any, *, anew: bool) -> dict[str, Any]:
        """The end of a solve for the page, which becomes the present equilibrium."""

    def _sliders(self) -> list[Slider]:
        return sliders(self.model, self.asked)

    def _lifted(self, scene: scenes.Scene) -> LiftedProblem:
        """The inverse problem of a scene with one target."""
        asked = build(scene, self.model.discretisation)
        return lifted_problem(asked, scene.targets, self.first, stable=False)

    def _reached(self, found: Inverse) -> dict[str, Any]:
        """The robot led to the inputs that a search found, and whether it is at the point then."""
        moved = self.move(found.solution.inputs.tolist())
        if not self._present.converged:
            return {**moved, "met": False}
        # The inputs are right for the equilibrium that was found: the way there may lead to another one.
        led_there = np.allclose(self._present.x, found.solution.x, rtol=0, atol=SAME)
        if found.met and not led_there:
            return {**moved, "text": ELSEWHERE, "met": False}
        return {**moved, "text": found.solution.message, "met": found.met}


def stacked_inputs(inputs: Sequence[float | None]) -> FloatArray:
    """Stacked inputs; NaN for null, which JSON has in place of a number."""
    return np.array([np.nan if value is None else value for value in inputs], dtype=np.float64)


def state_of(found: Equilibrium[Any] | CompiledSolution, drawn: FloatArray, *, anew: bool) -> dict[str, Any]:
    """The end of a solve for a page.

    Args:
        found: how the solve ended, in Python or in C.
        drawn: drawn parts of the equilibrium, shape (k,).
        anew: whether it was solved from the unloaded scene, because the last equilibrium led nowhere.
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
    """The estimated error of an equilibrium for a page: in words, and whether it is within the tolerance.

    Args:
        solution: with its estimates; None where there is no equilibrium.
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
