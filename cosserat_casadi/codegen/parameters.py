"""Parameters of a scene in functions in C: for the solver they are further inputs.

The solver in C has one vector of inputs with appended parameters. So a path from some parameters to others, derivatives
of a solution by parameters, and the parts of an assembly are handled as for inputs. For a scene without parameters the
functions here return those of the model.
"""

from __future__ import annotations

import casadi as ca

from cosserat_casadi.model.build import Model
from cosserat_casadi.model.function_table import PARAMETERS, FunctionSpec
from cosserat_casadi.tubes.tube_functions import TubeFunctions


def given_size(model: Model | TubeFunctions) -> int:
    """Number of entries of the solver's vector in C: inputs and parameters."""
    return model.inputs.size + model.parameters.size


def solver_function(model: Model, spec: FunctionSpec) -> ca.Function:
    """Make a function of the solver with inputs and parameters in one argument.

    Args:
        model: model of the function.
        spec: entry of the function in the table of functions.
    """
    function = spec.function_in_c(model)
    if not model.parameters.size:
        return function
    return with_parameters_behind_inputs(function)


def with_parameters_behind_inputs(function: ca.Function) -> ca.Function:
    """A function whose argument ``inputs`` holds the parameters too, behind the inputs; itself if it takes none."""
    words = function.name_in()
    if PARAMETERS not in words:
        return function
    place = words.index("inputs")
    count = function.size1_in(place)
    symbols = function.mx_in()
    inputs = ca.MX.sym("inputs", count + function.size1_in(PARAMETERS))
    given = [inputs[:count, 0], inputs[count:, 0]]
    outer = [*symbols[:place], inputs, *symbols[place + 2 :]]
    results = function.call([*symbols[:place], *given, *symbols[place + 2 :]], True, False)
    names = [word for word in words if word != PARAMETERS]
    return ca.Function(function.name(), outer, results, names, function.name_out())


def input_jacobian(model: Model) -> ca.Function:
    """(x, inputs) ↦ derivative of the residual with respect to inputs, then to parameters."""
    if not model.parameters.size:
        return model.input_jacobian
    symbols = model.input_jacobian.mx_in()
    by_both = [function.call(symbols)[0] for function in (model.input_jacobian, model.parameter_jacobian)]
    both = ca.Function("input_jacobian", symbols, [ca.horzcat(*by_both)], ["x", "inputs", PARAMETERS], ["by_both"])
    return with_parameters_behind_inputs(both)


def parameter_rate(path_residual: ca.Function, name: str) -> ca.Function:
    """Make (x, inputs, load_factor, parameters_rate) ↦ contribution of parameters to the residual's rate at fixed x.

    The function is separate, as the rate by inputs alone takes far fewer instructions.

    Args:
        path_residual: (x, inputs, p, load_factor) ↦ residual.
        name: name of the function.
    """
    residual = with_parameters_behind_inputs(path_residual)
    x, inputs, load_factor = residual.mx_in()
    size = path_residual.size1_in(PARAMETERS)
    count = inputs.size1() - size
    speed = ca.MX.sym("parameters_rate", size)
    p = ca.MX.sym("p", size)
    moving = residual.call([x, ca.vertcat(inputs[:count, 0], p), load_factor], True, False)[0]
    at_point = ca.substitute(ca.jtimes(moving, p, speed), p, inputs[count:])
    words = [*residual.name_in(), "parameters_rate"]
    return ca.Function(name, [x, inputs, load_factor, speed], [ca.densify(at_point)], words, ["residual_rate"])
