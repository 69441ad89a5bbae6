"""What a model costs, and what each load adds to it, in scalar operations."""

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


@dataclass(frozen=True)
class MotionPrice:
    """Scalar operations of the equations of motion, common terms shared.

    Attributes:
        inverse_dynamics: of the residual.
        jacobian: of the residual with its derivatives with positions, velocities and accelerations.
    """

    inverse_dynamics: int
    jacobian: int


def price_of_motion(model: Model) -> MotionPrice:
    """Operations of a model's equations of motion."""
    return MotionPrice(
        inverse_dynamics=model.operations(model.inverse_dynamics),
        jacobian=model.operations(model.dynamics_jacobian),
    )


def price_of_load(scene: scenes.Scene, load: str) -> int:
    """Operations that a load or actuator adds to the residual: the scene with it less the scene without."""
    baked = scene.baked()
    loaded = build(baked)
    bare = build(without_load(baked, load))
    return loaded.operations(loaded.residual) - bare.operations(bare.residual)


def price_of_obstacle(scene: scenes.Scene, obstacle: str) -> int:
    """Operations that an obstacle with a width adds to the residual, with the elements that it asks for."""
    baked = scene.baked()
    kept = tuple(other for other in baked.obstacles if other.name != obstacle)
    bare = build(baked.model_copy(update={"obstacles": kept}))
    met = build(baked)
    return met.operations(met.residual) - bare.operations(bare.residual)


def is_damped(scene: scenes.Scene) -> bool:
    """Whether a rod of the scene or the contact with an obstacle is damped."""
    rods = any(rod.damping is not None for rod in scene.rods)
    return rods or any(obstacle.damping > 0.0 for obstacle in scene.obstacles)


def without_damping(scene: scenes.Scene) -> scenes.Scene:
    """The scene without the damping of its rods and of contact, and without the parameters that were of it."""
    rods = tuple(rod.model_copy(update={"damping": None}) for rod in scene.rods)
    obstacles = tuple(obstacle.model_copy(update={"damping": 0.0}) for obstacle in scene.obstacles)
    # A parameter is named OWNER.FIELD, or OWNER.FIELD.NUMBER; what follows it is of the same kind.
    named = zip(scene.parameters, scene.parameter_names(), strict=True)
    parameters = tuple(entry for entry, name in named if name.split(".")[1] != "damping")
    return scene.model_copy(update={"rods": rods, "obstacles": obstacles, "parameters": parameters})


def without_load(scene: scenes.Scene, name: str) -> scenes.Scene:
    """The scene without one of its loads or actuators, and without the inputs that were its."""
    loads = tuple(load for load in scene.loads if load.name != name)
    actuators = tuple(actuator for actuator in scene.actuators if actuator.name != name)
    inputs = tuple(entry.name for entry in scene.free_inputs() if entry.owner != name)
    return scene.model_copy(update={"loads": loads, "actuators": actuators, "inputs": inputs})
