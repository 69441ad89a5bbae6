"""How far a state is from its targets: symbolically for an optimiser, in metres and radians for a person."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.control.targets import TARGET_KINDS, TargetMiss, length_of
from cosserat_casadi.equilibrium.solution import Equilibrium
from cosserat_casadi.maths.pose import POSE_SIZE
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.system_functions import SystemFunctions


def wanted_poses(targets: Sequence[scenes.Target]) -> FloatArray:
    """Positions and quaternions that targets ask for, 7 numbers for each; zeros for what a target leaves free."""
    return np.concatenate([TARGET_KINDS[target.kind].wanted(target) for target in targets])


def weighted_errors(
    model: SystemFunctions,
    targets: Sequence[scenes.Target],
    wanted: Matrix,
    x: Matrix,
    inputs: Matrix,
) -> Matrix:
    """Weighted errors of targets, without unit; half their sum of squares is what an optimiser lessens.

    Positions count relative to the rod's length. Orientations by the chord 2 sin(θ/2) of the angle θ between them,
    which is smooth at every angle. The points of a curve count together as much as one point.

    Args:
        model: the model.
        targets: the targets; their positions and orientations are not read, but for the points of curves.
        wanted: these, as in :func:`wanted_poses`.
        x: unknowns.
        inputs: stacked inputs.
    """
    errors = []
    for i, target in enumerate(targets):
        pose = wanted[POSE_SIZE * i : POSE_SIZE * (i + 1)]
        error = TARGET_KINDS[target.kind].error(target, model, pose, x, inputs)
        errors.append(np.sqrt(target.weight) * error)
    stacked: Matrix = ca.vertcat(*errors)
    return stacked


def target_errors(solution: Equilibrium[Any], targets: Sequence[scenes.Target]) -> tuple[TargetMiss, ...]:
    """How far a solution is from each of the targets, and how far the model itself may be off there."""
    gaps = []
    for target in targets:
        mechanics = TARGET_KINDS[target.kind]
        gap = mechanics.gap(target, solution)
        error = mechanics.model_error(target, solution)
        if error is not None:
            angle_error = None if gap.angle is None else error
            gap = replace(gap, position_error=error * length_of(solution.model, target), angle_error=angle_error)
        gaps.append(gap)
    return tuple(gaps)
