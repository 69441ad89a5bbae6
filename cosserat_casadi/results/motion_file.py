"""The files of a motion: complete JSON, CSV and Parquet with one row per time, NPZ with arrays by dotted name.

pyarrow is an extra and is imported inside functions only.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from cosserat_casadi.errors import Problem, SceneError
from cosserat_casadi.files import write_atomically
from cosserat_casadi.maths.calls import evaluated
from cosserat_casadi.maths.typing import FloatArray
from cosserat_casadi.model.load_cases import column_indices
from cosserat_casadi.motion.checkpoint import KEY
from cosserat_casadi.motion.event_restart import ContactEvent
from cosserat_casadi.motion.pose_series import Poses
from cosserat_casadi.motion.trajectory import Motion
from cosserat_casadi.results.contact_entry import contact_entry, rubbing_entries
from cosserat_casadi.results.json_text import SCHEMA, plain
from cosserat_casadi.results.presentation import NamedArrays
from cosserat_casadi.results.solution_file import listed_abscissae
from cosserat_casadi.sweeps.outcome_file import arrow_module

FORMATS = (".json", ".csv", ".parquet", ".npz")
"""Suffixes of files of a motion."""

POSITION_COLUMNS = ("x", "y", "z")
QUATERNION_COLUMNS = ("qw", "qx", "qy", "qz")
"""Endings of the columns of a pose: position in m, quaternion."""

Column = tuple[str, FloatArray]
"""Name and values over time, shape (T,)."""


def check_motion_path(path: str | Path) -> None:
    """Refuse a file that cannot be written, before the motion is computed.

    Raises:
        SceneError: the suffix is none of FORMATS.
        ParquetUnavailableError: it is Parquet, and pyarrow is not installed.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        problem = f"{path} has no suffix of a file that a motion can be written to"
        raise SceneError(Problem("--output", problem, f"use one of {', '.join(FORMATS)}"))
    if suffix == ".parquet":
        arrow_module()


def motion_columns(motion: Motion) -> dict[str, FloatArray]:
    """A motion as named columns over time, each of shape (T,), SI units.

    ``t``; inputs as ``push.force.x``; rods as ``rod.tip.x`` … ``rod.tip.qz`` and ``rod.X=0.5.x``; bodies as
    ``platform.x`` … ``platform.qz``; actuators as ``cable.tension`` and ``cable.length``; ``energy.kinetic`` … An
    effort or a conjugate that is also an input has only the column of the input.
    """
    columns: dict[str, FloatArray] = {}
    for name, values in _columns(motion):
        columns.setdefault(name, values)
    return columns


def motion_result(motion: Motion) -> dict[str, Any]:
    """All data of a motion, with numpy arrays instead of lists."""
    model = motion.model
    scene = model.scene
    data: dict[str, Any] = {
        **_head(motion),
        "times": motion.times,
        "inputs": _inputs_over_time(motion),
        "discretisation": model.resolution,
        "rods": {name: _rod_entry(motion, name) for name in model.discrete.rods},
    }
    # Tables of absent kinds of objects are left out.
    if scene.listed_bodies:
        data["bodies"] = {body.name: _pose_entry(motion.body(body.name)) for body in scene.listed_bodies}
    if scene.actuators:
        data["actuators"] = {actuator.name: _actuator_entry(motion, actuator.name) for actuator in scene.actuators}
    if model.joint:
        data["joints"] = {name: _joint_entry(motion, name) for name in model.joint}
    if scene.has_contact:
        data["contact"] = _contact_entry(motion)
    elif motion.events:
        data["events"] = _events_entry(motion)
    data["energy"] = asdict(motion.energy)
    if motion.events:
        data["energy"]["impacts_spread"] = motion.impacts_spread
    if motion.end is not None:
        data[KEY] = motion.end.to_data()
    return data


def motion_arrays(motion: Motion) -> NamedArrays:
    """The arrays of a motion over ``time``: inputs, rods, bodies, actuators, joints and energies, SI units."""
    model = motion.model
    arrays = NamedArrays(
        coordinates={"time": ("time", motion.times, {"units": "s"}), "axis": list("xyz"), "quaternion": list("wxyz")},
        attributes={"title": model.scene.title or "", **{key: _head(motion)[key] for key in ("outcome", "message")}},
    )
    if motion.error_estimate is not None:
        arrays.attributes["error_estimate"] = motion.error_estimate
    units = {entry.name: entry.declared.unit for entry in model.scene.free_inputs()}
    for name, values in _inputs_over_time(motion).items():
        axes = tuple(f"{name}.{number}" for number in range(1, values.ndim))
        if values.shape[-1] == 3 and values.ndim > 1:
            axes = (*axes[:-1], "axis")
        arrays.add(name, ("time", *axes), values, units[name])
    for name in model.discrete.rods:
        entry = _rod_entry(motion, name)
        _add_pose(arrays, f"{name}.tip", entry["tip"])
        arrays.coordinates[f"{name}.X"] = entry["X"]
        arrays.add(f"{name}.position", ("time", f"{name}.X", "axis"), entry["position"], "m")
    for body in model.scene.listed_bodies:
        _add_pose(arrays, body.name, _pose_entry(motion.body(body.name)))
    numbers = {actuator.name: _actuator_entry(motion, actuator.name) for actuator in model.scene.actuators}
    numbers |= {name: _joint_entry(motion, name) for name in model.joint}
    for name, quantities in numbers.items():
        for quantity, values in quantities.items():
            arrays.add(f"{name}.{quantity}", ("time",), values)
    for quantity, values in asdict(motion.energy).items():
        arrays.add(f"energy.{quantity}", ("time",), values, "" if quantity == "imbalance" else "J")
    return arrays


def _add_pose(arrays: NamedArrays, name: str, pose: dict[str, FloatArray]) -> None:
    arrays.add(f"{name}.position", ("time", "axis"), pose["position"], "m")
    arrays.add(f"{name}.quaternion", ("time", "quaternion"), pose["quaternion"])


def _contact_entry(motion: Motion) -> dict[str, Any]:
    """Contact with obstacles: depths for obstacles with a width, contacts and impacts for obstacles without."""
    if not motion.model.scene.touches_exactly:
        entry = contact_entry(motion.model, motion.x, motion.inputs)
        return entry | rubbing_entries(motion, len(motion.times))
    numbered = [(row, contact) for row, contacts in enumerate(motion.contacts) for contact in contacts]
    contacts = [contact for _, contact in numbered]
    friction = {}
    if motion.model.scene.rubs_exactly:
        forces = [np.zeros(3) if contact.friction is None else contact.friction for contact in contacts]
        slips = np.array([contact.slips for contact in contacts], dtype=bool)
        friction = {"friction": np.array(forces).reshape(-1, 3), "slips": slips}
    rods = {}
    if motion.model.scene.rods_touch_exactly:
        rods = {"at_other": [contact.at_other for contact in contacts]}
    return {
        "kind": "exact",
        "row": np.array([row for row, _ in numbered], dtype=int),
        "obstacle": [contact.obstacle for contact in contacts],
        "rod": [contact.owner for contact in contacts],
        "at": np.array([contact.at for contact in contacts]),
        "of_body": [contact.of_body for contact in contacts],
        "force": np.array([contact.force for contact in contacts]).reshape(-1, 3),
        "lies": np.array([contact.lies for contact in contacts], dtype=bool),
        **rods,
        **friction,
        "events": _events_entry(motion),
    }


def _events_entry(motion: Motion) -> dict[str, list[Any]]:
    """Events of contact or cables, one list for each of their fields."""
    return {name: [getattr(event, name) for event in motion.events] for name in ContactEvent.__dataclass_fields__}


def _head(motion: Motion) -> dict[str, Any]:
    """Time-independent entries of a motion."""
    return {
        "title": motion.model.scene.title,
        "converged": motion.converged,
        "outcome": motion.outcome.label,
        "message": motion.message,
        "warnings": list(motion.warnings),
        "error_estimate": motion.error_estimate,
        "within_tolerance": motion.within_tolerance,
        "start": motion.start,
        "steps": motion.statistics.steps,
        "statistics": asdict(motion.statistics),
    }


def _inputs_over_time(motion: Motion) -> dict[str, FloatArray]:
    """Every input at the T times: shape (T,) for a number, (T, 3) for a vector, (T, k, 3) for Legendre coefficients."""
    inputs = {}
    for entry, entries in motion.model.inputs:
        components, degrees = entry.shape
        # Coefficients are rows, as in other result files.
        values = motion.inputs[:, entries].reshape(-1, degrees, components)
        if degrees == 1:
            values = values[:, 0, :]
        if entry.size == 1:
            values = values[:, 0]
        inputs[entry.name] = values
    return inputs


def _rod_entry(motion: Motion, name: str) -> dict[str, Any]:
    X = listed_abscissae(motion.model.element_ends(name))
    sections = motion.section(name, X)
    return {
        "tip": _pose_entry(motion.tip(name)),
        "X": X,
        "position": sections.position,
    }


def _pose_entry(poses: Poses) -> dict[str, FloatArray]:
    return {"position": poses.position, "quaternion": poses.quaternion}


def _actuator_entry(motion: Motion, name: str) -> dict[str, FloatArray]:
    """Effort and conjugate of an actuator by their names, such as tension and length."""
    function = motion.model.actuator[name]
    states = motion.actuator(name)
    return {function.name_out(0): states.effort, function.name_out(1): states.conjugate}


def _joint_entry(motion: Motion, name: str) -> dict[str, FloatArray]:
    """Effort and coordinate of a joint by their keys, such as moment and angle, and the effort of stops."""
    function = motion.model.joint[name]
    values = evaluated(function, motion.x, motion.inputs)
    return {key: value[:, 0, 0] for key, value in zip(function.name_out(), values, strict=True)}


def _columns(motion: Motion) -> Iterator[Column]:
    model = motion.model
    yield "t", motion.times
    for column, index in column_indices(model.inputs).items():
        yield column, motion.inputs[:, index]
    for name in model.discrete.rods:
        yield from _pose_columns(f"{name}.tip", motion.tip(name))
        X = listed_abscissae(model.element_ends(name))
        positions = motion.section(name, X).position
        for index, abscissa in enumerate(X.tolist()):
            yield from _vector_columns(f"{name}.X={abscissa:g}", positions[:, index], POSITION_COLUMNS)
    for body in model.scene.listed_bodies:
        yield from _pose_columns(body.name, motion.body(body.name))
    for actuator in model.scene.actuators:
        for quantity, values in _actuator_entry(motion, actuator.name).items():
            yield f"{actuator.name}.{quantity}", values
    for name in model.joint:
        for quantity, values in _joint_entry(motion, name).items():
            if f"{name}.{quantity}" not in model.inputs.names:
                yield f"{name}.{quantity}", values
    for energy, values in asdict(motion.energy).items():
        yield f"energy.{energy}", values


def _pose_columns(name: str, poses: Poses) -> Iterator[Column]:
    yield from _vector_columns(name, poses.position, POSITION_COLUMNS)
    yield from _vector_columns(name, poses.quaternion, QUATERNION_COLUMNS)


def _vector_columns(name: str, values: FloatArray, endings: tuple[str, ...]) -> Iterator[Column]:
    """One column for each component of values, shape (T, components)."""
    for ending, component in zip(endings, values.T, strict=True):
        yield f"{name}.{ending}", component


def motion_table(motion: Motion) -> tuple[list[str], list[list[float]]]:
    """Header and rows of the columns of a motion, one row per time."""
    columns = motion_columns(motion)
    return list(columns), np.column_stack(list(columns.values())).tolist()


def write_parquet(motion: Motion, path: Path) -> None:
    """Write the columns of a motion atomically; the same motion gives the same bytes.

    Raises:
        ParquetUnavailableError: pyarrow is not installed.
        WriteError: the file cannot be written, e.g. on a full disk.
    """
    arrow = arrow_module()
    import pyarrow.parquet

    columns = {}
    for name, values in motion_columns(motion).items():
        columns[name] = arrow.array(values, mask=~np.isfinite(values))
    # The metadata holds the head of the JSON file, with the outcome of the motion.
    head = json.dumps(plain({"schema": SCHEMA, **_head(motion)}), ensure_ascii=False)
    table = arrow.table(columns).replace_schema_metadata({"cosserat": head})
    content = io.BytesIO()
    pyarrow.parquet.write_table(table, content)
    write_atomically(path, content.getvalue())


def write_npz(motion: Motion, path: Path) -> None:
    """Write the arrays of a motion by dotted name, atomically and reproducibly."""
    content = io.BytesIO()
    data = {"schema": SCHEMA, **motion_result(motion)}
    if KEY in data:
        # The checkpoint holds numbers, lists and words: it is written as one JSON text.
        data[KEY] = json.dumps(plain(data[KEY]))
    arrays: dict[str, Any] = dict(_dotted(data))
    np.savez(content, **arrays)
    write_atomically(path, content.getvalue())


def _dotted(data: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Entries of nested tables by dotted name; a missing title is left out."""
    for key, entry in data.items():
        if isinstance(entry, dict):
            yield from _dotted(entry, f"{prefix}{key}.")
        elif entry is not None:
            yield f"{prefix}{key}", entry
