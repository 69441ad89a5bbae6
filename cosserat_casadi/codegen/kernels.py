"""The generated kernels: functions of a model as straight-line C without dependencies."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import casadi as ca

from cosserat_casadi.accuracy.cost import STRAIGHT
from cosserat_casadi.codegen.assembled import Assembled
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.model.build import Model

GENERATOR = {"with_header": True, "static_aux": True}


def kernels(model: Model, names: Names, parts: Assembled | None) -> list[ca.Function]:
    """What the solver in C is made of, with dense outputs; of an assembly the equations are in parts."""
    whole = {names.kernel("residual"): model.path_residual, names.kernel("jacobian"): model.path_jacobian}
    wanted = {
        **(whole if parts is None else {}),
        names.kernel("rate"): model.path_rate,
        names.kernel("tangent"): model.path_tangent,
        names.kernel("coarseness"): model.coarseness,
    }
    for rod in names.rods:
        wanted[names.kernel("igm", rod)] = model.igm[rod]
        wanted[names.kernel("tip", rod)] = tip(model, rod)
        wanted[names.kernel("tip_jacobian", rod)] = model.tip_jacobian[rod]
        wanted[names.kernel("shape", rod)] = model.shape[rod]
    for actuator in names.actuators:
        wanted[names.kernel("actuator", actuator)] = model.actuator[actuator]
    for body in names.bodies:
        wanted[names.kernel("body", body)] = body_pose(model, body)
        wanted[names.kernel("body_jacobian", body)] = model.body_jacobian[body]
    found = [kernel(model, function, name) for name, function in wanted.items()]
    return found if parts is None else [*parts.kernels, *found]


def kernel(model: Model, function: ca.Function, name: str) -> ca.Function:
    """One function under the name it has in C: straight-line code if it is short, else loops."""
    # The literal linear system is solved with pivoting, which has no scalar form.
    literal = any(chosen.transport == "permuted" for chosen in model.discretisation.values())
    if not literal:
        straight = scalar(function, name)
        if straight.n_instructions() <= STRAIGHT:
            return straight
    symbols = function.mx_in()
    results = [ca.densify(result) for result in function.call(symbols)]
    return ca.Function(name, symbols, results, function.name_in(), function.name_out())


def tip(model: Model, rod: str) -> ca.Function:
    """(x, inputs) ↦ (position, quaternion) of the tip, world frame."""
    return _pose("tip", model.tip[rod])


def body_pose(model: Model, body: str) -> ca.Function:
    """(x, inputs) ↦ (position, quaternion) of a rigid body, world frame."""
    return _pose("body", model.body[body])


def _pose(word: str, function: ca.Function) -> ca.Function:
    """A pose without the rotation matrix that it is also given as."""
    x, inputs = function.mx_in()
    position, quaternion, _ = function(x, inputs)
    return ca.Function(word, [x, inputs], [position, quaternion], ["x", "inputs"], ["position", "quaternion"])


def scalar(function: ca.Function, name: str) -> ca.Function:
    """A function as scalar instructions with dense outputs, constants folded and common terms shared."""
    symbols = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    expressions = [ca.densify(expression) for expression in ca.cse(list(function.call(symbols)))]
    return ca.Function(name, symbols, expressions, function.name_in(), function.name_out())


def sources(functions: Sequence[ca.Function], stem: str, integer: str) -> dict[str, str]:
    """Text of ``stem.c`` and ``stem.h`` with these functions, with this C type for integers."""
    generator = ca.CodeGenerator(stem, {**GENERATOR, "casadi_int": integer})
    for function in functions:
        generator.add(function)
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(f"{folder}/")
        return {name: (Path(folder) / name).read_text() for name in (f"{stem}.c", f"{stem}.h")}
