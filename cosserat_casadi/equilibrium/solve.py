"""Solve a model: by load continuation, or by CasADi's own solvers, judged by one test for all methods.

See docs/theory.md, section 9.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np
import numpy.typing as npt

from cosserat_casadi.equilibrium.answer_error import with_error_estimate
from cosserat_casadi.equilibrium.contact.contact_answer_error import with_error_in_contact
from cosserat_casadi.equilibrium.contact.contact_equations import Grids
from cosserat_casadi.equilibrium.contact.contact_solve import solve_contact
from cosserat_casadi.equilibrium.contact.contact_state import without_contacts
from cosserat_casadi.equilibrium.judge import correct, judge
from cosserat_casadi.equilibrium.load_path import (
    backwards,
    column,
    continuation_limits,
    input_path,
    load_path,
    may_stretch,
    nearly_loaded,
    paced_by_shape,
)
from cosserat_casadi.equilibrium.locking import with_locking_note
from cosserat_casadi.equilibrium.relax import can_relax, relaxed
from cosserat_casadi.equilibrium.smooth_passage import (
    PlacesAt,
    SmoothBarriers,
    are_one,
    past_no_obstacle,
    places_along,
    places_between,
)
from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.equilibrium.taut_rods import held_taut, is_closed
from cosserat_casadi.errors import Problem, SceneError, SolveError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.discrete_scene import with_parameters
from cosserat_casadi.model.inputs import input_layout
from cosserat_casadi.model.obstacle_checks import refuse_held_by_contact
from cosserat_casadi.model.parameters import parameter_layout
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.numerics.continuation import ContinuationResult, ContinuationSettings, Path, follow
from cosserat_casadi.numerics.newton import NewtonResult, relative_norm
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress

CANNOT_RELAX = " The search for less energy takes no assemblies, free rods and cables of given length."
"""Sentence in the message of a solution that cannot be relaxed."""

IN_CONTACT = " The search for less energy takes no rods in contact."
"""Sentence in the message of an unstable solution in exact contact."""

NONE_STABLE = " The search for less energy found no stable equilibrium."
"""Sentence in the message of a solution after all tries for a stable equilibrium have failed."""

AT_ONCE = " The start has other parameters, and rods would pass through an obstacle or a rod: change them by less."
"""Sentence in the message if the path from a solution with other parameters does not end at a solution."""

TAUT_PATH = " Tension grew large on the load path: the shape alone bounded its steps."
"""Sentence in the message of a solution on a path that :func:`paced_by_shape` makes."""

NOTHING = 1e-14
"""Relative norm of a residual that is rounding alone, as that of the unloaded scene without loads is."""

Start = Solution | FloatArray | None
"""Start of a solve: a solution, unknowns, or None for the unloaded rod."""


@dataclass(frozen=True)
class _Task:
    """Arguments of a method: its problem and its limits.

    Attributes:
        model: what to solve.
        inputs: stacked inputs, shape (model.inputs.size,).
        start: start of the solve.
        limits: limits of the continuation.
        progress: receives the share of the path that is done.
    """

    model: Model
    inputs: FloatArray
    start: Start
    limits: ContinuationSettings
    progress: Progress | None

    @property
    def model_of_start(self) -> Model | None:
        """The model of a solution to start from, if it is another one, with other numbers or built anew; else None."""
        if not isinstance(self.start, Solution) or self.start.model is self.model:
            return None
        return self.start.model

    @cached_property
    def parametric(self) -> Model:
        """The model with the parameters of its scene as arguments; this model if there are none, or with memory."""
        own, nominal = self.model.discrete, self.model.discrete.nominal
        if not nominal.scene.parameters or nominal.layout is not own.layout:
            return self.model
        return Model(with_parameters(nominal).with_layers(own.layers))

    @cached_property
    def parameters(self) -> tuple[FloatArray, FloatArray] | None:
        """Parameters of the model of the start, and of this model; None if the models differ in more than these."""
        before, model = self.model_of_start, self.parametric
        if before is None or not model.parameters.size:
            return None
        named = model.scene.parameters
        scenes = (bound.scene.model_copy(update={"parameters": named}) for bound in (before, self.model))
        try:
            first, last = (parameter_layout(scene).pack() for scene in scenes)
            is_alike = model.at(first).scene == before.scene
        except SceneError:
            # The other scene has numbers that are refused here, or lacks these names.
            is_alike = False
        return (first, model.parameters.nearer(first, last)) if is_alike else None

    @property
    def places_of_start(self) -> PlacesAt | None:
        """Positions of rods and bodies on the way from the model of the start; None if it is this model."""
        later = SmoothBarriers(self.model)
        if self.model_of_start is None or not later.any:
            return None
        if self.parameters is not None:
            return places_along(self.parametric, self.parameters)
        earlier = SmoothBarriers(self.model_of_start)
        return places_between(earlier, later) if earlier.compares_with(later) else None

    @property
    def first_iterate(self) -> FloatArray:
        """Unknowns at the start, shape (n,)."""
        if self.start is None:
            return self.model.unloaded()
        return self.start.x if isinstance(self.start, Solution) else self.start


@dataclass(frozen=True)
class _End:
    """The end of a method, before it is judged.

    Attributes:
        x: unknowns, shape (model.size,).
        outcome: outcome that the method reports.
        iterations: number of its Newton steps.
        load_factor: share of the loads that it reached.
        paced: whether the shape alone bounded the steps of its path.
    """

    x: FloatArray
    outcome: Outcome
    iterations: int
    load_factor: float = 1.0
    paced: bool = False


def solve(
    model: Model,
    values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
    *,
    parameters: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
    start: Start = None,
    method: str = "continuation",
    stable: bool = False,
    settings: ContinuationSettings | None = None,
    progress: Progress | None = None,
    raise_on_failure: bool = False,
    estimate_error: bool = True,
) -> Solution:
    """Equilibrium of a model on its discretisation; see the public ``solve``.

    Raises:
        SceneError, SolveError, ValueError: as the public ``solve`` raises them.
    """
    model = model.at(parameters)
    limits = settings or continuation_limits(model)
    if model.scene.touches_exactly:
        values = _values_in_contact(model, values)
        solution = _in_contact(model, values, start, method, limits, progress)
        if estimate_error:
            solution = with_error_in_contact(solution, limits.newton)
        if stable:
            check_potential(solution.model, solution.inputs)
            solution = noted_unstable(solution)
        if raise_on_failure and not solution.converged:
            raise SolveError(solution.message)
        return solution
    inputs = _stacked(model, values)
    task = _Task(model, inputs, start, limits, progress)
    unknowns = len(task.first_iterate)
    if unknowns != model.size:
        raise ValueError(f"the start has {unknowns} unknowns, the model {model.size}")
    if isinstance(start, Solution) and len(start.inputs) != model.inputs.size:
        counts = f"{len(start.inputs)} inputs, the model {model.inputs.size}"
        raise ValueError(f"the start has {counts}: give its unknowns, start=solution.x")
    if method not in _METHODS:
        raise ValueError(f"method is one of {', '.join(_METHODS)}, got {method!r}")
    if stable:
        check_potential(model, inputs)

    end = _METHODS[method](task)
    solution = judge(
        model,
        inputs,
        end.x,
        end.outcome,
        iterations=end.iterations,
        load_factor=end.load_factor,
        tolerance=limits.newton.tolerance,
    )
    stalled = solution.outcome is Outcome.LOAD_STALLED
    from_others = isinstance(start, Solution) and start.model is not model
    if stalled and end.load_factor == 0.0 and from_others and model.scene.has_contact:
        solution = replace(solution, message=solution.message + AT_ONCE)
    if stalled and start is None:
        solution = _settled_on_obstacles(solution, limits, progress)
    if end.paced:
        solution = replace(solution, message=solution.message + TAUT_PATH, paced=True)
    if stable and not solution.stable:
        solution = stabilised(solution, limits, progress)
    if estimate_error:
        solution = with_locking_note(with_error_estimate(solution))
    if raise_on_failure and not solution.converged:
        raise SolveError(solution.message)
    return solution


def _in_contact(
    model: Model,
    values: Mapping[str, npt.ArrayLike] | None,
    start: Start,
    method: str,
    limits: ContinuationSettings,
    progress: Progress | None,
) -> Solution:
    """Equilibrium of a scene with obstacles on the modes and nodes of its model.

    Raises:
        SceneError: contact alone would have to hold a free rod.
        ValueError: the method or the start does not support contact.
    """
    refuse_held_by_contact(model.scene)
    if method != "continuation":
        raise ValueError(f"only continuation finds contacts, not {method!r}")
    if start is not None and not isinstance(start, Solution):
        raise ValueError("contacts need a solution to start from, or the unloaded scene: unknowns name no contacts")
    return solve_contact(
        model.scene, Grids(model.discretisation), values, start=start, newton=limits.newton, progress=progress
    )


def _values_in_contact(
    model: Model, values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None
) -> Mapping[str, npt.ArrayLike] | None:
    """Inputs by name, without the forces of contacts in a solution's model, which are unknowns of the solve."""
    if values is None or isinstance(values, Mapping):
        return values
    by_name = model.inputs.split(values)
    given = set(input_layout(without_contacts(model.scene)).names)
    return {name: value for name, value in by_name.items() if name in given}


def noted_unstable(solution: Solution) -> Solution:
    """A solution in contact; if a stable one was requested, its message says that no other is sought."""
    if not solution.converged or solution.stable:
        return solution
    return replace(solution, message=solution.message + IN_CONTACT)


def _stacked(model: Model, values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None) -> FloatArray:
    """Stacked inputs, checked, shape (model.inputs.size,).

    Raises:
        SceneError: a name is unknown, or a value is refused.
    """
    if values is None or isinstance(values, Mapping):
        return model.pack(values)
    # Unpacked and packed by name, so that the faults of each input are found.
    return model.pack(model.inputs.split(values))


def check_potential(model: SystemFunctions, inputs: FloatArray) -> None:
    """Refuse a search for a stable equilibrium without a potential, whose second variation would decide.

    Raises:
        SceneError: the loads have no potential at these inputs.
    """
    if not model.has_potential(inputs):
        problem = "the loads have no potential, so that no energy says which equilibrium is stable"
        raise SceneError(Problem("--stable", problem, "leave it out, or make the loads dead forces"))


def stabilised(solution: Solution, limits: ContinuationSettings, progress: Progress | None = None) -> Solution:
    """Replace an unstable solution by a stable one.

    Args:
        solution: the end of a method.
        limits: limits of the continuation, whose Newton settings bound the final correction.
        progress: receives the share of the tries that is done.

    Returns:
        a stable equilibrium; if none can be reached, the solution with a message that says so.
    """
    if solution.outcome in (Outcome.NOT_FINITE, Outcome.UNRESOLVED):
        return solution
    if not can_relax(solution.model):
        return replace(solution, message=solution.message + CANNOT_RELAX)
    stable = _relaxed_past_no_obstacle(solution, limits, progress)
    if stable is None:
        return replace(solution, message=solution.message + NONE_STABLE)
    return stable


def _relaxed_past_no_obstacle(
    solution: Solution, limits: ContinuationSettings, progress: Progress | None
) -> Solution | None:
    """The equilibrium that a solution relaxes to; None if it is not reached, or only through an obstacle or a rod."""
    settled = relaxed(solution, limits.newton, progress)
    barriers = SmoothBarriers(solution.model)
    if settled is None or not barriers.any:
        return settled
    ends = (solution.inputs, solution.inputs)
    return None if barriers.are_between(solution.x, settled.x, ends) else settled


def is_behind(model: Model, x: FloatArray, inputs: FloatArray) -> bool | None:
    """Whether an equilibrium is behind a smooth obstacle or a rod; None if that is unknown.

    It is if the straight way from the unloaded shape leads through the obstacle, and the rods return to another shape
    as the loads vanish. If that path stalls, the end of the load path decides: it is in front, since no path leads
    through an obstacle or a rod.
    """
    barriers = SmoothBarriers(model)
    unloaded = model.unloaded()
    if not barriers.any or not barriers.are_between(unloaded, x, (inputs, inputs)):
        return False
    path = past_no_obstacle(backwards(load_path(model, inputs), x), model, (inputs, inputs))
    released = follow(path, continuation_limits(model))
    if released.outcome is Outcome.CONVERGED:
        return not are_one(released.x, unloaded)
    led = solve(model, inputs, estimate_error=False)
    return False if led.converged and are_one(led.x, x) else None


def _settled_on_obstacles(
    solution: Solution, limits: ContinuationSettings, progress: Progress | None = None
) -> Solution:
    """The equilibrium to which a rod snaps, past no obstacle, where its load path stalled on soft obstacles."""
    model = solution.model
    if not SmoothBarriers(model).any or not can_relax(model) or not model.has_potential(solution.inputs):
        return solution
    return _relaxed_past_no_obstacle(solution, limits, progress) or solution


def _continuation(task: _Task) -> _End:
    """End of a solve: from a solution along a path of inputs, from unknowns by Newton, else along the load path."""
    if isinstance(task.start, Solution):
        nearer = task.model.inputs.nearer(task.start.inputs, task.inputs)
        path = input_path(task.model, task.start.x, task.start.inputs, nearer)
    else:
        corrected = _corrected_guess(task)
        if corrected is not None:
            return _End(corrected.x, corrected.outcome, corrected.iterations)
        if _rests_unloaded(task):
            return _End(task.model.unloaded(), Outcome.CONVERGED, iterations=0)
        path = load_path(task.model, task.inputs)
    first = task.start.inputs if isinstance(task.start, Solution) else task.inputs
    inputs = (first, task.model.inputs.nearer(first, task.inputs))
    path = past_no_obstacle(path, task.model, inputs, before_it=task.places_of_start)
    result = follow(path, task.limits, task.progress)
    stalled = result.outcome is Outcome.LOAD_STALLED
    nearly = stalled and not isinstance(task.start, Solution) and result.reached > nearly_loaded(task.model)
    paced = _paced(task, path) if nearly and may_stretch(task.model) else None
    if paced is not None:
        ended = paced if paced.outcome is Outcome.CONVERGED else result
        result = replace(ended, iterations=result.iterations + paced.iterations)
    is_paced = paced is not None and result.outcome is Outcome.CONVERGED
    if result.outcome is not Outcome.CONVERGED:
        result = _with_parameters(task, result)
    return _End(result.x, result.outcome, result.iterations, result.reached, is_paced)


def _taut(task: _Task) -> _End:
    """End of the load path whose steps the shape alone bounds; of a continuation if that does not converge."""
    if task.start is not None:
        return _continuation(task)
    path = past_no_obstacle(load_path(task.model, task.inputs), task.model, (task.inputs, task.inputs))
    paced = _paced(task, path)
    if paced is not None and paced.outcome is Outcome.CONVERGED:
        return _End(paced.x, paced.outcome, paced.iterations, paced=True)
    end = _continuation(task)
    return end if paced is None else replace(end, iterations=end.iterations + paced.iterations)


def _paced(task: _Task, path: Path) -> ContinuationResult | None:
    """The end of a load path if the shape alone bounds its steps; None without supports, and for rods held straight."""
    model = task.model
    if all(model.discrete.unknowns.differential):
        return None
    extend = may_stretch(model)
    if not extend and (not model.discrete.constraints or model.scene.bodies or held_taut(model, task.inputs)):
        return None
    result = follow(paced_by_shape(path, model), task.limits, task.progress)
    # The tension of a rod that cannot extend may grow without bound, and the residual counts relative to it.
    if result.outcome is Outcome.CONVERGED and not extend and not is_closed(model, task.inputs, result.x):
        result = replace(result, outcome=Outcome.LOAD_STALLED)
    return result


def _with_parameters(task: _Task, failed: ContinuationResult) -> ContinuationResult:
    """The end of a path on which parameters and inputs change, if it converges; else the failed end."""
    start = task.start
    if not isinstance(start, Solution) or task.parameters is None:
        return failed
    model, parameters = task.parametric, task.parameters
    inputs = (start.inputs, model.inputs.nearer(start.inputs, task.inputs))
    path = input_path(model, start.x, *inputs, parameters)
    path = past_no_obstacle(path, model, inputs, parameters)
    result = follow(path, task.limits, task.progress)
    iterations = failed.iterations + result.iterations
    return replace(result if result.outcome is Outcome.CONVERGED else failed, iterations=iterations)


def _corrected_guess(task: _Task) -> NewtonResult | None:
    """End of Newton's method from given unknowns; None without any, or if it leaves their neighbourhood."""
    if task.start is None or isinstance(task.start, Solution):
        return None
    # Zero unknowns are the unloaded rod, not a guess.
    if not np.any(task.start):
        return None
    return correct(task.model, task.inputs, task.start, task.limits.newton)


def _rests_unloaded(task: _Task) -> bool:
    """Whether the unloaded scene is an equilibrium of the scene, so that there is no load to follow."""
    unloaded = task.model.unloaded()
    residual = column(task.model.path_residual(unloaded, task.inputs, 1.0))
    return bool(relative_norm(residual, unloaded) <= NOTHING)


def _rootfinder(task: _Task) -> _End:
    """CasADi's Newton at the full load; its report of success is not used."""
    newton = task.limits.newton
    options = {
        "abstol": newton.tolerance,
        "max_iter": newton.iterations,
        "error_on_fail": False,
        "jacobian_function": task.model.jacobian,
    }
    finder = ca.rootfinder("finder", "newton", task.model.residual, options)
    root = finder(task.first_iterate, task.inputs)
    iterations = int(finder.stats()["iter_count"])
    # If the residual is small in spite of this, the judge finds out.
    return _End(root.full()[:, 0], Outcome.MAX_ITERATIONS, iterations)


def _nlpsol(task: _Task) -> _End:
    """Ipopt at the full load on a problem without an objective, the residual as its constraints."""
    model = task.model
    x = ca.MX.sym("x", model.size)
    inputs = ca.MX.sym("inputs", model.inputs.size)
    problem = {
        "x": x,
        "p": inputs,
        "f": ca.MX(0),
        "g": model.residual(x, inputs),
    }
    tolerance = task.limits.newton.tolerance
    ipopt = {
        "print_level": 0,
        "sb": "yes",
        "tol": tolerance,
        "constr_viol_tol": tolerance,
    }
    options = {"print_time": False, "error_on_fail": False, "ipopt": ipopt}
    solver = ca.nlpsol("solver", "ipopt", problem, options)
    optimum = solver(x0=task.first_iterate, p=task.inputs, lbg=0, ubg=0)
    solution = optimum["x"].full()[:, 0]
    iterations = int(solver.stats()["iter_count"])
    # If the residual is small in spite of this, the judge finds out.
    return _End(solution, Outcome.MAX_ITERATIONS, iterations)


_METHODS: dict[str, Callable[[_Task], _End]] = {
    "continuation": _continuation,
    "taut": _taut,
    "rootfinder": _rootfinder,
    "nlpsol": _nlpsol,
}
