"""Values of loads and actuators among the stacked inputs."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi import scene as scenes
from cosserat_casadi.loads.expressions import expressions_in
from cosserat_casadi.loads.load import constant
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.inputs import InputLayout, scene_value


def input_values(layout: InputLayout, record: scenes.LoadRecord | scenes.Actuator, inputs: Matrix) -> dict[str, Matrix]:
    """Inputs of a load or an actuator, and its numbers that are expressions of parameters.

    An input that is always zero is a matrix that stores nothing.
    """
    values = expressions_in(record)
    for field in record.inputs:
        value = input_value(layout, record, field, inputs)
        if value is None:
            value = ca.DM(*scene_value(record, field).shape)
        values[field] = value
    return values


def input_value(
    layout: InputLayout, record: scenes.LoadRecord | scenes.Actuator, field: str, inputs: Matrix
) -> Matrix | None:
    """One input of a load or an actuator; None where it is zero for good."""
    entries = layout.of_load(record.name, field)
    default = scene_value(record, field)
    if entries is None:
        return constant(default)
    return ca.reshape(inputs[entries], *default.shape)
