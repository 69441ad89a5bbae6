"""The result file: a solution as JSON."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.equilibrium.solution import Solution
from cosserat_casadi.files import write_atomically
from cosserat_casadi.maths.typing import FloatArray

SAMPLES = 41
"""Abscissae, evenly spaced, at which a result lists a rod's fields; element ends come on top."""


def result(solution: Solution) -> dict[str, Any]:
    """A solution as the plain data of the result file; a number that is not finite becomes null."""
    model = solution.model
    data = {
        "schema": 1,
        "title": model.scene.title,
        "converged": solution.converged,
        "outcome": solution.outcome.label,
        "message": solution.message,
        "residual_norm": solution.residual_norm,
        "error_estimate": solution.error_estimate,
        "shape_error_estimate": solution.shape_error_estimate,
        "stable": solution.stable,
        "smallest_eigenvalue": solution.smallest_eigenvalue,
        "iterations": solution.iterations,
        "load_factor": solution.load_factor,
        "inputs": {name: value.T.squeeze() for name, value in model.inputs.unpack(solution.inputs).items()},
        "discretisation": {
            name: {
                "modes": list(d.modes),
                "nodes": d.nodes,
                "breaks": list(d.breaks),
                "transport": d.transport,
            }
            for name, d in model.discretisation.items()
        },
        "rods": {name: _rod(solution, name) for name in model.discrete.rods},
    }
    if model.scene.bodies:
        data["bodies"] = {body.name: _body(solution, body.name) for body in model.scene.bodies}
    if model.scene.actuators:
        data["actuators"] = {one.name: solution.actuator(one.name) for one in model.scene.actuators}
    found: dict[str, Any] = plain(data)
    return found


def result_text(solution: Solution) -> str:
    """The result file as text."""
    return json.dumps(result(solution), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def write_result(solution: Solution, path: str | Path) -> None:
    """Write the result file, whole or not at all."""
    write_atomically(Path(path), result_text(solution).encode())


def _rod(solution: Solution, name: str) -> dict[str, Any]:
    X = _abscissae(solution.model.discretisation[name].breaks)
    pose, tip, base = solution.pose(X, name), solution.tip(name), solution.base_wrench(name)
    return {
        "X": X,
        "position": pose.position,
        "quaternion": pose.quaternion,
        "strain": solution.strain(X, name),
        "internal_wrench": solution.internal_wrench(X, name),
        "tip": {"position": tip.position[0], "rotation": tip.rotation[0], "quaternion": tip.quaternion[0]},
        "base_wrench": {"force": base.force, "moment": base.moment},
    }


def _body(solution: Solution, name: str) -> dict[str, Any]:
    pose = solution.body(name)
    return {"position": pose.position[0], "rotation": pose.rotation[0], "quaternion": pose.quaternion[0]}


def _abscissae(breaks: tuple[float, ...]) -> FloatArray:
    return np.unique(np.concatenate([np.linspace(0.0, 1.0, SAMPLES), breaks]))


def plain(value: Any) -> Any:
    """Arrays as lists, numbers as Python's own, what is not finite as None."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value
