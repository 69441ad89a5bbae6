"""The end of an inverse problem, and its verdict: whether the targets are met, in words too."""

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
"""How the message of an unstable result begins."""

NOT_STABLE = " No stable equilibrium was found that comes as near."
"""How the message of an unstable result ends where a stable one was wanted."""


BARRED = (
    " The search led through an obstacle or a rod: these are its inputs, with rods on the side on which they began. "
    "Other starts may lead to the targets."
)
"""Sentence where the optimiser ended behind an obstacle or a rod."""


@dataclass(frozen=True, repr=False)
class Inverse(Result):
    """Inputs found for targets.

    Attributes:
        solution: equilibrium at the inputs found; its message says whether the targets are met.
        targets: targets of the scene, or of a row of a table.
        gaps: how far each target is missed, in their order.
        met: whether the equilibrium was found and every gap is within the scene's tolerance, and where it was
            estimated the error of the model too; where a stable one was wanted, whether it is that as well.
        rounds: runs of the optimiser, from all starts together and on all discretisations; 0 where Newton's method has
            met the targets from a neighbour.
        starts: starts that were tried, 1 where the first has met the targets.
        starts_left_out: further starts that the search had no time for.
        cut_short: whether the optimiser ran out of time: the inputs are where it was, which need not be a minimum.
        barred: whether the optimiser ended behind a smooth obstacle or a rod: the equilibrium is that on this side.
        at_bounds: decision variables that ended at a bound, by name.
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
        """Whether the equilibrium is known not to be stable; without a potential none is."""
        return self.solution.converged and self.solution.stable is False

    @property
    def values(self) -> dict[str, Any]:
        """The inputs found, by name: a number for one entry, else an array of shape (components, k)."""
        values: dict[str, Any] = {}
        unpacked = self.solution.model.inputs.unpack(self.solution.inputs)
        for name in given_names(self.solution.model):
            value = unpacked[name]
            values[name] = value
            if value.size == 1:
                values[name] = np.float64(value.item())
        return values


def with_verdict(result: Inverse, stable: bool) -> Inverse:
    """The result of a search, judged: gaps, error of the model where it was estimated, and stability.

    Args:
        result: of :func:`search`, with an estimate of its error or without.
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
    """Root of the weighted squares of what the targets are missed by; infinite without an equilibrium."""
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
        sentence = f"The targets are not all met; the closest that was found misses {misses}."
        return sentence + _minimum_sentence(result)
    if _missed_by_the_model(result):
        return _model_sentence(result)
    return "The targets are met."


def _missed_by_the_model(result: Inverse) -> bool:
    """Whether the model meets every target, but the error of its modes and nodes is too large for that."""
    return result.solution.converged and all(_reached(result)) and not meets_all(result)


def _minimum_sentence(result: Inverse) -> str:
    """Where a search that leaves a gap ended: it is local, whatever the number of its starts."""
    where = "within the bounds"
    if result.at_bounds:
        where = f"at the bound of {', '.join(result.at_bounds)}"
    starts = "1 start"
    if result.starts > 1:
        starts = f"{result.starts} starts"
    sentence = f" It is a local minimum {where}, the best of {starts}."
    if result.cut_short:
        sentence = f" The optimiser ran out of time {where}, in the best of {starts}: it need not be a local minimum."
    if result.barred:
        sentence = BARRED
    if result.starts_left_out:
        sentence += f" The search took too long for {result.starts_left_out} further ones."
    return sentence


def _model_sentence(result: Inverse) -> str:
    """Why targets that the discrete model meets are not met by the rod, as far as is known."""
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
    """Whether the equilibrium was found and meets every target: by the discrete model, and that within its error."""
    tolerance = result.solution.model.scene.accuracy.tolerance
    within = [gap.within(length, tolerance) for gap, length in _gaps_and_lengths(result)]
    return result.solution.converged and all(within)


def _reached(result: Inverse) -> list[bool]:
    """Whether the discrete model meets each target, whatever its own error."""
    tolerance = result.solution.model.scene.accuracy.tolerance
    return [gap.reached(length, tolerance) for gap, length in _gaps_and_lengths(result)]


def _gaps_and_lengths(result: Inverse) -> list[tuple[TargetMiss, float]]:
    """The gap of each target, and the length that it is measured by, m."""
    lengths = [length_of(result.solution.model, target) for target in result.targets]
    return list(zip(result.gaps, lengths, strict=True))
