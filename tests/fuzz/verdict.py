"""One scene of the fuzz: solved, and what is claimed checked by other means."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi import SceneError, Solution, scene_from_dict, solve
from tests.pose_errors import distance_between
from tests.reference.robot_scenes import as_clamped, joint_faults, on_a_hub, robot_scene
from tests.reference.weak_form import Claim, Violation, violation

UNIT = 1e-9
"""Largest deviation of a quaternion's length from one, beside what the estimate allows."""

ROUNDING = 1e-8
"""Violation of the weak form that is not asked about: rounding of long stiff rods, and of the check itself."""

SLACK, SLACK_STRAIN = 10.0, 1e4
"""Factors on the estimated error of the shape: for poses, and for stresses, which follow derivatives of the shape.

Of stresses no result claims an error. On fixed discretisations as coarse as nine modes on seven nodes theirs was up to
8 300 times that of the shape, while the poses were within their estimates. The tip's own estimate is no measure here:
the tip is superconvergent, the strain between the nodes is not.
"""


@dataclass(frozen=True)
class Verdict:
    """What became of a scene.

    Attributes:
        outcome: the word of the result file, or "refused".
        seconds: how long it took.
        weak: violation of the weak form where it converged, else zero.
        gap: distance of the tip to the one integrated from the claimed strain, over length; else zero.
        faults: what is wrong, in words; empty for a true outcome.
    """

    outcome: str
    seconds: float
    weak: float = 0.0
    gap: float = 0.0
    faults: tuple[str, ...] = ()


def robot_verdict(seed: int) -> Verdict:
    """What becomes of a drawn robot: judged as the clamped rod that it is in equilibrium, and its joint beside it.

    The joint of every third stands between the world and a body without mass, to which the base is fixed.
    """
    tables = robot_scene(seed)
    return verdict(tables, on_a_hub(tables) if seed % 3 == 0 and "joints" in tables else tables)


def verdict(tables: dict[str, Any], variant: dict[str, Any] | None = None) -> Verdict:
    """Solve a scene, or a variant with the same equilibria, and judge the answer.

    What the package raises, but for a refusal, is a fault.
    """
    start = time.perf_counter()
    try:
        solution = solve(scene_from_dict(variant or tables))
        written = solution.to_dict()
    except SceneError:
        return Verdict("refused", time.perf_counter() - start)
    except Exception as error:
        said = f"{type(error).__name__}: {error}"
        return Verdict("raised", time.perf_counter() - start, faults=(said,))
    seconds = time.perf_counter() - start
    if not solution.converged:
        said = () if solution.message and written["converged"] is False else ("a failure without a sentence",)
        return Verdict(solution.outcome.label, seconds, faults=said)
    return _judged(tables, solution, written, seconds)


def _judged(tables: dict[str, Any], solution: Solution, written: Any, seconds: float) -> Verdict:
    found, length = evaluate(tables, solution), tables["rods"][0]["length"]
    gap = distance_between(found.position, solution.tip().position) / length
    shape = _estimate(solution)
    faults = []
    if not _finite(written):
        faults.append("a number is not finite")
    lengths = np.linalg.norm(solution.model.fields["rod"](solution.x, solution.inputs)[1].full(), axis=0)
    checks = {
        "quaternions off unit length": (np.abs(lengths - 1).max(), SLACK * shape + UNIT),
        "gap at the tip": (gap, SLACK * shape + ROUNDING),
        "weak form": (found.weak, SLACK_STRAIN * shape + ROUNDING),
        "wrench left at the tip": (found.tip, SLACK_STRAIN * shape + ROUNDING),
    }
    faults += [f"{name}: {value:.2g} > {bound:.2g}" for name, (value, bound) in checks.items() if not value <= bound]
    faults += joint_faults(tables, solution, SLACK_STRAIN * shape + ROUNDING)
    return Verdict("converged", seconds, found.weak, gap, tuple(faults))


def evaluate(tables: dict[str, Any], solution: Solution) -> Violation:
    """The weak form on what a solution claims."""
    discretisation = solution.model.discretisation["rod"]
    clamped, force, moment = as_clamped(tables, solution)
    claim = Claim(solution.strain, force, moment, discretisation.breaks, discretisation.modes)
    held = next((support["kind"] for support in tables.get("supports", [])), None)
    bending = solution.model.discrete.rods["rod"].properties.bending_stiffness
    return violation(clamped, claim, bending, held)


def _estimate(solution: Solution) -> float:
    """Estimated error of the shape; infinite where there is none."""
    estimates = (solution.error_estimate, solution.shape_error_estimate)
    known = [estimate for estimate in estimates if estimate is not None]
    return max(known) if known else np.inf


def _finite(written: Any) -> bool:
    """Whether every number of a result file is finite."""
    if isinstance(written, dict):
        return all(map(_finite, written.values()))
    if isinstance(written, list | tuple):
        return all(map(_finite, written))
    return not isinstance(written, float) or bool(np.isfinite(written))
