"""Cost of a model, and the cost of each of its loads, in scalar operations."""

from __future__ import annotations

from dataclasses import dataclass

from cosserat_casadi import scene as scenes
from cosserat_casadi.model.build import Model, build
from cosserat_casadi.model.operations import Count, count, counts
from cosserat_casadi.numerics.progress import StageProgress
from cosserat_casadi.scene.records import HashedTable


@dataclass(frozen=True)
class Price:
    """Scalar operations of a model's functions."""

    residual: Count
    jacobian: Count
    igm: Count


def price(model: Model) -> Price:
    """Operations of a model's functions."""
    return Price(
        residual=count(model.residual),
        jacobian=count(model.jacobian),
        igm=_sum(counts(list(model.igm.values()))),
    )


def _sum(of_rods: list[Count]) -> Count:
    number = sum(of_rod.number for of_rod in of_rods)
    exact = all(of_rod.exact for of_rod in of_rods)
    return Count(number, exact)


def prices_of_effects(scene: scenes.Scene, progress: StageProgress | None = None) -> dict[str, Count]:
    """Operations that each load, actuator, obstacle with a width and contact of rods adds to the residual, by name.

    The price is the cost of the residual with the effect less the cost without it. Without contact the elements that it
    asks for are missing too. All pairs of sections count, as if they were near.

    Args:
        scene: the scene with all effects.
        progress: is called with the effect left out, the number left out so far, and the number of effects.
    """
    scene = scene.baked()
    without = {cause.name: without_load(scene, cause.name) for cause in scene.causes}
    for obstacle in scene.obstacles:
        if obstacle.is_smooth:
            others = tuple(other for other in scene.obstacles if other is not obstacle)
            without[obstacle.name] = scene.model_copy(update={"obstacles": others})
    for contact in scene.rod_contacts:
        left = tuple(other for other in scene.rod_contacts if other is not contact)
        without[contact.label] = scene.model_copy(update={"rod_contacts": left})
    residuals = [build(scene).residual]
    for done, (name, bare) in enumerate(without.items()):
        if progress is not None:
            progress(f"Counting the operations of {name}", done, len(without))
        residuals.append(build(bare).residual)
    whole, *others = counts(residuals)
    return {name: whole - other for name, other in zip(without, others, strict=True)}


def is_damped(scene: scenes.Scene) -> bool:
    """Whether a rod of the scene is damped, or contact or a joint dissipates energy."""
    of_rods = any(rod.damping is not None for rod in scene.rods)
    of_pairs = any(contact.friction for contact in scene.rod_contacts)
    of_joints = any(getattr(joint, key, 0.0) > 0.0 for joint in scene.joints for key in ("damping", "friction"))
    of_obstacles = any(obstacle.damping > 0.0 or obstacle.rubs for obstacle in scene.obstacles)
    return of_rods or of_pairs or of_joints or of_obstacles


def without_damping(scene: scenes.Scene) -> scenes.Scene:
    """The scene without damping and friction, and without parameters for these."""
    rods = tuple(rod.model_copy(update={"damping": None}) for rod in scene.rods)
    obstacles = tuple(obstacle.model_copy(update={"damping": 0.0, "friction": 0.0}) for obstacle in scene.obstacles)
    contacts = tuple(contact.model_copy(update={"friction": 0.0}) for contact in scene.rod_contacts)
    # A joint keeps its coordinate, and must not get one by a key that the scene does not have.
    joints = tuple(
        joint.model_copy(update=dict.fromkeys(joint.model_fields_set & {"damping", "friction"}, 0.0))
        for joint in scene.joints
    )
    # A parameter is named OWNER.FIELD or OWNER.FIELD.NUMBER: the second part tells what it is.
    named = zip(scene.parameters, scene.parameter_names(), strict=True)
    parameters = tuple(entry for entry, name in named if name.split(".")[1] not in ("damping", "friction"))
    return scene.model_copy(
        update={
            "rods": rods,
            "obstacles": obstacles,
            "rod_contacts": contacts,
            "joints": joints,
            "parameters": parameters,
        }
    )


def without_load(scene: scenes.Scene, name: str) -> scenes.Scene:
    """The scene without one of its loads or actuators, and without the inputs, ranges and parameters of this one."""

    def is_other(field: str) -> bool:
        """Whether a name such as ``push.force`` belongs to another part of the scene."""
        return field.split(".")[0] != name

    named = zip(scene.parameters, scene.parameter_names(), strict=True)
    return scene.model_copy(
        update={
            "loads": tuple(load for load in scene.loads if load.name != name),
            "actuators": tuple(actuator for actuator in scene.actuators if actuator.name != name),
            "inputs": tuple(entry.name for entry in scene.free_inputs() if is_other(entry.name)),
            "parameters": tuple(entry for entry, parameter in named if is_other(parameter)),
            "ranges": HashedTable({field: pairs for field, pairs in scene.ranges.items() if is_other(field)}),
            "bounds": tuple(bound for bound in scene.bounds if is_other(bound.input)),
            "motions": tuple(motion for motion in scene.motions if is_other(motion.input)),
        }
    )
