"""The words of the solver's source that depend on how its Jacobian is eliminated: as a whole, or rod after rod."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from typing import Any

from cosserat_casadi.codegen.assembled import Assembled
from cosserat_casadi.codegen.blocks import Front
from cosserat_casadi.codegen.parts import Parted

Render = Callable[[str, dict[str, Any]], str]

DENSE_IRREGULAR = """  for (i = 0; i < N; i++) {{
    if (kept->own.factors[i * N + i] == 0) return {macro}_SINGULAR;
  }}
"""


def dense_words(render: Render, basics: dict[str, Any]) -> dict[str, Any]:
    """Words of a solver with one dense Jacobian."""
    return {
        "equations": render("dense_equations.c.in", basics),
        "factors": render("dense_factors.c.in", basics),
        "public_equations": render("dense_public.c.in", basics),
        "product": render("dense_product.c.in", basics),
        "factor_fields": _fields(basics, f"{basics['MACRO']}_UNKNOWNS * {basics['MACRO']}_UNKNOWNS"),
        "kept_factors": "kept->own.factors, kept->own.pivots",
        "irregular": DENSE_IRREGULAR.format(macro=basics["MACRO"]),
    }


def block_words(render: Render, basics: dict[str, Any], found: Assembled) -> dict[str, Any]:
    """Words of a solver that eliminates rod after rod."""
    split = found.blocks
    room = max(split.pattern.size1() ** 2, split.room)
    parteds = {"residual": found.residual, "jacobian": found.jacobian, "input": found.input_jacobian}
    words = {
        **basics,
        "entries": split.pattern.nnz(),
        "fronts": split.room,
        "border": len(split.border),
        "border_first": split.border_first,
        "largest": max(front.order for front in split.fronts),
        "most_entries": max(len(part.entries) for one in parteds.values() for part in one.parts),
        "part_functions": "".join(_functions(render, one) for one in parteds.values()),
        "part_tables": "".join(_tables(word, one) for word, one in parteds.items()),
        "front_tables": _fronts(split.fronts),
        "front_places": _numbers(split.places),
        "dense_places": _numbers(split.dense_places),
        "border_members": _numbers(split.border),
        **{f"{word}_parts": len(one.parts) for word, one in parteds.items()},
    }
    return {
        "equations": render("block_equations.c.in", words),
        "factors": render("block_factors.c.in", words),
        "public_equations": render("block_public.c.in", words),
        "product": render("block_product.c.in", basics),
        "factor_fields": _fields(basics, str(room)) + "  int dense;\n  int regular;\n",
        "kept_factors": "kept",
        "irregular": f"  if (!kept->own.regular) return {basics['MACRO']}_SINGULAR;\n",
    }


def _fields(basics: dict[str, Any], room: str) -> str:
    """Members of a struct: a factorised matrix."""
    return f"  {basics['name']}_real factors[{room}];\n  int pivots[{basics['MACRO']}_UNKNOWNS];\n"


def _functions(render: Render, parted: Parted) -> str:
    names = [kernel.name() for kernel in parted.kernels]
    return "".join(render("part.c.in", {"function": _function(name), "kernel": name}) for name in names)


def _function(kernel: str) -> str:
    return f"call_{kernel}"


def _tables(word: str, parted: Parted) -> str:
    stem, lines, rows = word.upper(), list[str](), list[str]()
    for i, part in enumerate(parted.parts):
        tables: dict[str, Sequence[float]] = {
            "UNKNOWNS": part.x,
            "GIVEN": part.inputs,
            "CONSTANTS": part.constants,
            "ENTRIES": part.entries,
        }
        lines += [_table(f"{stem}_{key}_{i}", values) for key, values in tables.items()]
        names = [f"{stem}_{key}_{i}" if values else "0" for key, values in tables.items()]
        counts = [str(len(values)) for values in (part.x, part.inputs, part.entries)]
        rows.append(f"  {{{', '.join([_function(parted.kernels[part.kernel].name()), *names, *counts])}}}")
    # A scene without inputs has no part to list, and C no array without entries.
    listed = ",\n".join(rows or ["  {0, 0, 0, 0, 0, 0, 0, 0}"])
    return "".join(lines) + f"static const part {stem}_PARTS[] = {{\n{listed},\n}};\n"


def _fronts(fronts: Sequence[Front]) -> str:
    lines, rows = list[str](), list[str]()
    for i, front in enumerate(fronts):
        lines += [_table(f"MEMBERS_{i}", front.members), _table(f"EDGES_{i}", front.edges)]
        edges = f"EDGES_{i}" if front.edges else "0"
        rows.append(f"  {{MEMBERS_{i}, {edges}, {len(front.members)}, {len(front.edges)}, {front.first}}}")
    listed = ",\n".join(rows)
    return "".join(lines) + f"static const front FRONT_LIST[RODS] = {{\n{listed},\n}};\n"


def _table(name: str, values: Sequence[float]) -> str:
    """A constant array; nothing where it would be empty."""
    if not values:
        return ""
    kind = "int" if isinstance(values[0], int) else "real"
    return f"static const {kind} {name}[] = {{{_numbers(values)}}};\n"


def _numbers(values: Sequence[float]) -> str:
    text = ", ".join(str(value) if isinstance(value, int) else f"(real){value!r}" for value in values)
    return text if len(text) < 60 else "\n" + textwrap.fill(text, 116, initial_indent="  ", subsequent_indent="  ")
