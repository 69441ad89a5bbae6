"""What one stage of an optimal-control problem evaluates, compiled, with the derivatives that its solver asks for.

An optimiser needs whole Jacobians. A library that knows only directional derivatives gives them a column at a time;
here the Jacobian is one function in C, and so is the second derivative. CasADi finds them by their names.
"""

from __future__ import annotations

import os
from collections.abc import Sequence

import casadi as ca

from cosserat_casadi.accuracy.cost import STRAIGHT
from cosserat_casadi.codegen.compiled import Progress, compiled_texts, find_compiler
from cosserat_casadi.codegen.kernels import sources
from cosserat_casadi.codegen.loops import in_loops
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.errors import ExportError, Problem
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model


def compiled_stage(
    model: Model,
    name: str = "stage",
    *,
    curvature: bool = False,
    compiler: str | None = None,
    progress: Progress | None = None,
) -> ca.Function:
    """(x, inputs) ↦ (residual, pose of every tip and body), compiled once, with compiled derivatives.

    Of a scene with parameters (x, inputs, p): fix them with ``model.at(…)`` where they are none of the problem's.

    Args:
        model: the model.
        name: what the function is called, a C identifier.
        curvature: whether second derivatives are exact. If not, those of residual and poses count as zero, so that any
            of CasADi's solvers sees the Gauss–Newton Hessian of a cost made of squares: positive semidefinite, and
            good where the deviations are small. Exact ones have several times as many instructions: minutes of gcc.
        compiler: C compiler; by default that of the environment variable CC, then cc, gcc, clang.
        progress: told what is compiled, how many files are, and of how many; not where nothing is left to do.

    Returns:
        outputs ``residual``, shape (size,), then for every rod and body ``tip_…`` or ``body_…``, shape (7,): position,
        m, and quaternion w x y z.

    Raises:
        ExportError: the name is no C identifier, the model has no scalar form, there is no compiler, or it fails.
    """
    library_names(name)
    check_scalar(model)
    found = find_compiler(compiler)
    texts: dict[str, str] = {}
    for function in stage_functions(model, name, curvature):
        texts |= sources([function], function.name(), "long long int")
    return ca.external(name, os.fspath(compiled_texts(name, texts, found, progress=progress)))


def check_scalar(model: Model) -> None:
    """Refuse a model that cannot be written as scalar instructions.

    Raises:
        ExportError: the rotation of a rod is integrated by the literal linear system.
    """
    literal = [rod for rod, chosen in model.discretisation.items() if chosen.transport == "permuted"]
    if literal:
        problem = "the literal linear system of the rotation is solved with pivoting, which has no scalar form"
        raise ExportError(*[Problem(f"rods.{rod}", problem, "leave accuracy.rotation out") for rod in literal])


def stage_functions(model: Model, name: str, curvature: bool) -> list[ca.Function]:
    """The function, its Jacobian, its adjoint and the adjoint's Jacobian, named as ``casadi.external`` looks for them.

    Args:
        model: the model.
        name: what the function is called.
        curvature: whether the last one is exact.
    """
    plain = written(_stage(model, name), name)
    slopes = written(_slopes(model, plain), f"jac_{name}")
    return differentiated(plain, slopes, curvature)


def differentiated(plain: ca.Function, slopes: ca.Function, curvature: bool) -> list[ca.Function]:
    """A function and its Jacobian with its adjoint, and the Jacobian of that.

    Args:
        plain: the function.
        slopes: its Jacobian, as CasADi takes it.
        curvature: whether the Jacobian of the adjoint is exact.
    """
    adjoint = plain.reverse(1)
    second = adjoint.jacobian() if curvature else bare_second(plain, slopes, adjoint)
    return [plain, slopes, written(adjoint, adjoint.name()), written(second, f"jac_{adjoint.name()}")]


def written(function: ca.Function, name: str) -> ca.Function:
    """A function as scalar instructions with common terms shared, or where they are too many for loops in C."""
    symbols = [ca.SX.sym(function.name_in(i), function.sparsity_in(i)) for i in range(function.n_in())]
    results = ca.cse(list(function.call(symbols)))
    straight = ca.Function(name, symbols, results, function.name_in(), function.name_out())
    if straight.n_instructions() <= STRAIGHT:
        return straight
    arguments = function.mx_in()
    whole = ca.Function(name, arguments, function.call(arguments), function.name_in(), function.name_out())
    return in_loops(whole)


def poses_of(model: Model) -> dict[str, ca.Function]:
    """The poses of tips and bodies, under the names that they have as results."""
    poses = {f"tip_{rod}": tip for rod, tip in model.tip.items()}
    return poses | {f"body_{body}": pose for body, pose in model.body.items()}


def _stage(model: Model, name: str) -> ca.Function:
    arguments = model.residual.mx_in()
    poses = poses_of(model)
    results = [model.residual(*arguments)]
    for pose in poses.values():
        position, quaternion, _ = pose(*arguments)
        results.append(ca.vertcat(position, quaternion))
    return ca.Function(name, arguments, results, model.residual.name_in(), ["residual", *poses])


def _slopes(model: Model, plain: ca.Function) -> ca.Function:
    """∂ output / ∂ input, output by output, with the model's own Jacobians."""
    arguments = model.residual.mx_in()
    poses = [*model.tip_jacobian.values(), *model.body_jacobian.values()]
    blocks = [model.jacobian(*arguments)[0], model.input_jacobian(*arguments)]
    if model.parameters.size:
        blocks.append(model.parameter_jacobian(*arguments))
    for pose in poses:
        blocks += pose(*arguments)
    return jacobian_of(plain, arguments, blocks)


def bare_second(plain: ca.Function, slopes: ca.Function, adjoint: ca.Function) -> ca.Function:
    """Jacobian of the adjoint with its multipliers; with x, inputs and p it is left empty."""
    symbols = adjoint.mx_in()
    blocks = slopes.call(symbols[: slopes.n_in()])
    rows = []
    for i in range(plain.n_in()):
        rows += [ca.MX(plain.size1_in(i), symbol.numel()) for symbol in symbols[: slopes.n_in()]]
        rows += [block.T for block in blocks[i :: plain.n_in()]]
    return jacobian_of(adjoint, symbols, rows)


def jacobian_of(function: ca.Function, symbols: Sequence[Matrix], blocks: Sequence[Matrix]) -> ca.Function:
    """Blocks as the function that CasADi takes for a Jacobian: its outputs are inputs too, without an entry."""
    outputs = [ca.MX.sym(f"out_{name}", ca.Sparsity(*function.size_out(name))) for name in function.name_out()]
    words_in = [*function.name_in(), *[f"out_{name}" for name in function.name_out()]]
    words_out = [f"jac_{o}_{i}" for o in function.name_out() for i in function.name_in()]
    return ca.Function(f"jac_{function.name()}", [*symbols, *outputs], blocks, words_in, words_out)
