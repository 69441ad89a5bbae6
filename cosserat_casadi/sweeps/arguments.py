"""Columns of a table that become parameters of one compiled library, which rows that differ in them share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations, product
from typing import Any

import numpy as np

from cosserat_casadi.codegen.contact.checks import check_contact
from cosserat_casadi.errors import ExportError, SceneError
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.build import build
from cosserat_casadi.model.discretise import discretise
from cosserat_casadi.model.parameters import parameter_layout
from cosserat_casadi.scene import Scene, scene_from_dict
from cosserat_casadi.sweeps.sampling import column_ends, farthest_rows
from cosserat_casadi.sweeps.scratch import Scratch

COMPILED_FROM = 1000
"""Least rows with equal parameters for which a library is compiled; a sweep of inputs alone always has one.

To generate and compile one took 13 s for a rod of 12 unknowns where building its model in Python took 0.07 s and a
solve there 5 to 20 ms: the two break even at about a thousand rows. Both costs grow with the size of the equations.
"""

IN_CONTACT_FROM = 512
"""Least rows of one scene in exact contact for which a library is compiled. To find its contacts, to generate and
to compile it took 60 to 90 s of processor time for a rod of 15 unknowns, and a row in Python 0.25 s, in C 1 ms
(``benchmarks/contact_rows.py``)."""


def argument_columns(
    tables: Mapping[str, Any], columns: Sequence[str], chosen: Sequence[int], values: FloatArray, scratch: Scratch
) -> list[int]:
    """Columns that a compiled library takes as parameters; none if too few rows would share it.

    Args:
        tables: tables of the scene.
        columns: columns of the table.
        chosen: columns that are not inputs.
        values: values of the table, shape (rows, columns).
        scratch: storage of the values.
    """
    in_contact = any("width" not in obstacle for obstacle in tables.get("obstacles", []))
    compiled_from = IN_CONTACT_FROM if in_contact else COMPILED_FROM
    # Rows of tubes are not compiled.
    if len(values) < compiled_from or tables.get("tubes"):
        return []
    # A column of one value is a constant, which costs nothing.
    low, high = column_ends(values, scratch)
    varying = [k for k in chosen if high[k] > low[k]]
    arguments = [k for k in varying if accepts_parameters(tables, [columns[k]])]
    rest = [k for k in chosen if k not in arguments]
    if rest:
        _, counts = np.unique(values[:, rest], axis=0, return_counts=True)
        if counts.min() < compiled_from:
            return []
    names = [columns[k] for k in arguments]
    if not names or not accepts_parameters(tables, names):
        return []
    try:
        scene = scene_from_dict({**tables, "parameters": names})
        build(scene, discretise(scene, 1, 2))
    except SceneError:
        # A load may depend on the position of the unloaded rod.
        return []
    return arguments if touches_in_c(scene) or not scene.touches_exactly else []


def touches_in_c(scene: Scene) -> bool:
    """Whether a scene is in exact contact, and C supports all its contents."""
    try:
        check_contact(scene, {})
    except ExportError:
        return False
    # Error estimates of rods that carry bodies need sections between the ends, which C does not have.
    return scene.touches_exactly and not scene.bodies


def accepts_parameters(tables: Mapping[str, Any], names: Sequence[str]) -> bool:
    """Whether columns are parameters of the scene, of one number each."""
    try:
        scene = scene_from_dict({**tables, "parameters": list(names)})
    except SceneError:
        return False
    return parameter_layout(scene).size == len(names)


def extreme_rows(values: FloatArray, scratch: Scratch) -> list[int]:
    """Rows that are tested instead of all rows: the rows nearest to the corners of every two columns.

    A scene refuses numbers beyond a bound, or two numbers in the wrong order; these rows are the first to be refused.

    Args:
        values: shape (rows, columns).
        scratch: storage of the values.
    """
    low, high = column_ends(values, scratch)
    columns = values.shape[1]
    ends = np.concatenate([-np.eye(columns), np.eye(columns)])
    corners = np.zeros((0, columns))
    for one, other in combinations(range(columns), 2):
        for signs in product((-1.0, 1.0), repeat=2):
            corner = np.zeros((1, columns))
            corner[0, [one, other]] = signs
            corners = np.concatenate([corners, corner])
    origin = np.zeros(columns)
    same = np.ones(columns)
    chosen = [0, *farthest_rows(values, ends, origin, same, scratch)]
    chosen += farthest_rows(values, corners, low, high - low, scratch)
    # In the common unit of both, the row in which one number comes nearest to exceeding the other.
    chosen += farthest_rows(values, corners, origin, same, scratch)
    return list(dict.fromkeys(chosen))
