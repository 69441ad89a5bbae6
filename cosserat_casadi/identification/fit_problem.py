"""One identification: equilibria and motions at the start, searches, results, and their statistics."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.identification.case_contacts import ContactEquilibria, ContactMisfit
from cosserat_casadi.identification.case_equilibria import Equilibria
from cosserat_casadi.identification.case_motions import StartInputs
from cosserat_casadi.identification.case_time_steps import STEP_ERROR, error_of_steps, given_steps, with_steps
from cosserat_casadi.identification.concluding import Ending, without_equilibrium
from cosserat_casadi.identification.fit_unknowns import UnknownLayout
from cosserat_casadi.identification.identification_result import Identification, LeftOut, Row
from cosserat_casadi.identification.measured_cases import Case
from cosserat_casadi.identification.measured_quantities import QUANTITIES
from cosserat_casadi.identification.misfit import Misfit, MisfitState, inputs_of, moving
from cosserat_casadi.identification.statistics import NoiseFrom, Statistics, statistics
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.sections import sizes_of
from cosserat_casadi.numerics.arrow_least_squares import ArrowFit, ArrowStep, Fit, FitOutcome, Limits
from cosserat_casadi.numerics.progress import Report
from cosserat_casadi.numerics.robust_loss import Loss
from cosserat_casadi.tubes.tube_functions import AnyModel

SEED = 16
"""Seed of the draw of cases that are held out, and of the random starts."""

DECADES = 10.0
"""Ratio of the bounds above which starts are spread over the logarithm."""

SAME_COST = 1e-3
"""Difference of half the sums of squares up to which two starts count as having found one optimum."""

NEAREST = 0.05
"""Share of the way to a start below which the start is given up, and the search begins at the first one."""

NOT_SWINGING = "A measured mode does not vibrate there."
"""Reason for leaving out a case that has an equilibrium."""

NOT_MOVING = "The steps of its motion could not be solved there."
"""Reason for leaving out a motion."""

MOST_RETRIES = 3
"""Most retries of cases without an equilibrium or motion, at the fitted numbers."""

MOST_SHORTENINGS = 3
"""Most repetitions of the search with half the step."""

Progress = Callable[[int, float], None]
"""Callback with the number of steps and half the sum of squares."""


_Missing = list[tuple[Case, str]]
"""Cases that take no part, each with the reason as a sentence."""


_Started = tuple[Misfit, MisfitState]
"""Misfit of the cases that take part, and their state at the initial unknowns."""


@dataclass(frozen=True)
class Task:
    """An identification.

    Attributes:
        model: model with the unknowns.
        layout: the unknowns.
        loss: cost of residuals.
        options: options of the scene.
        starts: number of starts of the search.
        report: callback with the work under way.
        progress: callback with the steps of the search.
    """

    model: AnyModel
    layout: UnknownLayout
    loss: Loss
    options: scenes.IdentificationSettings
    starts: int
    report: Report
    progress: Progress | None

    def run(self, fitted: Sequence[Case], held_out: Sequence[Case]) -> Identification:
        """Fit some cases, and predict others."""
        self.report("solving all cases")
        shared, _ = self.layout.start(len(fitted))
        started, missing = self._first(fitted, shared)
        if started is None or (missing and self.options.failures == "stop"):
            left_out = [LeftOut(case.where, reason) for case, reason in missing]
            return without_equilibrium(self.model, self.layout, left_out, stopped=started is not None)
        misfit = started[0]
        fit, ended_here = self._best(*started)
        misfit, fit, missing = self._with_others(misfit, fit, missing)
        fit, step_error = self._with_short_steps(misfit, fit)
        self.report("judging the result")
        left_out = [LeftOut(case.where, reason) for case, reason in missing]
        arrow = self._arrow_fit(misfit).linear(fit.shared, fit.own, fit.state)
        known = self._statistics(arrow, fit, misfit)
        predicted = self._predicted(held_out, fit, left_out)
        rows = self._rows(misfit, fit.state, held_out=False)
        if predicted is not None:
            rows += self._rows(*predicted, held_out=True)
        ending = Ending(misfit, fit, known, left_out)
        entries = [(row.measurement, row.entry, row.measured) for row in rows]
        warnings = [*_wide_bounds(self.model, self.layout), *far_positions(self.model.scene, entries)]
        if fit.beyond is None or fit.outcome is FitOutcome.CONVERGED:
            warnings += misfit.marginal(fit.state)
        return ending.concluded(rows, warnings, (self.starts, ended_here), step_error)

    def _first(self, cases: Sequence[Case], shared: FloatArray) -> tuple[_Started | None, _Missing]:
        """Make the misfit of the cases that have an equilibrium or a motion at the start; also return the others."""
        _, own = self.layout.start(len(cases))
        moves = moving(cases)
        start = StartInputs(self.model)
        inputs = inputs_of(cases)
        wanted = start.of(self.layout.inputs(shared, own, inputs), moves)
        everyone = self._equilibria(cases)
        point, reasons = everyone.started(
            start.of(inputs, moves), wanted, self.layout.p, self.layout.parameters(shared)
        )
        missing = [(case, reason) for case, reason in zip(cases, reasons, strict=True) if reason]
        kept = [i for i, reason in enumerate(reasons) if not reason]
        if not kept:
            return None, missing
        cases, point, own = [cases[i] for i in kept], point.chosen(kept), own[kept]
        misfit = self._misfit(cases)
        state = with_steps(misfit, misfit.first(point, shared, own))
        spoilt = set(misfit.row_cases[~np.isfinite(state.residual)].tolist())
        if spoilt:
            missing += [(cases[i], NOT_MOVING if cases[i].moves else NOT_SWINGING) for i in sorted(spoilt)]
            kept = [i for i in range(len(cases)) if i not in spoilt]
            if not kept:
                return None, missing
            # Steps were halved as long as some motion could not be computed: the others may take longer ones.
            misfit = self._misfit([cases[i] for i in kept])
            state = with_steps(misfit, misfit.first(point.chosen(kept), shared, own[kept]))
        return (misfit, state), missing

    def _misfit(self, cases: Sequence[Case]) -> Misfit:
        kind = ContactMisfit if self.model.scene.touches_exactly else Misfit
        return kind(self.model, self.layout, cases, self._equilibria(cases))

    def _equilibria(self, cases: Sequence[Case]) -> Equilibria:
        kind = ContactEquilibria if self.model.scene.touches_exactly else Equilibria
        # Motions begin in the unloaded shape, and not in an equilibrium, where the scene says so.
        unloaded = self.model.scene.simulation is not None and self.model.scene.starts_unloaded
        return kind(self.model, len(cases), moving(cases) & unloaded)

    def _with_others(
        self, misfit: Misfit, fit: Fit[MisfitState], missing: _Missing
    ) -> tuple[Misfit, Fit[MisfitState], _Missing]:
        """Repeat the search with cases that had no equilibrium at the start but have one at the fitted numbers."""
        for _ in range(MOST_RETRIES):
            if not missing:
                break
            further, left = self._first([case for case, _ in missing], fit.shared)
            if further is None:
                break
            missing = left
            before = misfit
            added, at_start = further
            point = fit.state.point.joined(at_start.point)
            misfit = self._misfit([*before.cases, *added.cases])
            misfit.motions.size = min(before.motions.size, added.motions.size)
            if not before.motions.times:
                misfit.motions.size = added.motions.size
            own = np.concatenate([fit.own, at_start.own])
            state = misfit.first(point, fit.shared, own)
            self.report("fitting, with cases that had no equilibrium before")
            fit = self._arrow_fit(misfit).run(fit.shared, own, state, self.progress)
        return misfit, fit, missing

    def _with_short_steps(self, misfit: Misfit, fit: Fit[MisfitState]) -> tuple[Fit[MisfitState], float]:
        """Repeat the search with shorter steps, if the steps of the start are too long at the fitted numbers."""
        error = error_of_steps(misfit, fit.state)
        for _ in range(MOST_SHORTENINGS):
            if error <= STEP_ERROR or given_steps(self.model):
                break
            self.report("fitting, with shorter steps")
            misfit.motions.size /= 2.0
            state = misfit.first(fit.state.point, fit.shared, fit.own)
            fit = self._arrow_fit(misfit).run(fit.shared, fit.own, state, self.progress)
            error = error_of_steps(misfit, fit.state)
        return fit, error

    def _arrow_fit(self, misfit: Misfit, shared: Limits | None = None) -> ArrowFit[MisfitState]:
        limits = self.layout.shared_limits if shared is None else shared
        return ArrowFit(misfit, limits, self.layout.own_limits, self.loss, kinked=misfit.kinked)

    def _best(self, misfit: Misfit, first: MisfitState) -> tuple[Fit[MisfitState], int]:
        """Find the best fit of all starts, and the number of starts that ended there."""
        arrow_fit = self._arrow_fit(misfit)
        misfit.jacobian(first)
        fits = []
        for number, shared in enumerate(self._start_points(first.shared)):
            self.report("fitting" if self.starts == 1 else f"fitting, start {number + 1} of {self.starts}")
            state = self._towards(misfit, first, shared) if number else first
            fits.append(arrow_fit.run(state.shared, first.own, state, self.progress))
        best = min(fits, key=lambda fit: fit.cost)
        alike = [fit for fit in fits if fit.cost - best.cost <= SAME_COST * (1 + best.cost)]
        return best, len(alike)

    def _towards(self, misfit: Misfit, first: MisfitState, shared: FloatArray) -> MisfitState:
        """Follow all cases to a start, or as far on the way to it as possible; return the state."""
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
        """Starts of the searches: at the scene's values, then at random between bounds or from priors."""
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

    def _statistics(self, arrow: ArrowStep, fit: Fit[MisfitState], misfit: Misfit) -> Statistics:
        """Statistics of the unknowns at the optimum."""
        priors = np.count_nonzero(self.layout.shared_limits.weight)
        priors += len(misfit.cases) * np.count_nonzero(self.layout.own_limits.weight)
        return statistics(
            arrow,
            self.layout.shared_labels,
            (self.layout.scales(fit.shared), self.layout.own_scales),
            freedom=len(fit.state.residual) + int(priors) - len(arrow.held),
            squares=self.loss.noise_squares(fit.state.residual),
            noise_from=self._noise_from,
        )

    @property
    def _noise_from(self) -> NoiseFrom:
        """Source of the noise of intervals; a loss for outliers means that sigma does not describe all of it."""
        if self.options.noise == "residual":
            return NoiseFrom.RESIDUALS
        if self.loss.kind == "squares":
            return NoiseFrom.SIGMA
        return NoiseFrom.BOTH

    def _predicted(self, cases: Sequence[Case], fit: Fit[MisfitState], left_out: list[LeftOut]) -> _Started | None:
        """Predict held-out cases at the fitted numbers; unknowns of single cases are fitted to the cases' data."""
        if not cases:
            return None
        started, failed = self._first(cases, fit.shared)
        left_out += [LeftOut(case.where, f"Held out: {reason}") for case, reason in failed]
        if started is None:
            return None
        if not self.layout.own:
            return started
        misfit, state = started
        held = replace(self.layout.shared_limits, lower=fit.shared, upper=fit.shared, weight=np.zeros_like(fit.shared))
        return misfit, self._arrow_fit(misfit, held).run(fit.shared, state.own, state).state

    def _rows(self, misfit: Misfit, state: MisfitState, *, held_out: bool) -> list[Row]:
        """Every measured number with that of the model."""
        rows = []
        for number, measured in misfit.measurements.items():
            residual = misfit.residual_of(measured, state)
            weights = self.loss.weights(residual)
            for i, (datum, entry) in enumerate(measured.data):
                value = QUANTITIES[measured.record.quantity].number(entry, datum.values)
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
                    time=None if np.isnan(datum.time) else datum.time,
                    at=None if np.isnan(datum.at) else datum.at,
                )
                rows.append(row)
        return rows


FAR = 3.0
"""Lengths of all rods, or tubes, beyond which a measured position, from the base on, is hardly one of the scene."""


def _wide_bounds(model: AnyModel, layout: UnknownLayout) -> Iterator[str]:
    """Warnings of sizes of a section whose range begins above the length of the rod."""
    rods = {rod.name: rod for rod in model.scene.rods}
    for entry in layout.shared:
        owner, _, key = entry.record.name.partition(".")
        lower = entry.limits()[0]
        rod = rods.get(owner)
        if rod is None or rod.section is None:
            continue
        is_size = any(part in sizes_of(rod.section) for part in key.split("."))
        if is_size and np.any(lower >= rod.length):
            yield f"{entry.record.name} may not be below {lower.max():g} m, in a rod of {rod.length:g} m: metres?"


def far_positions(scene: scenes.Scene, entries: Sequence[tuple[int, int, float]]) -> Iterator[str]:
    """Warnings of measured positions that no rod reaches.

    Args:
        scene: scene of the measurements.
        entries: index of the measurement, index of its entry, and the measured number.
    """
    length = sum(rod.length for rod in scene.rods) + sum(tube.length for tube in scene.tubes)
    places = [rod.base.position for rod in scene.rods]
    for joint in scene.joints:
        places += [joint.position, *(place.position for place in joint.places)]
    reach = FAR * (length + max((np.abs(place).max() for place in places), default=0.0))
    for number, measurement in enumerate(scene.measurements):
        coordinates = QUANTITIES[measurement.quantity].coordinates
        distances = [abs(value) for own, entry, value in entries if own == number and entry < coordinates]
        if distances and max(distances) > reach:
            farthest = max(distances)
            yield (
                f"{measurement.title}: a position of {farthest:g} m is measured, where rods and tubes together are "
                f"{length:g} m long: are the columns in mm? Then scale = 1e-3."
            )
