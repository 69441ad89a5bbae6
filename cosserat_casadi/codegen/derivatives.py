"""Functions of a model with derivatives to second order, named as ``casadi.external`` looks for them."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.codegen.kernels import body_pose, kernel, tip
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.model.build import Model


def external_functions(model: Model, names: Names) -> dict[str, ca.Function]:
    """Functions that a loaded library offers, by symbol: residual, tips and shapes, actuators and bodies."""
    functions = {names.differentiable("residual"): model.residual}
    for rod in names.rods:
        functions[names.differentiable("tip", rod)] = tip(model, rod)
        functions[names.differentiable("shape", rod)] = model.shape[rod]
    for actuator in names.actuators:
        functions[names.differentiable("actuator", actuator)] = model.actuator[actuator]
    for body in names.bodies:
        functions[names.differentiable("body", body)] = body_pose(model, body)
    return functions


def differentiable(model: Model, names: Names) -> list[ca.Function]:
    """Each function with its forward and reverse derivatives, and the forward derivative of the latter."""
    functions = []
    for symbol, function in external_functions(model, names).items():
        plain = kernel(model, function, symbol)
        reverse = plain.reverse(1)
        functions += [plain, plain.forward(1), reverse, reverse.forward(1)]
    return functions
