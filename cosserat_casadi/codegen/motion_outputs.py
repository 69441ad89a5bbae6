"""What a scene in motion shows to the outside: poses, velocities, efforts, as one vector with exact derivatives.

Simulators that couple models, and environments for learning, see these quantities and not the unknowns of the rods.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import casadi as ca

from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model

POSITION = ("x", "y", "z")
QUATERNION = ("w", "x", "y", "z")

STATE_ARGUMENTS = ("x", "v", "inputs", "inputs_rate")
"""Arguments of the outputs: the state of the motion, the inputs and their rates."""


@dataclass(frozen=True)
class MotionOutput:
    """One number that is seen of a motion.

    Attributes:
        name: dotted, such as ``arm.tip.position.x``.
        unit: SI unit, "1" where there is none.
        description: one sentence.
    """

    name: str
    unit: str
    description: str


@dataclass(frozen=True)
class MotionOutputs:
    """The outputs of a model in motion.

    Attributes:
        entries: what each entry of the vector is.
        function: (x, v, inputs, inputs_rate) ↦ outputs, shape (k,).
        jacobian: the same arguments ↦ derivatives with (x, v) side by side, k×2n, with inputs and with inputs_rate.
    """

    entries: tuple[MotionOutput, ...]
    function: ca.Function
    jacobian: ca.Function


def motion_outputs(model: Model) -> MotionOutputs:
    """Poses and velocities of tips and bodies, then efforts of actuators and what they do work on.

    Args:
        model: a model that was built with its motion.
    """
    size = model.size
    count = model.inputs.size
    sizes = (size, size, count, count)
    x, v, inputs, inputs_rate = (ca.MX.sym(name, n) for name, n in zip(STATE_ARGUMENTS, sizes, strict=True))
    entries: list[MotionOutput] = []
    values: list[Matrix] = []
    for name, pose in _poses(model):
        position, quaternion = pose(x, inputs)[:2]
        velocity = ca.jtimes(position, x, v) + ca.jtimes(position, inputs, inputs_rate)
        entries += [MotionOutput(f"{name}.position.{axis}", "m", f"Position of {name}.") for axis in POSITION]
        entries += [MotionOutput(f"{name}.quaternion.{part}", "1", f"Orientation of {name}.") for part in QUATERNION]
        entries += [MotionOutput(f"{name}.velocity.{axis}", "m/s", f"Velocity of {name}.") for axis in POSITION]
        values += [position, quaternion, velocity]
    for name, actuator in model.actuator.items():
        outputs = type(model).actuator.spec.outputs_of(model.discrete, name)[:2]
        for output, value in zip(outputs, actuator(x, inputs)[:2], strict=True):
            full_name = f"{name}.{output.name}"
            # What is given is no result: the tension of a tendon that is pulled by one.
            if full_name not in model.inputs.names:
                entries.append(MotionOutput(full_name, output.unit, f"{output.name.capitalize()} of {name}."))
                values.append(value)
    stacked = ca.densify(ca.vertcat(*values))
    arguments = [x, v, inputs, inputs_rate]
    return MotionOutputs(
        entries=tuple(entries),
        function=ca.Function("motion_outputs", arguments, [stacked], [*STATE_ARGUMENTS], ["outputs"]),
        jacobian=_jacobian(stacked, arguments),
    )


def _poses(model: Model) -> Iterator[tuple[str, ca.Function]]:
    """What has a pose, by the name of its outputs."""
    for rod, tip in model.tip.items():
        yield f"{rod}.tip", tip
    yield from model.body.items()


def _jacobian(stacked: Matrix, arguments: list[ca.MX]) -> ca.Function:
    """Derivatives with (x, v), with inputs and with their rates."""
    x, v, inputs, inputs_rate = arguments
    by_state = ca.horzcat(ca.jacobian(stacked, x), ca.jacobian(stacked, v))
    results = [by_state, ca.jacobian(stacked, inputs), ca.jacobian(stacked, inputs_rate)]
    names = ["d_outputs_d_state", "d_outputs_d_inputs", "d_outputs_d_inputs_rate"]
    dense = [ca.densify(result) for result in results]
    return ca.Function("motion_outputs_jacobian", arguments, dense, [*STATE_ARGUMENTS], names)
