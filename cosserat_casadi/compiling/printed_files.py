"""C files of functions, for a library or for ``casadi.external``.

Functions of scalars are printed by scalars_in_c.py, functions of matrices by program_in_c.py. CasADi prints a function
with an instruction that neither supports: the literal linear system of a rotation, which is solved with pivoting, and
the contact of rods, which is computed only where they are near.
"""

from __future__ import annotations

import errno
import os
import re
import tempfile
import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path

import casadi as ca

from cosserat_casadi.compiling.listing import UnknownOperationError
from cosserat_casadi.compiling.printed_kernels import Kernel, PrintedKernel, printed_sources
from cosserat_casadi.compiling.program_in_c import program_in_c
from cosserat_casadi.compiling.scalars_in_c import scalars_in_c
from cosserat_casadi.compiling.steps import UnknownInstructionError, program_of
from cosserat_casadi.compiling.texts import fill, resource
from cosserat_casadi.errors import WriteError
from cosserat_casadi.maths.calls import chooses

QUIET = """/* All kernels have the arguments of CasADi, whether they need them or not. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
"""

HIDDEN = """/* Functions that CasADi's code calls are seen by the library alone. */
#include <math.h>
#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility push(hidden)
#endif
{text}#if defined(__GNUC__) && !defined(_WIN32)
#pragma GCC visibility pop
#endif
"""

OF_EXTERNALS = """#ifndef CASADI_SYMBOL_EXPORT
#if defined(_WIN32)
#define CASADI_SYMBOL_EXPORT __declspec(dllexport)
#else
#define CASADI_SYMBOL_EXPORT
#endif
#endif
"""

TYPES = """#ifndef casadi_real
#define casadi_real double
#endif
#ifndef casadi_int
#define casadi_int {integer}
#endif
"""

BEGIN = """#ifdef __cplusplus
extern "C" {
#endif
"""

END = """#ifdef __cplusplus
} /* extern "C" */
#endif
"""
"""Last lines of every file, including files of CasADi."""

GENERATOR = {"with_header": True}

HELPER = re.compile(r"^(?:void|casadi_real|casadi_int|int) casadi_\w+\(", re.MULTILINE)
"""Pattern of the first line of a function of CasADi's runtime, which is no kernel."""

PROTOTYPE = re.compile(r"^(?:void|int|const \w+ ?\*|casadi_int|casadi_real) ?(?!casadi_)\w+\([^{;]*\);", re.MULTILINE)
"""Pattern of the declaration of a kernel in CasADi's header."""


def external_sources(functions: Sequence[ca.Function], stem: str, integer: str) -> dict[str, str]:
    """Write source and header of functions that ``casadi.external`` loads, by file name.

    Args:
        functions: the functions.
        stem: stem of the file names.
        integer: type of integers in C.
    """
    return printed_files(functions, stem, integer, QUIET + OF_EXTERNALS, described=True)


def in_c(kernel: Kernel) -> Kernel:
    """Print a kernel; return the function itself if CasADi has to print it."""
    if not isinstance(kernel, ca.Function) or chooses(kernel):
        return kernel
    try:
        if kernel.is_a("SXFunction"):
            return scalars_in_c(kernel, kernel)
        return program_in_c(program_of(kernel), kernel)
    except (UnknownInstructionError, UnknownOperationError):
        return kernel


def printed_files(
    kernels: Sequence[Kernel],
    stem: str,
    integer: str,
    prologue: str,
    *,
    described: bool = False,
    on_device: bool = False,
) -> dict[str, str]:
    """Write source and header, and the files that the source includes.

    Args:
        kernels: the kernels.
        stem: stem of the file names.
        integer: type of integers in C.
        prologue: beginning of the source.
        described: whether functions follow that describe arguments and results to ``casadi.external``.
        on_device: whether compilers for GPUs must accept them too.
    """
    written = [in_c(kernel) for kernel in kernels]
    own = [kernel for kernel in written if isinstance(kernel, PrintedKernel)]
    by_casadi = [kernel for kernel in written if isinstance(kernel, ca.Function)]
    sources = printed_sources(own, stem, "SOLVER_DEVICE " if on_device else "")
    types = TYPES.format(integer=integer)
    descriptions = "".join(_description(kernel) for kernel in own) if described else ""
    source = f"#include <math.h>\n{types}{BEGIN}{sources.source}{descriptions}{END}"
    header = f"{BEGIN}{types}{sources.prototypes}{END}"
    if by_casadi:
        generated = _by_casadi(by_casadi, stem, integer)
        if on_device:
            # Kernels, and the functions that kernels call, are functions of the device.
            on_hosts = {file: PROTOTYPE.sub(r"SOLVER_DEVICE \g<0>", text) for file, text in generated.items()}
            generated = {file: HELPER.sub(r"static \g<0>", text) for file, text in on_hosts.items()}
        text = generated[f"{stem}.c"]
        source = (text if described else HIDDEN.format(text=text)) + source
        header = generated[f"{stem}.h"] + header
    return {f"{stem}.c": prologue + source, f"{stem}.h": header, **sources.included}


def _description(kernel: PrintedKernel) -> str:
    """Write functions in C that describe arguments and results to ``casadi.external``."""
    function = kernel.signature
    arguments = [function.sparsity_in(i) for i in range(function.n_in())]
    results = [function.sparsity_out(i) for i in range(function.n_out())]
    words = {
        "name": kernel.name(),
        "arguments": len(arguments),
        "results": len(results),
        "names_in": _listed(f'"{name}"' for name in function.name_in()),
        "names_out": _listed(f'"{name}"' for name in function.name_out()),
        "sparsities_in": _patterns("in", arguments),
        "sparsities_out": _patterns("out", results),
        "reals": kernel.reals,
    }
    return fill(resource("templates", "external.c.in"), words)


def _patterns(side: str, patterns: Sequence[ca.Sparsity]) -> str:
    """Write constant arrays of sparsity patterns, and one of pointers to them."""
    tables = []
    for i, pattern in enumerate(patterns):
        numbers = [*pattern.shape, 1] if pattern.is_dense() else [*pattern.shape, *pattern.colind(), *pattern.row()]
        tables.append(f"  static const casadi_int {side}_{i}[] = {{{_listed(map(str, numbers))}}};\n")
    pointers = _listed(f"{side}_{i}" for i in range(len(patterns)))
    return "".join(tables) + f"  static const casadi_int *const every[] = {{{pointers}}};\n"


def _listed(texts: Iterable[str]) -> str:
    return textwrap.fill(", ".join(texts) or "0", 110, subsequent_indent="    ", break_long_words=False)


def _by_casadi(functions: Sequence[ca.Function], stem: str, integer: str) -> dict[str, str]:
    """Let CasADi write source and header.

    Raises:
        WriteError: the disk was full. CasADi does not check its writes, and leaves truncated files.
    """
    generator = ca.CodeGenerator(stem, {**GENERATOR, "casadi_int": integer})
    for function in functions:
        generator.add(function)
    files = {}
    with tempfile.TemporaryDirectory() as folder:
        generator.generate(f"{folder}/")
        for name in (f"{stem}.c", f"{stem}.h"):
            file = Path(folder) / name
            files[name] = file.read_text(encoding="utf-8")
            if not files[name].endswith(END):
                raise WriteError(file, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))
    return files
