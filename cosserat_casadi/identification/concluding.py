"""Statistics, remarks and warnings on the result of a search."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cosserat_casadi.identification.case_time_steps import STEP_ERROR
from cosserat_casadi.identification.fit_unknowns import UnknownLayout
from cosserat_casadi.identification.identification_result import Identification, LeftOut, Row
from cosserat_casadi.identification.measured_modes import JointModes
from cosserat_casadi.identification.misfit import Misfit, MisfitState
from cosserat_casadi.identification.statistics import Direction, Statistics
from cosserat_casadi.numerics.arrow_least_squares import Fit, FitOutcome
from cosserat_casadi.numerics.outcome import Outcome
from cosserat_casadi.spelling import counted, named
from cosserat_casadi.tubes.tube_functions import AnyModel

POOR = 2.0
"""Root mean square of the residuals, in standard deviations, above which the model does not explain the data."""


def without_equilibrium(
    model: AnyModel, layout: UnknownLayout, left_out: Sequence[LeftOut], *, stopped: bool
) -> Identification:
    """Make the result of an identification with cases that have no equilibrium.

    Args:
        model: the model that was to be fitted.
        layout: the unknowns.
        left_out: the cases without equilibrium.
        stopped: whether other cases have one, but the scene requires all.
    """
    cases = named([case.where for case in left_out])
    reason = left_out[0].reason
    message = f"No case has an equilibrium at the start: {cases}. {reason}"
    if stopped:
        message = f"No equilibrium at the start in {cases}. {reason} The scene asks to stop the search at such cases."
    shared, own = layout.start(0)
    n = len(shared)
    nothing = Statistics(
        covariance=np.full((n, n), np.nan),
        determined=np.zeros(n, dtype=bool),
        unseen=(),
        settled=False,
        noise=1.0,
        quantile=np.nan,
        own=own,
    )
    return Identification(
        model=model,
        layout=layout,
        shared=np.full(n, np.nan),
        own=own,
        statistics=nothing,
        converged=False,
        outcome="no_equilibrium",
        message=message,
        iterations=0,
        cost=np.nan,
        rows=(),
        cases=(),
        unknowns_x=np.zeros((0, model.size)),
        inputs=np.zeros((0, model.inputs.size)),
        unstable=(),
        left_out=tuple(left_out),
        at_bounds=(),
        warnings=(),
        starts=(0, 0),
    )


@dataclass(frozen=True)
class Ending:
    """Result of a search.

    Attributes:
        misfit: misfit of the cases that took part.
        fit: result of the fit.
        known: statistics of the unknowns there.
        left_out: cases that took no part.
    """

    misfit: Misfit
    fit: Fit[MisfitState]
    known: Statistics
    left_out: Sequence[LeftOut]

    @cached_property
    def kinks(self) -> list[str]:
        """Contacts that open, close or change at the result of the search."""
        if self.fit.beyond is None or self.fit.outcome is FitOutcome.CONVERGED:
            return []
        return self.misfit.at_kink(self.fit.state, self.fit.beyond)

    def concluded(
        self, rows: Sequence[Row], warnings: Sequence[str], starts: tuple[int, int], step_error: float
    ) -> Identification:
        """Make the identification with its remarks.

        Args:
            rows: every measured number with that of the model.
            warnings: warnings that precede the remarks.
            starts: number of starts, and number of starts that ended here.
            step_error: error of a residual by the steps of the motions.
        """
        fit, misfit = self.fit, self.misfit
        layout = misfit.layout
        at_bound = layout.shared_limits.at_end(fit.shared)
        at_bounds = [label for label, is_there in zip(layout.shared_labels, at_bound, strict=True) if is_there]
        outcome, message = self._outcome()
        moves = bool(misfit.motions.times)
        draft = Identification(
            model=misfit.model,
            layout=layout,
            shared=fit.shared,
            own=fit.own,
            statistics=self.known,
            converged=outcome == "converged",
            outcome=outcome,
            message=message,
            iterations=fit.iterations,
            cost=fit.cost,
            rows=tuple(rows),
            cases=tuple(case.where for case in misfit.cases),
            unknowns_x=fit.state.point.x,
            inputs=fit.state.point.inputs,
            equilibria=misfit.solutions(fit.state),
            unstable=tuple(misfit.unstable(fit.state)),
            left_out=tuple(self.left_out),
            at_bounds=tuple(at_bounds),
            warnings=(),
            starts=starts,
            step=misfit.motions.size if moves else None,
            step_error=step_error if moves else None,
        )
        return replace(draft, warnings=(*warnings, *self._remarks(draft)))

    def _outcome(self) -> tuple[str, str]:
        """Outcome of the search, in a word and in sentences."""
        fit, misfit, known = self.fit, self.misfit, self.known
        if fit.outcome not in (FitOutcome.CONVERGED, FitOutcome.AT_KINK):
            remedy = ""
            if self.kinks:
                changes = f"Contacts change there ({named(self.kinks)})"
                remedy = f" {changes}: begin nearer to the answer, or leave these cases out."
            return fit.outcome.name.lower(), f"Not found: {fit.outcome.value}{remedy}"
        unresolved = misfit.unresolved(fit.state)
        if unresolved:
            cases = named(unresolved)
            return "unresolved", f"Not found: the nodes do not resolve the rods in {cases}; allow more of them."
        passages = misfit.passages(fit.state)
        if passages:
            cases = named([case for case, _ in passages])
            return "unresolved", f"Not found. Of {cases}: {passages[0][1]}"
        beyond = misfit.beyond_limits(fit.state)
        if beyond:
            limit = beyond[0][1]
            told = Outcome[limit.word]
            cases = named([case for case, _ in beyond])
            return told.label, f"Not found. Of {cases}: {told.value} {limit.whose}."
        if not known.settled:
            directions = "; ".join(described(direction) for direction in known.unseen)
            remedy = "Leave unknowns out, give priors, or measure more."
            return "not_determined", f"Not found: the data do not determine {directions}. {remedy}"
        unknowns = counted(len(fit.shared), "unknown")
        numbers = counted(len(fit.state.residual), "number")
        return "converged", f"Found: {unknowns} from {numbers}."

    def _remarks(self, found: Identification) -> list[str]:
        """Remarks on the fit, for the user."""
        remarks = []
        if found.converged and self.kinks:
            remarks.append(
                f"The misfit is least exactly where contacts come, go or change: {named(self.kinks)}. Its derivatives "
                "jump there, and intervals hold for changes to one side only: measure where contacts press, or "
                "nothing touches."
            )
        rms = found.rms()
        if rms is not None and rms > POOR:
            remarks.append(
                f"The residuals are {rms:.3g} standard deviations (rms): the model does not explain the data to the "
                "accuracy that sigma states."
            )
        barred = self.misfit.barred
        if barred and (not found.converged or (rms is not None and rms > POOR)):
            remarks.append(
                f"The search refused steps through an obstacle or a rod in {named(barred)}: rods stay on the side on "
                "which the scene has them. Check on which side they were measured, or begin nearer to the answer."
            )
        if found.converged and found.statistics.unseen:
            directions = "; ".join(described(direction) for direction in found.statistics.unseen)
            remarks.append(f"The data do not determine {directions}: only the priors do.")
        if found.at_bounds:
            remarks.append(
                f"At a bound: {', '.join(found.at_bounds)}. The intervals of the other unknowns take these values as "
                "exact."
            )
        if found.unstable:
            remarks.append(
                f"The equilibrium is unstable in {named(found.unstable)}: the measured equilibrium is hardly this one."
            )
        remarks += _on_own_unknowns(found)
        remarks += _on_joint_modes(found, self.misfit.joint_modes(self.fit.state))
        if self.left_out:
            remarks.append(f"Left out: {named([case.where for case in self.left_out])}. {self.left_out[0].reason}")
        if found.step is not None and found.step_error is not None and not found.step_error <= STEP_ERROR:
            remarks.append(
                f"Steps of {found.step:.3g} s leave an error of {found.step_error:.2g} standard deviations in the "
                "motions: give [simulation] a shorter step, or none."
            )
        return remarks


def _on_own_unknowns(found: Identification) -> list[str]:
    """Remarks on unknowns of single cases that their data leave undetermined, and the effect on held-out cases."""
    remarks = []
    for label, deviations in zip(found.layout.own_labels, found.statistics.own.T, strict=True):
        open_in = [where for where, sigma in zip(found.cases, deviations, strict=True) if np.isnan(sigma)]
        if open_in:
            remarks.append(f"The data do not determine {label} in {named(open_in)}: its value there has no meaning.")
    held_out = {row.case for row in found.rows if row.held_out}
    if held_out and found.layout.own_labels:
        numbers = sum(row.held_out for row in found.rows)
        fitted = counted(len(held_out) * len(found.layout.own_labels), "unknown")
        remarks.append(
            f"{fitted} of the held-out cases themselves were fitted to their {counted(numbers, 'number')}: the "
            "prediction tests only the rest of these numbers."
        )
    return remarks


def _on_joint_modes(found: Identification, joint_modes: Sequence[JointModes]) -> list[str]:
    """Remarks on measured modes of one frequency, and on the unknowns that would separate them."""
    remarks = []
    for numbers in dict.fromkeys(joint.numbers for joint in joint_modes):
        alike = [joint for joint in joint_modes if joint.numbers == numbers]
        modes = " and ".join(str(number) for number in numbers)
        where = named([found.cases[joint.case] for joint in alike])
        sentence = (
            f"Modes {modes} have one frequency in {where}: the measurements of these modes are compared with their "
            "mean."
        )
        parted = np.any([joint.parted for joint in alike], axis=0)
        names = [label for label, is_so in zip(found.layout.shared_labels, parted, strict=True) if is_so]
        if names:
            verb = "parts" if len(names) == 1 else "part"
            sentence += f" {', '.join(names)} {verb} them, which their mean does not see: begin elsewhere."
        remarks.append(sentence)
    return remarks


def described(direction: Direction) -> str:
    """Describe a direction in words, such as ``−0.97 a + 0.24 b``."""
    terms = []
    for name, part in sorted(direction.parts.items(), key=lambda item: -abs(item[1])):
        sign = "−" if part < 0 else "+"
        terms.append(f"{sign} {abs(part):.2g} {name}" if len(direction.parts) > 1 else name)
    return " ".join(terms).removeprefix("+ ")
