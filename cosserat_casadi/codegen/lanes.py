"""Kernels that compute several rows at once: the same C with vectors of the processor in place of its numbers.

``NAME_solve_batch`` of a library with lanes solves its cases side by side, and so do the rows of large sweeps.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.columns import LANES
from cosserat_casadi.codegen.functions_in_c import functions_in_c
from cosserat_casadi.codegen.kernels import kernel, kernel_sources
from cosserat_casadi.codegen.memory import largest_room, stack_bytes
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import given_size
from cosserat_casadi.codegen.texts import render, resource
from cosserat_casadi.model.build import Model

EQUATIONS = ("residual", "jacobian", "rate", "tangent", "resolution_index")
"""Words in the names of the kernels that solve a row."""

STRAIGHT_IN_LANES = 60_000
"""Instructions of a kernel up to which rows are solved side by side. Its code is without loops, which has no memory to
go through: what makes it slow, its length, four rows share. Loops in lanes are slower than rows one after the other,
whose Jacobians have their columns in lanes (``benchmarks/row_cost.py``)."""

NUMBER = r"-?(?:\d+\.?\d*(?:e[+-]?\d+)?|INFINITY|NAN)"

LANEWISE = ("sqrt", "exp")
"""Functions of the mathematical library that ``lanes_arithmetic.h`` has for lanes."""

UNLIKE = re.compile(r"(?<![<>=!])(?:[<>]=?|[!=]=|!|&&|\|\|)(?![<>=])|\?")
"""Comparisons, and choices between two values: what lanes would answer each in its own way."""

CALL = re.compile(r"\b([a-z]\w*)\(")

HARMLESS = (
    re.compile(r"/\*.*?\*/"),
    re.compile(r"\barg\[\d+\] ?\? ?arg\[\d+\](?:\[\d+\])? : (?:0|casadi_zeros)"),
    re.compile(r"\bif \((?:res|arg)1?\[\d+\](?: ?!= ?0)?\)"),
    re.compile(r"\bif \(casadi_f\d+\([^()]*\)\) return 1;"),
    re.compile(r"\bfor \((?:[^()]|\([^()]*\))*\)"),
)
"""What CasADi asks of its arguments and of its loops, which is the same in all lanes."""

OWN = re.compile(r"casadi_(?:f\d+|sq|fmax|fabs|copy|clear|fill|dot|densify|mtimes\w*)")
"""Routines of CasADi's that are the same for lanes."""


ROWS_TOGETHER = 16
"""Rows under way at a time: enough of them wait for the same."""

FILES = ("lanes.h", "lanes_arithmetic.h", "lanes_linear.c", "lanes.c")
"""Files of the folder ``c`` that a library with lanes has, as they are."""


@dataclass(frozen=True)
class InLanes:
    """What a library with lanes has beside the others.

    Attributes:
        files: sources and headers by name.
        words: of the batch in the library's own source and header.
    """

    files: Mapping[str, str]
    words: Mapping[str, Any]


def lanes_files(name: str) -> tuple[str, str]:
    """Names of the source and header of a library's equations in lanes."""
    return f"{name}_lanes.c", f"{name}_lanes.h"


def in_lanes(model: Model, names: Names) -> InLanes | None:
    """What solves cases side by side; None for a model whose cases are solved one after the other.

    Args:
        model: what is solved.
        names: of the library.
    """
    # An assembly is eliminated rod after rod, which has no form for lanes.
    if assembled(model, names) is not None:
        return None
    wanted = {*map(names.kernel, EQUATIONS)}
    entries = [entry for entry in functions_in_c(model, names) if entry.kernel in wanted]
    functions = [kernel(model, entry.function, entry.kernel, STRAIGHT_IN_LANES) for entry in entries]
    if not all(function.is_a("SXFunction") for function in functions):
        return None
    stem = f"{names.name}_lanes"
    generated = kernel_sources(functions, names, stem)
    source_file, header_file = lanes_files(names.name)
    bodies = re.findall(r"^(?:static int|CASADI_SYMBOL_EXPORT int) .*?^\}$", generated[source_file], re.M | re.S)
    if not all(map(_alike, bodies)):
        return None
    words = {
        "name": names.name,
        "kernels": _with_lanes(generated[source_file]),
        "functions": "".join(f"KERNEL({entry.kernel})\n" for entry in entries),
        "prototypes": "".join(f"KERNEL_IN_LANES({entry.kernel});\n" for entry in entries),
        "sizes": _sizes(generated[header_file]),
    }
    files = {
        source_file: render("lanes.c.in", words),
        header_file: render("lanes.h.in", words),
        **{file: resource("c", file) for file in FILES},
    }
    return InLanes(files, _batch_words(model, names, generated))


def _batch_words(model: Model, names: Names, generated: Mapping[str, str]) -> dict[str, Any]:
    """Words of the batch: its memory, and what depends on whether the scene names parameters."""
    has_parameters = model.parameters.size > 0
    tangent = "solved_tangent_in_lanes.c.in" if has_parameters else "tangent_in_lanes.c.in"
    row = "batch->inputs + (size_t)i * INPUTS"
    if has_parameters:
        own_inputs = "batch->inputs + (size_t)i * OWN_INPUTS"
        row = f"stack({own_inputs}, batch->parameters + (size_t)i * PARAMETERS, work->stacked)"
    return {
        "given_size": given_size(model),
        "rows_together": ROWS_TOGETHER,
        "lanes_reals": largest_room(generated, "W") + 1,
        "lanes_integers": largest_room(generated, "IW") + 1,
        "lanes_stack_kb": f"{np.ceil(LANES * stack_bytes(generated) / 500) / 2:g}",
        "tangent": render(tangent, {"name": names.name}),
        "given_in_lanes": row,
        "parameters_or_none": "parameters" if has_parameters else "0",
    }


def _sizes(header: str) -> str:
    """What the kernels of a header ask for, as of kernels in lanes."""
    macros = re.findall(r"^#define (\w+)_(SZ_\w+ \d+)$", header, re.M)
    return "".join(f"#define {kernel}_in_lanes_{size}\n" for kernel, size in macros)


def _alike(body: str) -> bool:
    """Whether a function does the same in all lanes: no comparison of values, no function without a form for lanes."""
    code = body.partition("\n")[2]
    for harmless in HARMLESS:
        code = harmless.sub("", code)
    called = set(CALL.findall(code)) - set(LANEWISE)
    return not UNLIKE.search(code) and all(OWN.fullmatch(name) for name in called)


def _with_lanes(source: str) -> str:
    """A source of CasADi's with numbers that stand alone spread to all lanes, and functions for lanes."""
    # What is before the file's own beginning sets the type of single numbers.
    source = source[source.index("/* This file was") :]
    source = re.sub(rf"^(\s+\w+ ?= ?)({NUMBER});", r"\1IN_ALL(\2);", source, flags=re.M)
    source = re.sub(r"(arg\[\d+\] ?\? ?arg\[\d+\]\[\d+\] : )0;", r"\1IN_ALL(0);", source)
    source = re.sub(r"^(\s+(?:if .*\) )?res\[\d+\]\[\d+\]=)({NUMBER});", r"\1IN_ALL(\2);", source, flags=re.M)
    source = re.sub(r"(\*[xy]\+\+ = )(0\.?);", r"\1IN_ALL(\2);", source)
    source = re.sub(rf"(?<!\w)({'|'.join(LANEWISE)})\(", r"lanes_\1(", source)
    source = source.replace("static casadi_real casadi_sq(", "IN_PLACE casadi_real casadi_sq(")
    # CasADi has routines of its own around these.
    body = r"(static casadi_real casadi_(fmax|fabs)\(casadi_real x(, casadi_real y)?\) \{\n).*?^\}"
    source = re.sub(body, _routine, source, flags=re.M | re.S)

    def spread(table: re.Match[str]) -> str:
        numbers = re.sub(NUMBER, lambda number: f"ALIKE({number[0]})", table[2])
        return f"{table[1]}{numbers}}};"

    tables = r"^(static const casadi_real \w+\[\d+\] =\s*\{)(.*?)\};"
    return re.sub(tables, spread, source, flags=re.M | re.S)


def _routine(found: re.Match[str]) -> str:
    given = "x, y" if found[3] else "x"
    return f"{found[1]}  return lanes_{found[2]}({given});\n}}"
