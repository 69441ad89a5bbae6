"""The rules between tables of a scene.

They read the tables of the file, whose values may be faulty. The model finds faults of geometry, such as joints that
over-constrain or bodies that cannot close. A rule for one kind alone is a method of its record, ``scene_conflicts``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from cosserat_casadi.scene.actuator_records import ACTUATORS
from cosserat_casadi.scene.assembly_rules import (
    bases_on_nothing,
    bodies_that_nobody_holds,
    rods_that_spin,
    sections_held_twice,
)
from cosserat_casadi.scene.constraint_records import JOINTS, SUPPORTS, Body
from cosserat_casadi.scene.disk_record import Disks
from cosserat_casadi.scene.families import Family
from cosserat_casadi.scene.faults import (
    SINGULAR,
    Fault,
    Path,
    SceneTables,
    Table,
    below,
    list_of,
    listing,
    shown,
    table_of,
)
from cosserat_casadi.scene.input_range_records import ranges_of_no_input
from cosserat_casadi.scene.input_rules import bounds_of_no_input, free_names, inputs_that_are_not, requested_fields
from cosserat_casadi.scene.load_records import LOADS
from cosserat_casadi.scene.material_records import MATERIALS
from cosserat_casadi.scene.measurement_record import MEASUREMENTS, overlap
from cosserat_casadi.scene.motion_records import InputMotion
from cosserat_casadi.scene.motion_rules import motions_of_no_input
from cosserat_casadi.scene.obstacle_records import OBSTACLES
from cosserat_casadi.scene.parameter_records import PARAMETER_LISTS, Holder, holders_of, parameter_faults, tie_faults
from cosserat_casadi.scene.records import Entry, sound
from cosserat_casadi.scene.rod_contact_record import RodContact
from cosserat_casadi.scene.rod_records import Rod, admitted_strains
from cosserat_casadi.scene.target_records import TARGETS, Bound
from cosserat_casadi.scene.tube_records import Tube, tube_faults
from cosserat_casadi.scene.unknown_records import Unknown
from cosserat_casadi.scene.velocity_record import InitialVelocity

Rule = Callable[[SceneTables], Iterator[Fault]]

LISTS: dict[str, Family[Any] | type[Entry]] = {
    "loads": LOADS,
    "supports": SUPPORTS,
    "joints": JOINTS,
    "actuators": ACTUATORS,
    "rods": Rod,
    "bodies": Body,
    "disks": Disks,
    "obstacles": OBSTACLES,
    "rod_contacts": RodContact,
    "tubes": Tube,
    "targets": TARGETS,
    "bounds": Bound,
    "motions": InputMotion,
    "velocities": InitialVelocity,
    "measurements": MEASUREMENTS,
    "unknowns": Unknown,
}
"""Records or families of the lists of a scene."""

OF_ONE_COLUMN = ("name", "columns", "inputs", "scale", "shift", "sigma", "held_out")
"""Keys of a measurement that do not tell which number of which rows it is."""


def scene_faults(given: Table) -> Iterator[Fault]:
    """Faults of combinations of tables of a scene, by every rule."""
    scene = SceneTables(given)
    for rule in RULES:
        yield from rule(scene)


def _entries(scene: SceneTables) -> Iterator[tuple[Path, type[Entry], Table]]:
    """Path, record and table of every entry of a known kind."""
    for key, kinds in LISTS.items():
        for i, table in scene.tables(key):
            if not isinstance(kinds, Family):
                yield (key, i), kinds, table
                continue
            record = kinds.record_of(table)
            # An unknown word is refused as the table is read.
            if record is not None:
                yield (key, i), record, table


# Names


def repeated_names(scene: SceneTables) -> Iterator[Fault]:
    """Two entries of one list have the same name."""
    for key in (*SINGULAR, "measurements"):
        named = scene.named(key)
        for i, table in scene.tables(key):
            name = table.get("name")
            # Faulty names have their own fault; supports and joints need no name.
            if not isinstance(name, str):
                continue
            first, _ = named[name]
            if first != i:
                problem = f"{shown(name)} is already the name of {key}[{first}]"
                yield Fault((key, i, "name"), problem)


def shared_names(scene: SceneTables) -> Iterator[Fault]:
    """A load, an actuator or a joint share a name, so that their inputs could not be told apart."""
    taken: dict[str, str] = {name: f"loads[{i}]" for name, (i, _) in scene.named("loads").items()}
    for key in ("actuators", "joints"):
        for i, table in scene.tables(key):
            name = table.get("name")
            # A joint without drive and motor has no input.
            record = JOINTS.record_of(table) if key == "joints" else None
            if record is not None and not any(field in table for field in record.inputs):
                continue
            if isinstance(name, str) and name in taken:
                yield Fault((key, i, "name"), f"{shown(name)} is already the name of {taken[name]}")
        taken.update({name: f"{key}[{i}]" for name, (i, _) in scene.named(key).items()})


def dangling_names(scene: SceneTables) -> Iterator[Fault]:
    """A table refers to an entry that the scene does not have."""
    if not scene.named("rods") and not scene.named("tubes"):
        # Missing rods have a fault already, and every reference would dangle.
        return
    for path, record, table in _entries(scene):
        for field_path, name, key in _references(record, table):
            if key == "rods" and scene.named("tubes"):
                # Loads and others name tubes in a scene of tubes.
                key = "tubes"
            known = scene.named(key)
            if name not in known:
                problem = f"no {SINGULAR[key]} is named {shown(name)}"
                yield Fault((*path, *field_path), problem, listing(known, key))


def _references(record: type[Entry], table: Table) -> Iterator[tuple[Path, str, str]]:
    """The names that a table refers to, with the path in the table and the key of the list for each."""
    for field, key in record.references.items():
        value = table.get(field)
        # A value is one name, or a list of names.
        if record.model_fields[field].annotation in (str, str | None):
            if isinstance(value, str):
                yield (field,), value, key
            continue
        for i, name in enumerate(list_of(value)):
            if isinstance(name, str):
                yield (field, i), name, key


# Rods, supports and accuracy


def own_rules(scene: SceneTables) -> Iterator[Fault]:
    """Faults by the rules of single kinds."""
    # A rule for one kind alone, such as the reach of a support, is written beside its record.
    for path, record, table in _entries(scene):
        yield from below(path, record.scene_conflicts(table, scene))


def weightless_rods(scene: SceneTables) -> Iterator[Fault]:
    """Faults of rods, or tubes, without mass on which gravity acts."""
    load_on_all, load_on_rod = _gravity(scene)
    listed = [(key, i, rod) for key in ("rods", "tubes") for i, rod in scene.tables(key)]
    for key, i, rod in listed:
        # One fault for each rod, however many loads of gravity act on it.
        load = load_on_all
        name = rod.get("name")
        if load is None and isinstance(name, str):
            load = load_on_rod.get(name)
        if load is None:
            continue
        material = rod.get("material")
        is_direct = "stiffness" in rod or "stiffness_matrix" in rod
        if is_direct and "linear_density" not in rod:
            remedy = f"{load} acts on this {SINGULAR[key]}: give its mass per length, kg/m"
            yield Fault((key, i, "linear_density"), "missing", remedy)
        elif not is_direct and isinstance(material, Mapping) and "density" not in material:
            remedy = f"{load} acts on this {SINGULAR[key]}: give its density, kg/m³"
            yield Fault((key, i, "material", "density"), "missing", remedy)


def _gravity(scene: SceneTables) -> tuple[str | None, dict[str, str]]:
    """The gravity on every rod, if any, and loads of gravity on named rods alone."""
    load_on_all: str | None = None
    load_on_rod: dict[str, str] = {}
    for i, load in scene.tables("loads"):
        if load.get("kind") != "gravity":
            continue
        rods = load.get("rods")
        # Gravity that names only bodies does not act on rods.
        if rods is None and "bodies" not in load:
            load_on_all = load_on_all or f"loads[{i}]"
        elif isinstance(rods, list):
            load_on_rod.update({name: f"loads[{i}]" for name in rods if isinstance(name, str)})
    return load_on_all, load_on_rod


def overlapping_supports(scene: SceneTables) -> Iterator[Fault]:
    """Two supports hold one tip."""
    first: dict[str, int] = {}
    for i, support in scene.tables("supports"):
        name = support.get("rod")
        if not isinstance(name, str):
            continue
        holder = first.setdefault(name, i)
        if holder != i:
            path = ("supports", i, "rod")
            problem = f"overlapping supports: supports[{holder}] holds the tip of {shown(name)} already"
            yield Fault(path, problem, "one support for each tip")


def discretised_rods_that_are_not(scene: SceneTables) -> Iterator[Fault]:
    """Faults of ``of_rods``: entries name rods of the scene, each once, with one number of modes for each strain."""
    rods = scene.named("rods")
    first: dict[str, int] = {}
    for i, entry in enumerate(list_of(table_of(scene.get("accuracy")).get("of_rods"))):
        own = table_of(entry)
        name = own.get("rod")
        if not isinstance(name, str):
            continue
        path: Path = ("accuracy", "of_rods", i)
        if name not in rods:
            yield Fault((*path, "rod"), f"no rod is named {shown(name)}", listing(rods, "rods"))
            continue
        if first.setdefault(name, i) != i:
            yield Fault((*path, "rod"), f"of_rods[{first[name]}] is of {shown(name)} already")
        _, rod = rods[name]
        admitted = len(admitted_strains(rod.get("strain")))
        modes = list_of(own.get("modes"))
        # Zero stands for a faulty entry, which has a fault of its own.
        if admitted and modes and admitted != len(modes):
            problem = f"must have one entry per strain, got {len(modes)} where the rod admits {admitted}"
            yield Fault((*path, "modes"), problem)


def miscounted_modes(scene: SceneTables) -> Iterator[Fault]:
    """Faults of a list of modes with another number of entries than a rod has strains."""
    count = len(list_of(table_of(scene.get("accuracy")).get("modes")))
    for i, rod in scene.tables("rods"):
        admitted = len(admitted_strains(rod.get("strain")))
        # Zero stands for a faulty entry, which has a fault of its own.
        if admitted and count and admitted != count:
            problem = f"must have one entry per strain of every rod, got {count} where rods[{i}] admits {admitted}"
            yield Fault(("accuracy", "modes"), problem, "give one number for all")
            return


def sections_of_no_layer(scene: SceneTables) -> Iterator[Fault]:
    """Faults of sections for layers in a scene without smooth contact of rods."""
    if scene.tables("tubes"):
        # The rules of tubes refuse such keys beside tubes.
        return
    for _, table in scene.tables("obstacles"):
        record = OBSTACLES.record_of(table)
        obstacle = None if record is None else sound(record, table)
        # A faulty obstacle has its own faults.
        if obstacle is None or (obstacle.is_smooth and obstacle.presses_rods):
            return
    problem = "no obstacle with a width presses a rod: nothing is summed at sections"
    yield from _counts_of_no_sum(scene, "sections", problem, "give an obstacle a width, m")


def fibres_of_no_law(scene: SceneTables) -> Iterator[Fault]:
    """Faults of fibres in a scene whose materials have no law that is summed over them."""
    if scene.tables("tubes"):
        return
    for _, rod in scene.tables("rods"):
        material = MATERIALS.record_of(table_of(rod.get("material")))
        # An unknown law has its own fault.
        if material is None or material.fibres:
            return
    yield from _counts_of_no_sum(scene, "fibres", "no law of a material is summed over fibres", "give a rod of rubber")


def _counts_of_no_sum(scene: SceneTables, key: str, problem: str, remedy: str) -> Iterator[Fault]:
    """A fault for each place where ``accuracy`` counts the terms of a sum that no rod of the scene has."""
    accuracy = table_of(scene.get("accuracy"))
    tables = {(): accuracy} | {("of_rods", i): table_of(own) for i, own in enumerate(list_of(accuracy.get("of_rods")))}
    for path, table in tables.items():
        if key in table:
            yield Fault(("accuracy", *path, key), problem, f"leave it out, or {remedy}")


def parameters_that_are_not(scene: SceneTables) -> Iterator[Fault]:
    """Faults of parameters and unknowns that name no number of the scene, or one that cannot be a parameter."""
    groups: list[tuple[list[Any], Path]] = []
    for i, entry in enumerate(list_of(scene.get("parameters"))):
        groups.append((_listed_names(entry), ("parameters", i)))
    parameters = [group for group, _ in groups]
    first: dict[str, int] = {}
    for i, table in scene.tables("unknowns"):
        key = "parameter" if "parameter" in table else "input"
        names = _listed_names(table.get(key))
        if not names or not all(isinstance(name, str) for name in names):
            continue
        fault = _fault_of_unknown(("unknowns", i, key), names, first, parameters)
        if fault is not None:
            yield fault
        elif key == "parameter" and names not in parameters:
            groups.append((names, ("unknowns", i, "parameter")))
    if not groups:
        return
    holders = holders_of(
        Holder(str(key), int(index), sound(record, table), table.get("name"))
        for (key, index), record, table in _entries(scene)
        if key in PARAMETER_LISTS
    )
    names = [name for group, _ in groups for name in group]
    paths = [path if len(group) == 1 else (*path, j) for group, path in groups for j in range(len(group))]
    yield from parameter_faults(names, paths, holders, free_names(scene), requested_fields(scene))
    yield from tie_faults([(group, path) for group, path in groups if len(group) > 1], holders)


def _fault_of_unknown(
    path: tuple[str, int, str], names: Sequence[str], first: dict[str, int], parameters: Sequence[list[Any]]
) -> Fault | None:
    """Fault of an unknown with numbers of an earlier one, or with some of a list of parameters; else None.

    Args:
        path: path of its names.
        names: the names of its numbers.
        first: index of the first unknown with each name; the names are added.
        parameters: lists of names of parameters.
    """
    _, number, key = path
    again = next((name for name in names if first.setdefault(name, number) != number), None)
    if again is not None:
        return Fault(path, f"unknowns[{first[again]}] is {shown(again)} already", "name it once")
    if key == "parameter":
        shared = [group for group in parameters if group != names and set(map(str, group)) & set(names)]
        if shared:
            problem = f"{shown(names)} and {shown(shared[0])} of parameters share numbers"
            return Fault(path, problem, "tie the same numbers in both, or leave one out")
        return None
    # The rules of `parameters` report faults of parameters.
    for other in first:
        if other != names[0] and overlap(names[0], other):
            return Fault(path, f"{shown(names[0])} and unknowns[{first[other]}] share numbers", "name each number once")
    return None


def _listed_names(given: Any) -> list[Any]:
    """The names in a value that is one name or a list of names."""
    return list(given) if isinstance(given, list | tuple) else [given]


def measured_twice(scene: SceneTables) -> Iterator[Fault]:
    """Faults of two measurements that read one column as the same number, which would count twice."""
    first: list[tuple[int, dict[str, Any], Sequence[Any]]] = []
    for i, table in scene.tables("measurements"):
        columns = list_of(table.get("columns"))
        rows = {key: value for key, value in table.items() if key not in OF_ONE_COLUMN}
        for earlier, earlier_rows, earlier_columns in first:
            shared = [one for one, other in zip(columns, earlier_columns, strict=False) if one and one == other]
            if rows == earlier_rows and shared:
                problem = f"measurements[{earlier}] reads {shown(shared[0])} of these rows already"
                yield Fault(("measurements", i, "columns"), problem, "read it once, or other rows, by where")
                break
        first.append((i, rows, columns))


RULES: tuple[Rule, ...] = (
    repeated_names,
    shared_names,
    dangling_names,
    bases_on_nothing,
    bodies_that_nobody_holds,
    sections_held_twice,
    weightless_rods,
    rods_that_spin,
    overlapping_supports,
    own_rules,
    miscounted_modes,
    discretised_rods_that_are_not,
    sections_of_no_layer,
    fibres_of_no_law,
    tube_faults,
    inputs_that_are_not,
    parameters_that_are_not,
    measured_twice,
    bounds_of_no_input,
    ranges_of_no_input,
    motions_of_no_input,
)
"""Every rule of a scene. Faults at one key of the file are listed in this order."""
