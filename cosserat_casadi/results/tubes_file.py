"""Files of concentric tubes: an equilibrium, all equilibria, and a path, as JSON; a path as a table."""

from __future__ import annotations

from typing import Any

from cosserat_casadi.paths.tube_path import TubeEvent, TubePath
from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
from cosserat_casadi.tubes.tube_solution import TubeSolution


def tubes_result(solution: TubeSolution | TubeEquilibria) -> dict[str, Any]:
    """An equilibrium, or all equilibria at the same inputs in order of energy, as the data of a file."""
    if isinstance(solution, TubeSolution):
        entries = _equilibrium(solution)
    else:
        entries = {
            "complete": solution.complete,
            "message": solution.message,
            "equilibria": [_equilibrium(one) for one in solution.solutions],
        }
    return {"title": solution.robot.scene.title, **entries}


def tube_path_result(path: TubePath) -> dict[str, Any]:
    """A path as the data of a file."""
    points = zip(path.values, path.solutions, strict=True)
    return {
        "title": path.model.scene.title,
        "converged": path.converged,
        "outcome": path.outcome.label,
        "message": path.message,
        "error_estimate": path.error_estimate,
        "input": path.name,
        "unit": path.unit,
        "points": [{"value": value, **_point(solution)} for value, solution in points],
        "events": [_event(event) for event in path.events],
    }


def tube_path_table(path: TubePath) -> tuple[list[str], list[list[Any]]]:
    """Header and rows of the points of a path: the input, stability, energy, and the tips of all tubes."""
    names = path.robot.names if path.solutions else ()
    columns = [path.name, "stable", "energy", *(f"{name}.tip.{axis}" for name in names for axis in "xyz")]
    rows = []
    for value, solution in zip(path.values, path.solutions, strict=True):
        tips = [entry for tip in solution.tips.values() for entry in tip.position]
        rows.append([value, solution.stable, solution.energy, *tips])
    return columns, rows


def _equilibrium(solution: TubeSolution) -> dict[str, Any]:
    """Entry of one equilibrium."""
    robot = solution.robot
    shape = solution.shape
    entries = {}
    for index, (name, tip) in enumerate(solution.tips.items()):
        entries[name] = {
            "tip": {"position": tip.position, "rotation": tip.rotation, "quaternion": tip.quaternion},
            "angle": shape.angles[:, index],
            "torque": shape.torques[:, index],
        }
    return {
        "converged": solution.converged,
        "outcome": solution.outcome.label,
        "message": solution.message,
        "residual_norm": solution.residual_norm,
        "error_estimate": solution.error_estimate,
        "stable": solution.stable,
        "falling_directions": solution.stability.falling,
        "neutral": solution.stability.neutral,
        "determinant": solution.stability.determinant,
        "energy": solution.energy,
        "steps": solution.model.steps,
        "inputs": dict(zip(robot.columns, solution.inputs.tolist(), strict=True)),
        "tip_angles": solution.angles,
        "centre_line": {"distance": shape.distance, "position": shape.position, "quaternion": shape.quaternion},
        "tubes": entries,
    }


def _point(solution: TubeSolution) -> dict[str, Any]:
    """Entry of a point of a path."""
    return {
        "stable": solution.stable,
        "energy": solution.energy,
        "tip_angles": solution.angles,
        "tips": {name: tip.position for name, tip in solution.tips.items()},
    }


def _event(event: TubeEvent) -> dict[str, Any]:
    """Entry of an event of a path."""
    snaps_to = None if event.snaps_to is None else _point(event.snaps_to)
    return {
        "kind": event.kind,
        "value": event.value,
        "before": event.position,
        **_point(event.solution),
        "snaps_to": snaps_to,
        "released_energy": event.released_energy,
    }
