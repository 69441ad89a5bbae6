"""The cheapest discretisation that meets a tolerance (docs/theory.md, section 10).

Uniform discretisations are refined, level by level, to a reference solution: one whose own error is a small part of
the tolerance. From there modes per component, intervals and the order of the rotation integrator are coarsened to what
the tolerance needs. The coarsened model is solved, and its distance to the reference, with what the reference itself
may be off, is the estimate of its error.

A rod that is held at both ends has several equilibria near each other. Which equilibrium is found must not hang on the
discretisation: it is decided on levels that are alike for every tolerance, and for modes that the user fixes.

The choice is made at the inputs of the scene, or of the call: a component that they do not excite keeps one mode. Who
changes the inputs afterwards, to load the rod harder or in another direction, fixes modes and nodes or chooses at the
inputs that excite most.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, overload

import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.assess import (
    Enough,
    NeedsFinerGrid,
    NeedsFinerSums,
    NeedsModes,
    NeedsNodes,
    NoEquilibrium,
    Verdict,
    assess,
    min_modes,
)
from cosserat_casadi.accuracy.coarsen import Coarsening
from cosserat_casadi.accuracy.contact import solve_contact_scene
from cosserat_casadi.accuracy.levels import REFERENCE_MODES, Level, layer_nodes, layer_sections, nodes_for_turn
from cosserat_casadi.accuracy.resolution import TELLING, Resolution
from cosserat_casadi.accuracy.scene_solver import SceneSolver, corrected_from
from cosserat_casadi.equilibrium.answer_error import with_notes
from cosserat_casadi.equilibrium.locking import locking_note
from cosserat_casadi.equilibrium.metrics import ROUNDING, has_more_modes, largest_turn, with_estimate
from cosserat_casadi.equilibrium.relax import PATH_OF_ENERGY
from cosserat_casadi.equilibrium.solution import Equilibrium, Solution
from cosserat_casadi.equilibrium.solve import NONE_STABLE, Start, check_potential, noted_unstable
from cosserat_casadi.equilibrium.solve import solve as solve_model
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.discretise import discretise, summed_at
from cosserat_casadi.model.obstacle_checks import refuse_held_by_contact
from cosserat_casadi.model.system_functions import SystemFunctions
from cosserat_casadi.model.tube_checks import refuse_tubes
from cosserat_casadi.numerics.continuation import ContinuationSettings
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Progress, Report
from cosserat_casadi.rod.discretisation import Discretisation

LOG = logging.getLogger(__name__)

if TYPE_CHECKING:
    from cosserat_casadi.tubes.tube_functions import TubeFunctions
    from cosserat_casadi.tubes.tube_solution import TubeSolution

LARGEST_SHAPE_ERROR = 0.1
"""Shape error, relative to the length, above which a discretisation fixed by the user is reported as UNRESOLVED."""

COARSENING_SHARES = (0.85, 0.35)
"""Shares of the tolerance that coarsening may use up, one try after the other."""

DECIDING_TOLERANCE = 1e-5
"""Tolerance of the solution that decides which equilibrium of a held rod is meant, whatever is asked for."""

MARGIN = 1.02
"""Factor on the distance to a reference solution whose own error is known."""

MOST_FAILURES = 2
"""Levels without an equilibrium after which the next one ends the search."""

FINER_MODES = 4
"""Modes that are added to the user's to estimate their error."""

FINER_NODES = 10
"""Intervals that are added to the user's to estimate their error."""


@overload
def solve(
    subject: scenes.Scene,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    stable: bool = False,
    progress: Progress | None = None,
    report: Report | None = None,
) -> Solution | TubeSolution: ...


@overload
def solve(
    subject: Model,
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
) -> Solution: ...


@overload
def solve(
    subject: TubeFunctions,
    values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
    *,
    parameters: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
    start: TubeSolution | FloatArray | None = None,
    stable: bool = False,
    estimate_error: bool = True,
) -> TubeSolution: ...


@overload
def solve(
    subject: SystemFunctions,
    values: Mapping[str, npt.ArrayLike] | npt.ArrayLike | None = None,
    *,
    start: Any = None,
    stable: bool = False,
    estimate_error: bool = True,
) -> Equilibrium[Any]: ...


def solve(subject: Any, values: Any = None, **options: Any) -> Any:
    """Equilibrium of a scene, or of a model on its discretisation.

    A scene is solved to its tolerance, on the cheapest discretisation that meets it. The discretisation suits these
    inputs: a strain that they do not excite has one mode. Where the scene fixes modes or nodes they are used as they
    are, and only the error is estimated.

    A held rod whose load path ends at an unstable equilibrium, or at none, is relaxed to a stable one. Concentric tubes
    are straight at first, become curved where they are, and are loaded then; :func:`all_equilibria` finds every one.

    Args:
        subject: a validated scene, or a model of it: of rods, or of concentric tubes.
        values: inputs by name, where an input that is left out keeps the scene's value; of a model all stacked too.
        options: named as follows.
        stable: whether a free rod is relaxed too, under loads that have a potential; of a scene with tubes whether the
            stable equilibrium of least energy is wanted where the first equilibrium is not stable.
        progress: receives the share of the load path of rods that is done.
        report: receives the discretisation of rods, in words; of a scene.
        parameters: of a model, by name or stacked, as :meth:`Model.at` takes them; by default the scene's.
        start: of a model, like all that follow: where to start; by default the unloaded rod, or straight tubes. From a
            solution of the same model, continuation follows the inputs from the solution's to the wanted ones, and so
            stays on its branch. Other parameters are taken at once and, where that fails, followed together with the
            inputs. Of a scene with obstacles, the contacts of the solution are tried first. From unknowns of shape
            (size,), Newton is tried at the wanted inputs, and the unloaded rod where that strays.
        method: of rods, "continuation" (default), "rootfinder" (CasADi's Newton) or "nlpsol" (ipopt); the last two
            start at the full load and may find another branch, or none.
        settings: limits of the continuation, of rods.
        raise_on_failure: raise instead of returning what did not converge, of rods.
        estimate_error: whether the error that modes and nodes, or steps, leave is estimated; of rods it costs about a
            Newton step.

    Raises:
        SceneError: a value is refused, a stable equilibrium is wanted under loads without a potential, or contact alone
            would have to hold a free rod.
        SolveError: no equilibrium was found and ``raise_on_failure`` is set.
        ValueError: the method is unknown, or the start is one of another model.
    """
    if isinstance(subject, Model):
        return solve_model(subject, values, **options)
    if isinstance(subject, scenes.Scene) and not subject.tubes:
        return solve_rods(subject, values, **options)
    # Imported here, because no scene of rods needs the modules of tubes.
    from cosserat_casadi.tubes.tube_equilibria import tubes_at_rest

    return tubes_at_rest(subject, values, **options)


def solve_rods(
    scene: scenes.Scene,
    values: Mapping[str, npt.ArrayLike] | None = None,
    *,
    stable: bool = False,
    progress: Progress | None = None,
    report: Report | None = None,
) -> Solution:
    """Equilibrium of a scene of rods, as :func:`solve` describes it.

    Raises:
        SceneError: as :func:`solve` raises it, and where the scene has tubes.
    """
    refuse_tubes(scene)
    refuse_held_by_contact(scene)
    if stable:
        # Refused before anything is solved; whether there is a potential does not depend on the discretisation.
        coarsest = build(scene, discretise(scene, 1, 2))
        check_potential(coarsest, coarsest.pack(values))
    # Parameters have the scene's values: what is solved is one scene.
    scene = scene.baked()
    solver = SceneSolver(scene, values, stable, progress, report)
    if scene.touches_exactly:
        transport = scene.accuracy.rotation or solver.reference_transport
        in_contact = with_notes(solve_contact_scene(solver, transport))
        return noted_unstable(in_contact) if stable else in_contact
    solution = with_notes(_with_fixed(solver) if scene.accuracy.fixed else _with_tolerance(solver))
    # The last correction alone may need no step: a user asks what the search has cost.
    solution = replace(solution, iterations=solver.iterations)
    if solver.relaxed and solution.stable:
        solution = _with_note(solution, PATH_OF_ENERGY)
    if stable and solution.converged and not solution.stable:
        solution = _with_note(solution, NONE_STABLE)
    return solution


@dataclass(frozen=True)
class _Reference:
    """A solution that can serve as a reference for a tolerance.

    Attributes:
        solution: on a uniform discretisation.
        level: of this discretisation.
        resolution: its errors.
        fewer_modes: the finest solution with fewer modes on the way to it; None where it is the first.
    """

    solution: Solution
    level: Level
    resolution: Resolution
    fewer_modes: Solution | None


def _with_tolerance(solver: SceneSolver) -> Solution:
    """The cheapest solution found whose estimated error is below the tolerance.

    Levels are refined as the verdicts ask until one solution can serve as a reference. Without one, the last failure,
    or the finest solution as UNRESOLVED.
    """
    if solver.signal_modes > REFERENCE_MODES[-1]:
        # Not even the finest level sees what the scene asks for: whatever is found is no reference.
        solution = _at_level(solver, Level.first(solver.tolerance), None)
        return solution.unresolved() if solution.converged else solution
    found = _of_held_rod(solver) if solver.is_held else _for_tolerance(solver, solver.tolerance)
    if isinstance(found, _Reference):
        return _coarsened(solver, found.resolution)
    return found


def _for_tolerance(solver: SceneSolver, tolerance: float) -> _Reference | Solution:
    """A reference for a tolerance, refined from the level that it begins with; or a failure."""
    least = solver.signal_modes
    if solver.is_assembly:
        # On fewer modes what is extrapolated is far too large, and so is the model that it leads to.
        least = max(least, TELLING)
    first = Level.first(tolerance, least, layer_nodes(solver.scene), layer_sections(solver.scene, tolerance))
    return _refined(solver, first, tolerance)


def _of_held_rod(solver: SceneSolver) -> _Reference | Solution:
    """A reference for the tolerance, refined from the equilibrium that is meant; or a failure."""
    found = _for_tolerance(solver, DECIDING_TOLERANCE)
    if isinstance(found, _Reference):
        if solver.tolerance >= DECIDING_TOLERANCE:
            return found
        return _refined(solver, found.level, solver.tolerance, found)
    if found.outcome is Outcome.UNRESOLVED and solver.tolerance > DECIDING_TOLERANCE:
        # No level resolves it so well, but one may do for less.
        return _for_tolerance(solver, solver.tolerance)
    return found


def _refined(
    solver: SceneSolver, first: Level, tolerance: float, on_first: _Reference | None = None
) -> _Reference | Solution:
    """A solution that can serve as a reference; without one the last failure, or the finest solution as UNRESOLVED.

    The estimate of an UNRESOLVED one is its distance to the finest that has fewer modes.

    Args:
        solver: of the scene.
        first: the level to begin with.
        tolerance: wanted error.
        on_first: verdict on that level, as the reference for a larger tolerance.
    """
    level: Level | None = first
    coarser: Solution | None = None
    fewer_modes = None if on_first is None else on_first.fewer_modes
    failures: list[Solution] = []
    while level is not None:
        solution = _at_level(solver, level, coarser) if on_first is None else on_first.solution
        on_first = None
        verdict = assess(solution, tolerance, solver.wave_modes > 0)
        LOG.info("level of %d modes, for an error of %.1e: %s", level.modes, tolerance, type(verdict).__name__)
        if isinstance(verdict, NoEquilibrium):
            failures.append(solution)
            # Too few modes may have no equilibrium where the rod has one: some more levels are tried.
            if len(failures) > MOST_FAILURES or solver.taut:
                return solution
        else:
            if coarser is not None and has_more_modes(solution, coarser):
                fewer_modes = coarser
            coarser = solution
        if isinstance(verdict, Enough):
            # Only now: with few modes a rod may seem unstable that is not.
            relaxed = solver.relax(solution)
            if relaxed is solution or not relaxed.stable:
                return _Reference(solution, level, verdict.resolution, fewer_modes)
            coarser = relaxed
        level = _next_level(level, verdict)
    if coarser is None:
        return failures[-1]
    if fewer_modes is not None:
        # The level below is farther off than this one, by about as much as the two are apart.
        coarser = with_estimate(coarser, fewer_modes, factor=1.0)
    return coarser.unresolved()


def _next_level(level: Level, verdict: Verdict) -> Level | None:
    """Where a verdict leads to; None where there is nothing finer to try."""
    match verdict:
        case NeedsNodes(nodes):
            return replace(level, min_nodes=nodes)
        case NoEquilibrium():
            return level.with_modes(level.modes + 1)
        case NeedsModes(modes, extrapolated=True):
            return level.with_extrapolated_modes(modes)
        case NeedsModes(modes):
            return level.with_modes(modes)
        case NeedsFinerSums(factor):
            return level.with_finer_sums(factor)
        case NeedsFinerGrid():
            return level.with_finer_grid()
        case Enough():
            return level


def _at_level(solver: SceneSolver, level: Level, coarser: Solution | None) -> Solution:
    """The solution on a level, on intervals enough for how far the rods turned on the level before."""
    turn = solver.unloaded_turn
    if coarser is not None:
        turn = max(turn, largest_turn(coarser))
    nodes = level.nodes(turn)
    uniform = discretise(solver.scene, level.modes, nodes, solver.reference_transport)
    return solver.solve(summed_at(uniform, level.sections), coarser)


def _coarsened(solver: SceneSolver, resolution: Resolution) -> Solution:
    """The cheapest solution near a reference; the reference itself where none is near enough to it."""
    reference = resolution.preview.reference
    reference_error = resolution.tip_error
    for share in COARSENING_SHARES:
        bound = share * solver.tolerance - reference_error
        discretisation, start = Coarsening(resolution.preview, bound, solver.wave_modes).run()
        model = solver.build(discretisation)
        solution = corrected_from(model, start, reference.inputs)
        if solution is not None:
            solver.iterations += solution.iterations
        if solution is None or not solution.converged:
            # The preview was too far off; a tighter bound keeps it nearer.
            continue
        # Few modes meet the tip and may still be too stiff to buckle: the reference decides what is stable.
        if solution.stable is not reference.stable:
            continue
        judged = replace(
            with_estimate(solution, reference, MARGIN, reference_error, resolution.shape_error),
            smallest_eigenvalue=reference.smallest_eigenvalue,
            message=reference.message,
        )
        if judged.error_estimate is not None and judged.error_estimate <= solver.tolerance:
            return judged
    return replace(
        reference,
        error_estimate=reference_error + ROUNDING,
        shape_error_estimate=resolution.shape_error + ROUNDING,
    )


def _with_fixed(solver: SceneSolver) -> Solution:
    """The solution on the discretisation that the scene asks for, with its error estimated by a finer one."""
    unnamed = None if solver.scene.accuracy.rotation else solver.reference_transport
    discretisation = discretise(solver.scene, transport=unnamed)
    meant = _meant(solver)
    solution = solver.relax(solver.solve(discretisation, meant))
    if not solution.converged:
        return solution
    note = locking_note(solution)
    judged = _beside_finer(solver, discretisation, solution, meant)
    return _with_note(judged, f" {note}") if note else judged


def _beside_finer(
    solver: SceneSolver, discretisation: Mapping[str, Discretisation], solution: Solution, meant: Solution | None
) -> Solution:
    """A solution on the discretisation that the scene asks for, with its distance to a finer one as its error."""
    turn = largest_turn(solution)
    visible_from = max(solver.signal_modes, min_modes(solution, turn, solver.tolerance))
    finer = {}
    for name, fixed in discretisation.items():
        finer_modes = tuple(max(count + FINER_MODES, visible_from) for count in fixed.modes)
        resolving_nodes = nodes_for_turn(max(finer_modes), max(turn, solver.unloaded_turn))
        finer_nodes = max(fixed.nodes + FINER_NODES, resolving_nodes)
        # The fixed integrator may leave an error of its own: the reference takes the one that suits the tolerance.
        finer[name] = replace(fixed, modes=finer_modes, nodes=finer_nodes, transport=solver.reference_transport)
    finer_sums = [max(sections.counts) for sections in solution.model.discrete.finer_sections.values()]
    finer = summed_at(finer, max(finer_sums, default=0))
    reference = solver.solve(finer, meant or solution)
    if not reference.converged:
        return solution.unresolved()
    judged = with_estimate(solution, reference)
    shape_error = judged.shape_error_estimate
    # Written so that an estimate which is not a number counts as too large.
    if shape_error is not None and shape_error <= LARGEST_SHAPE_ERROR:
        return judged
    return judged.unresolved()


def _meant(solver: SceneSolver) -> Solution | None:
    """The equilibrium of a held rod that is meant; None where nothing holds it, or none is found."""
    if not solver.is_held or solver.signal_modes > REFERENCE_MODES[-1]:
        return None
    found = _for_tolerance(solver, DECIDING_TOLERANCE)
    if isinstance(found, _Reference):
        return found.solution
    # The modes of the user may have an equilibrium all the same, and one to relax to.
    solver.vain_descents = 0
    return None


def _with_note(solution: Solution, note: str) -> Solution:
    """The solution with a sentence in its message, once."""
    if note in solution.message:
        return solution
    return replace(solution, message=solution.message + note)
