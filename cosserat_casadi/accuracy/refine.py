"""The cheapest discretisation that meets a tolerance (docs/theory.md, section 10).

Uniform discretisations are refined, level by level, to a reference solution: one whose own error is a small part of
the tolerance. From there modes per component, intervals and the order of the rotation integrator are coarsened as far
as the tolerance allows. The coarsened model is solved, and its distance from the reference, plus the error of the
reference itself, is the estimate of its error.

A rod that is held at both ends has several equilibria near each other. The discretisation must not decide which of them
is found: it is decided on levels that are equal for every tolerance, and for modes that the user fixes.

The choice is made at the inputs of the scene, or of the call: a component that they do not excite keeps one mode. To
change the inputs afterwards, to load the rod harder or in another direction, fix modes and nodes or choose at the
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
    NeedsFibres,
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
from cosserat_casadi.accuracy.levels import (
    REFERENCE_MODES,
    Level,
    layer_nodes,
    layer_sections,
    nodes_for_turn,
    told_waves,
)
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
from cosserat_casadi.model.discretise import discretise, summed_at, with_more_fibres
from cosserat_casadi.model.obstacle_checks import refuse_held_by_contact
from cosserat_casadi.model.required_modes import modes_for_turn
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

COARSENINGS = ((0.85, False), (0.35, False), (0.85, True))
"""Shares of the tolerance for coarsening, and whether pairs of strains keep equal modes; one try after the other."""

DECIDING_TOLERANCE = 1e-5
"""Tolerance of the solution that decides which equilibrium of a held rod is computed, for every wanted tolerance."""

MARGIN = 1.02
"""Safety factor on the distance from a reference solution with a known error."""

MOST_FAILURES = 2
"""Number of levels without an equilibrium that end the search."""

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
    are first straight, then take their curvatures, then their loads; :func:`all_equilibria` finds every equilibrium.

    Args:
        subject: a validated scene, or a model of it: of rods, or of concentric tubes.
        values: inputs by name, others keep the scene's values; for a model also all inputs stacked.
        options: named as follows.
        stable: whether a free rod is relaxed too, under loads with a potential; for tubes whether the stable
            equilibrium of least energy replaces an unstable first one.
        progress: receives the share of the load path of rods that is done.
        report: receives the discretisation of the rods of a scene, in words.
        parameters: parameters of a model, by name or stacked, see :meth:`Model.at`; by default the scene's values.
        start: start of the solve of a model, as all further options are for models; by default the unloaded rod, or
            straight tubes. From a solution of the same model, continuation follows the inputs from the solution's to
            the wanted ones, and so stays on its branch. Other parameters are set at once or, if that fails, followed
            together with the inputs. In a scene with obstacles the contacts of the solution are tried first. From
            unknowns of shape (size,), Newton is tried at the wanted inputs, then the unloaded rod.
        method: for rods, "continuation" (default), "taut" (continuation for large tension: the shape alone bounds the
            steps), "rootfinder" (CasADi's Newton) or "nlpsol" (ipopt); the last two start at the full load and may find
            another branch, or none.
        settings: limits of the continuation, for rods.
        raise_on_failure: whether to raise instead of returning an answer that did not converge, for rods.
        estimate_error: whether the error by modes and nodes, or steps, is estimated; for rods it costs about a
            Newton step.

    Raises:
        SceneError: a value is refused, a stable equilibrium is wanted under loads without a potential, or contact alone
            would have to hold a free rod.
        SolveError: no equilibrium was found and ``raise_on_failure`` is set.
        ValueError: the method is unknown, or the start belongs to another model.
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
    """Equilibrium of a scene of rods; see :func:`solve`.

    Raises:
        SceneError: as for :func:`solve`, or the scene has tubes.
    """
    refuse_tubes(scene)
    refuse_held_by_contact(scene)
    if stable:
        # Tested before anything is solved, since the discretisation does not decide whether there is a potential.
        coarsest = build(scene, discretise(scene, 1, 2))
        check_potential(coarsest, coarsest.pack(values))
    # Parameters have the scene's values, so that one scene is solved.
    scene = scene.baked()
    solver = SceneSolver(scene, values, stable, progress, report)
    if scene.touches_exactly:
        transport = scene.accuracy.rotation or solver.reference_transport
        in_contact = with_notes(solve_contact_scene(solver, transport))
        return noted_unstable(in_contact) if stable else in_contact
    solution = with_notes(_with_fixed(solver) if scene.accuracy.fixed else _with_tolerance(solver))
    # The last correction may need no step: a user wants the cost of the whole search.
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
        solution: solution on a uniform discretisation.
        level: level of this discretisation.
        resolution: its errors.
        fewer_modes: the finest earlier solution with fewer modes; None for the first level.
    """

    solution: Solution
    level: Level
    resolution: Resolution
    fewer_modes: Solution | None


def _with_tolerance(solver: SceneSolver) -> Solution:
    """The cheapest solution found whose estimated error is below the tolerance.

    Levels are refined by the verdicts until a solution can serve as a reference. If none can, the result is the last
    failure, or the finest solution as UNRESOLVED.
    """
    if solver.signal_modes > REFERENCE_MODES[-1]:
        # Not even the finest level resolves the scene's data: no solution can be a reference.
        solution = _at_level(solver, Level.first(solver.tolerance), None)
        if not solution.converged:
            return solution
        return _with_note(solution.unresolved(), told_waves(solver.signal_modes))
    found = _of_held_rod(solver) if solver.is_held else _for_tolerance(solver, solver.tolerance)
    if isinstance(found, _Reference):
        return _coarsened(solver, found.resolution)
    return found


def _for_tolerance(solver: SceneSolver, tolerance: float) -> _Reference | Solution:
    """A reference for a tolerance, refined from the tolerance's first level; or a failure."""
    least = solver.signal_modes
    if solver.is_assembly:
        # With fewer modes the extrapolation is far too large, and so is the model that it leads to.
        least = max(least, TELLING)
    first = Level.first(tolerance, least, layer_nodes(solver.scene), layer_sections(solver.scene, tolerance))
    return _refined(solver, first, tolerance)


def _of_held_rod(solver: SceneSolver) -> _Reference | Solution:
    """A reference for the tolerance, refined from the decided equilibrium of a held rod; or a failure."""
    found = _for_tolerance(solver, DECIDING_TOLERANCE)
    if isinstance(found, _Reference):
        if solver.tolerance >= DECIDING_TOLERANCE:
            return found
        return _refined(solver, found.level, solver.tolerance, found)
    if found.outcome is Outcome.UNRESOLVED and solver.tolerance > DECIDING_TOLERANCE:
        # No level resolves it so well, but a level may suffice for a larger tolerance.
        return _for_tolerance(solver, solver.tolerance)
    return found


def _refined(
    solver: SceneSolver, first: Level, tolerance: float, on_first: _Reference | None = None
) -> _Reference | Solution:
    """A solution that can serve as a reference, or the last failure, or the finest solution as UNRESOLVED.

    The error estimate of an UNRESOLVED one is its distance from the finest solution with fewer modes.

    Args:
        solver: solver of the scene.
        first: the first level.
        tolerance: wanted error.
        on_first: verdict on that level for a larger tolerance, if it is known.
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
            # The rod may have an equilibrium although too few modes have none: some more levels are tried.
            if len(failures) > MOST_FAILURES or solver.taut:
                return solution
        else:
            if coarser is not None and has_more_modes(solution, coarser):
                fewer_modes = coarser
            coarser = solution
        if isinstance(verdict, Enough):
            # Not before: with few modes a stable rod may seem unstable.
            relaxed = solver.relax(solution)
            if relaxed is solution or not relaxed.stable:
                return _Reference(solution, level, verdict.resolution, fewer_modes)
            coarser = relaxed
        level = _next_level(level, verdict)
    if coarser is None:
        return failures[-1]
    if fewer_modes is not None:
        # The level below has a larger error than this one, by about the distance of the two.
        coarser = with_estimate(coarser, fewer_modes, factor=1.0)
    return _with_note(coarser.unresolved(), told_waves(modes_for_turn(largest_turn(coarser))))


def _next_level(level: Level, verdict: Verdict) -> Level | None:
    """The level that a verdict asks for; None if there is no finer one."""
    match verdict:
        case NeedsNodes(nodes):
            return replace(level, min_nodes=nodes)
        case NoEquilibrium():
            return level.with_modes(level.modes + 1)
        case NeedsModes(modes, extrapolated=True):
            return level.with_extrapolated_modes(modes)
        case NeedsModes(modes):
            return level.with_seeing_modes(modes)
        case NeedsFinerSums(factor):
            return level.with_finer_sums(factor)
        case NeedsFibres():
            return level.with_more_fibres()
        case NeedsFinerGrid():
            return level.with_finer_grid()
        case Enough():
            return level


def _at_level(solver: SceneSolver, level: Level, coarser: Solution | None) -> Solution:
    """The solution on a level, with intervals for the turns of the rods on the level before."""
    turn = solver.unloaded_turn
    if coarser is not None:
        turn = max(turn, largest_turn(coarser))
    nodes = level.nodes(turn)
    uniform = discretise(solver.scene, level.modes, nodes, solver.reference_transport)
    chosen = with_more_fibres(summed_at(uniform, level.sections), level.more_fibres)
    return solver.solve(chosen, coarser)


def _coarsened(solver: SceneSolver, resolution: Resolution) -> Solution:
    """The cheapest solution near a reference; the reference itself if none is near enough."""
    reference = resolution.preview.reference
    reference_error = resolution.tip_error
    for share, as_round in COARSENINGS:
        bound = share * solver.tolerance - reference_error
        discretisation, start = Coarsening(resolution.preview, bound, solver.wave_modes, as_round).run()
        model = solver.build(discretisation)
        solution = corrected_from(model, start, reference.inputs)
        if solution is not None:
            solver.iterations += solution.iterations
        if solution is None or not solution.converged:
            # The preview was too inexact; a tighter bound keeps the solution nearer.
            continue
        # Few modes may have the right tip and still be too stiff to buckle: the reference decides on stability.
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
    """The solution on the scene's discretisation, with its error estimated by a finer one."""
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
    """A solution on the scene's discretisation, with its distance from a finer solution as its error."""
    turn = largest_turn(solution)
    visible_from = max(solver.signal_modes, min_modes(solution, turn, solver.tolerance))
    finer = {}
    for name, fixed in discretisation.items():
        finer_modes = tuple(max(count + FINER_MODES, visible_from) for count in fixed.modes)
        resolving_nodes = nodes_for_turn(max(finer_modes), max(turn, solver.unloaded_turn))
        finer_nodes = max(fixed.nodes + FINER_NODES, resolving_nodes)
        # The fixed integrator may have an error: the reference takes the integrator for the tolerance.
        finer[name] = replace(fixed, modes=finer_modes, nodes=finer_nodes, transport=solver.reference_transport)
    finer_sums = [max(sections.counts) for sections in solution.model.discrete.finer_sections.values()]
    finer = with_more_fibres(summed_at(finer, max(finer_sums, default=0)))
    reference = solver.solve(finer, meant or solution)
    if not reference.converged:
        return solution.unresolved()
    judged = with_estimate(solution, reference)
    shape_error = judged.shape_error_estimate
    # With this comparison an estimate that is NaN counts as too large.
    if shape_error is not None and shape_error <= LARGEST_SHAPE_ERROR:
        return judged
    return judged.unresolved()


def _meant(solver: SceneSolver) -> Solution | None:
    """The decided equilibrium of a held rod; None for free rods, or if none is found."""
    if not solver.is_held or solver.signal_modes > REFERENCE_MODES[-1]:
        return None
    found = _for_tolerance(solver, DECIDING_TOLERANCE)
    if isinstance(found, _Reference):
        return found.solution
    # The modes of the user may still have an equilibrium, and one to relax to.
    solver.vain_descents = 0
    return None


def _with_note(solution: Solution, note: str) -> Solution:
    """The solution with a sentence in its message, once."""
    if note in solution.message:
        return solution
    return replace(solution, message=solution.message + note)
