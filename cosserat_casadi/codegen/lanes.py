"""Kernels that compute several rows at once: their C with vectors of the processor in place of numbers.

``NAME_solve_batch`` of a library with lanes solves its cases side by side, and so do the rows of large sweeps.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosserat_casadi.codegen.blocks import blocks
from cosserat_casadi.codegen.functions_in_c import functions_in_c
from cosserat_casadi.codegen.kernels import kernel
from cosserat_casadi.codegen.memory import largest_room, stack_bytes
from cosserat_casadi.codegen.names import Names
from cosserat_casadi.codegen.parameters import given_size
from cosserat_casadi.compiling.listing import LANES, UnknownOperationError
from cosserat_casadi.compiling.printed_kernels import printed_sources
from cosserat_casadi.compiling.scalars_in_c import scalars_in_c
from cosserat_casadi.compiling.statements import LANES_OF_ROWS
from cosserat_casadi.compiling.texts import render, resource
from cosserat_casadi.model.build import Model

EQUATIONS = ("residual", "jacobian", "rate", "tangent", "resolution_index")
"""Words in the names of the kernels in lanes, by which rows are solved."""

STRAIGHT_IN_LANES = 60_000
"""Most instructions of a kernel by which rows are solved side by side. Its code has no loops and passes through no
arrays: its cost is its length, which four rows share. Loops in lanes are slower than rows one after the other, whose
Jacobians have their columns in lanes (``benchmarks/row_cost.py``)."""

ROWS_TOGETHER = 16
"""Number of rows under way at a time, so that enough rows wait for each kernel."""

FILES = ("lanes.h", "lanes_arithmetic.h", "lanes_linear.c", "lanes.c")
"""Files of the folder ``c`` that a library with lanes contains unchanged."""


@dataclass(frozen=True)
class InLanes:
    """Additional files and words of a library with lanes.

    Attributes:
        files: sources and headers by name.
        words: words for batches in the library's own source and header.
    """

    files: Mapping[str, str]
    words: Mapping[str, Any]


def lanes_files(name: str) -> tuple[str, str]:
    """Return the file names of the source and header of a library's equations in lanes."""
    return f"{name}_lanes.c", f"{name}_lanes.h"


def in_lanes(model: Model, names: Names) -> InLanes | None:
    """Make files and words to solve cases side by side; None for a model whose cases are solved one after the other."""
    # An assembly is eliminated rod after rod, which has no form for lanes.
    if blocks(model.discrete, model.path_jacobian.sparsity_out(0)) is not None:
        return None
    wanted = {*map(names.kernel, EQUATIONS)}
    entries = [entry for entry in functions_in_c(model, names) if entry.kernel in wanted]
    functions = [kernel(model, entry.function, entry.kernel, STRAIGHT_IN_LANES) for entry in entries]
    if not all(function.is_a("SXFunction") for function in functions):
        return None
    try:
        written = [scalars_in_c(function, function, LANES_OF_ROWS) for function in functions]
    except UnknownOperationError:
        return None
    source_file, header_file = lanes_files(names.name)
    sources = printed_sources(written, f"{names.name}_lanes")
    generated = {source_file: sources.source, header_file: sources.prototypes}
    words = {
        "name": names.name,
        "kernels": sources.functions,
        "functions": "".join(f"KERNEL({entry.kernel})\n" for entry in entries),
        "prototypes": "".join(f"KERNEL_IN_LANES({entry.kernel});\n" for entry in entries),
        "sizes": _sizes(sources.prototypes),
    }
    files = {
        source_file: render("lanes.c.in", words),
        header_file: render("lanes.h.in", words),
        **{file: resource("c", file) for file in FILES},
    }
    return InLanes(files, _batch_words(model, names, generated))


def _batch_words(model: Model, names: Names, generated: Mapping[str, str]) -> dict[str, Any]:
    """Words for batches: their memory, and the arguments with or without parameters."""
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
    """Sizes of the arrays of the kernels in a header, under the names of kernels in lanes."""
    macros = re.findall(r"^#define (\w+)_(SZ_\w+ \d+)$", header, re.M)
    return "".join(f"#define {kernel}_in_lanes_{size}\n" for kernel, size in macros)
