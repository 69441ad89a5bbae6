"""Columns of a table as parts of a scene: inputs at run time, or parameters.

A column that may be an input becomes one, regardless of the scene's ``inputs``, and all else is constant: a load or
a cable, the length of a rod, its base. Other columns are keys as for ``--set``, such as ``wire.section.radius``. In a
table of many rows the columns that may be parameters of a model are arguments of one compiled library. Other columns
make another scene for each set of values, which rows of equal values share.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError, collect_problems, refuse
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.model.constraint_rank import check_constraints
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.model.parameters import parameter_layout
from cosserat_casadi.scene import Scene, scene_from_dict
from cosserat_casadi.scene.faults import listing
from cosserat_casadi.scene.number_table import shortened
from cosserat_casadi.scene.reading import override_path
from cosserat_casadi.scene.writing import scene_tables
from cosserat_casadi.sweeps.arguments import accepts_parameters, argument_columns, extreme_rows
from cosserat_casadi.sweeps.sampling import farthest_rows
from cosserat_casadi.sweeps.scratch import Scratch
from cosserat_casadi.sweeps.table import Table
from cosserat_casadi.tubes.robot import robot_of

NOT_PARAMETERS = ("schema", "title", "inputs", "accuracy", "targets", "bounds", "simulation", "motions", "velocities")
"""Tables of a scene that do not change the computed results."""

STIFFNESS = ("material", "section", "stiffness", "linear_density")
"""Tables and numbers of a rod that change its elasticity or mass, not its pose."""


@dataclass(frozen=True)
class Variant:
    """Rows of one scene.

    Attributes:
        scene: the scene, with the swept inputs as inputs and the arguments of its library as parameters.
        rows: indices of its rows in the table, shape (k,).
    """

    scene: Scene
    rows: npt.NDArray[np.int64]


@dataclass(frozen=True)
class Variants:
    """The rows of a table as scenes, inputs and parameters.

    Attributes:
        nominal: the given scene, with the swept inputs as inputs.
        entries: scenes, in the order of their first rows.
        inputs: stacked inputs of every row of the table, shape (rows, size).
        layout: layout of the inputs.
        parameters: columns that are not inputs.
        arguments: columns among these that libraries take as parameters.
        p: values of the arguments in every row of the table, shape (rows, arguments).
    """

    nominal: Scene
    entries: tuple[Variant, ...]
    inputs: FloatArray
    layout: InputLayout
    parameters: tuple[str, ...]
    arguments: tuple[str, ...]
    p: FloatArray

    def scene_of_row(self, row: int) -> Scene:
        """The scene of a row, with constants as all its numbers."""
        # A single scene has all rows, which need no search.
        holders = self.entries if len(self.entries) == 1 else [e for e in self.entries if row in e.rows]
        scene = holders[0].scene
        if not self.arguments:
            return scene
        return _overridden(scene_tables(scene.baked()), self.arguments, self.p[row], scene.input_names())

    def given(self, rows: npt.NDArray[np.int64]) -> FloatArray:
        """Arguments of a library for rows: inputs followed by parameters."""
        return np.hstack([self.inputs[rows], self.p[rows]])

    def inputs_of_row(self, row: int) -> dict[str, FloatArray]:
        """Inputs of a row by name."""
        return self.layout.unpack(self.inputs[row])

    def with_potential(self, chosen: Iterable[int], scratch: Scratch) -> npt.NDArray[np.bool_]:
        """Whether the loads of each row have a potential, so that stability is defined, shape (rows,).

        This depends only on which inputs and parameters are zero: one row of each pattern of zeros is tested.

        Args:
            chosen: indices of the scenes with rows to test; rows of other scenes count as having a potential.
            scratch: storage for the result.
        """
        judged: npt.NDArray[np.bool_] = scratch.array((len(self.inputs),), np.bool_)
        judged[:] = True
        for variant in chosen:
            rows_of_variant = self.entries[variant].rows
            verdicts: dict[bytes, bool] = {}
            for block in scratch.blocks(len(rows_of_variant)):
                rows = rows_of_variant[block]
                patterns, first, pattern_of_row = np.unique(
                    self.given(rows) != 0.0, axis=0, return_index=True, return_inverse=True
                )
                for pattern, row in zip(patterns, rows[first].tolist(), strict=True):
                    if pattern.tobytes() not in verdicts:
                        scene = self.scene_of_row(row)
                        # The coarsest model serves, since all models have these loads.
                        coarsest = build(scene, discretise(scene, 1, 2))
                        verdicts[pattern.tobytes()] = coarsest.has_potential(self.inputs[row])
                of_patterns = np.array([verdicts[pattern.tobytes()] for pattern in patterns])
                judged[rows] = of_patterns[pattern_of_row.ravel()]
        return judged


def variants_of(scene: Scene, table: Table) -> Variants:
    """The scenes and inputs of the rows of a table.

    Raises:
        SceneError: with every fault: a column that is neither input nor parameter, a value that makes no sense.
    """
    free = _with_swept_inputs(scene, table.columns)
    layout = input_layout(free)
    index_of = column_indices(layout)
    refuse(_named_whole(table, layout, index_of))
    input_columns = [k for k, column in enumerate(table.columns) if column in index_of]
    parameter_columns = [k for k, column in enumerate(table.columns) if column not in index_of]
    inputs = table.scratch.array((len(table.values), layout.size))
    indices = [index_of[table.columns[k]] for k in input_columns]
    for block in table.scratch.blocks(len(inputs)):
        inputs[block] = layout.pack()
        inputs[block, indices] = table.values[block, input_columns]
    parameters = tuple(table.columns[k] for k in parameter_columns)
    reserved = any(_is_reserved(name) for name in parameters)
    tables = scene_tables(free)
    argument_indices = (
        [] if reserved else argument_columns(tables, table.columns, parameter_columns, table.values, table.scratch)
    )
    arguments = tuple(table.columns[k] for k in argument_indices)
    p = table.scratch.array((len(table.values), len(arguments)))
    for block in table.scratch.blocks(len(p)):
        p[block] = table.values[block, argument_indices]
    problems = list(_set_twice(free, [*layout.names, *parameters], table))
    if not scene.tubes:
        problems += _refused_inputs(free, layout, inputs, table)
    if arguments:
        free = scene_from_dict({**tables, "parameters": list(arguments)})
        problems += _refused_rows(free, table, arguments, p)
    others = [k for k in parameter_columns if k not in argument_indices]
    entries = list(_entries(free, table, others, problems))
    if scene.tubes:
        problems += _refused_tubes(entries, inputs, table)
    refuse(shortened(problems, table.where))
    return Variants(free.baked(), tuple(entries), inputs, layout, parameters, arguments, p)


def _named_whole(table: Table, layout: InputLayout, index_of: Mapping[str, int]) -> Iterator[Problem]:
    """Faults of columns with the name of an input of several numbers, which every row would refuse."""
    for name in layout.names:
        if name in table.columns and name not in index_of:
            entries = [column for column in index_of if column.startswith(f"{name}.")]
            problem = f"{name!r} has {len(entries)} numbers, and a column is one"
            yield Problem(table.where, problem, listing(entries, "name its entries"))


def _overridden(
    tables: Mapping[str, Any], names: Sequence[str], values: FloatArray, inputs: Sequence[str] | None = None
) -> Scene:
    """The scene with other numbers, and with these inputs if given.

    A number has its name for ``--set``, or for ``parameters``, such as ``wire.intrinsic.curvature.y``.
    """
    overrides = []
    numbers = {}
    for name, value in zip(names, values, strict=True):
        if _is_named_as_parameter(tables, name):
            numbers[name] = float(value)
        else:
            overrides.append(f"{name}={float(value)!r}")
    given = tables if inputs is None else {**tables, "inputs": list(inputs)}
    if not numbers:
        return scene_from_dict(given, overrides)
    scene = scene_from_dict({**given, "parameters": list(numbers)}, overrides)
    return parameter_layout(scene).set_in(scene, numbers)


def _is_named_as_parameter(tables: Mapping[str, Any], name: str) -> bool:
    """Whether a name is valid for a parameter, but not for ``--set``."""
    try:
        override_path(tables, name)
    except SceneError:
        return accepts_parameters(tables, [name])
    return False


def _refused_rows(scene: Scene, table: Table, names: Sequence[str], values: FloatArray) -> Iterable[Problem]:
    """Faults of the rows that would be refused first, for these values of some columns."""
    tables = scene_tables(scene.baked())
    joints_move = any(_moves_joints(tables, name) for name in names)
    found: dict[str, Problem] = {}
    for row in extreme_rows(values, table.scratch):
        try:
            changed = _overridden(tables, names, values[row])
            if joints_move:
                check_constraints(changed)
        except SceneError as error:
            for problem in error.problems:
                found.setdefault(str(problem), _of_table(problem, table, row))
    return found.values()


def _with_swept_inputs(scene: Scene, columns: Sequence[str]) -> Scene:
    """The scene with the inputs that columns name, and no others; tubes have all inputs."""
    if scene.tubes:
        return scene
    tables = scene_tables(scene)
    # Targets and bounds may name inputs that are constants in a sweep.
    tables.pop("targets", None)
    tables.pop("bounds", None)
    possible = [f"{record.name}.{field}" for record in (*scene.input_owners, *scene.rods) for field in record.inputs]
    # A column adds an axis and a degree to the name of its input: ``push.force.x.1`` belongs to ``push.force``.
    named = [[name for name in possible if f"{column}.".startswith(f"{name}.")] for column in columns]
    names = dict.fromkeys(max(of_column, key=len) for of_column in named if of_column)
    inputs = [name for name in names if _may_be_input(tables, name)]
    return scene_from_dict({**tables, "inputs": inputs})


def _may_be_input(tables: Mapping[str, Any], name: str) -> bool:
    """Whether the scene accepts a name among its inputs."""
    try:
        scene_from_dict({**tables, "inputs": [name]})
    except SceneError:
        return False
    return True


def _set_twice(scene: Scene, names: Sequence[str], table: Table) -> Iterator[Problem]:
    """Faults of names of inputs and parameters that set one number: one of them would have no effect."""
    tables = scene_tables(scene)
    paths: dict[str, tuple[str | int, ...]] = {}
    for name in names:
        # A missing key is reported with the row that would set it.
        with suppress(SceneError):
            # A tangent is another notation of the orientation.
            paths[name] = override_path(tables, name.replace(".base.tangent", ".base.quaternion"))
    for (first, first_path), (second, second_path) in combinations(paths.items(), 2):
        # If one path is within the other, setting the shorter one sets the longer one too.
        shared = min(len(first_path), len(second_path))
        if first_path[:shared] == second_path[:shared]:
            remedy = "name each swept number once: push.force.x, wire.section.radius"
            yield Problem(table.where, f"{second!r} sets what {first!r} sets", remedy)


def _entries(
    scene: Scene,
    table: Table,
    parameter_columns: Sequence[int],
    problems: list[Problem],
) -> Iterator[Variant]:
    """The variants of a table; faults are added to the problems."""
    if not parameter_columns:
        with collect_problems(problems):
            check_constraints(scene)
        rows = table.scratch.array((len(table.values),), np.int64)
        for block in table.scratch.blocks(len(rows)):
            rows[block] = np.arange(block.start, block.stop)
        yield Variant(scene, rows)
        return
    reserved = [table.columns[k] for k in parameter_columns if _is_reserved(table.columns[k])]
    for column in reserved:
        problem = f"{column!r} cannot be swept"
        example = "sweep an input or a number of a part, such as push.force.x, or change it with --set for all rows"
        problems.append(Problem(table.where, problem, example))
    if not reserved:
        yield from _scenes(scene_tables(scene), table, parameter_columns, problems)


def _is_reserved(column: str) -> bool:
    """Whether a column is in a table of the scene that does not change the computed results."""
    first_key = column.replace("[", ".").split(".")[0]
    return first_key in NOT_PARAMETERS


def _scenes(
    tables: Mapping[str, Any],
    table: Table,
    parameter_columns: Sequence[int],
    problems: list[Problem],
) -> Iterator[Variant]:
    """A scene for each set of parameters; a fault is reported once, with its first row."""
    columns = [table.columns[k] for k in parameter_columns]
    joints_move = any(_moves_joints(tables, column) for column in columns)
    found: dict[str, Problem] = {}
    for values, rows in _groups(table.values[:, list(parameter_columns)]):
        try:
            variant = Variant(_overridden(tables, columns, values), rows)
            # Building a model would find it too, but only in a worker, and the test takes as long as that.
            if joints_move or rows[0] == 0:
                check_constraints(variant.scene)
            yield variant
        except SceneError as error:
            for problem in error.problems:
                found.setdefault(str(problem), _of_table(problem, table, int(rows[0])))
    problems.extend(found.values())


def _moves_joints(tables: Mapping[str, Any], column: str) -> bool:
    """Whether what joints hold may depend on a parameter."""
    try:
        table, *_, field = override_path(tables, column)[:3]
    except SceneError:
        return False
    return table != "actuators" and field not in STIFFNESS


def _groups(values: FloatArray) -> Iterator[tuple[FloatArray, npt.NDArray[np.int64]]]:
    """Distinct rows in the order in which they first come, each with the numbers of the rows that are equal to it."""
    distinct, first, group_of_row = np.unique(values, axis=0, return_index=True, return_inverse=True)
    group_of_row = group_of_row.ravel()
    # Rows sorted by group, then cut where a group ends.
    by_group = np.argsort(group_of_row, kind="stable")
    ends = np.cumsum(np.bincount(group_of_row))[:-1]
    rows = np.split(by_group, ends)
    for group in np.argsort(first):
        yield distinct[group], rows[group]


def _of_table(problem: Problem, table: Table, row: int) -> Problem:
    """A fault of an override as one of the table."""
    # Parameters are set as overrides, which a reader of the table has not written.
    column = problem.where.removeprefix("--set ")
    where = f"{table.where_of(row)}, {column}"
    return Problem(where, problem.problem, problem.remedy)


def _refused_inputs(
    scene: Scene,
    layout: InputLayout,
    inputs: FloatArray,
    table: Table,
) -> Iterator[Problem]:
    """Values of inputs that the scene itself could not have."""
    for name, entries in layout.slices.items():
        values = inputs[:, entries]
        if name.endswith(".base.quaternion"):
            for block in table.scratch.blocks(len(values)):
                zero_rows = np.flatnonzero(~np.any(values[block], axis=1))
                if zero_rows.size:
                    where = table.where_of(block.start + int(zero_rows[0]))
                    yield Problem(f"{where}, {name}", "must not be zero")
                    break
        elif values.shape[1] == 1:
            yield from _refused_numbers(scene, name, values, table)


def _refused_tubes(entries: Sequence[Variant], inputs: FloatArray, table: Table) -> Iterator[Problem]:
    """Rows of inputs beyond the ranges of their tubes, or at which no tube stands out of the plate."""
    for entry in entries:
        robot = robot_of(entry.scene)
        for row in entry.rows.tolist():
            try:
                robot.packed(inputs[row])
            except SceneError as error:
                for problem in error.problems:
                    yield Problem(table.where_of(row), f"{problem.where} {problem.problem}", problem.remedy)


def _refused_numbers(
    scene: Scene,
    name: str,
    values: FloatArray,
    table: Table,
) -> Iterator[Problem]:
    """A number such as a tension is refused where the scene refuses it; all between two that it takes are taken."""
    tables = scene_tables(scene)
    ends = np.array([[-1.0], [1.0]])
    for row in dict.fromkeys(farthest_rows(values, ends, np.zeros(1), np.ones(1), table.scratch)):
        try:
            scene_from_dict(tables, [f"{name}={float(values[row, 0])!r}"])
        except SceneError as error:
            yield from (_of_table(problem, table, row) for problem in error.problems)
