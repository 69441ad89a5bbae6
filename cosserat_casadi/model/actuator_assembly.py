"""Actuators of a scene in the equations of its rods, and whether their forces are gradients."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.discrete_scene import DiscreteScene
from cosserat_casadi.model.inputs import load_values
from cosserat_casadi.model.load_inputs import input_value, input_values
from cosserat_casadi.model.registry import EFFECTS
from cosserat_casadi.rod.actuation import Actuation
from cosserat_casadi.rod.kinematics import shape


def actuators_have_potential(discrete: DiscreteScene, inputs: FloatArray) -> bool:
    """Whether the forces of all actuators of a scene are gradients at these inputs."""
    values = load_values(discrete.scene, discrete.layout, inputs)
    for actuator in discrete.scene.actuators:
        member = EFFECTS[actuator.kind]
        # Inputs that are zero leave no entry: a direction of friction that is zero rubs nowhere.
        numbers = {name: ca.sparsify(ca.DM(value)) for name, value in values[actuator.name].items()}
        without_effort = not member.prescribes_conjugate(actuator) and not numbers[member.effort].nnz()
        rod = discrete.rods[actuator.rod]
        quantity = member.worked_on(actuator, rod.grid, numbers)
        unloaded = shape(rod, ca.DM.zeros(rod.size))
        if not without_effort and not quantity.on(unloaded).conservative:
            return False
    return True


def rod_actuation(discrete: DiscreteScene, rod: str, inputs: Matrix) -> list[Actuation]:
    """Efforts on one rod that the scene or its inputs give."""
    actuation = []
    for actuator in discrete.scene.actuators:
        member = EFFECTS[actuator.kind]
        # The effort of an actuator of given length is an unknown, not an input.
        if not member.acts_on(actuator, rod) or member.prescribes_conjugate(actuator):
            continue
        effort = input_value(discrete.layout, actuator, member.effort, inputs)
        if effort is not None:
            values = input_values(discrete.layout, actuator, inputs)
            quantity = member.worked_on(actuator, discrete.rods[rod].grid, values)
            actuation.append(Actuation(quantity, member.energy_sign * effort))
    return actuation
