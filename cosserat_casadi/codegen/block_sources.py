"""Words in the templates of the solver that depend on the elimination of its Jacobian: as a whole, or rod by rod."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cosserat_casadi.codegen.assembled import Assembled
from cosserat_casadi.codegen.blocks import Front
from cosserat_casadi.codegen.parts import Parted
from cosserat_casadi.compiling.c_tables import numbers, table
from cosserat_casadi.compiling.texts import render

Words = dict[str, Any]

MEMBERS = """  {real} entries[{entries}];
  {real} part_unknowns[{macro}_UNKNOWNS];
  {real} part_inputs[{input_room}];
  {real} part_entries[{most_entries}];
  {real} front_values[{front_count}][{max_order}];
  {real} interface_values[{interface}];
"""
"""Arrays of the block elimination, as members of the workspace."""


def dense_words(basics: Words) -> Words:
    """Words of a solver with one dense Jacobian."""
    return {
        "equations": render("dense_equations.c.in", basics),
        "linear_header": "",
        "linear_source": "linear_dense.c",
        "linear_sizes": "",
        "linear_members": "",
        "linear_reals": 0,
        "factor_count": basics["unknowns"] ** 2,
    }


def block_words(basics: Words, partition: Assembled) -> Words:
    """Words of a solver that eliminates rod by rod."""
    split = partition.blocks
    order = split.by_fronts
    tables, listed = front_tables(order.fronts)
    parteds = {"residual": partition.residual, "jacobian": partition.jacobian, "input": partition.input_jacobian}
    words = {
        "part_functions": "".join(part_functions(parted) for parted in parteds.values()),
        "part_tables": "".join(part_tables("part", word, parted) for word, parted in parteds.items()),
        "front_tables": f"{tables}static const front FRONTS[FRONT_COUNT] = {{\n{listed},\n}};\n",
        "front_indices": numbers(order.indices),
        "dense_indices": numbers(split.dense_indices),
        "interface_members": numbers(order.interface),
    }
    sizes = {
        "entries": split.pattern.nnz(),
        "front_count": len(order.fronts),
        "fronts_size": order.size,
        "interface": len(order.interface),
        "interface_start": order.interface_start,
        "max_order": max(front.order for front in order.fronts),
    }
    most_entries = max(len(part.entries) for parted in parteds.values() for part in parted.parts)
    work = [sizes["entries"], basics["unknowns"], basics["input_room"], most_entries]
    work += [sizes["front_count"] * sizes["max_order"], sizes["interface"]]
    members = {
        **sizes,
        "real": f"{basics['name']}_real",
        "macro": basics["MACRO"],
        "input_room": basics["input_room"],
        "most_entries": most_entries,
    }
    return {
        "equations": render("block_equations.c.in", words),
        "linear_header": '#include "linear_blocks.h"\n',
        "linear_source": "linear_blocks.c",
        "linear_sizes": "\n".join(f"#define SOLVER_{word.upper()} {size}" for word, size in sizes.items()),
        "linear_members": MEMBERS.format(**members),
        "linear_reals": sum(work),
        # The fallback eliminates the matrix as a whole in the same room.
        "factor_count": max(split.pattern.size1() ** 2, order.size),
    }


def part_functions(parted: Parted) -> str:
    """Functions that call the kernels of parts."""
    names = [kernel.name() for kernel in parted.kernels]
    return "".join(render("part.c.in", {"function": _function(name), "kernel": name}) for name in names)


def _function(kernel: str) -> str:
    return f"call_{kernel}"


def part_tables(kind: str, word: str, parted: Parted) -> str:
    """Tables of parts.

    Args:
        kind: type of the records in C.
        word: prefix of the names of the tables.
        parted: the parts.
    """
    stem = word.upper()
    lines = list[str]()
    rows = list[str]()
    for i, part in enumerate(parted.parts):
        tables: dict[str, Sequence[float]] = {
            "UNKNOWNS": part.x,
            "GIVEN": part.inputs,
            "CONSTANTS": part.constants,
            "ENTRIES": part.entries,
        }
        lines += [table(f"{stem}_{key}_{i}", values) for key, values in tables.items()]
        names = [f"{stem}_{key}_{i}" if values else "0" for key, values in tables.items()]
        counts = [str(len(values)) for values in (part.x, part.inputs, part.entries)]
        rows.append(f"  {{{', '.join([_function(parted.kernels[part.kernel].name()), *names, *counts])}}}")
    # A scene without inputs has no part to list, and C no array without entries.
    listed = ",\n".join(rows or ["  {0, 0, 0, 0, 0, 0, 0, 0}"])
    count = f"enum {{ {stem}_PART_COUNT = {len(rows)} }};\n"
    return "".join(lines) + f"static const {kind} {stem}_PARTS[] = {{\n{listed},\n}};\n{count}"


def front_tables(fronts: Sequence[Front], stem: str = "") -> tuple[str, str]:
    """Tables of the unknowns of fronts, whose names begin with a stem, and the records in C that name them."""
    tables = ""
    rows = list[str]()
    for i, front in enumerate(fronts):
        tables += table(f"{stem}MEMBERS_{i}", front.members) + table(f"{stem}TOUCHED_{i}", front.interface)
        touched = f"{stem}TOUCHED_{i}" if front.interface else "0"
        counts = f"{len(front.members)}, {len(front.interface)}, {front.start}"
        rows.append(f"  {{{stem}MEMBERS_{i}, {touched}, {counts}}}")
    return tables, ",\n".join(rows)
