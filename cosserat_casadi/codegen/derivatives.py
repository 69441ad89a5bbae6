"""Functions of a model with derivatives to second order, named as ``casadi.external`` looks for them."""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.codegen.functions_in_c import differentiable_functions
from cosserat_casadi.codegen.kernels import kernel
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.model.build import Model


def differentiable(model: Model, names: Names) -> list[ca.Function]:
    """Each function with its forward and reverse derivatives, and the forward derivative of the latter."""
    functions = []
    for entry in differentiable_functions(model, names):
        plain = kernel(model, entry.function, entry.external)
        reverse = plain.reverse(1)
        functions += [plain, plain.forward(1), reverse, reverse.forward(1)]
    return functions
