"""A model for acados: expressions of an implicit DAE, or the C functions that acados generates from such expressions.

At rest the states are the model's inputs, the controls their rates, the algebraic states the unknowns of the rods:
ẋ = u, 0 = residual(z, x), for the integrator IRK. In motion the states begin with the unknowns that move, q, and their
velocities v: q̇ = v, and 0 = F(q and z, v, v̇, inputs, u), the equations of motion; z are multipliers and tensions.

All expressions are scalar: acados differentiates them anew, and a compiler takes hundreds of times longer for second
derivatives of a graph of matrices than of scalars.

Names and argument lists of the C functions, [x, ẋ, u, z, t, p] to values and Jacobians, are taken from acados'
``casadi_function_generation.py``, the C signature from ``external_function_param_casadi`` in
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
from cosserat_casadi.codegen.manifest import MANIFEST
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.codegen.stage import check_scalar
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.equilibrium.contact.relaxed_contact import RelaxedContact
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.calls import chooses
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import RELAXED, WIDTH, refuse_obstacles
from cosserat_casadi.motion.collocated_stage import algebraic_places, differential_places
from cosserat_casadi.motion.motion_checks import check_movable


@dataclass(frozen=True)
class AcadosExpressions:
    """Attributes of an ``AcadosModel``, by their names in acados.

    Attributes:
        name: name of the model, a C identifier.
        x: states, SX symbols, or MX if rods touch rods: the stacked inputs, shape (model.inputs.size,); in motion,
            before them, the differential unknowns of the model and their velocities, 1/s.
        xdot: time derivatives of the states.
        u: controls: the rates of the inputs, units per second.
        z: algebraic states: the unknowns of the model, shape (model.size,); in motion its algebraic unknowns.
        p: parameters of the scene, shape (model.parameters.size,), often none; for relaxed contact the smoothing and
            the abscissae.
        f_impl_expr: expressions that the integrator holds at zero: in motion q̇ − v, then ẋ − u, then the residual.
    """

    name: str
    x: Matrix
    xdot: Matrix
    u: Matrix
    z: Matrix
    p: Matrix
    f_impl_expr: Matrix

    def assign(self, target: Any, *, parameters: str = "p") -> None:
        """Set these attributes of an ``AcadosModel``; the user adds costs and constraints in x, u, z and p.

        Args:
            target: the ``AcadosModel``.
            parameters: attribute for the parameters of the scene, if it names some: ``p``, a value for each stage, or
                ``p_global``, one value for all stages, by which acados can differentiate solutions.
        """
        for entry in fields(self):
            word = parameters if entry.name == "p" else entry.name
            if entry.name != "p" or self.p.numel():
                setattr(target, word, getattr(self, entry.name))


def acados_expressions(model: Model | RelaxedContact, name: str, *, moving: bool = False) -> AcadosExpressions:
    """Make an implicit DAE of the model.

    Outputs for a cost in these symbols are, at rest, ``model.tip[rod](expressions.z, expressions.x)`` and the like;
    for a scene with parameters, ``expressions.p`` is a third argument. In motion, for a model without algebraic
    unknowns, they are ``model.tip[rod](expressions.x[: model.size], inputs)``, where the inputs are the last entries
    of ``expressions.x``.

    Args:
        model: the model; for a scene in exact contact, at rest, the one that :func:`relaxed_contact` makes of it.
        name: name of the model in acados, a C identifier.
        moving: whether the equations are equations of motion. With supports, joints or cables of given length they have
            index 3, for which acados promises nothing.

    Raises:
        ExportError: the name is no C identifier, the model has no inputs or no scalar form.
        SceneError: a rod has no mass, or contact is exact.
    """
    _check(model, name, moving)
    expressions, _ = _dae(model, name, moving)
    return expressions


def acados_functions(model: Model | RelaxedContact, name: str, *, moving: bool = False) -> list[ca.Function]:
    """Make the functions that acados' integrator IRK evaluates, the DAE and its Jacobians, besides those of the model.

    Raises:
        ExportError: the name is no C identifier, the model has no inputs or no scalar form.
        SceneError: it is to move, and a rod has no mass, or contact is exact.
    """
    _check(model, name, moving)
    dae, slopes = _dae(model, name, moving)
    blocks = {"fun": dae.f_impl_expr, **slopes}
    wanted = {
        "fun": ("fun",),
        "fun_jac_x_xdot_z": ("fun", "jac_x", "jac_xdot", "jac_z"),
        "fun_jac_x_xdot_u_z": ("fun", "jac_x", "jac_xdot", "jac_u", "jac_z"),
        "fun_jac_x_xdot_u": ("fun", "jac_x", "jac_xdot", "jac_u"),
        "jac_x_xdot_u_z": ("jac_x", "jac_xdot", "jac_u", "jac_z"),
    }
    symbols = [dae.x, dae.xdot, dae.u, dae.z, type(dae.x).sym("t"), dae.p]
    words = ["x", "xdot", "u", "z", "t", "p"]
    functions = []
    for ending, outputs in wanted.items():
        results = ca.cse([blocks[word] for word in outputs])
        functions.append(ca.Function(f"{name}_impl_dae_{ending}", symbols, results, words, list(outputs)))
    return functions


def write_acados(
    model: Model | RelaxedContact, directory: str | os.PathLike[str], name: str, *, moving: bool = False
) -> Path:
    """Write the functions as C for ``external_function_param_casadi``, one file and header each.

    Args:
        model: the model, as in :func:`acados_expressions`.
        directory: a folder that is new, empty, or written by an earlier call.
        name: prefix of every function, a C identifier.
        moving: whether the equations are equations of motion, as in :func:`acados_expressions`.

    Returns:
        the folder.

    Raises:
        ExportError: the name or the folder is refused, the model has no inputs or no scalar form; nothing was written.
        SceneError: it is to move, and a rod has no mass, or contact is exact; nothing was written.
    """
    functions = acados_functions(model, name, moving=moving)
    folder = Path(directory)
    stale = check_folder(folder)
    files: dict[str, str] = {}
    for function in functions:
        files |= external_sources([function], function.name(), "int")
    versions = {"cosserat_casadi": version("cosserat-casadi"), "casadi": ca.CasadiMeta.version()}
    described = {"name": name, "functions": [f.name() for f in functions], "files": [*files, MANIFEST]}
    files[MANIFEST] = json.dumps({**described, "versions": versions}, indent=1) + "\n"
    write_folder(folder, files, stale)
    return folder


Dae = tuple[AcadosExpressions, dict[str, Matrix]]
"""An implicit DAE, and its derivatives by x, ẋ, u and z, under their names in acados' functions."""


def _dae(model: Model | RelaxedContact, name: str, moving: bool) -> Dae:
    if isinstance(model, RelaxedContact) or not moving:
        return _dae_at_rest(model, name)
    return _dae_in_motion(model, name)


def _dae_at_rest(model: Model | RelaxedContact, name: str) -> Dae:
    kind = _kind(model.residual)
    count = model.inputs.size
    x = kind.sym("x", count)
    xdot = kind.sym("xdot", count)
    u = kind.sym("u", count)
    z = kind.sym("z", model.size)
    p = kind.sym("p", model.parameters.size)
    at = [z, x, p] if model.parameters.size else [z, x]
    by_z, _ = model.jacobian(*at)
    identity = kind.eye(count)
    slopes = {
        "jac_x": ca.vertcat(kind(count, count), model.input_jacobian(*at)),
        "jac_xdot": ca.vertcat(identity, kind(model.size, count)),
        "jac_u": ca.vertcat(-identity, kind(model.size, count)),
        "jac_z": ca.vertcat(kind(count, model.size), by_z),
    }
    value = ca.vertcat(xdot - u, ca.cse(model.residual(*at)))
    return AcadosExpressions(name, x, xdot, u, z, p, value), slopes


def _dae_in_motion(model: Model, name: str) -> Dae:
    kind = _kind(model.inverse_dynamics)
    places = differential_places(model)
    held = algebraic_places(model)
    count = model.inputs.size
    size = places.shape[1]
    states = 2 * size + count
    x = kind.sym("x", states)
    xdot = kind.sym("xdot", states)
    u = kind.sym("u", count)
    z = kind.sym("z", held.shape[1])
    p = kind.sym("p", model.parameters.size)
    position, velocity, inputs = ca.vertsplit(x, [0, size, 2 * size, states])
    position_rate, acceleration, inputs_rate = ca.vertsplit(xdot, [0, size, 2 * size, states])
    steady = ca.DM(count, 1)
    given = [inputs, p] if model.parameters.size else [inputs]
    at = [places @ position + held @ z, places @ velocity, places @ acceleration, *given, u, steady]
    residual = ca.cse(model.inverse_dynamics(*at))
    stiffness, damping, mass, _ = model.dynamics_jacobian(*at)
    by_inputs, by_rate = _by_inputs(model)(*at)
    value = ca.vertcat(position_rate - velocity, residual, inputs_rate - u)
    # Rows: the rates of the unknowns, the equations of motion, the rates of the inputs.
    one = kind.eye(size)
    one_input = kind.eye(count)
    none = kind(size, size)
    slopes = {
        "jac_x": ca.vertcat(
            ca.horzcat(none, -one, kind(size, count)),
            ca.horzcat(stiffness @ places, damping @ places, by_inputs),
            kind(count, states),
        ),
        "jac_xdot": ca.vertcat(
            ca.horzcat(one, none, kind(size, count)),
            ca.horzcat(kind(model.size, size), mass @ places, kind(model.size, count)),
            ca.horzcat(kind(count, 2 * size), one_input),
        ),
        "jac_u": ca.vertcat(kind(size, count), by_rate, -one_input),
        "jac_z": ca.vertcat(kind(size, z.numel()), stiffness @ held, kind(count, z.numel())),
    }
    return AcadosExpressions(name, x, xdot, u, z, p, value), slopes


def _kind(equations: ca.Function) -> type[ca.SX] | type[ca.MX]:
    """Type of symbols: scalars, or matrices for equations that skip unneeded terms, such as those of distant rods."""
    return ca.MX if chooses(equations) else ca.SX


def _by_inputs(model: Model) -> ca.Function:
    """Arguments of inverse dynamics ↦ its derivatives by the inputs and by their rates."""
    function = model.inverse_dynamics
    symbols = function.mx_in()
    residual = function(*symbols)
    wanted = [symbols[function.name_in().index(word)] for word in ("inputs", "inputs_rate")]
    return ca.Function("by_inputs", symbols, [ca.jacobian(residual, symbol) for symbol in wanted])


def _check(model: Model | RelaxedContact, name: str, moving: bool) -> None:
    library_names(name)
    if isinstance(model, RelaxedContact):
        model = model.model
        if moving:
            refuse_obstacles(model.scene, "an acados model in motion", WIDTH)
    else:
        refuse_obstacles(model.scene, "an acados model", WIDTH if moving else RELAXED)
    check_scalar(model)
    if not model.inputs.size:
        raise ExportError(Problem("inputs", "none is free: there is nothing to control", "name some in the scene"))
    if moving:
        check_movable(model)
