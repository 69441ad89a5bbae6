"""The scene with the identified numbers."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi import scene as scenes
from cosserat_casadi.identification.fit_unknowns import UnknownLayout, parts
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.scene.overrides import assign
from cosserat_casadi.scene.reading import SCENE_KEYS
from cosserat_casadi.scene.writing import scene_tables
from cosserat_casadi.tubes.tube_functions import AnyModel


def with_identified(scene: scenes.Scene, model: AnyModel, layout: UnknownLayout, shared: FloatArray) -> scenes.Scene:
    """Make a scene with the identified values of its parameters and of the inputs that all cases share.

    Args:
        scene: the scene of the unknowns, with or without inputs and parameters.
        model: the fitted model.
        layout: the unknowns.
        shared: identified values of the unknowns, shape (n,).

    Raises:
        SceneError: the scene refuses a number.
    """
    numbers = {entry.name: entry for entry in model.parameters.entries}
    inputs = model.pack()
    fields = []
    for entry, found in parts(layout.shared, shared):
        if entry.of_input:
            inputs[entry.indices] = entry.values(found)
            fields += [owner.name for owner, span in model.inputs if span.start <= entry.indices[0] < span.stop]
        else:
            scene = scene.with_numbers(numbers[entry.record.name], entry.values(found).tolist())
    tables = scene_tables(scene.in_proportion())
    values = model.inputs.unpack(inputs)
    for name in fields:
        _set_input(tables, name, values[name])
    return scenes.scene_from_dict(tables)


def with_inputs(scene: scenes.Scene, values: Mapping[str, FloatArray]) -> scenes.Scene:
    """Make a scene with other values of some of its inputs.

    Args:
        scene: the scene.
        values: values by name, in the shape in which a model unpacks them.
    """
    tables = scene_tables(scene)
    for name, value in values.items():
        _set_input(tables, name, value)
    return scenes.scene_from_dict(tables)


def _set_input(tables: dict[str, Any], name: str, value: FloatArray) -> None:
    """Set an input in its table: a number, a vector, or coefficients for each component."""
    rows = value.tolist()
    plain = [row[0] if len(row) == 1 else row for row in rows]
    if name.endswith("base.quaternion"):
        owner = name.split(".")[0]
        # A base has one of the two.
        for rod in tables["rods"]:
            if rod.get("name") == owner:
                rod.get("base", {}).pop("tangent", None)
        plain = (value[:, 0] / np.linalg.norm(value[:, 0])).tolist()
    assign(tables, name, plain[0] if len(plain) == 1 else plain, SCENE_KEYS)


def beside(scene: scenes.Scene, folder: Path) -> scenes.Scene:
    """Make a scene whose files of measurements are named relative to a folder."""
    measurements = []
    for measurement in scene.measurements:
        file = Path(os.path.relpath(measurement.file, folder)).as_posix()
        measurements.append(measurement.model_copy(update={"file": file}))
    return scene.model_copy(update={"measurements": tuple(measurements)})
