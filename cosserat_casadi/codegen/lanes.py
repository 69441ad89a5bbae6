"""Kernels that compute several rows at once: the same C with vectors of the processor in place of its numbers."""

from __future__ import annotations

import re
from collections.abc import Sequence

import casadi as ca

from cosserat_casadi.codegen.kernels import kernel_sources
from cosserat_casadi.codegen.library import render
from cosserat_casadi.codegen.names import Names

NUMBER = r"-?(?:\d+\.?\d*(?:e[+-]?\d+)?|INFINITY|NAN)"

LANEWISE = ("sqrt", "exp")
"""Functions of the mathematical library that ``lanes_arithmetic.h`` has for lanes."""

UNLIKE = re.compile(r"(?<![<>=!])(?:[<>]=?|[!=]=|!|&&|\|\|)(?![<>=])|\?")
"""Comparisons, and choices between two values: what lanes would answer each in its own way."""

CALL = re.compile(r"\b([a-z]\w*)\(")

PLAIN_LOOP = re.compile(r"\bfor \((?:[^()]|\([^()]*\))*\)")

OWN = re.compile(r"casadi_(?:f\d+|sq|fmax|fabs|copy|clear|fill|dot|densify|mtimes\w*)")
"""Routines of CasADi's that are the same for lanes."""


def lane_source(functions: Sequence[ca.Function], names: Names) -> str | None:
    """Source of kernels for several rows at once; None where one of them does what lanes cannot do together.

    Args:
        functions: the kernels.
        names: of the library.
    """
    stem = f"{names.name}_lanes_kernels"
    source = kernel_sources(functions, names, stem)[f"{stem}.c"]
    bodies = re.findall(r"^(?:static int|CASADI_SYMBOL_EXPORT int) .*?^\}$", source, re.M | re.S)
    if not all(map(_alike, bodies)):
        return None
    words = {
        "name": names.name,
        "kernels": _with_lanes(source),
        "functions": "\n".join(f"IN_LANES_OF({function.name()})" for function in functions),
    }
    return render("lanes.c.in", words)


def _alike(body: str) -> bool:
    """Whether a function does the same in all lanes: no comparison of values, no function without a form for lanes."""
    for line in body.splitlines()[1:]:
        code = re.sub(r"/\*.*\*/", "", line)
        code = re.sub(r"\barg\[\d+\] ?\? ?arg\[\d+\](?:\[\d+\])? : (?:0|casadi_zeros)", "given", code)
        code = re.sub(r"\bif \((?:res|arg)1?\[\d+\](?: ?!= ?0)?\)", "", code)
        code = re.sub(r"\bif \(casadi_f\d+\([^()]*\)\) return 1;", "", code)
        code = PLAIN_LOOP.sub("", code)
        if UNLIKE.search(code):
            return False
        called = set(CALL.findall(code)) - set(LANEWISE)
        if not all(OWN.fullmatch(name) for name in called):
            return False
    return True


def _with_lanes(source: str) -> str:
    """A source of CasADi's with numbers that stand alone spread to all lanes, and functions for lanes."""
    # What is before the file's own beginning sets the type of single numbers.
    source = source[source.index("/* This file was") :]
    source = re.sub(rf"^(\s+\w+ ?= ?)({NUMBER});", r"\1IN_ALL(\2);", source, flags=re.M)
    source = re.sub(r"(arg\[\d+\] ?\? ?arg\[\d+\]\[\d+\] : )0;", r"\1IN_ALL(0);", source)
    source = re.sub(r"^(\s+(?:if .*\) )?res\[\d+\]\[\d+\]=)({NUMBER});", r"\1IN_ALL(\2);", source, flags=re.M)
    source = re.sub(r"(\*[xy]\+\+ = )(0\.?);", r"\1IN_ALL(\2);", source)
    source = re.sub(rf"(?<!\w)({'|'.join(LANEWISE)})\(", r"lanes_\1(", source)
    source = re.sub(r"(static casadi_real casadi_fmax\(.*?\) \{\n).*?^\}", _FMAX, source, flags=re.M | re.S)

    def spread(table: re.Match[str]) -> str:
        numbers = re.sub(NUMBER, lambda number: f"ALIKE({number[0]})", table[2])
        return f"{table[1]}{numbers}}};"

    tables = r"^(static const casadi_real \w+\[\d+\] =\s*\{)(.*?)\};"
    return re.sub(tables, spread, source, flags=re.M | re.S)


_FMAX = r"\1  return lanes_fmax(x, y);\n}"
