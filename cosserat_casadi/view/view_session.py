"""Session with a compiled library: equilibria, derivatives, inputs for a target, modes and the motion."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.fixing import unfixed
from cosserat_casadi.accuracy.ranges import Given
from cosserat_casadi.accuracy.refine import solve_rods
from cosserat_casadi.codegen.compiled import Compiled
from cosserat_casadi.codegen.compiled_results import CompiledSolution
from cosserat_casadi.codegen.export import export
from cosserat_casadi.codegen.load import load
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
from cosserat_casadi.numerics.progress import StageProgress
from cosserat_casadi.page.drawn_model import DrawnModel, drawn_numbers
from cosserat_casadi.page.page_facts import page_facts
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.view.contact_session import ContactSession
from cosserat_casadi.view.robot_session import OF_EVERY_SESSION, RobotSession, accuracy_of, stacked_inputs, state_of
from cosserat_casadi.view.tube_session import TubeSession

NAME = "viewed"
"""Prefix of the symbols of the compiled library."""

SWING = 0.15
"""Largest drawn displacement of a mode over the length of the rod, or largest drawn angle, rad."""

PERIOD_FRAMES = 60
"""Number of pictures of one period of a mode."""

MODES = 6
"""Largest number of modes."""

FRAME_RATE = 60.0
"""Pictures per second of a motion, within the limits of their number."""

FEWEST_FRAMES, MOST_FRAMES = 100, 600

REFINED_SHARE = 0.5
"""Share of the tolerance in the choice of refined modes: the estimate exceeds the error by a factor."""


@dataclass
class ViewSession(RobotSession):
    """A robot moved by its compiled library.

    Attributes:
        library: the compiled library of its model, with the drawing function.
    """

    library: Compiled = field(kw_only=True)
    questions = OF_EVERY_SESSION | {"reach", "refined", "modes", "motion"}

    def facts(self) -> dict[str, Any]:
        """Facts of the scene for its page."""
        has_motion = self.first.model.scene.simulation is not None
        return {**page_facts(self.first, asked=self.asked), "motion": has_motion, "modes": True}

    def derivatives(self) -> list[float] | None:
        """Derivatives of all tips and bodies by all inputs, [pose][input][7]; None where there are none."""
        if not self._present.converged:
            return None
        tips = self.library.sensitivity(self._present.inputs, self._present.x)
        bodies = self.library.body_sensitivity(self._present.inputs, self._present.x)
        if tips is None or bodies is None:
            return None
        by_inputs = [derivative.T.ravel() for derivative in (*tips[1].values(), *bodies.values())]
        return list(np.concatenate(by_inputs).tolist())

    def eigenvalues(self) -> list[float] | None:
        """Eigenvalues of the second variation, ascending; None if stability is undefined."""
        if not self._present.converged or not self.first.model.has_potential(self._present.inputs):
            return None
        model = self.first.model
        jacobian = model.path_jacobian(self._present.x, self._present.inputs, 1.0).full()
        return list(admissible_eigenvalues(jacobian, variations(model)).tolist())

    def refined(self, inputs: Sequence[float | None]) -> dict[str, Any]:
        """The equilibrium for these inputs within the tolerance, with modes chosen for them.

        Newton's method starts from the present equilibrium, nearby on the same branch.

        Returns:
            ``within`` and ``text`` as of :meth:`accuracy`, and its ``drawn`` parts; None if it is not within the
            tolerance either.
        """
        near = self._last.x
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
        text = f"The drawing has modes chosen for these inputs: {refined.size} unknowns. {answer['text']}"
        return {**answer, "text": text, "drawn": drawn_numbers(model, found).tolist()}

    def modes(self) -> dict[str, Any]:
        """Modes at the present equilibrium, each with the pictures of one period.

        Raises:
            SceneError: no movable part has mass.
        """
        model = self.first.model
        solution = solve(model, model.inputs.unpack(self._present.inputs), start=self._last.x)
        found = modes_of(solution, count=MODES)
        phases = 2 * np.pi * np.arange(PERIOD_FRAMES) / PERIOD_FRAMES
        entries = []
        for mode in found.modes:
            # The period starts at the equilibrium.
            swing = SWING * np.imag(np.exp(1j * phases)[:, None] * mode.vector)
            pictures = [self.library.drawn(solution.x + part, self._present.inputs).full()[:, 0] for part in swing]
            words = f"{mode.frequency:.4g} Hz, {mode.words}"
            entries.append({"words": words, "frames": _packed(np.array(pictures))})
        return {"text": found.stability, "modes": entries}

    def motion(self) -> dict[str, Any]:
        """The motion of the scene with the inputs of the scene, as pictures evenly spaced in time.

        Raises:
            SceneError: no movable part has mass.
        """
        motion: Motion = simulate(self.first.model.scene, compiled=False)
        if not len(motion.times):
            return {"text": motion.message, "times": [], "frames": ""}
        first, last = float(motion.times[0]), float(motion.times[-1])
        wanted = int(FRAME_RATE * (last - first))
        times = np.linspace(first, last, min(max(wanted, FEWEST_FRAMES), MOST_FRAMES))
        drawn = DrawnModel(motion.model.discrete).drawn
        states = [motion.at(time) for time in times]
        pictures = [drawn(state.x, state.inputs).full()[:, 0] for state in states]
        return {"text": motion.message, "times": times.tolist(), "frames": _packed(np.array(pictures))}

    def _followed(self, given: FloatArray) -> CompiledSolution | None:
        # The first move starts from the unloaded scene.
        if self._present is self.first or not self._present.converged:
            return None
        return self.library.follow(self._present.inputs, given, self._present.x)

    def _solved(self, given: FloatArray) -> CompiledSolution:
        return self.library.solve(given)

    def _accepted(self, given: FloatArray, found: CompiledSolution, *, anew: bool) -> dict[str, Any]:
        self._present = found
        return state_of(found, self.library.drawn(found.x, given).full()[:, 0], anew=anew)


def is_compiled(scene: scenes.Scene) -> bool:
    """Whether a scene is moved by a compiled library; tubes and exact contact are solved in Python only."""
    if scene.tubes:
        return False
    try:
        refuse_obstacles(scene, "a compiled library")
    except SceneError:
        return False
    return True


def opened(
    solution: Equilibrium[Any], progress: StageProgress | None = None, asked: Given | None = None
) -> RobotSession:
    """A session of a solved scene; its library, if it has one, is compiled or taken from the cache.

    Args:
        solution: the equilibrium at the inputs of the scene.
        progress: called with the progress of the compilation.
        asked: ranges of the sliders; by default those of the choice of modes.

    Raises:
        ExportError: there is no C compiler, or it fails.
    """
    if isinstance(solution, TubeSolution):
        return TubeSession(solution)
    assert isinstance(solution, Solution)
    if not is_compiled(solution.model.scene):
        return ContactSession(solution, asked)
    with tempfile.TemporaryDirectory() as folder:
        # The compiled library is in the cache: the sources are no longer needed.
        sources = export(DrawnModel(solution.model.discrete), Path(folder) / NAME, NAME)
        library = load(sources, progress=progress)
    assert isinstance(library, Compiled)
    return ViewSession(solution, asked, library=library)


def _packed(pictures: FloatArray) -> str:
    """Pictures as 32-bit floats in base64, one after the other."""
    return base64.b64encode(pictures.astype("<f4").tobytes()).decode()
