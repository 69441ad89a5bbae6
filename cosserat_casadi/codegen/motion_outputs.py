"""Outputs of a scene in motion: poses, velocities, efforts, as one vector with exact derivatives.

Co-simulation and learning environments use these quantities in place of the unknowns of the rods.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import PARAMETERS

POSITION = ("x", "y", "z")
QUATERNION = ("w", "x", "y", "z")


@dataclass(frozen=True)
class MotionOutput:
    """One scalar output of a motion.

    Attributes:
        name: dotted name, such as ``arm.tip.position.x``.
        unit: SI unit, "1" if dimensionless.
        description: one sentence.
    """

    name: str
    unit: str
    description: str


@dataclass(frozen=True)
class MotionOutputs:
    """The outputs of a model in motion.

    Attributes:
        entries: description of each entry of the vector.
        function: (x, v, inputs, inputs_rate) ↦ outputs, shape (k,); for a scene with parameters (x, v, inputs, p,
            inputs_rate) ↦ outputs.
        jacobian: these arguments ↦ derivatives by (x, v) side by side, k×2n, by inputs, by p if there are parameters,
            and by inputs_rate.
    """

    entries: tuple[MotionOutput, ...]
    function: ca.Function
    jacobian: ca.Function


def motion_outputs(model: Model) -> MotionOutputs:
    """Make the outputs: poses and velocities of tips and bodies, then efforts and conjugates of actuators and joints.

    Args:
        model: a model that was built with its motion.
    """
    x, v = ca.MX.sym("x", model.size), ca.MX.sym("v", model.size)
    inputs, inputs_rate = ca.MX.sym("inputs", model.inputs.size), ca.MX.sym("inputs_rate", model.inputs.size)
    p = [ca.MX.sym(PARAMETERS, model.parameters.size)] if model.parameters.size else []
    entries: list[MotionOutput] = []
    values: list[Matrix] = []
    poses = {f"{rod}.tip": tip for rod, tip in model.tip.items()}
    for name, pose in [*poses.items(), *model.body.items()]:
        position, quaternion = pose(x, inputs, *p)[:2]
        velocity = ca.jtimes(position, x, v) + ca.jtimes(position, inputs, inputs_rate)
        entries += [MotionOutput(f"{name}.position.{axis}", "m", f"Position of {name}.") for axis in POSITION]
        entries += [MotionOutput(f"{name}.quaternion.{part}", "1", f"Orientation of {name}.") for part in QUATERNION]
        entries += [MotionOutput(f"{name}.velocity.{axis}", "m/s", f"Velocity of {name}.") for axis in POSITION]
        values += [position, quaternion, velocity]
    owned = [(type(model).actuator.spec, *item) for item in model.actuator.items()]
    owned += [(type(model).joint.spec, *item) for item in model.joint.items()]
    for spec, name, function in owned:
        outputs = spec.outputs_of(model.discrete, name)[:2]
        for output, value in zip(outputs, function(x, inputs, *p)[:2], strict=True):
            full_name = f"{name}.{output.name}"
            # An input is no result: the tension of a tendon that is pulled by one.
            if full_name not in model.inputs.names:
                entries.append(MotionOutput(full_name, output.unit, f"{output.name.capitalize()} of {name}."))
                values.append(value)
    stacked = ca.densify(ca.vertcat(*values))
    arguments = [x, v, inputs, *p, inputs_rate]
    names = ["x", "v", "inputs", *([PARAMETERS] if p else []), "inputs_rate"]
    return MotionOutputs(
        entries=tuple(entries),
        function=ca.Function("motion_outputs", arguments, [stacked], names, ["outputs"]),
        jacobian=_jacobian(stacked, arguments, names),
    )


def _jacobian(stacked: Matrix, arguments: list[ca.MX], names: list[str]) -> ca.Function:
    """Make the derivatives by (x, v), and by each of the other arguments."""
    x, v, *others = arguments
    by_state = ca.horzcat(ca.jacobian(stacked, x), ca.jacobian(stacked, v))
    results = [by_state, *(ca.jacobian(stacked, other) for other in others)]
    dense = [ca.densify(result) for result in results]
    derivatives = [f"d_outputs_d_{word}" for word in ("state", *names[2:])]
    return ca.Function("motion_outputs_jacobian", arguments, dense, names, derivatives)
