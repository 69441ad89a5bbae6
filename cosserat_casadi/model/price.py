"""What a model costs, and what each effect adds to it, in scalar operations."""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi import scene as scenes
from cosserat_casadi.model.build import Model, build


@dataclass(frozen=True)
class Price:
    """Scalar operations of a model's functions, common terms shared.

    Attributes:
        residual: of the residual.
        jacobian: of the residual and its Jacobian together.
        igm: of the Inverse Geometric Models of all rods.
    """

    residual: int
    jacobian: int
    igm: int


def price(model: Model) -> Price:
    """Operations of a model's functions."""
    return Price(
        residual=model.operations(model.residual),
        jacobian=model.operations(model.jacobian),
        igm=sum(model.operations(igm) for igm in model.igm.values()),
    )


def price_of_load(scene: scenes.Scene, load: str) -> int:
    """Operations that a load or actuator adds to the residual: the scene with it less the scene without."""
    model, without = build(scene), build(without_load(scene, load))
    return model.operations(model.residual) - without.operations(without.residual)


def without_load(scene: scenes.Scene, load: str) -> scenes.Scene:
    """The scene without one of its loads or actuators, and without the inputs that were its."""
    loads = tuple(other for other in scene.loads if other.name != load)
    actuators = tuple(other for other in scene.actuators if other.name != load)
    names = tuple(name for name in scene.input_names() if not name.startswith(f"{load}."))
    return scene.model_copy(update={"loads": loads, "actuators": actuators, "inputs": names})
