"""Arrows of the loads of a solution: every load draws itself, on the sections and bodies that it acts on."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.equilibrium.solution import Solution, SolvedPoses
from cosserat_casadi.loads.arrow import Arrow
from cosserat_casadi.loads.load import Poses
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.arrow_records import LoadArrows


def scene_arrows(solution: Solution) -> list[Arrow]:
    """Arrows of all loads of a solution, in world axes."""

    def rod_poses(name: str, X: FloatArray) -> Poses:
        return _columns(solution.pose(X, name))

    def body_pose(name: str) -> Poses:
        return _columns(solution.body(name))

    arrows = LoadArrows(solution.model.discrete, ca.DM(solution.inputs), rod_poses, body_pose)
    return arrows.all()


def _columns(pose: SolvedPoses) -> Poses:
    # Kernels take columns, (3, k); results hold a row for each section.
    return pose.position.T, pose.rotation
