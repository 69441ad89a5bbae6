"""Rows solved in Python: for parameters of so few rows that compiling would take longer."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from cosserat_casadi.codegen.rows import JUDGED, row_results
from cosserat_casadi.equilibrium.contact.contact_equations import Grids
from cosserat_casadi.equilibrium.contact.contact_judgement import judged
from cosserat_casadi.equilibrium.contact.contact_search import equilibrium_in
from cosserat_casadi.equilibrium.contact.contact_state import with_contacts
from cosserat_casadi.equilibrium.contact.gaps import body_pairs, pairs, rod_pairs
from cosserat_casadi.equilibrium.judge import correct
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import solve
from cosserat_casadi.errors import SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discrete_scene import with_numbers
from cosserat_casadi.model.element_ends import element_ends
from cosserat_casadi.model.load_assembly import check_loads
from cosserat_casadi.numerics.newton import NewtonSettings
from cosserat_casadi.scene import Scene, parse_scene
from cosserat_casadi.sweeps.outcome_table import ENDINGS
from cosserat_casadi.tubes.robot import robot_of
from cosserat_casadi.tubes.tube_solution import TubeSolution
from cosserat_casadi.tubes.tube_solve import TubeModels, solve_inputs


@dataclass(frozen=True)
class RowModel:
    """A scene as text, with a fixed discretisation, that solves rows as a compiled library does.

    Attributes:
        scene: text of the scene.
        stability: whether rows end with the stability of their equilibria.
        measure: text of the scene that scales eigenvalues: the scene of the sweep. Empty if it equals ``scene``.
        estimate_errors: whether rows have their estimated error.
    """

    scene: str
    stability: bool = False
    measure: str = ""
    estimate_errors: bool = False

    def solve(self, inputs: FloatArray) -> FloatArray:
        """Rows of results, shape (count, results), for rows of inputs, followed by parameters if there are any."""
        scene = _scene(self.scene)
        columns = row_results(scene, estimate_errors=self.estimate_errors, stability=self.stability)
        width = len(columns)
        rows = []
        # Each row begins with straight tubes, with the steps that the tolerance needs.
        of_tubes = (solve_inputs(_tube_models(self.scene), row) for row in inputs)
        for solution in of_tubes if scene.tubes else self._of_rods(inputs):
            judged = self._counted_in_measure(solution) if self.stability else None
            rows.append(result_row(solution, width, judged, estimate_errors=self.estimate_errors))
        return np.array(rows).reshape(len(inputs), width)

    def _of_rods(self, inputs: FloatArray) -> Iterator[Solution]:
        """Solutions of rows, on the discretisation of the scene."""
        model = _model(self.scene)
        near: Solution | None = None
        for row in inputs:
            # Each row begins at the unloaded scene, so that its result does not depend on other rows. With exact
            # contact that takes too long, and the contacts of the row before are tried first; a chunk always has the
            # same rows.
            values, p = np.split(row, [model.inputs.size])
            solution = solve(
                model,
                model.inputs.unpack(values),
                parameters=model.parameters.unpack(p),
                start=near,
                estimate_error=self.estimate_errors,
            )
            # Other parameters may move obstacles, so that the way between the shapes leads through them.
            if model.scene.touches_exactly and solution.converged and not p.size:
                near = solution
            yield solution

    def _counted_in_measure(self, solution: Solution | TubeSolution) -> Solution | TubeSolution:
        """This equilibrium with unknowns in the scaling of the measure."""
        if isinstance(solution, TubeSolution) or not self.measure or not solution.converged:
            return solution
        if solution.model.scene.touches_exactly:
            return solution if self.measure == self.scene else _in_units_of(_scene(self.measure), solution)
        measured = _measured(self.scene, self.measure)
        if measured is None:
            return solution
        again = solve(measured, solution.inputs, start=solution.x, estimate_error=False)
        if not again.converged:
            # The sign of the eigenvalue is known, but not its size in that scaling.
            return replace(solution, smallest_eigenvalue=None)
        return again


def result_row(
    solution: Equilibrium[Any], width: int, judged: Equilibrium[Any] | None = None, *, estimate_errors: bool = False
) -> FloatArray:
    """A solution as a row of results, shape (width,); one that did not converge has its outcome alone.

    Args:
        solution: of the row.
        width: count of numbers in the row.
        judged: this equilibrium in the units of the smallest eigenvalue, for rows with stability, which is NaN if the
            loads have no potential.
        estimate_errors: whether the row has the estimated error, NaN without an estimate.
    """
    row = np.full(width, np.nan)
    outcome = ENDINGS.index(solution.outcome)
    row[: len(JUDGED)] = (outcome, solution.iterations, solution.residual_norm)
    if not solution.converged:
        return row
    numbers: list[float] = solved_poses(solution).tolist()
    numbers += [solution.energy] if isinstance(solution, TubeSolution) else _efforts_and_contacts(solution)
    if estimate_errors:
        # Columns ERRORS: an unknown error is NaN, and so is the verdict, which the sweep passes.
        numbers += [np.nan if solution.error_estimate is None else solution.error_estimate, np.nan]
    if judged is not None:
        numbers += [np.nan if number is None else float(number) for number in _verdict(judged)]
    row[len(JUDGED) : len(JUDGED) + len(numbers)] = numbers
    return row


def _verdict(solution: Any) -> tuple[float | None, ...]:
    """Stability for the last columns of a row; None if it is not defined."""
    if isinstance(solution, TubeSolution):
        return solution.stability.falling, solution.stability.determinant, solution.stable
    return solution.smallest_eigenvalue, solution.stable


def _efforts_and_contacts(solution: Any) -> list[float]:
    """Efforts of actuators with their conjugates, and contacts."""
    scene = solution.model.scene
    numbers: list[float] = []
    for actuator in scene.actuators:
        # The effort and its conjugate, such as tension and length.
        numbers.extend(solution.actuator(actuator.name).values())
    for rod, obstacle in pairs(scene):
        numbers += _contact_numbers(solution, rod, obstacle.name, of_body=False)
    for rod, other in rod_pairs(scene):
        numbers += _contact_numbers(solution, rod, other, of_body=False)
    for body, obstacle in body_pairs(scene):
        numbers += _contact_numbers(solution, body.name, obstacle.name, of_body=True)
    return numbers


def solved_poses(solution: Any) -> FloatArray:
    """Positions and quaternions of the tips and the bodies of a solution, shape (7 tips and bodies,)."""
    tips = [solution.tip(name) for name in solution.model.lengths]
    bodies = [solution.body(body.name) for body in solution.model.scene.bodies]
    poses = [np.concatenate([pose.position, pose.quaternion]) for pose in (*tips, *bodies)]
    return np.concatenate(poses)


def _contact_numbers(solution: Solution, name: str, obstacle: str, *, of_body: bool) -> list[float]:
    """Number of contacts of a rod or a body with an obstacle, and their resultant.

    For a rod the start and end of the contacts stand between the two, NaN without any; for two rods the places of
    the first contact.
    """
    wanted = (name, obstacle, of_body)
    contacts = [own for own in solution.contacts if (own.owner, own.obstacle, own.of_body) == wanted]
    first = min((contact.start for contact in contacts), default=np.nan)
    last = max((contact.end for contact in contacts), default=np.nan)
    if contacts and contacts[0].on_rods is not None:
        first, last = contacts[0].on_rods
    resultant = sum((contact.force for contact in contacts), start=np.zeros(3)).tolist()
    return [float(len(contacts)), *([] if of_body else [first, last]), *resultant]


def _in_units_of(measure: Scene, solution: Solution) -> Solution:
    """An equilibrium in contact with its eigenvalue in the scaling of another scene."""
    unknown = replace(solution, smallest_eigenvalue=None)
    placed = equilibrium_in(solution)
    touched = with_contacts(measure, placed.state, placed.placed.modes)
    scaling = build(touched, Grids(solution.model.discretisation).discretisation(touched))
    model = _scaled(solution.model.scene, scaling)
    corrected = None if model is None else correct(model, solution.inputs, solution.x, NewtonSettings())
    if model is None or corrected is None:
        return unknown
    again = equilibrium_in(replace(unknown, model=model, x=corrected.x))
    return judged(again, holds=True, iterations=0, tolerance=NewtonSettings().tolerance)


@lru_cache(maxsize=2)
def _measured(scene: str, measure: str) -> Model | None:
    """The model of a scene in the scaling of another, both as texts; None if :func:`_scaled` returns None."""
    return _scaled(parse_scene(scene), _model(measure))


def _scaled(scene: Scene, scaling: Model) -> Model | None:
    """The model of a scene in the scaling of a model; None if its loads or element ends do not allow it."""
    if any(len(element_ends(scene, rod.name)) != len(element_ends(scaling.scene, rod.name)) for rod in scene.rods):
        return None
    discrete = with_numbers(scaling.discrete, scene)
    try:
        check_loads(discrete)
    except SceneError:
        return None
    return Model(discrete)


@lru_cache(maxsize=3)
def _scene(text: str) -> Scene:
    return parse_scene(text)


@lru_cache(maxsize=3)
def _model(text: str) -> Model:
    return build(parse_scene(text))


@lru_cache(maxsize=3)
def _tube_models(text: str) -> TubeModels:
    return TubeModels(robot_of(parse_scene(text)))
