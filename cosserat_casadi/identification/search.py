"""Identification of a model's unknowns from its measurements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from cosserat_casadi import scene as scenes
from cosserat_casadi.accuracy.refine import solve_scene
from cosserat_casadi.accuracy.tune import common_discretisation, fixed, unfixed
from cosserat_casadi.equilibrium.stability import admissible_eigenvalues, stability_of, variations
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.identification.cases import Case, Data, read_cases
from cosserat_casadi.identification.checks import plausibility
from cosserat_casadi.identification.equilibria import Equilibria, Point
from cosserat_casadi.identification.found import Identification, LeftOut, Row
from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.identification.report import Ending
from cosserat_casadi.identification.statistics import Statistics, statistics
from cosserat_casadi.identification.unknowns import UnknownLayout, refuse_row_parameters, unknown_layout
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.obstacle_checks import refuse_obstacles
from cosserat_casadi.numerics.arrow_least_squares import Arrow, ArrowFit, Fit, Limits
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.numerics.progress import Report
from cosserat_casadi.numerics.robust_loss import Loss
from cosserat_casadi.scene.spelling import counted

SEED = 16
"""Of the cases that are held out, and of the random starts."""

DECADES = 10.0
"""Ratio of the bounds from which on starts are spread over their logarithm."""

SAME_COST = 1e-3
"""Difference of half the sums of squares within which two starts have ended at one optimum."""

NOT_FOLLOWED = "Its equilibrium could not be followed to where the search begins."
"""Why a case has none there."""

NEAREST = 0.05
"""Share of the way to a start at which it is given up, and the search begins where the first one does."""

RECHOSEN = 2
"""Times that a discretisation is chosen again at what was found."""

SAMPLES = 4
"""Cases that a discretisation is chosen on."""

Progress = Callable[[int, float], None]
"""Told the number of steps and half the sum of squares."""


def identify(
    model: Model,
    data: Data | None = None,
    *,
    hold_out: float | None = None,
    starts: int | None = None,
    report: Report | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Find the unknowns of a model's scene from what was measured.

    Args:
        model: of a scene with measurements and unknowns, which are its parameters and inputs:
            ``build(scene.with_unknowns())``.
        data: columns by measurement, by its name or its file, that stand for the file.
        hold_out: share of the cases that is not fitted but predicted; by default that of the scene.
        starts: places from which the search begins; by default that of the scene.
        report: told what is being done.
        progress: told the steps of the search.

    Raises:
        SceneError: a table is refused, the model lacks an unknown, or there are fewer data than unknowns.
    """
    refuse_obstacles(model.scene, "an identification")
    refuse_row_parameters(model.scene)
    scene = model.scene
    options = scene.identification
    layout = unknown_layout(model)
    if not scene.measurements:
        raise SceneError(Problem("measurements", "missing", "say what was measured"))
    cases = read_cases(scene, model.inputs, data)
    fitted, held_out = _split(cases, options.hold_out if hold_out is None else hold_out)
    _refuse_few_data(layout, fitted, scene)
    task = _Task(
        model,
        layout,
        Loss(options.loss, options.loss_width),
        options,
        options.starts if starts is None else starts,
        report or (lambda stage: None),
        progress,
    )
    return task.run(fitted, held_out)


def identify_scene(
    scene: scenes.Scene,
    data: Data | None = None,
    *,
    hold_out: float | None = None,
    starts: int | None = None,
    report: Report | None = None,
    progress: Progress | None = None,
) -> Identification:
    """Find the unknowns of a scene from what was measured, on modes and nodes that meet its tolerance.

    They are chosen on the cases that lie farthest apart: at the scene's own numbers, and again at those found, which
    may bend the rods otherwise. Where that asks for other modes or nodes, the search is made on them.

    Args:
        scene: with measurements and unknowns.
        data: as in :func:`identify`.
        hold_out: as there.
        starts: as there.
        report: as there.
        progress: as there.

    Raises:
        SceneError: as in :func:`identify`.
    """
    refuse_obstacles(scene, "an identification")
    refuse_row_parameters(scene)
    completed = scene.with_unknowns()
    draft = build(completed)
    # All that is refused is refused before time is spent on a discretisation.
    unknown_layout(draft)
    if not scene.measurements:
        raise SceneError(Problem("measurements", "missing", "say what was measured"))
    cases = read_cases(completed, draft.inputs, data)
    if report is not None:
        report("choosing the discretisation")
    chosen = _with_discretisation(completed, draft, np.array([case.inputs for case in cases]))
    found = identify(build(chosen), data, hold_out=hold_out, starts=starts, report=report, progress=progress)
    for _ in range(RECHOSEN):
        if scene.accuracy.fixed or not found.converged:
            break
        if report is not None:
            report("judging the discretisation")
        judged = _with_discretisation(found.fitted_scene(completed), draft, found.inputs)
        if judged.accuracy == chosen.accuracy:
            break
        chosen = completed.model_copy(update={"accuracy": judged.accuracy})
        found = identify(build(chosen), data, hold_out=hold_out, starts=starts, report=report, progress=progress)
    return found


def _with_discretisation(scene: scenes.Scene, draft: Model, inputs: FloatArray) -> scenes.Scene:
    """The scene on modes and nodes that serve those rows of inputs, (cases, size), that lie farthest apart."""
    if scene.accuracy.fixed:
        return scene
    baked = unfixed(scene.baked(), scene.accuracy.tolerance)
    chosen = [(baked, draft.inputs.unpack(inputs[row])) for row in _far_apart(inputs, SAMPLES)]
    alone = [solve_scene(one, values) for one, values in chosen]
    used = [i for i, solution in enumerate(alone) if solution.converged]
    if not used:
        return scene
    discretisation, _ = common_discretisation(
        [chosen[i] for i in used],
        [alone[i] for i in used],
        solve_scene,
    )
    return fixed(scene, discretisation)


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


def _split(cases: Sequence[Case], share: float) -> tuple[list[Case], list[Case]]:
    """Cases that are fitted, and those that are held out."""
    if not 0.0 <= share < 1.0:
        raise SceneError(Problem("--hold-out", f"must be >= 0 and < 1, got {share:g}"))
    count = round(share * len(cases))
    if share > 0.0 and count in (0, len(cases)):
        problem = f"holds out {count} of {len(cases)} cases"
        raise SceneError(Problem("--hold-out", problem, "hold out at least one, and leave at least one"))
    chosen = set(np.random.default_rng(SEED).permutation(len(cases))[:count].tolist())
    fitted = [case for i, case in enumerate(cases) if i not in chosen]
    return fitted, [cases[i] for i in sorted(chosen)]


def _refuse_few_data(layout: UnknownLayout, cases: Sequence[Case], scene: scenes.Scene) -> None:
    """Refuse fewer data than unknowns: whatever they are, they can be met.

    Raises:
        SceneError: there are fewer.
    """
    data = 0
    for case in cases:
        for number, rows in case.data.items():
            differences = len(scene.measurements[number].differences)
            data += sum(int(np.isfinite(row.values[:differences]).sum()) for row in rows)
    shared, own = len(layout.shared_labels), len(layout.own_labels)
    priors = int(np.count_nonzero(layout.shared_limits.weight))
    priors += len(cases) * int(np.count_nonzero(layout.own_limits.weight))
    unknowns = shared + own * len(cases)
    if data + priors < unknowns:
        wanted = f"{counted(unknowns, 'unknown')} in {counted(len(cases), 'case')}"
        problem = f"{wanted} are too many for {counted(data + priors, 'number')}"
        raise SceneError(Problem("unknowns", problem, "leave some out, give priors, or measure more"))


@dataclass(frozen=True)
class _Task:
    """An identification.

    Attributes:
        model: with the unknowns.
        layout: what is unknown.
        loss: what residuals cost.
        options: of the scene.
        starts: places from which the search begins.
        report: told what is being done.
        progress: told the steps of the search.
    """

    model: Model
    layout: UnknownLayout
    loss: Loss
    options: scenes.Identification
    starts: int
    report: Report
    progress: Progress | None

    def run(self, fitted: Sequence[Case], held_out: Sequence[Case]) -> Identification:
        """Fit some cases, predict others."""
        ending = Ending(self.model, self.layout)
        self.report("solving all cases")
        shared, _ = self.layout.start(len(fitted))
        first, left_out = self._first(fitted, shared)
        ending.left_out += left_out
        if first is None or (left_out and self.options.failures == "stop"):
            return ending.without_equilibrium(stopped=first is not None)
        misfit, state = first
        fit, ended_here = self._best(misfit, state)
        self.report("judging what was found")
        arrow = self._arrow_fit(misfit).linear(fit.shared, fit.own, fit.state)
        known = self._statistics(arrow, fit, misfit)
        predicted = self._predicted(held_out, fit, ending.left_out)
        rows = self._rows(misfit, fit.state, held_out=False)
        if predicted is not None:
            rows += self._rows(*predicted, held_out=True)
        ending.warnings += plausibility(self.model, self.layout, rows)
        ending.unstable += _unstable(misfit, fit.state.point)
        resolved = _resolved(self.model, fit.state.point)
        ending.unresolved += [case.where for case, is_so in zip(misfit.cases, resolved, strict=True) if not is_so]
        return ending.found(fit, known, rows, misfit, self.layout.shared_limits, (self.starts, ended_here))

    def _first(
        self, cases: Sequence[Case], shared: FloatArray
    ) -> tuple[tuple[Misfit, MisfitState] | None, list[LeftOut]]:
        """The misfit of the cases that have an equilibrium at the start, and those that have none."""
        nominal_p = self.layout.p
        _, own = self.layout.start(len(cases))
        inputs = np.array([case.inputs for case in cases]).reshape(len(cases), -1)
        everyone = Equilibria(self.model, len(cases))
        point, outcomes = everyone.loaded(inputs, nominal_p)
        # From the scene's own numbers to the start, where a bound or another value moves it.
        wanted = self.layout.inputs(shared, own, inputs)
        p = self.layout.parameters(shared)
        moved, reached = everyone.tracked(point, point.x, wanted, p)
        resolved = _resolved(self.model, moved)
        left_out = []
        kept = []
        for i, (case, outcome) in enumerate(zip(cases, outcomes, strict=True)):
            if outcome is not Outcome.CONVERGED:
                left_out.append(LeftOut(case.where, outcome.value))
            elif not reached[i]:
                left_out.append(LeftOut(case.where, NOT_FOLLOWED))
            elif not resolved[i]:
                left_out.append(LeftOut(case.where, Outcome.UNRESOLVED.value))
            else:
                kept.append(i)
        if not kept:
            return None, left_out
        remaining = Point(moved.x[kept], moved.inputs[kept], p, moved.inverses[kept])
        misfit = Misfit(self.model, self.layout, [cases[i] for i in kept], Equilibria(self.model, len(kept)))
        return (misfit, misfit.first(remaining, shared, own[kept])), left_out

    def _arrow_fit(self, misfit: Misfit, shared: Limits | None = None) -> ArrowFit[MisfitState]:
        limits = self.layout.shared_limits if shared is None else shared
        return ArrowFit(misfit, limits, self.layout.own_limits, self.loss)

    def _best(self, misfit: Misfit, first: MisfitState) -> tuple[Fit[MisfitState], int]:
        """The best fit of all starts, and how many of them ended there."""
        arrow_fit = self._arrow_fit(misfit)
        misfit.jacobians(first)
        fits = []
        for number, shared in enumerate(self._start_points(first.shared)):
            self.report("fitting" if self.starts == 1 else f"fitting, start {number + 1} of {self.starts}")
            state = self._towards(misfit, first, shared) if number else first
            fits.append(arrow_fit.run(state.shared, first.own, state, self.progress))
        best = min(fits, key=lambda fit: fit.cost)
        alike = [fit for fit in fits if fit.cost - best.cost <= SAME_COST * (1 + best.cost)]
        return best, len(alike)

    def _towards(self, misfit: Misfit, first: MisfitState, shared: FloatArray) -> MisfitState:
        """The state at a start, or as far on the way to it as all cases can be followed."""
        ratios = self.layout.shared_limits.ratios
        share = 1.0
        while share > NEAREST:
            way = first.shared + share * (shared - first.shared)
            way[ratios] = first.shared[ratios] * (shared[ratios] / first.shared[ratios]) ** share
            point, reached = misfit.moved(way, first.own, first)
            if np.all(reached):
                return misfit.first(point, way, first.own)
            share /= 2
        return first

    def _start_points(self, first: FloatArray) -> list[FloatArray]:
        """Where the searches begin: at the scene's values, then at random between bounds or from priors."""
        limits = self.layout.shared_limits
        rng = np.random.default_rng(SEED)
        points = [first]
        bounded = np.isfinite(limits.lower) & np.isfinite(limits.upper)
        spread = bounded & (limits.lower > 0) & (limits.upper > DECADES * limits.lower)
        even = bounded & ~spread
        expected = ~bounded & (limits.weight > 0)
        for _ in range(self.starts - 1):
            shares = rng.random(len(first))
            normal = rng.standard_normal(len(first))
            point = first.copy()
            point[even] = limits.lower[even] + shares[even] * (limits.upper[even] - limits.lower[even])
            ratios = limits.upper[spread] / limits.lower[spread]
            point[spread] = limits.lower[spread] * ratios ** shares[spread]
            point[expected] = limits.mean[expected] + normal[expected] / limits.weight[expected]
            points.append(limits.clipped(point))
        return points

    def _statistics(self, arrow: Arrow, fit: Fit[MisfitState], misfit: Misfit) -> Statistics:
        """What the data say at the optimum."""
        n, k = arrow.sizes
        unknowns = n + k * len(misfit.cases)
        priors = np.count_nonzero(self.layout.shared_limits.weight)
        priors += len(misfit.cases) * np.count_nonzero(self.layout.own_limits.weight)
        return statistics(
            arrow,
            self.layout.shared_labels,
            self.layout.scales(fit.shared),
            freedom=len(fit.state.residual) + int(priors) - unknowns,
            squares=self.loss.noise_squares(fit.state.residual),
            scaled_noise=self.options.noise == "residual",
        )

    def _predicted(
        self, cases: Sequence[Case], fit: Fit[MisfitState], left_out: list[LeftOut]
    ) -> tuple[Misfit, MisfitState] | None:
        """Cases that were held out, at what was found; unknowns of single cases are found from their own data."""
        if not cases:
            return None
        first, failed = self._first(cases, fit.shared)
        left_out += [replace(case, reason=f"Held out: {case.reason}") for case in failed]
        if first is None:
            return None
        misfit, state = first
        if not self.layout.own:
            return first
        held = replace(self.layout.shared_limits, lower=fit.shared, upper=fit.shared, weight=np.zeros_like(fit.shared))
        return misfit, self._arrow_fit(misfit, held).run(fit.shared, state.own, state).state

    def _rows(self, misfit: Misfit, state: MisfitState, *, held_out: bool) -> list[Row]:
        """Every measured number beside the model's."""
        rows = []
        for number, measured in misfit.measurements.items():
            residual = measured.residual(state.point)
            weights = self.loss.weights(residual)
            for i, (datum, entry) in enumerate(measured.data):
                is_angle = measured.record.quantity == "pose" and entry >= 3
                value = 0.0 if is_angle else float(datum.values[entry])
                difference = float(residual[i] * measured.sigma[entry])
                row = Row(
                    where=datum.where,
                    measurement=number,
                    entry=entry,
                    case=measured.row_cases[i],
                    measured=value,
                    modelled=value + difference,
                    residual=float(residual[i]),
                    weight=1.0 if held_out else float(weights[i]),
                    held_out=held_out,
                )
                rows.append(row)
        return rows


def _unstable(misfit: Misfit, point: Point) -> list[str]:
    """Cases whose equilibrium is unstable, where that has a meaning."""
    model = misfit.model
    allowed = variations(model)
    jacobians = misfit.equilibria.jacobians(point.x, point.inputs, point.p)
    unstable = []
    for case, jacobian, inputs in zip(misfit.cases, jacobians, point.inputs, strict=True):
        if model.has_potential(inputs) and not stability_of(admissible_eigenvalues(jacobian, allowed)).stable:
            unstable.append(case.where)
    return unstable


def _resolved(model: Model, point: Point) -> list[bool]:
    """Whether the nodes resolve the rods in each case."""
    parameters: list[npt.NDArray[np.float64]] = [point.p] if model.parameters.size else []
    return [
        float(model.resolution_index(x, inputs, *parameters)) <= 1.0
        for x, inputs in zip(point.x, point.inputs, strict=True)
    ]
