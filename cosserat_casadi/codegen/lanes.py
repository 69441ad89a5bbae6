"""Kernels that compute several rows at once: the same C with vectors of the processor in place of its numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from cosserat_casadi.codegen.assembled import assembled
from cosserat_casadi.codegen.functions_in_c import functions_in_c
from cosserat_casadi.codegen.kernels import kernel, kernel_sources
from cosserat_casadi.codegen.library import LANES
from cosserat_casadi.codegen.memory import largest_room
from cosserat_casadi.codegen.names import Names
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


@dataclass(frozen=True)
class Shown:
    """Results of a kernel in a row of results.

    Attributes:
        kernel: its name.
        first: column of its first result.
        second: column of its second.
        others: what stands for the results that a row does not show.
    """

    kernel: str
    first: int
    second: int
    others: str = ""


def in_lanes(model: Model, names: Names, shown: Sequence[Shown], results: int) -> dict[str, str] | None:
    """Sources by file name that solve rows side by side; None for a model whose rows are solved one after the other.

    The first, ``{name}_side_by_side.c``, is a part of the library's own source.

    Args:
        model: what is solved.
        names: of the library.
        shown: where in a row of results there are results of kernels.
        results: numbers in a row of results.
    """
    # An assembly is eliminated rod after rod, which has no form for lanes.
    if assembled(model, names) is not None:
        return None
    wanted = {*map(names.kernel, EQUATIONS), *(place.kernel for place in shown)}
    entries = [entry for entry in functions_in_c(model, names) if entry.kernel in wanted]
    functions = [kernel(model, entry.function, entry.kernel, STRAIGHT_IN_LANES) for entry in entries]
    if not all(function.is_a("SXFunction") for function in functions):
        return None
    stem = f"{names.name}_lanes"
    generated = kernel_sources(functions, names, stem)
    source = generated[f"{stem}.c"]
    bodies = re.findall(r"^(?:static int|CASADI_SYMBOL_EXPORT int) .*?^\}$", source, re.M | re.S)
    if not all(map(_alike, bodies)):
        return None
    words = {
        "name": names.name,
        "kernels": _with_lanes(source),
        "functions": "".join(f"KERNEL({entry.kernel})\n" for entry in entries),
        "prototypes": "".join(f"KERNEL_IN_LANES({entry.kernel});\n" for entry in entries),
        **_parameter_words(model, names, shown),
        "sizes": _sizes(generated[f"{stem}.h"]),
        "kernel_reals": largest_room(generated, "W") + 1,
        "kernel_integers": largest_room(generated, "IW") + 1,
        "results": results,
    }
    return {
        f"{names.name}_side_by_side.c": render("side_by_side.c.in", words),
        f"{stem}.c": render("lanes.c.in", words),
        **{file: resource("c", file) for file in LANES},
    }


def _parameter_words(model: Model, names: Names, shown: Sequence[Shown]) -> dict[str, str]:
    """What depends on whether the scene names parameters, which stand behind the inputs and change the start."""
    has_parameters = model.parameters.size > 0
    tangent = "solved_tangent_in_lanes.c.in" if has_parameters else "tangent_in_lanes.c.in"
    parameters = f", room->inputs + {names.macro}_INPUTS * LANES" if has_parameters else ""
    calls = [render("results_in_lanes.c.in", {**vars(place), "parameters": parameters}) for place in shown]
    return {
        "tangent": render(tangent, {"name": names.name}),
        "calls": "".join(calls),
        "parameters_in_source": ", const real *parameters" if has_parameters else "",
        "parameters_of_row": f", inputs + {names.macro}_INPUTS" if has_parameters else "",
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
