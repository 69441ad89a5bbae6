"""Scenes of concentric tubes have no rods: what works on rods refuses them."""

from __future__ import annotations

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError


def refuse_tubes(scene: scenes.Scene) -> None:
    """Refuse a scene of concentric tubes where rods are asked for.

    Raises:
        SceneError: the scene has tubes.
    """
    if scene.tubes:
        problem = "this works on rods, and the scene has concentric tubes"
        remedy = "solve, path, sweep, export and check take them"
        raise SceneError(Problem("tubes", problem, remedy))
