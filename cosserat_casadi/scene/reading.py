"""A scene from TOML: file, text or tables ↦ overrides ↦ `Scene`, or one `SceneError` with every fault.

For every file the outcome is one of the two. Numbers that are probably in another unit than the format's are accepted,
with a warning.
"""

from __future__ import annotations

import logging
import math
import os
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cosserat_casadi.errors import Problem, SceneError, refuse
from cosserat_casadi.scene.disk_record import lead_through_disks
from cosserat_casadi.scene.disks_in_contact import seat_disks
from cosserat_casadi.scene.faults import LISTS, PLAIN, SIZES, SceneTables, faults_of_range, shown
from cosserat_casadi.scene.faults import Path as FaultPath
from cosserat_casadi.scene.input_fields import InputField
from cosserat_casadi.scene.input_rules import owners_of
from cosserat_casadi.scene.joint_ends import place_joints_by_their_ends
from cosserat_casadi.scene.load_records import Gravity
from cosserat_casadi.scene.messages import problem_of, problems_of
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.obstacle_records import SMOOTH_KEYS
from cosserat_casadi.scene.overrides import RefusedOverride, apply_overrides, assign
from cosserat_casadi.scene.profiles import Notation, RefusedProfile, read_profile
from cosserat_casadi.scene.records import Record, keys_of, sound
from cosserat_casadi.scene.rod_records import Rod
from cosserat_casadi.scene.scene import Scene
from cosserat_casadi.scene.toml import TOO_DEEP, file_text, parsed
from cosserat_casadi.scene.tube_records import Tube
from cosserat_casadi.scene.values import names_in
from cosserat_casadi.scene.writing import scene_tables

LOG = logging.getLogger(__name__)

OF_MATERIALS = (
    ("youngs_modulus", "Pa", 1e3, "softer than any rod", 1e13, "stiffer than diamond", "60 GPa are 60e9"),
    ("density", "kg/m³", 10.0, "lighter than foam", 1e5, "heavier than any metal", "is it in kg/m³?"),
)
"""Keys of materials, their units, least and largest numbers of real rods with words for others, and a remedy.

Soft gels have some thousand Pa, diamond 1.2e12 Pa; osmium has 22.6e3 kg/m³.
"""

STRONGEST = 1e5
"""Acceleration of gravity, m/s², ten thousand times that of the earth."""

ANGLES = frozenset({"angle", "rest", "lower_stop", "upper_stop", "rotation"})
"""Keys of angles of hinges and of drives of tubes."""

FURTHEST = 4 * math.pi
"""Angle, rad, above the angles of most hinges and drives: 15° written as 15 exceeds it."""

MOST_SLENDER = 1e5
"""Length over the largest size of the section, above that of lines between pylons: 200 mm written as 200 exceeds it

beside a radius of half a millimetre."""

NEAR_ONE = 100.0
"""Largest number, and inverse of the smallest one, of a rod or tube that is written in dimensionless numbers."""

SCENE_KEYS = tuple(keys_of(Scene))
"""Tables and plain keys of a scene."""


def read_scene(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from a TOML file; ``logging`` warns of numbers that are probably in another unit.

    Args:
        path: the file.
        overrides: assignments such as ``push.force=[0.2, 0, 0]``, ``finger.length=0.3`` or
            ``accuracy.tolerance=1e-9``: a load, rod, support or table, a dotted path in it, and a TOML value.

    Returns:
        the scene, validated.

    Raises:
        SceneError: the file or an override is faulty; it lists every fault.
    """
    file = Path(path)
    scene = _scene(parsed(file_text(file), str(file)), overrides, file.parent, str(file))
    for note in _unlikely_numbers(scene):
        LOG.warning("%s", note)
    return scene


def parse_scene(text: str, overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from TOML text.

    Args:
        text: the scene; files that it names are relative to the working directory.
        overrides: as in `read_scene`.

    Raises:
        SceneError: the scene is faulty; it lists every fault.
    """
    tables = parsed(text)
    return scene_from_dict(tables, overrides)


def scene_from_dict(mapping: Mapping[str, Any], overrides: Sequence[str] = ()) -> Scene:
    """Read a scene from the tables of a TOML file, which are not changed.

    Args:
        mapping: tables as dictionaries, arrays as lists; files that they name are relative to the working directory.
        overrides: as in `read_scene`.

    Raises:
        SceneError: the scene is faulty; it lists every fault.
    """
    return _scene(mapping, overrides, Path())


def written_tables(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> dict[str, Any]:
    """The tables of a scene as its file writes them, with overrides.

    Args:
        path: the file of a valid scene.
        overrides: as in `read_scene`, valid too.
    """
    tables = parsed(file_text(Path(path)))
    apply_overrides(tables, overrides, SCENE_KEYS)
    return tables


def files_read(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> list[Path]:
    """The files of a scene: the scene file, and the tables that its motions and measurements name.

    For a refused scene, these are the files that are known before the refusal.

    Args:
        path: the file.
        overrides: as in `read_scene`.
    """
    file = Path(path)
    # A pipe cannot be read twice, and cannot be overwritten.
    if not file.is_file():
        return []
    try:
        tables = parsed(file_text(file))
        apply_overrides(tables, overrides, SCENE_KEYS)
    except (SceneError, RecursionError):
        return [file]
    _locate_files(tables, file.parent)
    return [file, *(Path(entry["file"]) for entry in _entries_with_files(tables))]


def override_path(mapping: Mapping[str, Any], key: str) -> FaultPath:
    """Path of the value that an override with this key sets: two keys with one path set one value.

    Args:
        mapping: tables of a scene.
        key: left side of an override, such as ``push.force`` or ``loads[0].force``.

    Raises:
        SceneError: the key does not exist.
    """
    try:
        # The value does not matter for the path.
        assignment = assign(_copy(mapping), key, 0.0, SCENE_KEYS)
    except RefusedOverride as error:
        raise SceneError(Problem(key, *error.args)) from None
    return assignment.leaf


def _scene(mapping: Mapping[str, Any], overrides: Sequence[str], folder: Path, where: str = "") -> Scene:
    try:
        tables = _copy(mapping)
        return _validated(tables, overrides, folder)
    # Copying, reading and testing the tables are recursive.
    except RecursionError:
        raise SceneError(Problem(where, TOO_DEEP)) from None


def _validated(tables: Any, overrides: Sequence[str], folder: Path) -> Scene:
    if not isinstance(tables, dict):
        raise SceneError(Problem("", f"must be a table, got {shown(tables)}"))
    # A refused override does not stop the reading: its problem is reported with those of the file.
    applied, problems = apply_overrides(tables, overrides, SCENE_KEYS)
    # Rules assume numbers of double precision.
    faults = list(faults_of_range(tables))
    if faults:
        raise SceneError(*problems, *(problem_of(fault, applied) for fault in faults))
    _locate_files(tables, folder)
    place_joints_by_their_ends(tables)
    lead_through_disks(tables)
    seat_disks(tables)
    make_room_for_waves(tables)
    try:
        scene = Scene.model_validate(tables)
    except ValidationError as error:
        problems += problems_of(error, tables, applied)
    refuse(problems)
    return scene


def _locate_files(tables: dict[str, Any], folder: Path) -> None:
    """Put the folder of the scene before the files that its motions and measurements name."""
    for entry in _entries_with_files(tables):
        entry["file"] = str(folder / entry["file"])


def _entries_with_files(tables: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Motions and measurements that name a file."""
    given = SceneTables(tables)
    entries = [entry for _, entry in (*given.tables("motions"), *given.tables("measurements"))]
    return [entry for entry in entries if isinstance(entry, dict) and isinstance(entry.get("file"), str)]


def _copy(value: Any) -> Any:
    """A copy down to the values, with lists for tuples."""
    # Overrides change the tables in place; the caller's must stay as they are.
    if isinstance(value, PLAIN):
        return value
    if isinstance(value, LISTS):
        return [_copy(entry) for entry in value]
    if isinstance(value, Mapping):
        return {key: _copy(entry) for key, entry in value.items()}
    return value


def make_room_for_waves(tables: dict[str, Any]) -> None:
    """Append zeros to inputs for the degrees of travelling waves; an input that is left out is zero.

    Faulty tables are not changed; the rules refuse them.

    Args:
        tables: tables of a scene, which are changed.
    """
    scene = SceneTables(tables)
    for _, table in scene.tables("motions"):
        motion = sound(InputMotion, table) if table.get("wave") == "travelling" else None
        if motion is None:
            continue
        name, _, field = motion.input.partition(".")
        record, owner = owners_of(scene).get(name, (None, {}))
        declared = None if record is None else record.inputs.get(field)
        # Values at knots are not coefficients; the rules refuse waves of such inputs.
        if declared is not None and declared.polynomial and isinstance(owner, dict) and "knots" not in owner:
            value = owner.get(field, [0.0] * declared.components)
            owner[field] = _filled_up(value, declared, motion.degrees)


def _filled_up(value: Any, declared: InputField, degrees: int) -> Any:
    """The value of an input with at least ``degrees`` coefficients for each component."""
    if declared.components == 1:
        return _component(value, degrees)
    if not isinstance(value, list):
        return value
    return [_component(component, degrees) for component in value]


def _component(value: Any, degrees: int) -> Any:
    if isinstance(value, Mapping):
        try:
            value = list(read_profile(value).converted(Notation.LEGENDRE).numbers)
        except RefusedProfile:
            return value
    listed = value if isinstance(value, list) else [value]
    return [*listed, *[0.0] * (degrees - len(listed))]


def _unlikely_numbers(scene: Scene) -> Iterator[str]:
    """Sentences on numbers that are probably in another unit; a rod with all of them near one is dimensionless."""
    tubes = [(f"tubes[{i}]", tube) for i, tube in enumerate(scene.tubes)]
    elastic: list[tuple[str, Rod | Tube]] = [(f"rods[{i}]", rod) for i, rod in enumerate(scene.rods)]
    for where, record in [*elastic, *tubes]:
        lengths = _numbers(record, {"length", "straight", "curved"})
        sizes = _sizes(record.section)
        material = _numbers(record.material, {key for key, *_ in OF_MATERIALS})
        numbers = (lengths | sizes | material).values()
        if all(1 / NEAR_ONE <= number <= NEAR_ONE for number in numbers):
            continue
        for key, unit, least, below_it, most, above_it, remedy in OF_MATERIALS:
            number = material.get(key)
            if number is not None and not least <= number <= most:
                words = below_it if number < least else above_it
                yield f"{where}.material.{key}: {number:g} {unit} is {words} ({remedy})"
        # The value of a length that is a parameter is unknown.
        longest = sum(lengths.values()) or math.inf
        for key, size in sizes.items():
            if size > longest:
                yield f"{where}.section.{key}: {size:g} m is more than the length of {longest:g} m (are both in m?)"
        if lengths and sum(lengths.values()) > MOST_SLENDER * max(sizes.values(), default=math.inf):
            yield f"{where}: the length of {longest:g} m is over {MOST_SLENDER:g} sizes of the section (are both in m?)"
    for i, load in enumerate(scene.loads):
        if isinstance(load, Gravity) and math.hypot(*load.acceleration) > STRONGEST:
            strength = math.hypot(*load.acceleration)
            yield f"loads[{i}].acceleration: {strength:g} m/s² is above any gravity (is it in m/s²?)"
    hinges = [(f"joints[{i}]", joint) for i, joint in enumerate(scene.joints) if joint.kind == "revolute"]
    for where, turned in (*hinges, *tubes):
        for key, angle in _numbers(turned, ANGLES).items():
            if abs(angle) > FURTHEST:
                yield f"{where}.{key}: {angle:g} rad is more than two turns (is it in rad?)"


def _numbers(record: Record | None, keys: Collection[str]) -> dict[str, float]:
    """Values of some keys of a record that are single numbers, not lists or expressions of parameters."""
    return {key: value for key, value in record or () if key in keys and isinstance(value, float | int)}


def _sizes(section: Record | None) -> dict[str, float]:
    """Sizes of a section by key; the larger one of base and tip for a varying size."""
    tapered = {key: value for key, value in section or () if key in SIZES and isinstance(value, tuple)}
    ends = {key: max(value) for key, value in tapered.items() if all(isinstance(end, float | int) for end in value)}
    return _numbers(section, SIZES) | ends


def with_exact_contact(scene: Scene) -> Scene:
    """The scene with obstacles without widths, for which a solve searches the contacts.

    Raises:
        SceneError: exact contact of these rods is not supported.
    """
    tables = scene_tables(scene)
    gone = set[str]()
    for number, obstacle in enumerate(tables.get("obstacles", [])):
        for key in SMOOTH_KEYS:
            obstacle.pop(key, None)
            gone |= {f"{owner}.{key}" for owner in (obstacle["name"], f"obstacles.{number}", f"obstacles[{number}]")}
    accuracy = tables.get("accuracy", {})
    for discretisation in (accuracy, *accuracy.get("of_rods", [])):
        discretisation.pop("sections", None)
    if scene.parameters:
        left = ([name for name in names_in(names) if name not in gone] for names in scene.parameters)
        tables["parameters"] = [names for names in left if names]
    return scene_from_dict(tables)
