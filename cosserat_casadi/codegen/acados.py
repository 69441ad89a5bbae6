"""A model as acados takes it: expressions of an implicit DAE, or the C functions that acados makes of such expressions.

The states are the model's inputs, the controls their rates, the algebraic states the unknowns of the rods:
ẋ = u, 0 = residual(z, x), for the integrator IRK. All is scalar: acados differentiates the expressions anew, and the
second derivatives of a graph of matrices take a compiler hundreds of times longer than those of scalars.

Names and argument lists of the C functions, [x, ẋ, u, z, t, p] to values and Jacobians, are those of acados'
``casadi_function_generation.py``; the C signature is that of ``external_function_param_casadi`` in
``acados/utils/external_function_generic.h`` (both in github.com/acados/acados, seen in 2025).
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, fields
from importlib.metadata import version
from pathlib import Path
from typing import Any

import casadi as ca

from cosserat_casadi.codegen.folder import check_folder, write_folder
from cosserat_casadi.codegen.kernels import sources
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.codegen.parameters import refuse_parameters
from cosserat_casadi.codegen.stage import check_scalar, written
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.model.build import Model


@dataclass(frozen=True)
class AcadosExpressions:
    """Attributes of an ``AcadosModel`` under their names there.

    Attributes:
        name: of the model, a C identifier.
        x: states, SX symbols: the stacked inputs, shape (model.inputs.size,).
        xdot: their derivatives.
        u: controls: the rates of the inputs, units per second.
        z: algebraic states: the unknowns of the rods, shape (model.size,).
        f_impl_expr: what the integrator holds at zero, ẋ − u and the residual.
    """

    name: str
    x: ca.SX
    xdot: ca.SX
    u: ca.SX
    z: ca.SX
    f_impl_expr: ca.SX

    def assign(self, target: Any) -> None:
        """Set these attributes of an ``AcadosModel``; costs and constraints are the user's, in x, u and z."""
        for entry in fields(self):
            setattr(target, entry.name, getattr(self, entry.name))


def acados_expressions(model: Model, name: str) -> AcadosExpressions:
    """The model as an implicit DAE in SX.

    ``model.tip[rod](expressions.z, expressions.x)`` and the like are outputs for a cost in the same symbols.

    Args:
        model: the model.
        name: what acados calls it, a C identifier.

    Raises:
        ExportError: the name is no C identifier, the model has no inputs or no scalar form.
    """
    _check(model, name)
    x, xdot, u, z = _symbols(model)
    return AcadosExpressions(name, x, xdot, u, z, ca.vertcat(xdot - u, ca.cse(model.residual(z, x))))


def acados_functions(model: Model, name: str) -> list[ca.Function]:
    """What acados' integrator IRK evaluates: the DAE and its Jacobians, with the model's own.

    Raises:
        ExportError: the name is no C identifier, the model has no inputs or no scalar form.
    """
    dae = acados_expressions(model, name)
    count = model.inputs.size
    by_z, value = model.jacobian(dae.z, dae.x)
    by_x = model.input_jacobian(dae.z, dae.x)
    zeros = ca.SX(count, count)
    identity = ca.SX.eye(count)
    blocks = {
        "fun": ca.vertcat(dae.xdot - dae.u, value),
        "jac_x": ca.vertcat(zeros, by_x),
        "jac_xdot": ca.vertcat(identity, ca.SX(model.size, count)),
        "jac_u": ca.vertcat(-identity, ca.SX(model.size, count)),
        "jac_z": ca.vertcat(ca.SX(count, model.size), by_z),
    }
    wanted = {
        "fun": ("fun",),
        "fun_jac_x_xdot_z": ("fun", "jac_x", "jac_xdot", "jac_z"),
        "fun_jac_x_xdot_u_z": ("fun", "jac_x", "jac_xdot", "jac_u", "jac_z"),
        "fun_jac_x_xdot_u": ("fun", "jac_x", "jac_xdot", "jac_u"),
        "jac_x_xdot_u_z": ("jac_x", "jac_xdot", "jac_u", "jac_z"),
    }
    symbols = [dae.x, dae.xdot, dae.u, dae.z, ca.SX.sym("t"), ca.SX.sym("p", 0)]
    words = ["x", "xdot", "u", "z", "t", "p"]
    return [
        written(ca.Function(called, symbols, [blocks[word] for word in outputs], words, list(outputs)), called)
        for called, outputs in ((f"{name}_impl_dae_{ending}", outputs) for ending, outputs in wanted.items())
    ]


def write_acados(model: Model, directory: str | os.PathLike[str], name: str) -> Path:
    """Write the functions as C for ``external_function_param_casadi``, one file and header each.

    Args:
        model: the model.
        directory: a folder, new, empty, or of an earlier call.
        name: what every function begins with, a C identifier.

    Returns:
        the folder.

    Raises:
        ExportError: the name or the folder is refused, the model has no inputs or no scalar form; nothing was written.
    """
    functions = acados_functions(model, name)
    folder = Path(directory)
    stale = check_folder(folder, MANIFEST)
    files: dict[str, str] = {}
    for function in functions:
        files |= sources([function], function.name(), "int")
    versions = {"cosserat_casadi": version("cosserat-casadi"), "casadi": ca.CasadiMeta.version()}
    described = {"name": name, "functions": [f.name() for f in functions], "files": [*files, MANIFEST]}
    files[MANIFEST] = json.dumps({**described, "versions": versions}, indent=1) + "\n"
    write_folder(folder, files, stale)
    return folder


def _symbols(model: Model) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    count = model.inputs.size
    return ca.SX.sym("x", count), ca.SX.sym("xdot", count), ca.SX.sym("u", count), ca.SX.sym("z", model.size)


def _check(model: Model, name: str) -> None:
    library_names(name)
    refuse_parameters(model.scene)
    check_scalar(model)
    if not model.inputs.size:
        raise ExportError(Problem("inputs", "none is free: there is nothing to control", "name some in the scene"))
