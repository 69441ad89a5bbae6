"""Inputs and results by name: the members of the structs in the header, and the functions that fill them."""

from __future__ import annotations

from typing import Any

import numpy as np

from cosserat_casadi.codegen.names import Names, identifier
from cosserat_casadi.model.build import Model


def vector_words(names: Names, entries: list[dict[str, Any]], word: str) -> dict[str, str]:
    """Words for a vector: macros and rows of the README, default values, members of its struct, copies to and from it.

    Args:
        names: names of the library and its parts.
        entries: inputs or parameters as in the manifest.
        word: "input" or "parameter", the prefix of these words.
    """
    macros = list[str]()
    rows = list[str]()
    values = list[str]()
    members = list[str]()
    pack = list[str]()
    unpack = list[str]()
    for entry in entries:
        member = identifier(entry["name"])
        macro = f"{names.macro}_{word.upper()}_{member.upper()}"
        first = entry["first"]
        count = len(entry["value"])
        unit = entry["unit"]
        axes = "" if entry.get("axes", "none") == "none" else f", {entry['axes']} axes"
        remark = axes if word == "input" else f": {entry['name']}"
        numbered = "1 number" if count == 1 else f"{count} numbers"
        span = f"{first} … {first + count - 1}" if count > 1 else f"{first}"
        macros.append(f"#define {macro} {first} /* {numbered}, {unit}{remark} */")
        macros.append(f"#define {macro}_SIZE {count}")
        rows.append(f"| {span} | `{entry['name']}`{axes} | {unit} | {listed(entry['value'])} |")
        values += [initialiser(value, names) for value in entry["value"]]
        members.append(f"  {names.name}_real {member}[{macro}_SIZE]; /* {unit} */")
        pack.append(f"  memcpy({word}s + {macro}, named->{member}, sizeof named->{member});")
        unpack.append(f"  memcpy(named->{member}, {word}s + {macro}, sizeof named->{member});")
    return {
        f"{word}_macros": "\n".join(macros),
        f"{word}_rows": "\n".join(rows),
        f"{word}_defaults": ", ".join(values),
        f"{word}_members": "\n".join(members),
        f"{word}_pack_lines": "\n".join(pack),
        f"{word}_unpack_lines": "\n".join(unpack),
    }


def result_struct_words(model: Model, names: Names) -> dict[str, str]:
    """Words for the struct of results.

    Args:
        model: the exported model.
        names: names of the library and its parts.
    """
    passed = ", parameters" if model.parameters.size else ""
    poses = {pose_name(names, "tip", rod): names.function("tip", rod) for rod in names.rods}
    poses |= {pose_name(names, "body", body): names.function("body", body) for body in names.bodies}
    members = [f"  {names.name}_pose {member};" for member in poses]
    calls = [
        f"  {function}(x, inputs{passed}, named->{member}.position, named->{member}.quaternion);"
        for member, function in poses.items()
    ]
    for actuator in names.actuators:
        effort, conjugate, _ = type(model).actuator.spec.outputs_of(model.discrete, actuator)
        members += [
            f"  {names.name}_real {quantity.name}_{actuator}; /* {quantity.unit} */" for quantity in (effort, conjugate)
        ]
        function = names.function("actuator", actuator)
        arguments = f"&named->{effort.name}_{actuator}, &named->{conjugate.name}_{actuator}"
        calls.append(f"  {function}(x, inputs{passed}, {arguments}, 0);")
    macros = [f"#define {names.macro}_POSE_{member.upper()} {i}" for i, member in enumerate(poses)]
    return {
        "results_members": "\n".join(members),
        "evaluate_lines": "\n".join(calls),
        "pose_macros": "\n".join(macros),
    }


def listed(values: list[float]) -> str:
    """Write numbers with the digits that they need."""
    return ", ".join(f"{value:g}" if float(f"{value:g}") == value else repr(value) for value in values)


def initialiser(value: float, names: Names) -> str:
    """Write a number that compilers accept without warnings as float and as double."""
    written = listed([value])
    return written if float(np.float32(value)) == value else f"({names.name}_real){written}"


def pose_name(names: Names, word: str, owner: str) -> str:
    """Name of the pose of a tip or a body, without the prefix of the library."""
    return names.function(word, owner).removeprefix(f"{names.name}_")
