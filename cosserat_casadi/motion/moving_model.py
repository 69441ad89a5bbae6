"""Models of motions, whose functions are shared by models of equal rods, whatever their inputs and duration.

To write the functions of a small model takes longer than to step it through a second. The latest models are kept, so
that a later motion of equal rods, or the next part of a long one, writes none.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.function_table import share_functions
from cosserat_casadi.rod.discretisation import Discretisation
from cosserat_casadi.scene import Scene

MOST_KEPT = 24
"""Number of models that are kept, enough for a few searches for modes, in motion and at rest."""


def moving_model(scene: Scene, discretisation: Mapping[str, Discretisation]) -> Model:
    """Return the model of a scene for a motion.

    Args:
        scene: the scene, with the inputs of its motions free.
        discretisation: discretisation of every rod.
    """
    return _sharing(scene, discretisation, moving=True)


def model_at_rest(model: Model) -> Model:
    """Return the model of statics on the discretisation of a model for a motion: free bases are clamped."""
    if model.discrete.scaling is not None:
        return model.changed(lambda scene: scene.held())
    return _sharing(model.scene.held().baked(), model.discretisation, moving=False)


def _sharing(scene: Scene, discretisation: Mapping[str, Discretisation], *, moving: bool) -> Model:
    """Return a model without parameters that shares constants and functions with models of equal rods."""
    kept = _kept(scene.of_equations(), tuple(discretisation.items()), moving)
    model = Model(kept.discrete.told_as(scene))
    share_functions(model, kept)
    return model


@lru_cache(maxsize=MOST_KEPT)
def _kept(scene: Scene, discretisation: tuple[tuple[str, Discretisation], ...], moving: bool) -> Model:
    """Return a model by all data on which its functions depend."""
    return build(scene, dict(discretisation), moving=moving)
