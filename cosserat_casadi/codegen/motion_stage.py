"""A compiled stage of an optimal-control problem in motion, with the derivatives that its solver needs.

As in :mod:`stage`, whole Jacobians are functions in C. The Jacobians of the equations consist of the derivatives of
inverse dynamics at every instant, K by x, C by v, M by a: with the tables A, A² and the nodes c of the method

    ∂R_i/∂x₀ = K, ∂R_i/∂(h v₀) = c_i K + C/h, ∂R_i/∂(h² a_j) = (A²)_ij K + A_ij C/h + δ_ij M/h²,

and ∂R_i/∂z_j = δ_ij K for an algebraic entry. Poses are a separate function, so that their second derivatives do not
evaluate the equations of motion.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from cosserat_casadi.accuracy.cost import STRAIGHT
from cosserat_casadi.codegen.names import library_names
from cosserat_casadi.codegen.stage import (
    adjoint_and_second,
    bare_second,
    exact_second,
    jacobian_of,
    poses_of,
    written,
    written_in_c,
)
from cosserat_casadi.compiling.cache import kept_texts
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.maths.calls import chooses, has_routines, with_shared_terms
from cosserat_casadi.maths.typing import FloatArray, Matrix
from cosserat_casadi.model.function_table import PARAMETERS
from cosserat_casadi.motion.collocated_stage import MotionStage, StageEquations, differential_places
from cosserat_casadi.numerics.progress import StageProgress


@dataclass(frozen=True)
class CompiledMotionStage:
    """Functions in C of a stage in motion, for a solver.

    Attributes:
        equations: equations of the stage, as in :attr:`MotionStage.equations`.
        poses: (state, inputs), with parameters (state, inputs, p), ↦ for every rod and body ``tip_…`` or ``body_…``,
            shape (7,): position, m, and quaternion w x y z.
    """

    equations: StageEquations
    poses: ca.Function


def compiled_motion_stage(
    stage: MotionStage,
    name: str = "stage",
    *,
    curvature: bool = False,
    compiler: str | None = None,
    progress: StageProgress | None = None,
) -> CompiledMotionStage:
    """Compile the equations of a stage in motion and its poses, with their derivatives.

    Args:
        stage: the stage.
        name: prefix of the functions, a C identifier.
        curvature: whether second derivatives are exact, as in :func:`compiled_stage`. They have several hundred times
            as many instructions as the equations of motion, and are for models of a few unknowns.
        compiler: C compiler; by default the command in the environment variable CC, then cc, gcc, clang, python-zig.
        progress: callback, as in :func:`compiled_stage`.

    Raises:
        ExportError: the name is no C identifier, there is no compiler, or it fails.
    """
    library_names(name)
    found = find_compiler(compiler)
    equations = f"{name}_equations"
    poses = f"{name}_poses"

    def write() -> dict[str, str]:
        of_equations = written_in_c(equations_functions(stage, equations, curvature), equations, progress)
        return of_equations | written_in_c(poses_functions(stage, poses, curvature), poses, progress)

    texts = kept_texts(name, (compiled_motion_stage.__name__, stage, name, curvature), write)
    library = os.fspath(compiled_texts(name, texts, found, progress=progress))
    return CompiledMotionStage(StageEquations(ca.external(equations, library)), ca.external(poses, library))


def equations_functions(stage: MotionStage, name: str, curvature: bool) -> Iterator[ca.Function]:
    """Make the equations, their Jacobian, their adjoint and its Jacobian, named for ``casadi.external``.

    Args:
        stage: the stage.
        name: name of the equations.
        curvature: whether the Jacobian of the adjoint is exact.
    """
    if stage.pairs is not None:
        stage = replace(stage, pairs=replace(stage.pairs, in_loops=True))
    inverse_dynamics = written(stage.dynamics.inverse_dynamics, f"{name}_at_instant")
    plain = stage.equations_by(inverse_dynamics, name)
    yield plain
    slopes = _equations_jacobian(stage, plain)
    yield slopes
    adjoint = plain.reverse(1)
    yield adjoint
    make_second = exact_second if curvature else bare_second
    yield make_second(plain, slopes, adjoint)


def poses_functions(stage: MotionStage, name: str, curvature: bool) -> Iterator[ca.Function]:
    """Make the poses of tips and bodies, with their derivatives as in :func:`equations_functions`."""
    model = stage.model
    state, _, inputs, *_ = stage.symbols
    given = [inputs]
    if model.parameters.size:
        # No pose reads the smoothing of contact, which stands behind the parameters of the model.
        given.append(ca.MX.sym(PARAMETERS, model.parameters.size))
    x = stage.x(state)
    poses = poses_of(model)
    results = []
    for pose in poses.values():
        position, quaternion, _ = pose(x, *given)
        results.append(ca.vertcat(position, quaternion))
    arguments = [state, *given]
    words = ["state", "inputs", PARAMETERS]
    whole = ca.Function(name, arguments, results, words[: len(arguments)], [*poses])
    plain = written(whole, name)
    yield plain
    blocks = []
    places = differential_places(model)
    for slope in [*model.tip_jacobian.values(), *model.body_jacobian.values()]:
        by_x, *by_given = slope(x, *given)
        by_position = by_x @ places
        # No pose reads a velocity.
        blocks += [ca.horzcat(by_position, ca.DM(*by_position.shape)), *by_given]
    slopes = written(jacobian_of(plain, arguments, blocks), f"jac_{name}")
    yield slopes
    yield from adjoint_and_second(plain, slopes, curvature)


def _equations_jacobian(stage: MotionStage, plain: ca.Function) -> ca.Function:
    """Make ∂ residual / ∂ (state, unknowns, inputs, p, rates) from K, C and M at every instant."""
    method = stage.method
    tangents = _tangents(stage, f"{plain.name()}_tangents")
    input_slopes = _input_slopes(stage, f"{plain.name()}_input_slopes")
    arguments = stage.symbols
    state, unknowns, inputs, *p, rate = arguments
    moving = stage.instants(state, unknowns)
    rows = []
    for i in range(method.stages):
        now = stage.inputs_at(i, inputs, rate)
        at = [moving.x[i], moving.v[i], moving.a[i], now, *p, rate]
        stiffness, damping, mass = tangents.call(at, False, True)
        by_inputs, *by_parameters, by_rate = input_slopes.call(at, False, True)
        damping = damping / stage.duration
        mass = mass / stage.duration**2
        by_state = ca.horzcat(stiffness @ stage.places, (float(method.nodes[i]) * stiffness + damping) @ stage.places)
        by_unknowns = []
        for j in range(method.stages):
            block = _columns(stage, method.matrix_squared[i, j], float(i == j), stiffness)
            block += float(method.matrix[i, j]) * damping
            if i == j:
                block += mass
            by_unknowns.append(block)
        by_rate = by_rate + float(method.nodes[i]) * stage.duration * by_inputs
        rows.append([by_state, ca.horzcat(*by_unknowns), by_inputs, *by_parameters, by_rate])
    blocks = [ca.vertcat(*[row[k] for row in rows]) for k in range(len(arguments))]
    return jacobian_of(plain, arguments, blocks)


def _tangents(stage: MotionStage, name: str) -> ca.Function:
    """(x, v, a, inputs, p, inputs_rate) ↦ ∂F/∂x, ∂F/∂v, ∂F/∂a of inverse dynamics at an instant."""
    jacobian = stage.dynamics.dynamics_jacobian
    arguments = jacobian.mx_in()
    steady = ca.DM(stage.model.inputs.size, 1)
    matrices = jacobian(*arguments[:-1], steady)[:3]
    function = ca.Function(name, arguments[:-1], matrices, jacobian.name_in()[:-1], jacobian.name_out()[:3])
    return written(function, name)


def _input_slopes(stage: MotionStage, name: str) -> ca.Function:
    """(x, v, a, inputs, p, inputs_rate) ↦ ∂F/∂inputs, ∂F/∂p, ∂F/∂inputs_rate of inverse dynamics at an instant."""
    plain = stage.dynamics.inverse_dynamics
    if not (chooses(plain) or has_routines(plain)):
        scalars = [ca.SX.sym(word, plain.sparsity_in(i)) for i, word in enumerate(plain.name_in()[:-1])]
        # A function of scalars differentiates only terms that read an input, a function of matrices all.
        straight = _by_inputs(stage, scalars, name)
        if straight.n_instructions() <= STRAIGHT:
            return straight
    return written(_by_inputs(stage, plain.mx_in()[:-1], name), name)


def _by_inputs(stage: MotionStage, arguments: Sequence[Matrix], name: str) -> ca.Function:
    """Make the derivatives by inputs, parameters and the rates of inputs in given symbols."""
    plain = stage.dynamics.inverse_dynamics
    residual = plain(*arguments, ca.DM(stage.model.inputs.size, 1))
    words = plain.name_in()[:-1]
    first = words.index("inputs")
    slopes = [ca.jacobian(residual, argument) for argument in arguments[first:]]
    return with_shared_terms(name, arguments, slopes, words, [f"by_{word}" for word in words[first:]])


def _columns(stage: MotionStage, differential: float, algebraic: float, stiffness: Matrix) -> Matrix:
    """Scale the columns of differential, and of algebraic, entries of the stiffness by one number each."""
    if np.all(stage.accelerated):
        return float(differential) * stiffness
    weights: FloatArray = np.where(stage.accelerated, differential, algebraic)
    return stiffness @ ca.diag(ca.DM(weights))
