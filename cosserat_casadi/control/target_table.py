"""Tables of targets from CSV files, with a row for each wanted pose of one section or body."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.number_table import read_numbers
from cosserat_casadi.scene.values import NORM_SLACK

POSITION = ("x", "y", "z")
"""Columns of a position, world axes, m."""

QUATERNION = ("qw", "qx", "qy", "qz")
"""Columns of an orientation."""


@dataclass(frozen=True)
class TargetTable:
    """Consecutive targets of one section or body.

    Attributes:
        columns: names of the columns of the file.
        values: numbers of the file, shape (rows, columns).
        lines: line of each row in the file.
        rows: the target of the scene at each row's pose.
    """

    columns: tuple[str, ...]
    values: FloatArray
    lines: tuple[int, ...]
    rows: tuple[tuple[scenes.Target], ...]


def read_targets(path: Path, scene: scenes.Scene) -> TargetTable:
    """Read the targets of a CSV file with the columns x, y, z and, for poses, qw, qx, qy, qz.

    Args:
        path: the file.
        scene: scene with a single target, for the same section or body; it gives the orientation if no columns do.

    Raises:
        SceneError: the file has faults, which the error lists; or the scene has not one target, or one of a curve.
    """
    target = _only_target(scene)
    header, values, lines, problems = read_numbers(path)
    refuse(_column_problems(str(path), header, target) + problems)
    columns = {name: values[:, index] for index, name in enumerate(header)}
    positions = np.stack([columns[name] for name in POSITION], axis=1)
    changes = [{"position": tuple(position)} for position in positions.tolist()]
    if QUATERNION[0] in columns:
        quaternions = np.stack([columns[name] for name in QUATERNION], axis=1)
        norms = np.linalg.norm(quaternions, axis=1)
        refuse(
            [
                Problem(f"{path}, line {line}", f"the quaternion must have norm 1, got norm {norm:.9g}")
                for norm, line in zip(norms, lines, strict=True)
                if abs(norm - 1.0) > NORM_SLACK
            ]
        )
        for change, quaternion in zip(changes, (quaternions / norms[:, None]).tolist(), strict=True):
            change["quaternion"] = tuple(quaternion)
    rows = [(target.model_copy(update=change),) for change in changes]
    return TargetTable(tuple(header), values, tuple(lines), tuple(rows))


def _only_target(scene: scenes.Scene) -> scenes.Target:
    remedy = "a table says where one section or body is to be: give one target of kind pose or position"
    if len(scene.targets) != 1:
        raise SceneError(Problem("targets", f"holds {len(scene.targets)} targets beside --table", remedy))
    (target,) = scene.targets
    if "position" not in type(target).model_fields:
        raise SceneError(Problem("targets[0]", f"is of kind {target.kind} beside --table", remedy))
    return target


def _column_problems(where: str, header: list[str], target: scenes.Target) -> list[Problem]:
    """Problems of columns that are missing, unknown, or useless for the target."""
    known = (*POSITION, *QUATERNION)
    needed = list(POSITION)
    oriented = [name for name in QUATERNION if name in header]
    if oriented:
        needed += QUATERNION
    remedy = f"the columns are {', '.join(POSITION)} and, of a pose, {', '.join(QUATERNION)}"
    problems = [Problem(where, f"has no column {name}", remedy) for name in needed if name not in header]
    problems += [Problem(where, f"has an unknown column {name}", remedy) for name in header if name not in known]
    if oriented and "quaternion" not in type(target).model_fields:
        kind = 'give the target of the scene kind = "pose"'
        problems.append(Problem(where, "has orientations, but the target leaves orientations free", kind))
    return problems
