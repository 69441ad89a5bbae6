"""Refusal of scenes of concentric tubes, which have no rods, by functions for rods."""

from __future__ import annotations

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.model.system_functions import OfScene


def refuse_tubes(subject: scenes.Scene | OfScene) -> None:
    """Refuse a scene or a model of concentric tubes where rods are needed.

    Raises:
        SceneError: the scene has tubes.
    """
    scene = subject if isinstance(subject, scenes.Scene) else subject.scene
    if scene.tubes:
        problem = "this works on rods, and the scene has concentric tubes"
        remedy = (
            "solve, path, inverse, sweep, export, identify and check take them, each answer with the steps that its "
            "tolerance asks for, so that nothing is chosen over ranges; build takes them with a number of steps"
        )
        raise SceneError(Problem("tubes", problem, remedy))
