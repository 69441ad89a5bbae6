"""Parameters of a scene where functions are written in C."""

from __future__ import annotations

from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.scene import Scene


def refuse_parameters(scene: Scene) -> None:
    """Refuse to write functions in C of a scene that names parameters.

    Raises:
        ExportError: with the first of them.
    """
    if scene.parameters:
        problem = f"{scene.parameters[0]!r} is a parameter, and functions in C take unknowns and inputs alone"
        remedy = "give --set parameters=[], or in Python write model.at(…), whose parameters have values"
        raise ExportError(Problem("parameters[0]", problem, remedy))
