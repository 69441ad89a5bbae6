"""Session of a page in the browser: equilibria, derivatives, inputs for a point, modes, the motion."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.fixing import unfixed
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.codegen.compiler import Progress
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.load import load
from cosserat_casadi.control.inverse import search
from cosserat_casadi.control.inverse_result import with_verdict
from cosserat_casadi.control.lifted_problem import LiftedProblem, lifted_problem
from cosserat_casadi.equilibrium.metrics import prolong
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, variations
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.motion.motion_refinement import simulate
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.motion.vibration_modes import modes_of
from cosserat_casadi.page.drawn_model import DrawnModel, drawn_numbers
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.page.slider_ranges import movable, sliders
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.view.answers import accuracy_of, stacked_inputs, state_of
from cosserat_casadi.view.contact_session import ContactSession
from cosserat_casadi.view.tube_session import TubeSession

NAME = "viewed"
"""Prefix of the symbols of the compiled library."""

SWING = 0.15
"""Largest displacement of a mode that is drawn over the rod's length, or largest angle, rad."""

PERIOD_FRAMES = 60
"""Pictures of one period of a mode."""

MODES = 6
"""Modes that are offered."""

FRAME_RATE = 60.0
"""Pictures per second of a motion, as far as they are not too few or too many."""

FEWEST_FRAMES, MOST_FRAMES = 100, 600

SAME = 1e-5
"""Largest difference of unknowns between two solves of one equilibrium."""

REFINED_SHARE = 0.5
"""Share of the tolerance for which modes are chosen at the hand: the estimate lies above the error by a factor."""

ELSEWHERE = "These inputs have an equilibrium at the point, and lead the robot to another one."


@dataclass
class ViewSession:
    """A robot that is moved from a browser: the equilibrium it is in, and what can be asked about it.

    Attributes:
        first: the equilibrium at the scene's own inputs.
        library: the compiled library of its model, with the picture.
        asked: ranges of the sliders; by default the ranges that modes are chosen for.
    """

    first: Solution
    library: Compiled
    asked: Given | None = None
    _inputs: FloatArray = field(init=False)
    _present: CompiledSolution | None = field(init=False, default=None)

    def __post_init__(self) -> None:
        self._inputs = self.first.inputs

    @property
    def input_count(self) -> int:
        """Numbers in the stacked inputs."""
        return self.first.model.inputs.size

    def facts(self) -> dict[str, Any]:
        """Facts of the scene for its page."""
        has_motion = self.first.model.scene.simulation is not None
        return {**page_facts(self.first, asked=self.asked), "motion": has_motion, "modes": True}

    def move(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs: along the way from the last one, or anew where that leads nowhere."""
        given = stacked_inputs(inputs)
        before = self._present
        anew = False
        if before is not None and before.converged:
            found = self.library.follow(self._inputs, given, before.x)
            anew = not found.converged
        if before is None or not before.converged or anew:
            found = self.library.solve(given)
        return self._accepted(given, found, anew)

    def reset(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs from the unloaded scene, whatever was before."""
        given = stacked_inputs(inputs)
        return self._accepted(given, self.library.solve(given), False)

    def derivatives(self) -> list[float] | None:
        """Derivatives of all tips and bodies by all inputs, [pose][input][7]; None where there are none."""
        if self._present is None or not self._present.converged:
            return None
        tips = self.library.sensitivity(self._inputs, self._present.x)
        bodies = self.library.body_sensitivity(self._inputs, self._present.x)
        if tips is None or bodies is None:
            return None
        by_inputs = [derivative.T.ravel() for derivative in (*tips[1].values(), *bodies.values())]
        return list(np.concatenate(by_inputs).tolist())

    def eigenvalues(self) -> list[float] | None:
        """Eigenvalues of the second variation, ascending; None where stability has no meaning."""
        if self._present is None or not self._present.converged or not self.first.model.has_potential(self._inputs):
            return None
        model = self.first.model
        jacobian = model.path_jacobian(self._present.x, self._inputs, 1.0).full()
        return list(admissible_eigenvalues(jacobian, variations(model)).tolist())

    def accuracy(self) -> dict[str, Any]:
        """The estimated error of the present equilibrium, in words, and whether it is within the tolerance.

        Returns:
            ``within``: whether it is; None where no tolerance has a meaning, or there is no equilibrium. ``text``: a
            sentence for the hand. ``refines``: whether :meth:`refined` may do better.
        """
        if self._present is None or not self._present.converged:
            return accuracy_of(None)
        model = self.first.model
        return accuracy_of(solve(model, self._inputs, start=self._present.x))

    def refined(self, inputs: Sequence[float | None], near: FloatArray) -> dict[str, Any]:
        """The equilibrium for these inputs to the tolerance, on modes that are chosen for them.

        Args:
            inputs: stacked.
            near: unknowns of the equilibrium beside it, from which Newton's method starts: it stays on the branch.

        Returns:
            ``within`` and ``text`` as of :meth:`accuracy`, and its ``drawn`` parts; None where it is not within the
            tolerance either.
        """
        model = self.first.model
        given = stacked_inputs(inputs)
        values = model.inputs.unpack(given)
        finer = unfixed(model.scene, REFINED_SHARE * model.scene.accuracy.tolerance)
        chosen = solve_rods(finer, values).model.discretisation
        refined = build(model.scene, chosen)
        coarse = replace(self.first, inputs=given, x=near)
        found = solve(refined, values, start=prolong(coarse, refined))
        answer = accuracy_of(found)
        if not found.within_tolerance:
            return {**answer, "drawn": None}
        text = f"Drawn with modes that are chosen for these inputs: {refined.size} unknowns. {answer['text']}"
        return {**answer, "text": text, "drawn": drawn_numbers(model, found).tolist()}

    @property
    def present(self) -> FloatArray:
        """Unknowns of the present equilibrium; those of the first where there is none."""
        return self._x

    def reach(self, pose: Mapping[str, str], position: Sequence[float]) -> dict[str, Any]:
        """Inputs that bring a tip or a body to a point, as ``inverse`` finds them from where the robot is.

        Args:
            pose: {"rod": name} of a tip, or {"body": name}.
            position: world axes, m.

        Returns:
            the equilibrium as :meth:`move` gives it, with the inputs and a sentence on whether the point is met.
        """
        target = scenes.PositionTarget(kind="position", position=tuple(position), **pose)
        problem = self._problem(*pose.items())
        model = self.first.model
        start = solve(model, model.inputs.unpack(self._inputs), start=self._x, estimate_error=False)
        origin = problem.variables.clipped(start.inputs)
        asked = replace(problem, targets=(target,), origin=origin)
        found = with_verdict(search(asked, start, stable=False, starts=0), stable=False)
        solution = found.solution
        inputs = solution.inputs.tolist()
        moved = self.move(inputs)
        if self._present is None or not self._present.converged:
            return {**moved, "inputs": inputs, "met": False}
        # The inputs are right for the equilibrium that was found: the way there may lead to another one.
        led_there = np.allclose(self._present.x, solution.x, rtol=0, atol=SAME)
        if found.met and not led_there:
            return {**moved, "inputs": inputs, "text": ELSEWHERE, "met": False}
        return {**moved, "inputs": inputs, "text": solution.message, "met": found.met}

    def modes(self) -> dict[str, Any]:
        """Modes about the present equilibrium, each with the pictures of one period.

        Raises:
            SceneError: nothing that may move has mass.
        """
        model = self.first.model
        solution = solve(model, model.inputs.unpack(self._inputs), start=self._x)
        found = modes_of(solution, count=MODES)
        phases = 2 * np.pi * np.arange(PERIOD_FRAMES) / PERIOD_FRAMES
        entries = []
        for mode in found.modes:
            # From the equilibrium on.
            swing = SWING * np.imag(np.exp(1j * phases)[:, None] * mode.vector)
            pictures = [self.library.drawn(solution.x + part, self._inputs).full()[:, 0] for part in swing]
            words = f"{mode.frequency:.4g} Hz, {mode.words}"
            entries.append({"words": words, "frames": _packed(np.array(pictures))})
        return {"text": found.stability, "modes": entries}

    def motion(self) -> dict[str, Any]:
        """The motion of the scene, at its own inputs, as pictures evenly spaced in time.

        Raises:
            SceneError: nothing that may move has mass.
        """
        motion: Motion = simulate(self.first.model.scene)
        if not len(motion.times):
            return {"text": motion.message, "times": [], "frames": ""}
        first, last = float(motion.times[0]), float(motion.times[-1])
        wanted = int(FRAME_RATE * (last - first))
        times = np.linspace(first, last, min(max(wanted, FEWEST_FRAMES), MOST_FRAMES))
        drawn = DrawnModel(motion.model.discrete).drawn
        states = [motion.at(time) for time in times]
        pictures = [drawn(state.x, state.inputs).full()[:, 0] for state in states]
        return {"text": motion.message, "times": times.tolist(), "frames": _packed(np.array(pictures))}

    @property
    def _x(self) -> FloatArray:
        """Unknowns of the present equilibrium; those of the first where there is none."""
        if self._present is None or not self._present.converged:
            return self.first.x
        return self._present.x

    def _accepted(self, inputs: FloatArray, found: CompiledSolution, anew: bool) -> dict[str, Any]:
        self._inputs = inputs
        self._present = found
        return state_of(found, self.library.drawn(found.x, inputs).full()[:, 0], anew=anew)

    @cached_property
    def _problems(self) -> dict[tuple[tuple[str, str], ...], LiftedProblem]:
        return {}

    def _problem(self, *pose: tuple[str, str]) -> LiftedProblem:
        """The inverse problem of a tip or a body, made once: other points are other parameters of it."""
        if pose not in self._problems:
            model = self.first.model
            target = scenes.PositionTarget(kind="position", position=(0.0, 0.0, 0.0), **dict(pose))
            changes = {"targets": (target,), "bounds": self._bounds()}
            asked = build(model.scene.model_copy(update=changes), model.discretisation)
            self._problems[pose] = lifted_problem(asked, asked.scene.targets, self.first, stable=False)
        return self._problems[pose]

    def _bounds(self) -> tuple[scenes.Bound, ...]:
        """The scene's bounds, or else the ends of the sliders that a hand may move."""
        model = self.first.model
        if model.scene.bounds:
            return model.scene.bounds
        names = movable(model)
        ends: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in names}
        for slider in sliders(model, self.asked):
            if slider.input in ends:
                ends[slider.input][0].append(slider.least)
                ends[slider.input][1].append(slider.most)
        return tuple(
            scenes.Bound(input=name, lower=min(lower), upper=max(upper)) for name, (lower, upper) in ends.items()
        )


def is_compiled(scene: scenes.Scene) -> bool:
    """Whether the compiled library moves a scene; tubes and exact contact are solved by Python alone."""
    if scene.tubes:
        return False
    try:
        refuse_obstacles(scene, "a compiled library")
    except SceneError:
        return False
    return True


def opened(
    solution: Equilibrium[Any], progress: Progress | None = None, asked: Given | None = None
) -> ViewSession | ContactSession | TubeSession:
    """A session of a solved scene, with its library compiled, or found compiled, where it has one.

    Args:
        solution: the equilibrium at the scene's own inputs.
        progress: told how far the compilation is.
        asked: ranges of the sliders; by default the ranges that modes are chosen for.

    Raises:
        ExportError: there is no C compiler, or it fails.
    """
    if isinstance(solution, TubeSolution):
        return TubeSession(solution)
    assert isinstance(solution, Solution)
    if not is_compiled(solution.model.scene):
        return ContactSession(solution, asked)
    with tempfile.TemporaryDirectory() as folder:
        # The compiled library lies in the cache: the sources are not needed any more.
        sources = export(DrawnModel(solution.model.discrete), Path(folder) / NAME, NAME)
        library = load(sources, progress=progress)
    assert isinstance(library, Compiled)
    return ViewSession(solution, library, asked)


def _packed(pictures: FloatArray) -> str:
    """Pictures as 32-bit floats in base64, one after the other."""
    return base64.b64encode(pictures.astype("<f4").tobytes()).decode()
