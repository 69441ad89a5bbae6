"""Result of an inverse problem, with the verdict on its targets, also in words."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.targets import (
    TARGET_KINDS,
    TargetMiss,
    length_of,
    target_errors,
    wanted_poses,
    weighted_errors,
)
from cosserat_casadi.equilibrium.answer_error import with_notes
from cosserat_casadi.equilibrium.contact.contact_state import given_names
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.result import Result

UNSTABLE = "Not stable: a real rod leaves this equilibrium. "
"""First sentence of the message of an unstable result."""

NOT_STABLE = " No stable equilibrium as near was found."
"""Last sentence of the message of an unstable result if a stable one was wanted."""


BARRED = (
    " The search led through an obstacle or a rod: these are its inputs, with rods on the side on which they began. "
    "Other starts may lead to the targets."
)
"""Sentence of a result whose optimiser ended behind an obstacle or a rod."""


@dataclass(frozen=True, repr=False)
class Inverse(Result):
    """Inputs that were found for targets.

    Attributes:
        solution: equilibrium at the inputs; its message says whether the targets are met.
        targets: targets of the scene, or of a row of a table.
        gaps: errors of the targets, in their order.
        met: whether the equilibrium was found, every target error is within the scene's tolerance, so is the error of
            the model if it was estimated, and the equilibrium is stable if that was wanted.
        rounds: number of runs of the optimiser, from all starts and on all discretisations; 0 if Newton's method met
            the targets from a neighbour.
        starts: number of starts that were tried; 1 if the first met the targets.
        starts_left_out: number of further starts for which there was no time.
        cut_short: whether the optimiser ran out of time; its last inputs need not be a minimum.
        barred: whether the optimiser ended behind a smooth obstacle or a rod; the equilibrium is the one on this side.
        at_bounds: names of the decision variables that ended at a bound.
    """

    solution: Equilibrium[Any]
    targets: tuple[scenes.Target, ...]
    gaps: tuple[TargetMiss, ...]
    met: bool
    rounds: int
    starts: int = 1
    starts_left_out: int = 0
    cut_short: bool = False
    barred: bool = False
    at_bounds: tuple[str, ...] = ()

    @property
    def unstable(self) -> bool:
        """Whether the equilibrium is known to be unstable; false for loads without a potential."""
        return self.solution.converged and self.solution.stable is False

    @property
    def values(self) -> dict[str, Any]:
        """The inputs by name: a number for a single entry, else an array of shape (components, k)."""
        values: dict[str, Any] = {}
        unpacked = self.solution.model.inputs.unpack(self.solution.inputs)
        for name in given_names(self.solution.model):
            value = unpacked[name]
            values[name] = value
            if value.size == 1:
                values[name] = np.float64(value.item())
        return values


def with_verdict(result: Inverse, stable: bool) -> Inverse:
    """Judge the result of a search by target errors, the error of the model if it was estimated, and stability.

    Args:
        result: result of :func:`search`, with or without an error estimate.
        stable: whether a stable equilibrium was wanted.
    """
    solution = result.solution
    gaps = target_errors(solution, result.targets)
    result = replace(result, gaps=gaps)
    result = replace(result, met=meets_all(result))
    if not _missed_by_the_model(result):
        solution = with_notes(solution)
    message = solution.message
    if result.barred and not solution.converged:
        message += BARRED
    if solution.converged:
        # What was asked for comes first: whether the targets are met.
        message = f"{_targets_sentence(result)} {message}"
    if result.unstable:
        message = UNSTABLE + message
    refused = stable and result.unstable
    if refused:
        message += NOT_STABLE
    return replace(
        result,
        solution=replace(solution, message=message),
        met=result.met and not refused,
    )


def gap_left(result: Inverse) -> float:
    """Square root of the sum of weighted squared target errors; infinite without an equilibrium."""
    solution = result.solution
    if not solution.converged:
        return np.inf
    wanted = ca.DM(wanted_poses(result.targets))
    errors = weighted_errors(solution.model, result.targets, wanted, ca.DM(solution.x), ca.DM(solution.inputs))
    return float(np.linalg.norm(ca.evalf(ca.MX(errors)).full()))


def _targets_sentence(result: Inverse) -> str:
    verdicts = _reached(result)
    missed = [gap for gap, reached in zip(result.gaps, verdicts, strict=True) if not reached]
    if missed:
        misses = "; ".join(_words(gap) for gap in missed)
        sentence = f"Not all targets are met; the closest result misses {misses}."
        return sentence + _minimum_sentence(result)
    if _missed_by_the_model(result):
        return _model_sentence(result)
    return "The targets are met."


def _missed_by_the_model(result: Inverse) -> bool:
    """Whether the model meets every target, but with too large an error by its modes and nodes."""
    return result.solution.converged and all(_reached(result)) and not meets_all(result)


def _minimum_sentence(result: Inverse) -> str:
    """Sentence on the end of a search with a remaining target error, which is local for any number of starts."""
    where = "within the bounds"
    if result.at_bounds:
        where = f"at the bound of {', '.join(result.at_bounds)}"
    starts = f"{result.starts} starts" if result.starts > 1 else "1 start"
    sentence = f" It is a local minimum {where}, the best of {starts}."
    if result.cut_short:
        sentence = f" The optimiser ran out of time {where}, in the best of {starts}: it need not be a local minimum."
    if result.barred:
        sentence = BARRED
    if result.starts_left_out:
        sentence += f" The search took too long for {result.starts_left_out} further ones."
    return sentence


def _model_sentence(result: Inverse) -> str:
    """Sentence on why targets that the discrete model meets may not be met by the rod."""
    scene = result.solution.model.scene
    errors = [TARGET_KINDS[target.kind].model_error(target, result.solution) or 0.0 for target in result.targets]
    return (
        "The targets are met by these modes and nodes, but not to the tolerance: the estimated error of the model, "
        f"{max(errors):.2g} of the length, is above {scene.accuracy.tolerance:g}. Allow more modes and nodes, or a "
        "larger tolerance."
    )


def _words(gap: TargetMiss) -> str:
    distance = f"{gap.what} by {gap.position:.3g} m"
    if gap.angle is None:
        return distance
    return f"{distance} and {gap.angle:.3g} rad"


def meets_all(result: Inverse) -> bool:
    """Whether the equilibrium meets every target in the discrete model, and within the model's error."""
    tolerance = result.solution.model.scene.accuracy.tolerance
    within = [gap.within(length, tolerance) for gap, length in _gaps_and_lengths(result)]
    return result.solution.converged and all(within)


def _reached(result: Inverse) -> list[bool]:
    """Whether the discrete model meets each target, regardless of its error."""
    tolerance = result.solution.model.scene.accuracy.tolerance
    return [gap.reached(length, tolerance) for gap, length in _gaps_and_lengths(result)]


def _gaps_and_lengths(result: Inverse) -> list[tuple[TargetMiss, float]]:
    """Error of each target, and the length by which it is divided, m."""
    lengths = [length_of(result.solution.model, target) for target in result.targets]
    return list(zip(result.gaps, lengths, strict=True))
