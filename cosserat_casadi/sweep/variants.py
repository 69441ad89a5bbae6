"""What the columns of a table are to a scene: inputs at run time, or parameters that make another scene.

A column that may be an input is made one, whatever the scene's own ``inputs`` say, and all else is baked in: a load or
a cable, the length of a rod, its base. Other columns are what ``--set`` takes, such as ``wire.section.radius``. Rows
of equal parameters share a scene.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.inputs import InputLayout, input_layout
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.model.rank import check_constraints
from cosserat_casadi.scene import Scene, scene_from_dict
from cosserat_casadi.scene.reading import place_of
from cosserat_casadi.scene.writing import scene_tables
from cosserat_casadi.sweep.table import Table, shortened

NOT_PARAMETERS = ("schema", "title", "inputs", "accuracy", "targets", "bounds")
"""Tables of a scene that are no property of what is computed."""


STIFFNESS = ("material", "section", "stiffness", "linear_density")
"""Tables and numbers of a rod that say how it yields, not where it is."""


@dataclass(frozen=True)
class Variant:
    """Rows of equal parameters.

    Attributes:
        scene: the scene with these parameters, its inputs those that are swept.
        rows: places in the table, shape (k,).
    """

    scene: Scene
    rows: npt.NDArray[np.int64]


@dataclass(frozen=True)
class Variants:
    """A table seen by a scene.

    Attributes:
        entries: scenes, in the order in which the table meets them.
        inputs: stacked inputs of every row of the table, shape (rows, size).
        layout: of the inputs.
        parameters: columns that are no inputs.
    """

    entries: tuple[Variant, ...]
    inputs: FloatArray
    layout: InputLayout
    parameters: tuple[str, ...]

    def of_row(self, row: int) -> Variant:
        """The scene that a row belongs to."""
        return next(entry for entry in self.entries if row in entry.rows)


def variants(scene: Scene, table: Table) -> Variants:
    """The scenes and inputs that a table asks for.

    Raises:
        SceneError: with every fault: a column that is neither input nor parameter, a value that makes no sense.
    """
    free = _freed(scene, table.columns)
    layout = input_layout(free)
    places = column_indices(layout)
    chosen = [k for k, column in enumerate(table.columns) if column in places]
    others = [k for k in range(len(table.columns)) if k not in chosen]
    inputs = np.tile(layout.pack(), (len(table.values), 1))
    inputs[:, [places[table.columns[k]] for k in chosen]] = table.values[:, chosen]
    parameters = tuple(table.columns[k] for k in others)
    problems = [*_set_twice(free, [*layout.names, *parameters], table), *_refused_inputs(free, layout, inputs, table)]
    entries = list(_entries(free, table, others, problems))
    if problems:
        raise SceneError(*shortened(problems, table.where))
    return Variants(tuple(entries), inputs, layout, parameters)


def _freed(scene: Scene, columns: Sequence[str]) -> Scene:
    """The scene whose inputs are those that columns name, and no other."""
    tables = {key: value for key, value in scene_tables(scene).items() if key not in ("targets", "bounds")}
    wanted: list[str] = []
    for name in dict.fromkeys(_input_name(column) for column in columns):
        try:
            scene_from_dict(tables | {"inputs": [name]})
        except SceneError:
            continue
        wanted.append(name)
    return scene_from_dict(tables | {"inputs": wanted})


def _input_name(column: str) -> str:
    """``push.force`` of ``push.force.x.1``, ``leg.base.position`` of ``leg.base.position.x``."""
    words = column.split(".")
    return ".".join(words[: 3 if words[1:2] == ["base"] else 2])


def _set_twice(scene: Scene, names: Sequence[str], table: Table) -> Iterator[Problem]:
    """Names of inputs and parameters that set one thing: one of them would count for nothing."""
    tables, places = scene_tables(scene), dict[str, tuple[str | int, ...]]()
    for name in names:
        # What is not there to be set is told with the row that would set it.
        with suppress(SceneError):
            # A tangent is one more way to give the orientation.
            places[name] = place_of(tables, name.replace(".base.tangent", ".base.quaternion"))
    for (one, first), (other, second) in combinations(places.items(), 2):
        shared = min(len(first), len(second))
        if first[:shared] == second[:shared]:
            remedy = "name what is swept in one way: push.force.x, wire.section.radius"
            yield Problem(table.where, f"{other!r} sets what {one!r} sets", remedy)


def _entries(scene: Scene, table: Table, parameters: Sequence[int], problems: list[Problem]) -> Iterator[Variant]:
    if not parameters:
        try:
            check_constraints(scene)
        except SceneError as error:
            problems += error.problems
        yield Variant(scene, np.arange(len(table.values)))
        return
    names = [table.columns[k] for k in parameters]
    reserved = [c for c in names if c.replace("[", ".").split(".")[0] in NOT_PARAMETERS]
    problems += [Problem(table.where, f"{c!r} cannot be swept", "change it with --set for all rows") for c in reserved]
    if not reserved:
        yield from _scenes(scene_tables(scene), table, parameters, problems)


def _scenes(
    tables: Mapping[str, Any], table: Table, parameters: Sequence[int], problems: list[Problem]
) -> Iterator[Variant]:
    """A scene for each set of parameters; a fault is told once, with the first row that has it."""
    columns = [table.columns[k] for k in parameters]
    seen, moved = set[str](), any(_moves_joints(tables, column) for column in columns)
    for values, rows in _groups(table.values[:, list(parameters)]):
        overrides = [f"{column}={float(value)!r}" for column, value in zip(columns, values, strict=True)]
        try:
            variant = Variant(scene_from_dict(tables, overrides), rows)
            # Building a model would find it too, but in a worker; it takes as long as that.
            if moved or rows[0] == 0:
                check_constraints(variant.scene)
            yield variant
        except SceneError as error:
            for problem in error.problems:
                if str(problem) not in seen:
                    seen.add(str(problem))
                    problems.append(_told(problem, table, int(rows[0])))


def _moves_joints(tables: Mapping[str, Any], column: str) -> bool:
    """Whether what joints hold may depend on a parameter."""
    try:
        table, *_, field = place_of(tables, column)[:3]
    except SceneError:
        return False
    return table != "actuators" and field not in STIFFNESS


def _groups(values: FloatArray) -> Iterator[tuple[FloatArray, npt.NDArray[np.int64]]]:
    """Distinct rows in the order in which they first come, each with the places where it stands."""
    distinct, first, which = np.unique(values, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    places = np.split(np.argsort(which.ravel(), kind="stable"), np.cumsum(np.bincount(which.ravel()))[:-1])
    for group in order:
        yield distinct[group], places[group]


def _told(problem: Problem, table: Table, row: int) -> Problem:
    """A fault of an override as one of the table."""
    if problem.where.startswith("--set "):
        return Problem(f"{table.place(row)}, {problem.where.removeprefix('--set ')}", problem.problem, problem.remedy)
    return Problem(f"{table.place(row)}, {problem.where}", problem.problem, problem.remedy)


def _refused_inputs(scene: Scene, layout: InputLayout, inputs: FloatArray, table: Table) -> Iterator[Problem]:
    """Values of inputs that the scene itself could not have."""
    for name, place in layout.slices.items():
        values = inputs[:, place]
        if name.endswith(".base.quaternion"):
            zero = np.flatnonzero(~np.any(values, axis=1))
            if zero.size:
                yield Problem(f"{table.place(int(zero[0]))}, {name}", "must not be zero")
        elif values.shape[1] == 1:
            yield from _refused_numbers(scene, name, values[:, 0], table)


def _refused_numbers(scene: Scene, name: str, values: FloatArray, table: Table) -> Iterator[Problem]:
    """A number such as a tension is refused where the scene refuses it; all between two that it takes are taken."""
    tables = scene_tables(scene)
    for row in dict.fromkeys((int(np.argmin(values)), int(np.argmax(values)))):
        try:
            scene_from_dict(tables, [f"{name}={float(values[row])!r}"])
        except SceneError as error:
            yield from (_told(problem, table, row) for problem in error.problems)
