"""Rules of inputs: listed names exist and can be free, bounded names are free."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cosserat_casadi.scene.actuator_records import ACTUATORS
from cosserat_casadi.scene.constraint_records import JOINTS
from cosserat_casadi.scene.faults import Fault, SceneTables, Table, below, list_of, listing, numbers_of, shown, table_of
from cosserat_casadi.scene.load_records import LOADS
from cosserat_casadi.scene.records import Entry
from cosserat_casadi.scene.rod_records import Rod
from cosserat_casadi.scene.tube_records import Tube

Owners = dict[str, tuple[type[Entry] | None, Table]]
"""Tables that may have inputs, by name, with the record of each; None for an unknown kind."""


def inputs_that_are_not(scene: SceneTables) -> Iterator[Fault]:
    """Faults of inputs that name nothing in the scene, or something that cannot be free."""
    owners = owners_of(scene)
    for i, entry in enumerate(list_of(scene.get("inputs"))):
        if not isinstance(entry, str):
            continue
        # Names have no dots; fields of inner tables do.
        name, _, field = entry.partition(".")
        if not field:
            yield Fault(("inputs", i), f"must read 'load.field', got {shown(entry)}")
        elif name in owners:
            record, table = owners[name]
            yield from below(("inputs", i), field_faults(field, record, table, scene))
        else:
            problem = f"no load, actuator or rod is named {shown(name)}"
            yield Fault(("inputs", i), problem, listing(owners, "names"))


def bounds_of_no_input(scene: SceneTables) -> Iterator[Fault]:
    """Faults of bounds: of inputs that are not free, second ones of an input, of another number of entries."""
    counts = entry_counts(scene)
    first: dict[str, int] = {}
    for i, bound in scene.tables("bounds"):
        name = bound.get("input")
        if not isinstance(name, str):
            continue
        # A name that is not an input has no number of entries to compare with the bound's.
        path = ("bounds", i, "input")
        if name not in counts:
            problem = f"{shown(name)} is not free at run time"
            yield Fault(path, problem, listing(counts, "inputs"))
            continue
        if first.setdefault(name, i) != i:
            yield Fault(path, f"bounds[{first[name]}] bounds {shown(name)} already")
        for side in ("lower", "upper"):
            count = len(numbers_of(bound.get(side)))
            wanted = counts[name]
            if wanted is not None and count > 1 and count != wanted:
                yield Fault(("bounds", i, side), f"must have {_numbers(wanted)}, got {count}")


def _numbers(count: int) -> str:
    return "1 number" if count == 1 else f"1 number or {count}"


def owners_of(scene: SceneTables) -> Owners:
    """Owners of inputs by name, with their records, or None for an unknown kind."""
    owners = _causes(scene)
    # Inputs of a load or an actuator hide those of a rod or a tube of the same name.
    for key, record in (("rods", Rod), ("tubes", Tube)):
        for name, (_, table) in scene.named(key).items():
            owners.setdefault(name, (record, table))
    return owners


def _causes(scene: SceneTables) -> Owners:
    """Joints, actuators and loads by name, with their records, or None for an unknown kind."""
    causes: Owners = {}
    # A load hides an actuator of the same name; another rule refuses the shared name.
    for family in (JOINTS, ACTUATORS, LOADS):
        for name, (_, table) in scene.named(family.table).items():
            causes[name] = (family.record_of(table), table)
    return causes


def field_faults(field: str, record: type[Entry] | None, table: Table, scene: SceneTables) -> Iterator[Fault]:
    """Faults, without path, of a field that cannot stay free at run time; none for an unknown kind."""
    if record is None:
        return
    fields = record.free_fields(table)
    if field in fields:
        yield from record.input_conflicts(field, table, scene)
        return
    name = shown(table["name"])
    # A load or an actuator has free magnitudes, a rod free geometry.
    if record is Rod:
        problem = f"{name} has no {shown(field)} to leave free"
        yield Fault((), problem, listing(fields, "fields"))
    else:
        problem = f"{name} has no magnitude {shown(field)}"
        yield Fault((), problem, listing(fields, "magnitudes"))


def input_field_of(name: str, owners: Owners) -> tuple[str, str] | None:
    """The input that a name begins with, as (owner, field); the name may go on with a part such as ``.z``.

    Returns:
        None if no load, actuator or rod has such a field; the longest field if there are several.
    """
    owner, _, rest = name.partition(".")
    record, table = owners.get(owner, (None, {}))
    if record is None:
        return None
    fields = [field for field in record.free_fields(table) if rest == field or rest.startswith(f"{field}.")]
    if not fields:
        return None
    return owner, max(fields, key=len)


def input_part_faults(name: str, scene: SceneTables) -> Iterator[Fault]:
    """Faults, without path, of a name that is not an input or a part of one; the model knows which parts exist."""
    owners = owners_of(scene)
    owner, _, rest = name.partition(".")
    if not rest:
        yield Fault((), f"must read 'load.field', got {shown(name)}")
        return
    if owner not in owners:
        yield Fault((), f"no load, actuator or rod is named {shown(owner)}", listing(owners, "names"))
        return
    record, table = owners[owner]
    named = input_field_of(name, owners)
    yield from field_faults(rest if named is None else named[1], record, table, scene)


def entry_counts(scene: SceneTables) -> dict[str, int | None]:
    """Numbers of entries of the free inputs by name; None for faulty inputs."""
    owners = owners_of(scene)
    return {name: _entry_count(name, owners) for name in free_names(scene)}


def free_names(scene: SceneTables) -> list[str]:
    """Names of the free inputs: the listed names, or else every magnitude."""
    entries = scene.get("inputs")
    if isinstance(entries, list):
        return [name for name in entries if isinstance(name, str)]
    return _magnitudes(scene)


def requested_fields(scene: SceneTables) -> dict[str, str]:
    """Further inputs of an identification, set by columns or unknown, with the table that asks for each."""
    owners = owners_of(scene)
    requests: dict[str, str] = {}
    asked: list[tuple[Any, str]] = []
    for i, measurement in scene.tables("measurements"):
        names = table_of(measurement.get("inputs"))
        asked += [(name, f"measurements[{i}] sets {shown(name)}") for name in names]
    for i, unknown in scene.tables("unknowns"):
        name = unknown.get("input")
        asked.append((name, f"unknowns[{i}] has the input {shown(name)}"))
    if any("time" in measurement for _, measurement in scene.tables("measurements")):
        for i, motion in scene.tables("motions"):
            name = motion.get("input")
            asked.append((name, f"motions[{i}] moves {shown(name)}"))
    for name, request in asked:
        named = input_field_of(name, owners) if isinstance(name, str) else None
        if named is not None:
            requests.setdefault(".".join(named), request)
    return requests


def _magnitudes(scene: SceneTables) -> list[str]:
    """Names of the free inputs of a scene that lists none: all inputs of tubes, magnitudes of actuators and loads."""
    of_tubes = [f"{name}.{field}" for name in scene.named("tubes") for field in Tube.inputs]
    return of_tubes + [
        f"{name}.{field}"
        for name, (record, table) in _causes(scene).items()
        if record is not None
        for field, declared in record.inputs.items()
        if field in table and not declared.on_request
    ]


def _entry_count(name: str, owners: Owners) -> int | None:
    owner, _, field = name.partition(".")
    record, table = owners.get(owner, (None, {}))
    if record is None or field not in record.inputs:
        return None
    declared = record.inputs[field]
    # Fields of inner tables are not looked up: none of them is a polynomial.
    value = table.get(field)
    return declared.entry_count(value)
