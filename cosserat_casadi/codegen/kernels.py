"""The generated kernels: a function of a model becomes straight-line C, columns, parts of rods, or loops."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from contextlib import suppress

import casadi as ca

from cosserat_casadi.accuracy.cost import MOST_IN_COLUMNS, STRAIGHT, STRAIGHT_BESIDE_INTERVALS, STRAIGHT_IN_SHARES
from cosserat_casadi.codegen import error_sources
from cosserat_casadi.codegen.assembled import Assembled
from cosserat_casadi.codegen.columns import SHARED_AT_MOST, WrittenJacobian, in_columns, on_path, pose_in_columns
from cosserat_casadi.codegen.contact.moving import contact_functions
from cosserat_casadi.codegen.functions_in_c import FunctionInC, differentiable_functions, functions_in_c
from cosserat_casadi.codegen.motion_parts import MotionInC
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import parameter_rate
from cosserat_casadi.codegen.parts import in_one, sharing
from cosserat_casadi.codegen.passages import passage_kernels
from cosserat_casadi.codegen.shared_values import with_shared_kernels
from cosserat_casadi.compiling.listing import UnknownOperationError, length, with_shorter_calls
from cosserat_casadi.compiling.printed_kernels import ColumnForm, Kernel
from cosserat_casadi.compiling.scalars_in_c import ColumnedFunction, with_calls_in_fours
from cosserat_casadi.maths.calls import chooses, has_routines, with_dense_results
from cosserat_casadi.model.build import Model
from cosserat_casadi.model.watched import watched_owners

PARTED = ("path_residual", "path_jacobian")
"""Functions that an assembly replaces by parts, one for each rod."""

RATE = "path_rate"
"""Name of a function that, like the residual, has an entry for each unknown."""

SELDOM = ("igm", "energies", "momentum", error_sources.BALANCE)
"""Functions that Newton's method does not call; long ones are written with loops, whose C is shorter."""

OF_SECTIONS = ("tip_jacobian",)
"""Derivatives of the pose of a section, written by columns if that is shorter than straight-line code."""

MOST_BESIDE_STEPS = 20_000
"""Most statements of a static Jacobian that is written by columns in a folder that also has motions.

A longer one would take most of the time to compile, and steps do not use it.
"""


SHORT = 400
"""Instructions of a function up to which it shares kernels with short ones alone.

To hand over the values that long functions need would take a fifth of its time.
"""


def kernels(model: Model, names: Names, parts: Assembled | None, motion: MotionInC | None = None) -> list[Kernel]:
    """Make the functions of the solver in C, with dense outputs; an assembly has its equations in parts."""
    wanted = functions_in_c(model, names)
    of_motion: list[Kernel] = [] if motion is None else list(motion.kernels)
    if motion is not None:
        of_motion += [kernel(model, function, name) for name, function in contact_functions(model, names).items()]
    of_parameters = [*_parameter_kernels(model, names, parts), *passage_kernels(model, names)]
    if parts is None:
        most = MOST_IN_COLUMNS if motion is None else MOST_BESIDE_STEPS
        return [*_of_one_rod(model, names, wanted, most), *of_parameters, *of_motion]
    every: list[Kernel] = [*parts.kernels, *of_parameters, *of_motion]
    names_of_kind = dict.fromkeys(entry.spec.name for entry in wanted if entry.spec.name not in PARTED)
    for kind in names_of_kind:
        entries = [entry for entry in wanted if entry.spec.name == kind]
        if kind in error_sources.KERNELS:
            every.append(_judging(model, entries[0], parts))
            continue
        plain = [kernel(model, entry.function, entry.kernel, STRAIGHT_IN_SHARES) for entry in entries]
        if not all(function.is_a("SXFunction") for function in plain):
            every += plain
        elif kind == RATE:
            every.append(
                _of_owners(entries[0].function, parts.blocks.parts, entries[0].kernel, STRAIGHT_BESIDE_INTERVALS)
            )
        else:
            shared = sharing([entry.function for entry in entries], plain, names.kernel(f"{kind}_of_each"))
            every += [_unlike(model, *three) for three in zip(entries, plain, shared, strict=True)]
    return every


def _unlike(model: Model, entry: FunctionInC, plain: ca.Function, shared: ca.Function) -> Kernel:
    """Write a function of one rod of an assembly: as for one rod alone, unless it shares code with others."""
    if shared is not plain or plain.n_instructions() <= STRAIGHT:
        return shared
    alone = _written(model, entry, STRAIGHT)
    return alone.printed if isinstance(alone, ColumnedFunction) else alone


def _judging(model: Model, entry: FunctionInC, parts: Assembled) -> ca.Function:
    """Write a function for the error estimate of an assembly; rods with equal instructions share code."""
    discrete = model.discrete
    numbers = {name: number for number, name in enumerate((*discrete.rods, *discrete.bodies))}
    unknowns = parts.blocks.parts
    missing = [numbers[rod] for rod in discrete.richer.missing_rods]
    watched = [numbers[owner] for owner in watched_owners(discrete)]
    owners = {
        error_sources.BALANCE: [*unknowns, *missing, *unknowns, *watched],
        error_sources.WATCHED: watched,
    }[entry.spec.name]
    most = len(discrete.rods) * STRAIGHT_IN_SHARES
    if chooses(entry.function) or _literal(model) or scalar(entry.function, entry.kernel, most) is None:
        return with_dense_results(entry.function, entry.kernel)
    return _of_owners(entry.function, owners, entry.kernel, STRAIGHT)


def _of_owners(function: ca.Function, owners: Sequence[int], name: str, most: int) -> ca.Function:
    """Write a function with one column, whose owners share code if their instructions are equal; else with loops."""
    straight = in_one(function, owners, name, most)
    return with_dense_results(function, name) if straight is None else straight


def _parameter_kernels(model: Model, names: Names, parts: Assembled | None) -> list[ca.Function]:
    """Make the function of the solver for parameters, as a list, empty for a scene without parameters."""
    if not model.parameters.size:
        return []
    name = names.kernel("parameter_rate")
    plain = kernel(model, parameter_rate(model.path_residual, name), name, STRAIGHT_IN_SHARES)
    if parts is None or not plain.is_a("SXFunction"):
        return [plain]
    return [_of_owners(parameter_rate(model.path_residual, name), parts.blocks.parts, name, STRAIGHT)]


def _of_one_rod(model: Model, names: Names, entries: Sequence[FunctionInC], most_in_columns: int) -> list[Kernel]:
    """Make the functions of a scene without parts, with a Jacobian by columns if it has at most so many statements.

    Functions in straight-line code call kernels of the values that they share (shared_values.py).
    """
    written = {entry.kernel: _written(model, entry, most_in_columns) for entry in entries}
    # All unknowns of a scene of one clamped rod are its strains.
    clamped = [rod.size for rod in model.discrete.rods.values()] == [model.size]
    straight: dict[tuple[int, bool], list[ca.Function | ColumnedFunction]] = defaultdict(list)
    finished: dict[str, Kernel] = {}
    for one in written.values():
        function = one.form.function if isinstance(one, ColumnedFunction) else one
        first = function.name_in()[:2]
        if function.is_a("SXFunction") and (first == ["x", "inputs"] or (clamped and first[0] == "q")):
            # The solver takes parameters as further inputs.
            inputs_size = function.size1_in(function.index_in("inputs"))
            straight[inputs_size, function.n_instructions() <= SHORT].append(one)
    for number, functions in enumerate(straight.values()):
        # CasADi prints an operation that is not known here: then these functions share nothing.
        with suppress(UnknownOperationError):
            for shared in with_shared_kernels(functions, names.kernel(f"shared_{number}")):
                finished[shared.name()] = shared
    for name, one in written.items():
        finished.setdefault(name, one.printed if isinstance(one, ColumnedFunction) else one)
    return [finished[name] for name in written]


def _written(model: Model, entry: FunctionInC, most_in_columns: int) -> ca.Function | ColumnedFunction:
    """Write a function of a scene without parts: by columns, as straight-line code, or with loops."""
    if chooses(entry.function):
        return with_dense_results(entry.function, entry.kernel)
    if entry.spec.name == "path_jacobian":
        columned = by_columns(on_path(model), entry.function, entry.kernel, most_in_columns)
        return columned if columned is not None else kernel(model, entry.function, entry.kernel)
    longest = STRAIGHT if entry.spec.name in SELDOM else STRAIGHT_BESIDE_INTERVALS
    straight = None if _literal(model) else scalar(entry.function, entry.kernel, longest)
    # More statements than STRAIGHT are worth it only where calls of intervals are made four at a time.
    if straight is None or (length(straight) > STRAIGHT and isinstance(with_calls_in_fours(straight), ca.Function)):
        return with_dense_results(entry.function, entry.kernel)
    if entry.spec.name in OF_SECTIONS:
        form = pose_in_columns(model, entry.spec, entry.owner or "", entry.kernel)
        columned = None if form is None else _within(form, straight, straight.n_instructions())
        return straight if columned is None else columned
    return straight


def by_columns(
    written: WrittenJacobian, function: ca.Function, name: str, most: int = MOST_IN_COLUMNS
) -> ColumnedFunction | None:
    """Write a Jacobian of one rod by columns; None if it has no such form, or one with too many statements.

    Args:
        written: the Jacobian.
        function: the Jacobian with its signature in C.
        name: name of the Jacobian in C.
        most: largest number of statements.
    """
    form = in_columns(written, name, most)
    return None if form is None else _within(form, with_dense_results(function, name), most)


def _within(form: ColumnForm, signature: ca.Function, most: int) -> ColumnedFunction | None:
    """Give a form a signature; None if it has more statements, or an operation without a form for four numbers."""
    columned = ColumnedFunction(form, signature)
    try:
        return columned if columned.printed.statements <= most else None
    except UnknownOperationError:
        return None


def _literal(model: Model) -> bool:
    """Whether rotations solve the literal linear system with pivoting, which has no scalar form."""
    return any(chosen.transport == "permuted" for chosen in model.discretisation.values())


def kernel(model: Model, function: ca.Function, name: str, straight_within: int = STRAIGHT) -> ca.Function:
    """Make a function with its name in C: in scalars up to so many instructions, else in matrices that become loops."""
    if not (_literal(model) or chooses(function) or has_routines(function)):
        straight = scalar(function, name, straight_within)
        if straight is not None:
            return straight
    return with_dense_results(function, name)


def scalar(function: ca.Function, name: str, most: int) -> ca.Function | None:
    """Write a function in scalars with dense outputs, constants folded and common terms shared.

    Args:
        function: the function in matrices.
        name: name of the function in C.
        most: largest number of instructions; the result is None for a longer function.
    """
    symbols = function.sx_in()
    expressions = list(function.call(symbols))
    if length(ca.Function(name, symbols, expressions)) > SHARED_AT_MOST * most:
        return None
    shared = [ca.densify(expression) for expression in ca.cse(expressions)]
    straight = with_shorter_calls(ca.Function(name, symbols, shared, function.name_in(), function.name_out()))
    return straight if length(straight) <= most else None


def differentiable(model: Model, names: Names) -> list[ca.Function]:
    """Make each function with its forward and reverse derivatives, and the forward derivative of the reverse one.

    They have the names for which ``casadi.external`` searches.
    """
    functions = []
    for entry in differentiable_functions(model, names):
        functions += with_derivatives(kernel(model, entry.function, entry.external))
    return functions


def with_derivatives(plain: ca.Function) -> list[ca.Function]:
    """Return a function, its forward and reverse derivatives, and the forward derivative of the reverse one."""
    reverse = plain.reverse(1)
    return [plain, plain.forward(1), reverse, reverse.forward(1)]
