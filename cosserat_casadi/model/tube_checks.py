"""Scenes of concentric tubes have no rods: what works on rods refuses them."""

from __future__ import annotations

from cosserat_casadi import scene as scenes
from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.model.system_functions import OfScene


def refuse_tubes(subject: scenes.Scene | OfScene) -> None:
    """Refuse concentric tubes, as a scene or as a model, where rods are asked for.

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
