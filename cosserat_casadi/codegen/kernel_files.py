"""C files of the kernels of a library, and of its functions with derivatives for ``casadi.external``."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from cosserat_casadi.codegen.names import Names
from cosserat_casadi.compiling.printed_files import QUIET, external_sources, printed_files
from cosserat_casadi.compiling.printed_kernels import Kernel

OF_A_LIBRARY = """#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "The solver looks for values that are not finite: compile without -ffast-math."
#endif
#ifdef {macro}_SINGLE
#define casadi_real float
#endif
/* Kernels are seen by the library alone. */
#if defined(__GNUC__) && !defined(_WIN32)
#define CASADI_SYMBOL_EXPORT __attribute__((visibility("hidden")))
#else
#define CASADI_SYMBOL_EXPORT
#endif
"""

ON_DEVICE = """#ifdef SOLVER_DEVICE
#undef CASADI_SYMBOL_EXPORT
#define CASADI_SYMBOL_EXPORT SOLVER_DEVICE
#endif
"""
"""Declarations of kernels for the source of batches on a GPU, which includes them."""


def kernel_sources(
    kernels: Sequence[Kernel], names: Names, stem: str | None = None, *, on_device: bool = False
) -> dict[str, str]:
    """Write source and header of the kernels, by file name; they compute in float if the library does.

    Args:
        kernels: the kernels.
        names: names of the library.
        stem: stem of the file names.
        on_device: whether compilers for GPUs must accept them too.
    """
    prologue = QUIET + OF_A_LIBRARY.format(macro=names.macro) + (ON_DEVICE if on_device else "")
    return printed_files(kernels, stem or f"{names.name}_kernels", "int", prologue, on_device=on_device)


def derivative_source(functions: Sequence[ca.Function], names: Names) -> dict[str, str]:
    """Write the source of a library's functions with derivatives, for ``casadi.external``, by file name."""
    stem = f"{names.name}_derivatives"
    # casadi.external expects the integers that CasADi itself was built with.
    written = external_sources(functions, stem, "long long int")
    # Nothing else includes their prototypes.
    del written[f"{stem}.h"]
    return written
