"""Compiled functions of one stage of an optimal-control problem, with the derivatives that its solver needs.

An optimiser needs whole Jacobians. A library with directional derivatives alone returns them a column at a time; here
the Jacobian is one function in C, and so is the second derivative. CasADi finds them by their names.

The second derivative of Σ λ_i g_i is symmetric and has many columns, which differ in one direction alone. Its code
computes one column, the derivative of the adjoint in a direction, in a loop over the columns; empty columns are not
computed, and of two blocks that are transposes of each other only one is.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence

import casadi as ca

from cosserat_casadi.accuracy.cost import STRAIGHT
from cosserat_casadi.codegen.names import identifier, library_names
from cosserat_casadi.compiling.cache import kept_texts
from cosserat_casadi.compiling.compiler import compiled_texts, find_compiler
from cosserat_casadi.compiling.printed_files import external_sources
from cosserat_casadi.equilibrium.contact.relaxed_contact import RelaxedContact
from cosserat_casadi.errors import ExportError, Problem, refuse
from cosserat_casadi.maths.calls import chooses, has_routines, in_scalars
from cosserat_casadi.maths.typing import Matrix
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.obstacle_checks import RELAXED, refuse_obstacles
from cosserat_casadi.model.section_poses import SectionPoses, section_weights
from cosserat_casadi.model.system import Arguments, System
from cosserat_casadi.numerics.progress import StageProgress

PARTS = 4
"""Number of functions of a stage: value, Jacobian, adjoint, and Jacobian of the adjoint."""


def compiled_stage(
    model: Model | RelaxedContact,
    name: str = "stage",
    *,
    curvature: bool = True,
    sections: Mapping[str, Sequence[float]] | None = None,
    actuators: Sequence[str] = (),
    compiler: str | None = None,
    progress: StageProgress | None = None,
) -> ca.Function:
    """Compile (x, inputs) ↦ (residual, pose of every tip and body, …), once, with compiled derivatives.

    For a scene with parameters the arguments are (x, inputs, p); ``model.at(…)`` fixes them if the problem has none.

    Args:
        model: the model; for a scene in exact contact the one that :func:`relaxed_contact` makes of it, whose poses are
            those of tips and bodies.
        name: name of the function, a C identifier.
        curvature: whether second derivatives are exact. If not, all second derivatives count as zero, so that any of
            CasADi's solvers has the Gauss–Newton Hessian of a least-squares cost: positive semidefinite, and good for
            small deviations without constraints on poses. A path through poses that are constraints needs exact ones:
            without them a solver may report it infeasible.
        sections: abscissae X in [0, 1] of further sections, rod by rod.
        actuators: actuators whose effort and conjugate are wanted, for a tendon its tension and its length.
        compiler: C compiler; by default the command in the environment variable CC, then cc, gcc, clang, python-zig.
        progress: callback with the function or file under way, the number of finished ones, and of all; not called if
            all files are compiled.

    Returns:
        outputs ``residual``, shape (size,), then for every rod and body ``tip_…`` or ``body_…``, shape (7,): position,
        m, and quaternion w x y z; for every rod of ``sections`` ``sections_…`` with such a column for each section;
        for each of ``actuators`` its effort and its conjugate, ``tension_…``, N, and ``length_…``, m.

    Raises:
        ExportError: the name is no C identifier, the model has no scalar form, there is no compiler, or it fails; or
            there is no such rod, section or actuator.
        SceneError: contact is exact.
    """
    library_names(name)
    wanted = dict(sections or {})
    if isinstance(model, RelaxedContact):
        check_scalar(model.model)
        if wanted or actuators:
            problem = "a stage in relaxed contact has the poses of tips and bodies alone"
            raise ExportError(Problem("sections, actuators", problem, "leave them out"))
    else:
        refuse_obstacles(model.scene, "a compiled stage", RELAXED)
        check_scalar(model)
        _check_wanted(model, wanted, actuators)
    found = find_compiler(compiler)
    made_from = (compiled_stage.__name__, model, name, curvature, wanted, actuators)
    texts = kept_texts(
        name,
        made_from,
        lambda: written_in_c(stage_functions(model, name, curvature, wanted, actuators), name, progress),
    )
    return ca.external(name, os.fspath(compiled_texts(name, texts, found, progress=progress)))


def written_in_c(functions: Iterator[ca.Function], name: str, progress: StageProgress | None) -> dict[str, str]:
    """Write sources and headers of functions, by file name, each function in a separate file.

    Args:
        functions: :data:`PARTS` functions, each of which takes time to make.
        name: name of the stage, for the progress.
        progress: callback for every function that is written.
    """
    texts: dict[str, str] = {}
    for done in range(PARTS):
        if progress is not None:
            progress(f"Writing {name} in C", done, PARTS)
        function = next(functions)
        texts |= external_sources([function], function.name(), "long long int")
    return texts


def check_scalar(model: Model) -> None:
    """Refuse a model that cannot be written as scalar instructions.

    Raises:
        ExportError: the rotation of a rod is integrated by the literal linear system.
    """
    literal = [rod for rod, chosen in model.discretisation.items() if chosen.transport == "permuted"]
    problem = "the literal linear system of the rotation is solved with pivoting, which has no scalar form"
    refuse([Problem(f"rods.{rod}", problem, "leave accuracy.rotation out") for rod in literal], ExportError)


def _check_wanted(model: Model, sections: Mapping[str, Sequence[float]], actuators: Sequence[str]) -> None:
    """Refuse outputs that the model does not have.

    Raises:
        ExportError: there is no such rod, section or actuator.
    """
    problems = []
    for rod, abscissae in sections.items():
        if rod not in model.discrete.rods:
            problems.append(Problem(f"sections.{rod}", "there is no such rod", _one_of(model.discrete.rods)))
        if not len(abscissae) or not all(0.0 <= X <= 1.0 for X in abscissae):
            problem = "abscissae go from 0 at the base to 1 at the tip, one at least"
            problems.append(Problem(f"sections.{rod}", problem, "give numbers in [0, 1]"))
    unknown = [actuator for actuator in actuators if actuator not in model.actuator]
    remedy = _one_of(model.actuator)
    problems += [Problem(f"actuators.{actuator}", "there is no such actuator", remedy) for actuator in unknown]
    refuse(problems, ExportError)


def _one_of(names: Mapping[str, object]) -> str:
    """Remedy for a name that does not exist: the list of names."""
    if not names:
        return "leave it out, the scene has none"
    return f"take one of {', '.join(names)}"


def stage_functions(
    model: Model | RelaxedContact,
    name: str,
    curvature: bool,
    sections: Mapping[str, Sequence[float]] | None = None,
    actuators: Sequence[str] = (),
) -> Iterator[ca.Function]:
    """Make the function, its Jacobian, its adjoint and the adjoint's Jacobian, named for ``casadi.external``.

    Args:
        model: the model.
        name: name of the function.
        curvature: whether the Jacobian of the adjoint is exact.
        sections: abscissae of further sections, rod by rod.
        actuators: actuators whose effort and conjugate are wanted.
    """
    further = {} if isinstance(model, RelaxedContact) else _further_outputs(model, sections or {}, actuators)
    plain = written(_stage(model, name, further), name)
    yield plain
    slopes = written(_slopes(model, plain, further), f"jac_{name}")
    yield slopes
    yield from adjoint_and_second(plain, slopes, curvature)


def adjoint_and_second(plain: ca.Function, slopes: ca.Function, curvature: bool) -> Iterator[ca.Function]:
    """Make the adjoint of a function, and the Jacobian of the adjoint.

    Args:
        plain: the function.
        slopes: its Jacobian, in the form that CasADi needs.
        curvature: whether the Jacobian of the adjoint is exact.
    """
    reverse = plain.reverse(1)
    adjoint = written(reverse, reverse.name())
    yield adjoint
    if curvature:
        yield exact_second(plain, slopes, adjoint)
        return
    bare = bare_second(plain, slopes, adjoint)
    yield written(bare, bare.name())


def written(function: ca.Function, name: str) -> ca.Function:
    """Write a function in scalars with common terms shared, or for loops in C if there are too many instructions.

    A function that skips unneeded terms, such as those of distant rods, or that calls routines, stays as it is.
    """
    if chooses(function) or has_routines(function):
        return _named(function, name)
    straight = in_scalars(function, name)
    if straight.n_instructions() <= STRAIGHT:
        return straight
    return _named(function, name)


def _named(function: ca.Function, name: str) -> ca.Function:
    """Give a function of matrices a name."""
    if function.name() == name:
        # Around it a second function would have its name.
        return function
    arguments = function.mx_in()
    return ca.Function(name, arguments, function.call(arguments), function.name_in(), function.name_out())


def poses_of(model: Model | RelaxedContact) -> dict[str, ca.Function]:
    """Return the poses of tips and bodies, by their names as results."""
    poses = {f"tip_{rod}": tip for rod, tip in model.tip.items()}
    return poses | {f"body_{identifier(body)}": pose for body, pose in model.body.items()}


def _further_outputs(
    model: Model, sections: Mapping[str, Sequence[float]], actuators: Sequence[str]
) -> dict[str, ca.Function]:
    """Make poses of sections, and efforts and conjugates of actuators, with their derivatives, by name.

    Each function takes the arguments of the residual, and returns a value and its derivative by each argument.
    """
    further: dict[str, ca.Function] = {}
    for rod, abscissae in sections.items():
        further[f"sections_{rod}"] = _section_poses(model, rod, abscissae)
    arguments = model.residual.mx_in()
    for actuator in actuators:
        function = model.actuator[actuator]
        effort, conjugate, by_x = function(*arguments)
        effort_name, conjugate_name, _ = function.name_out()
        of_effort = [ca.jacobian(effort, argument) for argument in arguments]
        of_conjugate = [by_x, *[ca.jacobian(conjugate, argument) for argument in arguments[1:]]]
        further[f"{effort_name}_{actuator}"] = ca.Function("effort", arguments, [effort, *of_effort])
        further[f"{conjugate_name}_{actuator}"] = ca.Function("conjugate", arguments, [conjugate, *of_conjugate])
    return further


def _section_poses(model: Model, rod: str, abscissae: Sequence[float]) -> ca.Function:
    """Make arguments of the residual ↦ (poses of sections of a rod, 7×k, and their derivatives by each argument)."""
    discrete = model.discrete
    x = ca.MX.sym("x", discrete.size)
    inputs = ca.MX.sym("inputs", discrete.layout.size)
    system = System(discrete, Arguments(x, inputs))
    poses = SectionPoses(system, rod, section_weights(discrete, rod, abscissae))
    others = [inputs, discrete.parameters.symbol] if discrete.parameters.size else [inputs]
    by_others = [ca.jacobian(ca.vec(poses.stacked), other) for other in others]
    return ca.Function("poses", [x, *others], [poses.stacked, poses.by_unknowns, *by_others])


def _stage(model: Model | RelaxedContact, name: str, further: Mapping[str, ca.Function]) -> ca.Function:
    arguments = model.residual.mx_in()
    poses = poses_of(model)
    results = [model.residual(*arguments)]
    for pose in poses.values():
        position, quaternion, _ = pose(*arguments)
        results.append(ca.vertcat(position, quaternion))
    results += [function.call(arguments)[0] for function in further.values()]
    return ca.Function(name, arguments, results, model.residual.name_in(), ["residual", *poses, *further])


def _slopes(model: Model | RelaxedContact, plain: ca.Function, further: Mapping[str, ca.Function]) -> ca.Function:
    """Make ∂ output / ∂ input, output by output, with the Jacobians of the model."""
    arguments = model.residual.mx_in()
    poses = [*model.tip_jacobian.values(), *model.body_jacobian.values()]
    blocks = [model.jacobian(*arguments)[0], model.input_jacobian(*arguments)]
    if model.parameters.size:
        blocks.append(model.parameter_jacobian(*arguments))
    for pose in poses:
        blocks += pose(*arguments)
    for function in further.values():
        blocks += function.call(arguments)[1:]
    return jacobian_of(plain, arguments, blocks)


def bare_second(plain: ca.Function, slopes: ca.Function, adjoint: ca.Function) -> ca.Function:
    """Make the Jacobian of the adjoint by its multipliers alone; the blocks by the arguments are left empty."""
    sizes = [plain.numel_in(i) for i in range(plain.n_in())]
    hessian: list[list[Matrix]] = [[ca.MX(rows, columns) for columns in sizes] for rows in sizes]
    return _second(plain, slopes, adjoint, adjoint.mx_in(), hessian)


def exact_second(plain: ca.Function, slopes: ca.Function, adjoint: ca.Function) -> ca.Function:
    """Make the Jacobian of the adjoint; the blocks by the arguments are computed column by column, in a loop."""
    symbols = adjoint.mx_in()
    arguments = range(plain.n_in())
    sizes = [plain.numel_in(i) for i in arguments]
    hessian: list[list[Matrix]] = [[ca.MX(rows, columns) for columns in sizes] for rows in sizes]
    known = set[int]()
    for j in arguments:
        missing = [i for i in arguments if i not in known]
        if not any(adjoint.jac_sparsity(i, j).nnz() for i in missing):
            # The block mirrors a known one.
            continue
        blocks = _by_directions(adjoint, symbols, j)
        for i in missing:
            hessian[i][j] = blocks[i]
            hessian[j][i] = blocks[i].T
        known.add(j)
    return _second(plain, slopes, adjoint, symbols, hessian)


def _second(
    plain: ca.Function,
    slopes: ca.Function,
    adjoint: ca.Function,
    symbols: Sequence[Matrix],
    hessian: Sequence[Sequence[Matrix]],
) -> ca.Function:
    """Make the Jacobian of the adjoint from its blocks.

    Args:
        plain: the function.
        slopes: its Jacobian, which gives the derivative of the adjoint by its multipliers.
        adjoint: the adjoint.
        symbols: arguments of the adjoint.
        hessian: derivatives of the adjoint by the arguments of the function, block by block.
    """
    count = plain.n_in()
    blocks = slopes.call(symbols[: slopes.n_in()])
    rows: list[Matrix] = []
    for i in range(count):
        rows += hessian[i]
        # The adjoint does not read the outputs of the function, which are arguments of it all the same.
        rows += [ca.MX(plain.numel_in(i), symbol.numel()) for symbol in symbols[count : slopes.n_in()]]
        rows += [block.T for block in blocks[i::count]]
    return jacobian_of(adjoint, symbols, rows)


def _by_directions(adjoint: ca.Function, symbols: Sequence[Matrix], j: int) -> list[Matrix]:
    """Write ∂ adjoint / ∂ argument j, output by output, in symbols of the arguments."""
    along = _along(adjoint, j)
    columns = _columns_with_entries(adjoint, j)
    directions = ca.DM.eye(symbols[j].numel())[:, columns]
    count = len(columns)
    # CasADi does not say of a map with arguments that are the same in all calls which function it calls.
    repeated = [ca.repmat(symbol, 1, count) for symbol in symbols]
    results = along.map(count).call([*repeated, ca.densify(directions)])
    if len(columns) == symbols[j].numel():
        return list(results)
    return [result @ directions.T for result in results]


def _along(adjoint: ca.Function, j: int) -> ca.Function:
    """Make (arguments of the adjoint, direction in argument j) ↦ derivative of the adjoint in that direction."""
    forward = adjoint.forward(1)
    symbols = adjoint.mx_in()
    direction = ca.MX.sym("direction", symbols[j].numel())
    # Outputs are arguments without an entry; other directions are zero and leave no instruction.
    outputs = [ca.MX(*adjoint.size_out(i)) for i in range(adjoint.n_out())]
    directions: list[Matrix] = [ca.MX(*symbol.shape) for symbol in symbols]
    directions[j] = direction
    results = forward.call([*symbols, *outputs, *directions])
    name = f"{adjoint.name()}_along_{adjoint.name_in(j)}"
    whole = ca.Function(name, [*symbols, direction], results, [*adjoint.name_in(), "direction"], adjoint.name_out())
    return written(whole, name)


def _columns_with_entries(adjoint: ca.Function, j: int) -> list[int]:
    """Entries of an argument on which the adjoint depends."""
    patterns = [adjoint.jac_sparsity(i, j) for i in range(adjoint.n_out())]
    columns = {column for pattern in patterns for column in pattern.get_col()}
    return sorted(columns)


def jacobian_of(function: ca.Function, symbols: Sequence[Matrix], blocks: Sequence[Matrix]) -> ca.Function:
    """Make the function that CasADi accepts as a Jacobian of blocks: it also takes the outputs, as empty inputs."""
    outputs = [ca.MX.sym(f"out_{name}", ca.Sparsity(*function.size_out(name))) for name in function.name_out()]
    words_in = [*function.name_in(), *[f"out_{name}" for name in function.name_out()]]
    words_out = [f"jac_{o}_{i}" for o in function.name_out() for i in function.name_in()]
    return ca.Function(f"jac_{function.name()}", [*symbols, *outputs], blocks, words_in, words_out)
