"""Modes and nodes that serve the measurements: of equilibria, vibrations and motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.common_modes import CommonModes, LoadCase
from cosserat_casadi.accuracy.fixing import fixed_alike, unfixed, union_of, with_accuracy
from cosserat_casadi.accuracy.models import build
from cosserat_casadi.identification.case_motions import StartInputs
from cosserat_casadi.identification.fitted_scene import with_inputs
from cosserat_casadi.identification.measured_cases import Case, Datum
from cosserat_casadi.identification.misfit import inputs_of, moving
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.motion.motion_refinement import simulate
from cosserat_casadi.motion.vibration_modes import ModesOutcome, modes_of
from cosserat_casadi.numerics.progress import Report
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene.measurements import ModeMeasurement
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_functions import AnyModel, TubeFunctions
from cosserat_casadi.tubes.tube_solve import TubeModels, solve_inputs

SAMPLES = 4
"""Cases that a discretisation is chosen on."""

SHARE_OF_SIGMA = 0.1
"""Error of the model, in standard deviations of the measurements, that is small enough."""

LOOSEST = 1e-3
"""Tolerance of equilibria, as `accuracy.tolerance`, above which none is taken: a sigma may be a guess."""

LEAST = 1e-6
"""Tolerance of a motion, over the length, below which none is asked for where the scene does not."""


@dataclass(frozen=True)
class FitDiscretisation:
    """A scene on modes and nodes that were chosen, and warnings about them.

    Attributes:
        scene: with fixed modes and nodes, unless no case has an equilibrium to choose them on.
        warnings: sentences.
        steps: of a piece of concentric tubes; None of rods.
    """

    scene: scenes.Scene
    warnings: tuple[str, ...] = ()
    steps: int | None = None

    @property
    def model(self) -> AnyModel:
        """The model of the scene."""
        return build(self.scene) if self.steps is None else build(self.scene, self.steps)


def with_discretisation(
    scene: scenes.Scene, draft: AnyModel, cases: Sequence[Case], report: Report
) -> FitDiscretisation:
    """The scene on modes and nodes that serve those cases that lie farthest apart.

    Args:
        scene: with all that is unknown or set by columns free.
        draft: a model of it.
        cases: the measured cases.
        report: told the stage.
    """
    if scene.accuracy.fixed:
        return FitDiscretisation(scene)
    tolerance = _tolerance(scene, cases)
    if isinstance(draft, TubeFunctions):
        asked = with_accuracy(scene, tolerance=tolerance)
        models = TubeModels(robot_of(asked))
        rows = inputs_of(cases)
        steps = [solve_inputs(models, rows[row]).model.steps for row in _far_apart(rows, SAMPLES)]
        return FitDiscretisation(asked, steps=max(steps))
    baked = unfixed(scene.baked(), tolerance)
    warnings: list[str] = []
    chosen: list[Discretisation] = []
    moves = moving(cases)
    inputs = StartInputs(draft).of(inputs_of(cases), moves)
    unloaded = scene.simulation is not None and scene.starts_unloaded
    at_rest = inputs[~moves] if unloaded else inputs
    chosen += _for_equilibria(baked, draft, at_rest, report)
    numbers = [int(datum.at) for case in cases for datum in _vibrations(scene, case)]
    if numbers:
        row = next(i for i, case in enumerate(cases) if _vibrations(scene, case))
        values = draft.inputs.unpack(inputs[row])
        of_modes = _after("discretisation for frequencies", report)
        modes = modes_of(baked, values, count=max(numbers) + 1, report=of_modes)
        chosen += modes.model.discretisation.values()
        if modes.outcome is not ModesOutcome.RESOLVED:
            warnings.append(f"The discretisation for frequencies: {modes.message}")
    if np.any(moves):
        moved = _moving_scene(baked, draft, cases[int(np.flatnonzero(moves)[0])])
        of_motion = _after("discretisation for motions", report)
        motion = simulate(moved, progress=lambda at: of_motion(f"{at.stage}, t = {at.time:.4g} s"), compiled=False)
        chosen += motion.model.discretisation.values()
        if not motion.converged:
            warnings.append(f"The discretisation for motions: {motion.message}")
    if not chosen:
        return FitDiscretisation(scene)
    # Written out: a tolerance that nobody has written asks nothing of modes that are fixed.
    asked = with_accuracy(scene, tolerance=tolerance)
    return FitDiscretisation(fixed_alike(asked, union_of(chosen)), tuple(warnings))


def _tolerance(scene: scenes.Scene, cases: Sequence[Case]) -> float:
    """The scene's tolerance; where nobody has written one, what the least deviation of the measured poses asks for.

    What else was measured, such as a force or a frequency, has no deviation that a pose could be held against: the
    default holds.
    """
    default = scene.accuracy.tolerance
    if "tolerance" in scene.accuracy.model_fields_set:
        return default
    lengths = {rod.name: rod.length for rod in scene.rods} | {tube.name: tube.length for tube in scene.tubes}
    relative: list[float] = []
    for number in {number for case in cases for number in case.data}:
        record = scene.measurements[number]
        units = record.differences
        if not set(units) <= {"m", "rad"}:
            return default
        # A body is as far from a base as the longest rod.
        length = lengths.get(getattr(record, "rod", None) or "", max(lengths.values()))
        sigmas = np.broadcast_to(np.asarray(record.sigma, dtype=float), len(units))
        relative += [sigma / length if unit == "m" else sigma for sigma, unit in zip(sigmas, units, strict=True)]
    return min(max(default, SHARE_OF_SIGMA * float(min(relative, default=0.0))), LOOSEST)


def _after(task: str, report: Report) -> Report:
    """A report of the stages of a task that is one stage of another."""
    return lambda stage: report(f"{task}: {stage}")


def _for_equilibria(baked: scenes.Scene, draft: Model, inputs: FloatArray, report: Report) -> list[Discretisation]:
    """Discretisations for rows of inputs, shape (cases, size): one, or none where no row has an equilibrium."""
    if not len(inputs):
        return []
    cases = [LoadCase(baked, draft.inputs.unpack(inputs[row])) for row in _far_apart(inputs, SAMPLES)]
    search = CommonModes(cases, lambda done, total: report(f"discretisation for equilibria: {done} of {total} solves"))
    answers = search.refined()
    if len(search.without_equilibrium) == len(cases):
        return []
    return list(answers.chosen.values())


def _vibrations(scene: scenes.Scene, case: Case) -> list[Datum]:
    """Measurements of vibrations in a case."""
    data: list[Datum] = []
    for number, rows in case.data.items():
        if isinstance(scene.measurements[number], ModeMeasurement):
            data += rows
    return data


def _moving_scene(scene: scenes.Scene, draft: Model, case: Case) -> scenes.Scene:
    """The scene with the inputs of a case, and with a tolerance of its motion that serves the measurements."""
    given = draft.inputs.unpack(case.inputs)
    moved = {motion.input for motion in scene.motions if motion.is_table}
    changed = with_inputs(scene, {name: value for name, value in given.items() if name not in moved})
    simulation = changed.simulation
    assert simulation is not None, "rules of the scene"
    if simulation.tolerance is not None:
        return changed
    sigmas = [
        float(np.min(scene.measurements[number].sigma))
        for number in case.data
        if scene.measurements[number].differences[0] == "m"
    ]
    length = sum(rod.length for rod in scene.rods)
    tolerance = max([LEAST, *(SHARE_OF_SIGMA * sigma / length for sigma in sigmas)])
    return changed.model_copy(update={"simulation": simulation.model_copy(update={"tolerance": min(tolerance, 1e-2)})})


def _far_apart(points: FloatArray, count: int) -> list[int]:
    """Rows of points that lie far from each other, each column over its range; the first is farthest from zero."""
    width = np.ptp(points, axis=0)
    scaled = points / np.where(width > 0, width, np.inf)
    chosen = [int(np.argmax(np.linalg.norm(scaled, axis=1)))]
    distance = np.linalg.norm(scaled - scaled[chosen[0]], axis=1)
    while len(chosen) < count and distance.max() > 0:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(scaled - scaled[chosen[-1]], axis=1))
    return chosen
