"""Rows of concentric tubes: their inputs, and the equilibria that they lead to, each as `solve` finds it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cosserat_casadi.codegen.rows import ERRORS, JUDGED, POSE
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout
from cosserat_casadi.scene import Scene, Tube, parse_scene
from cosserat_casadi.scene.number_table import shortened
from cosserat_casadi.spelling import closest
from cosserat_casadi.sweeps.outcome_table import ENDINGS
from cosserat_casadi.sweeps.row_model import error_numbers
from cosserat_casadi.sweeps.table import Table
from cosserat_casadi.sweeps.variants import Variant, Variants, all_rows
from cosserat_casadi.tubes.robot import Robot, robot_of
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import TubeModels, solve_inputs

ENERGY = "energy"
"""Column of the energy, J."""

TUBE_STABILITY = ("falling_directions", "determinant", "stable")
"""Last columns of a row of results, where they are asked for."""


def tube_results(scene: Scene, *, estimate_errors: bool = False, stability: bool) -> tuple[str, ...]:
    """Names of the columns of a row of results: how it ended, poses of the tips, energy, error, stability."""
    poses = [f"{tube.name}.{axis}" for tube in scene.tubes for axis in POSE]
    errors = ERRORS if estimate_errors else ()
    return (*JUDGED, *poses, ENERGY, *errors, *(TUBE_STABILITY if stability else ()))


def tube_variants(scene: Scene, table: Table) -> Variants:
    """A table seen by a scene of tubes, whose columns are inputs all.

    Raises:
        SceneError: with every fault: a column that is no input, a translation out of its range.
    """
    robot = robot_of(scene)
    problems = [*_unknown_columns(robot, table)]
    inputs = table.scratch.array((len(table.values), robot.inputs.size))
    if not problems:
        indices = [robot.input_index(column) for column in table.columns]
        for block in table.scratch.blocks(len(inputs)):
            inputs[block] = robot.inputs
            inputs[block, indices] = table.values[block]
        problems += _refused_rows(robot, inputs, table)
    if problems:
        raise SceneError(*shortened(problems, table.where))
    every = Variant(scene, all_rows(table))
    return Variants(scene, (every,), inputs, InputLayout(()), (), (), np.zeros((len(inputs), 0)))


def _unknown_columns(robot: Robot, table: Table) -> Iterator[Problem]:
    for column in table.columns:
        if column in robot.columns:
            continue
        remedy = closest(column, robot.columns)
        owner, _, field = column.partition(".")
        if owner in robot.names and field.split(".")[0] in Tube.model_fields:
            remedy = "rotations, translations and loads are swept; give it with --set, and sweep once for each value"
        yield Problem(table.where, f"{column!r} is no input of the tubes", remedy)


def _refused_rows(robot: Robot, inputs: FloatArray, table: Table) -> Iterator[Problem]:
    for row, values in enumerate(inputs):
        try:
            robot.packed(values)
        except SceneError as error:
            for problem in error.problems:
                yield Problem(table.where_of(row), f"{problem.where} {problem.problem}", problem.remedy)


@dataclass(frozen=True)
class TubeRows:
    """A scene of tubes as text; it answers rows of inputs.

    Attributes:
        scene: text of the scene.
        stability: whether rows end with the stability of their equilibria.
        estimate_errors: whether rows tell their estimated error.
    """

    scene: str
    stability: bool = False
    estimate_errors: bool = False

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results, shape (count, results), for rows of inputs, shape (count, inputs).

        From straight tubes each: what a row gives does not depend on those before.
        """
        models = _models(self.scene)
        scene = parse_scene(self.scene)
        width = len(tube_results(scene, estimate_errors=self.estimate_errors, stability=self.stability))
        rows = [self._row(solve_inputs(models, row), width) for row in inputs]
        return np.array(rows).reshape(len(inputs), width)

    def _row(self, solution: TubeSolution, width: int) -> FloatArray:
        """A solution as a row of results; of what did not converge nothing but how it ended."""
        row = np.full(width, np.nan)
        ending = ENDINGS.index(solution.outcome)
        row[: len(JUDGED)] = (ending, solution.iterations, solution.residual_norm)
        if not solution.converged:
            return row
        numbers: list[float] = []
        for tip in solution.tips.values():
            numbers += [*tip.position, *tip.quaternion]
        numbers.append(solution.energy)
        if self.estimate_errors:
            numbers += error_numbers(solution.error_estimate)
        if self.stability:
            judged = solution.stability
            # Loads without an energy leave falling directions and stability without a meaning.
            for number in (judged.falling, judged.determinant, judged.stable):
                numbers.append(np.nan if number is None else float(number))
        row[len(JUDGED) :] = numbers
        return row


@lru_cache(maxsize=2)
def _models(text: str) -> TubeModels:
    return TubeModels(robot_of(parse_scene(text)))
