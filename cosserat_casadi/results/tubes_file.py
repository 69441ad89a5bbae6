"""Files of concentric tubes: an equilibrium, all equilibria, and a path, as JSON; a path as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cosserat_casadi.files import write_atomically
from cosserat_casadi.paths.tube_path import TubeEvent, TubePath
from cosserat_casadi.results.json_text import SCHEMA, plain
from cosserat_casadi.tubes.tube_equilibria import TubeEquilibria
from cosserat_casadi.tubes.tube_solution import TubeSolution


def tubes_result(solution: TubeSolution | TubeEquilibria) -> dict[str, Any]:
    """An equilibrium, or all at the same inputs by their energy, as the plain data of a file.

    A number that is not finite becomes null.
    """
    if isinstance(solution, TubeSolution):
        entries = _equilibrium(solution)
    else:
        entries = {
            "complete": solution.complete,
            "message": solution.message,
            "equilibria": [_equilibrium(one) for one in solution.solutions],
        }
    data: dict[str, Any] = plain({"schema": SCHEMA, "title": solution.robot.scene.title, **entries})
    return data


def tube_path_result(path: TubePath) -> dict[str, Any]:
    """A path as the plain data of a file."""
    data: dict[str, Any] = plain(
        {
            "schema": SCHEMA,
            "title": path.model.scene.title,
            "converged": path.converged,
            "outcome": path.outcome.label,
            "message": path.message,
            "error_estimate": path.error_estimate,
            "input": path.name,
            "unit": path.unit,
            "points": [
                {"value": value, **_point(solution)}
                for value, solution in zip(path.values, path.solutions, strict=True)
            ],
            "events": [_event(event) for event in path.events],
        }
    )
    return data


def tube_path_table(path: TubePath) -> str:
    """The points of a path as CSV: the input, stability, energy, and the tips of all tubes."""
    names: tuple[str, ...] = ()
    if path.solutions:
        names = path.solutions[0].robot.names
    columns = [path.name, "stable", "energy"]
    columns += [f"{name}.tip.{axis}" for name in names for axis in "xyz"]
    lines = [",".join(columns)]
    for value, solution in zip(path.values, path.solutions, strict=True):
        cells = [repr(float(value)), _word(solution.stable), repr(solution.energy)]
        cells += [repr(float(entry)) for tip in solution.tips.values() for entry in tip.position]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def write_tube_path_table(path: TubePath, file: Path) -> None:
    """Write the points of a path as CSV, whole or not at all."""
    write_atomically(file, tube_path_table(path).encode())


def _word(stable: bool | None) -> str:
    """A verdict in a table; empty where there is none."""
    if stable is None:
        return ""
    return str(stable).lower()


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
    snaps_to = None
    if event.snaps_to is not None:
        snaps_to = _point(event.snaps_to)
    return {
        "kind": event.kind,
        "value": event.value,
        "before": event.position,
        **_point(event.solution),
        "snaps_to": snaps_to,
        "released_energy": event.released_energy,
    }
